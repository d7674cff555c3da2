//! What visitors touch, as the loop publishes it.

use crate::Published;
use crate::adaptors::ATTRACT_IDS;

/// Id of the hands in the list of touching pens.
const HAND: u16 = u16::MAX;

/// A pen that presses, or a hand over the tracker: bare hands touch nothing.
pub(super) fn is_at_work(felt: &(u16, [f32; 3])) -> bool {
    felt.0 == HAND || felt.1[2] > 0.0
}

/// Returns what visitors touch now: their pens and hands, without those of the attract loop. `None`
/// if they touch nothing.
pub(super) fn touch(state: &Published) -> Option<Vec<(u16, [f32; 3])>> {
    let mut felt: Vec<(u16, [f32; 3])> = Vec::new();
    for (id, pen) in state.pens.iter().flatten() {
        if !ATTRACT_IDS.contains(&id.0) {
            // Some pens report a resting pressure in the air.
            let presses = state.pressing.iter().flatten().any(|p| p == id);
            let pressure = if presses { pen.pressure.max(f32::MIN_POSITIVE) } else { 0.0 };
            felt.push((id.0, [pen.view.x, pen.view.y, pressure]));
        }
    }
    let visitors = state.hand_devices.iter().flatten().any(|id| !ATTRACT_IDS.contains(&id.0));
    if let Some(hands) = state.hands.as_ref().filter(|_| visitors) {
        felt.extend(hands.as_slice().iter().map(|h| (HAND, h.palm.to_array())));
    }
    (!felt.is_empty()).then_some(felt)
}
