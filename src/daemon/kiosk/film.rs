//! What plays while nobody is there: a recording cut to its strokes, or the strokes that come with
//! the program.

use std::path::Path;

use crate::startup::{Area, used_area};
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue::Sender;
use sculptd_devices::recording::{Player, RecordingError};
use sculptd_devices::{Body, DeviceId, Pen, Sample, Tool, sim};

/// Longest time without a touch that is shown, microseconds: nobody watches a still screen.
const PAUSE_US: u64 = 1_000_000;
/// Before the first touch, after the last one and between two films.
const REST_US: u64 = 500_000;
/// Time between two samples of the built-in film.
const STEP_US: u64 = 7_500;

/// Samples in order, their times counted from the film's beginning.
#[derive(Debug)]
pub struct AttractRecording {
    samples: Vec<Sample>,
    next: usize,
    ends_us: u64,
}

/// Returns true if the sample shows activity: a tip on the surface, or a hand in view.
fn touches(sample: &Sample) -> bool {
    match &sample.body {
        Body::Pen(pen) => pen.tip,
        Body::Hands(hands) => hands.count > 0,
        _ => false,
    }
}

impl AttractRecording {
    /// Reads a recording to its end; a film without a touch has no samples.
    pub fn open(
        path: &Path,
        as_device: DeviceId,
        aspect: f32,
        all: &Catalogue,
    ) -> Result<AttractRecording, RecordingError> {
        let mut player = Player::open(path, as_device, all)?;
        let area = used_area(Player::open(path, as_device, all)?, aspect);
        let mut samples = Vec::new();
        player.advance(u64::MAX, &mut |sample| samples.push(laid(sample, area)));
        Ok(AttractRecording::cut(samples))
    }

    /// The strokes that come with the program.
    pub fn own(as_device: DeviceId) -> AttractRecording {
        let journal = sim::journal();
        let sample = |t_us: u64| {
            let pose = journal.pen.at(t_us);
            let pen = Pen {
                tool: Tool::Pen,
                in_range: pose.in_range,
                tip: pose.tip,
                pos_mm: pose.pos_mm,
                area_mm: journal.area_mm,
                pressure: Some(pose.pressure),
                tilt: Some(pose.tilt),
                ..Pen::default()
            };
            Sample { device: as_device, t_us, device_t_us: None, body: Body::Pen(pen) }
        };
        AttractRecording::cut(
            (0..=journal.pen.end_us() / STEP_US + 1).map(|i| sample(i * STEP_US)).collect(),
        )
    }

    /// Leaves out what comes before the first touch and shortens every pause. The last word of each
    /// visit stays.
    fn cut(all: Vec<Sample>) -> AttractRecording {
        let Some(first) = all.iter().position(touches) else {
            return AttractRecording { samples: vec![], next: 0, ends_us: 0 };
        };
        let begin = all[first].t_us.saturating_sub(REST_US);
        // Shown time is the sample's own, less what was taken out before it.
        let (mut samples, mut out_us, mut felt_us) = (Vec::new(), begin, all[first].t_us);
        let mut before = felt_us;
        for mut sample in all.into_iter().filter(|s| s.t_us >= begin) {
            out_us += sample.t_us.saturating_sub(before.max(felt_us + PAUSE_US));
            before = sample.t_us.max(before);
            if touches(&sample) {
                felt_us = sample.t_us;
            }
            sample.t_us = sample.t_us.saturating_sub(out_us);
            samples.push(sample);
        }
        let ends_us = samples.last().map_or(0, |s| s.t_us) + REST_US;
        AttractRecording { samples, next: 0, ends_us }
    }

    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    pub fn rewind(&mut self) {
        self.next = 0;
    }

    /// Sends the samples due at `now_us` after the beginning, which is at `began_us` on the clock.
    /// Returns false once the recording has ended.
    pub fn play(&mut self, began_us: u64, now_us: u64, to: &mut Sender) -> bool {
        while let Some(sample) = self.samples.get(self.next).filter(|s| s.t_us <= now_us) {
            to.push(Sample { t_us: began_us + sample.t_us, ..*sample });
            self.next += 1;
        }
        to.flush();
        self.next < self.samples.len() || now_us < self.ends_us
    }

    /// Stops in the middle: whatever is down is lifted, whatever is in view leaves.
    pub fn stop(&mut self, now_us: u64, to: &mut Sender) {
        let Some(last) = self.next.checked_sub(1).and_then(|i| self.samples.get(i)) else { return };
        let body = match last.body {
            Body::Pen(pen) => {
                Body::Pen(Pen { in_range: false, tip: false, pressure: Some(0.0), ..pen })
            }
            Body::Hands(_) => Body::Hands(Default::default()),
            other => other,
        };
        to.push(Sample { t_us: now_us, body, ..*last });
        to.flush();
        self.next = self.samples.len();
    }
}

/// The part of the tablet that the recording uses, laid over the view.
fn laid(mut sample: Sample, area: Option<Area>) -> Sample {
    if let (Body::Pen(pen), Some(area)) = (&mut sample.body, area) {
        pen.pos_mm -= area.min;
        pen.area_mm = area.size;
    }
    sample
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pen(t_us: u64, tip: bool) -> Sample {
        let body = Body::Pen(Pen { in_range: true, tip, ..Pen::default() });
        Sample { device: DeviceId(1), t_us, device_t_us: None, body }
    }

    #[test]
    fn a_film_begins_with_its_first_touch_and_has_no_long_pause() {
        // A minute of nothing, a stroke, a minute of hover, a stroke.
        let mut all: Vec<Sample> = (0..600).map(|i| pen(i * 100_000, false)).collect();
        all.extend((0..100).map(|i| pen(60_000_000 + i * 10_000, true)));
        all.extend((0..600).map(|i| pen(61_000_000 + i * 100_000, false)));
        all.extend((0..100).map(|i| pen(121_000_000 + i * 10_000, true)));
        let film = AttractRecording::cut(all);
        let touched: Vec<u64> =
            film.samples.iter().filter(|s| touches(s)).map(|s| s.t_us).collect();
        assert_eq!(touched.len(), 200);
        assert_eq!(touched[0], REST_US);
        // The timing within a stroke does not change.
        assert_eq!(touched[99] - touched[0], 990_000);
        let pause = touched[100] - touched[99];
        assert!((PAUSE_US..PAUSE_US + 300_000).contains(&pause), "{pause}");
        assert!(film.samples.windows(2).all(|p| p[0].t_us <= p[1].t_us));
        assert!(AttractRecording::cut(vec![pen(0, false)]).is_empty());
    }

    #[test]
    fn the_built_in_film_is_short_and_touches() {
        let film = AttractRecording::own(DeviceId(1));
        assert!(film.samples.iter().filter(|s| touches(s)).count() > 300);
        assert!(film.ends_us < 20_000_000);
        assert!(!touches(film.samples.last().expect("samples")));
    }
}
