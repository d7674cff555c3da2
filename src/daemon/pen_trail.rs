//! Every place of every tablet's pen, and every press of a pad's key, from the tick thread to the
//! window.
//!
//! A window learns from it where the desktop puts a pen. The published state alone does not do: a
//! window looks at it once a frame, and a pen that is drawn by a processor in a slow frame has been
//! in many places since.
//!
//! Law kept here: the tick thread never waits. Where nobody takes the places, the newest are
//! dropped.

use crossbeam_channel as cc;
use glam::Vec2;

use sculptd_devices::{Body, DeviceId, Sample};

use crate::adaptors::TABLET_IDS;

/// Places that wait for the window: some ten seconds of two pens at 200 Hz.
const CAPACITY: usize = 4096;

/// Pads whose keys are followed.
const PADS: usize = 16;

/// Position of a pen at one time, or the press of a pad's key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailPoint {
    /// The tablet.
    pub device: DeviceId,
    /// Time on the daemon's clock, in microseconds.
    pub t_us: u64,
    /// Position as shares of the tablet's area; `None`: the pen has left the tablet's range.
    pub share: Option<Vec2>,
    /// The tip touches.
    pub tip: bool,
    /// A key of the pad was pressed; of the pen nothing is said.
    pub key: bool,
}

/// The tick thread's end.
#[derive(Debug)]
pub struct PenTrailSender {
    to: cc::Sender<TrailPoint>,
    /// The keys of each pad that are down.
    keys: Vec<(DeviceId, u32)>,
}

/// The window's end. Each place comes out of one of the clones.
#[derive(Debug, Clone)]
pub struct PenTrail(cc::Receiver<TrailPoint>);

/// Both ends.
pub fn pen_trail() -> (PenTrailSender, PenTrail) {
    let (to, from) = cc::bounded(CAPACITY);
    (PenTrailSender { to, keys: Vec::with_capacity(PADS) }, PenTrail(from))
}

impl PenTrailSender {
    /// Tells of the samples of a tick.
    pub fn send(&mut self, samples: &[Sample]) {
        for sample in samples.iter().filter(|s| TABLET_IDS.contains(&s.device.0)) {
            let (device, t_us) = (sample.device, sample.t_us);
            let point = match &sample.body {
                Body::Pen(pen) => {
                    let share = pen.pos_mm / pen.area_mm.max(Vec2::splat(1e-3));
                    let share = pen.in_range.then_some(share);
                    TrailPoint { device, t_us, share, tip: pen.tip && pen.in_range, key: false }
                }
                Body::Pad(pad) if self.presses(device, pad.keys) => {
                    TrailPoint { device, t_us, share: None, tip: false, key: true }
                }
                Body::Pad(_) | Body::Hands(_) => continue,
            };
            let _ = self.to.try_send(point);
        }
    }

    /// Returns true if a key of a pad is newly down.
    fn presses(&mut self, device: DeviceId, keys: u32) -> bool {
        let at = self.keys.iter().position(|k| k.0 == device);
        if at.is_none() && self.keys.len() >= PADS {
            return false;
        }
        let at = at.unwrap_or_else(|| {
            self.keys.push((device, 0));
            self.keys.len() - 1
        });
        keys & !std::mem::replace(&mut self.keys[at].1, keys) != 0
    }
}

impl PenTrail {
    /// Returns the points since the last call, oldest first.
    pub fn take(&self) -> impl Iterator<Item = TrailPoint> + '_ {
        self.0.try_iter().take(CAPACITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::{Pad, Pen};

    #[test]
    fn each_press_of_a_key_is_told_once() {
        let (mut to, from) = pen_trail();
        let pad = |device, t_us, keys| Sample {
            device: DeviceId(device),
            t_us,
            device_t_us: None,
            body: Body::Pad(Pad { keys, ..Pad::default() }),
        };
        to.send(&[pad(0, 1, 1), pad(0, 2, 3), pad(0, 3, 2), pad(1, 4, 2), pad(0, 5, 0)]);
        let told: Vec<(u64, bool)> = from.take().map(|p| (p.t_us, p.key)).collect();
        assert_eq!(told, [(1, true), (2, true), (4, true)]);
    }

    #[test]
    fn a_tablets_places_come_in_order_and_nobody_waits() {
        let (mut to, from) = pen_trail();
        let sample = |device, i: u64, in_range| Sample {
            device: DeviceId(device),
            t_us: i,
            device_t_us: None,
            body: Body::Pen(Pen {
                in_range,
                pos_mm: Vec2::new(i as f32, 50.0),
                area_mm: Vec2::splat(100.0),
                ..Pen::default()
            }),
        };
        // A pointer's own samples are none of a tablet's.
        to.send(&[sample(0, 1, true), sample(crate::adaptors::POINTER_ID.0, 2, true)]);
        to.send(&[sample(0, 3, false)]);
        let all: Vec<TrailPoint> = from.take().collect();
        assert_eq!(all.iter().map(|p| p.t_us).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(all[0].share, Some(Vec2::new(0.01, 0.5)));
        assert_eq!(all[1].share, None);
        for i in 0..10_000 {
            to.send(&[sample(0, i, true)]);
        }
        assert_eq!(from.take().count(), CAPACITY);
    }
}
