//! The complete state of a pad, from reports that each hold a part of it.

use crate::report::PadReport;
use crate::sample::{Body, DeviceId, Pad, Sample};

/// The pad of one device. A sample is made only when something changed: most reports repeat the
/// last.
#[derive(Debug, Clone)]
pub struct PadState {
    device: DeviceId,
    pad: Pad,
}

impl PadState {
    /// A pad with nothing pressed and every wheel at 0.
    pub fn new(device: DeviceId) -> Self {
        PadState { device, pad: Pad::default() }
    }

    /// Takes what one report says, and emits the new state if it differs from the last.
    pub fn report(&mut self, r: &PadReport, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        let mut next = self.pad;
        if let Some(keys) = r.keys {
            next.keys = keys;
        }
        if let Some((wheel, steps)) = r.turned
            && let Some(count) = next.wheels.get_mut(usize::from(wheel))
        {
            *count = count.saturating_add(steps);
        }
        if let Some((strip, place)) = r.strip
            && let Some(slot) = next.strips.get_mut(usize::from(strip))
        {
            *slot = place.filter(|p| p.is_finite()).map(|p| p.clamp(0.0, 1.0));
        }
        self.set(next, t_us, emit);
    }

    /// The device was unplugged: every key is released.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.set(Pad { wheels: self.pad.wheels, ..Pad::default() }, t_us, emit);
    }

    fn set(&mut self, next: Pad, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        if next != self.pad {
            self.pad = next;
            emit(Sample { device: self.device, t_us, device_t_us: None, body: Body::Pad(next) });
        }
    }
}
