//! Bare hands: from tracked joints to tools that touch the clay.

mod volume;

pub use volume::Volume;

use std::collections::VecDeque;

use glam::Vec3;

use crate::brush::Push as PushKernel;
use crate::devices::{DeviceId, Hands};
use crate::mesh::Reach;

/// A hand that was not seen for longer than this starts anew: 100 ms is bridged, as one occluded moment.
const BRIDGE_US: u64 = 100_000;
/// Fingertip tool radius in mm: a fingertip is 14 to 18 mm wide, and clay gives.
const TIP_RADIUS_MM: f32 = 12.0;
/// A hand pushes softly in its first moments: 0.75 s after it appears it has its full strength, so that a hand that comes
/// into view inside the clay does not tear it.
const RAMP_US: u64 = 750_000;
/// Swept pushes waiting for budget; the oldest two are joined when it is full.
const MAX_WAITING: usize = 256;

/// A tool swept from one place to another, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    pub from: Vec3,
    pub to: Vec3,
    pub radius: f32,
    /// Share of the full displacement, 0 to 1.
    pub strength: f32,
}

impl Push {
    pub fn reach(&self) -> Reach {
        Reach::Capsule { from: self.from, to: self.to, radius: self.radius }
    }

    pub fn kernel(&self) -> PushKernel {
        PushKernel::new(self.from, self.to, self.radius, self.strength)
    }
}

#[derive(Debug, Clone, Copy)]
struct Track {
    device: DeviceId,
    hand: i32,
    since_us: u64,
    seen_us: u64,
    tip: Vec3,
}

/// The state of all hands between samples.
#[derive(Debug)]
pub struct HandTools {
    tracks: Vec<Track>,
    waiting: VecDeque<Push>,
    touching: bool,
}

impl Default for HandTools {
    fn default() -> Self {
        HandTools {
            tracks: Vec::with_capacity(16),
            waiting: VecDeque::with_capacity(MAX_WAITING),
            touching: false,
        }
    }
}

impl HandTools {
    /// Takes one frame of one tracker.
    pub fn take(&mut self, device: DeviceId, t_us: u64, hands: &Hands, volume: &Volume) {
        self.tracks.retain(|t| t.device != device || t_us.saturating_sub(t.seen_us) <= BRIDGE_US);
        for hand in hands.as_slice() {
            let Some(index) = hand.fingers[1] else { continue };
            if index.extended == Some(false) {
                continue;
            }
            let tip = volume.to_world(index.tip);
            let known = self.tracks.iter_mut().find(|t| t.device == device && t.hand == hand.id);
            let Some(track) = known else {
                if self.tracks.len() < self.tracks.capacity() {
                    self.tracks.push(Track { device, hand: hand.id, since_us: t_us, seen_us: t_us, tip });
                }
                continue;
            };
            let ramp = (t_us.saturating_sub(track.since_us) as f32 / RAMP_US as f32).min(1.0);
            let strength =
                ramp * hand.confidence.unwrap_or(1.0).clamp(0.0, 1.0) * volume.edge_fade(index.tip);
            let push = Push { from: track.tip, to: tip, radius: TIP_RADIUS_MM * volume.scale(), strength };
            (track.tip, track.seen_us) = (tip, t_us);
            if strength > 0.0 {
                self.wait(push);
            }
        }
        self.touching = !self.tracks.is_empty();
    }

    fn wait(&mut self, push: Push) {
        if self.waiting.len() >= MAX_WAITING {
            if let Some(last) = self.waiting.back_mut() {
                last.to = push.to;
                return;
            }
        }
        self.waiting.push_back(push);
    }

    pub fn next_push(&mut self) -> Option<Push> {
        self.waiting.pop_front()
    }

    /// A hand is over the clay or a push waits: the undo step stays open.
    pub fn is_touching(&self) -> bool {
        self.touching || !self.waiting.is_empty()
    }

    /// Forgets every hand: what was touching stops.
    pub fn lift(&mut self) {
        self.tracks.clear();
        self.touching = false;
    }
}
