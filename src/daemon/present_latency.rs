//! How long a sample takes from a device to the screen, stage by stage.
//!
//! A frame is counted when it is the first one that shows the newest sample. Its age is split where
//! it passes from one hand to the next: read, taken by a tick, found by a frame, drawn, presented.
//! "Presented" is when the graphics library has taken the picture; when the screen lights up is not
//! known to a program.

use serde::Serialize;

use sculptd_devices::latency::{Latency, Quantiles};

/// The stages, in order, and at last their sum.
pub const STAGES: [&str; 5] = ["tick", "wait", "draw", "present", "total"];
/// Description of each stage, for people.
pub const ABOUT: [&str; 5] = [
    "read to the end of the tick that took it",
    "the end of that tick to the begin of a frame",
    "the begin of the frame to its picture handed over",
    "handed over to presented",
    "read to presented",
];
/// Inclusive bounds of the histogram's classes, in microseconds; the last class is unbounded. They
/// are steps of [`Latency`], so the counts are exact.
pub const CLASSES_US: [u64; 11] =
    [255, 511, 1_023, 2_047, 4_095, 8_191, 16_383, 32_767, 65_535, 131_071, 262_143];

/// Times of one frame on the daemon's clock, microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PresentedFrame {
    /// The newest sample that it shows was read.
    pub sampled_us: u64,
    /// The tick that took it ended.
    pub ticked_us: u64,
    /// The frame began.
    pub begun_us: u64,
    /// Its picture was handed to the card.
    pub submitted_us: u64,
    /// It was presented.
    pub presented_us: u64,
}

/// Counts of all frames of a run.
#[derive(Debug, Clone, Default)]
pub struct PresentLatency {
    stages: [Latency; STAGES.len()],
    frames: u64,
}

/// One stage, in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct StageQuantiles {
    pub name: &'static str,
    #[serde(flatten)]
    pub quantiles: Quantiles,
}

/// Summary at the end of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PresentSummary {
    /// Frames that showed a new sample.
    pub frames: u64,
    /// Quantiles of each stage, microseconds.
    pub stages: Vec<StageQuantiles>,
    /// Frames in each class of [`CLASSES_US`] by the total, and those beyond.
    pub histogram: Vec<u64>,
}

impl PresentLatency {
    /// Counts a frame.
    pub fn record(&mut self, f: &PresentedFrame) {
        let times = [f.sampled_us, f.ticked_us, f.begun_us, f.submitted_us, f.presented_us];
        for (stage, pair) in self.stages.iter_mut().zip(times.windows(2)) {
            stage.record(pair[1].saturating_sub(pair[0]));
        }
        self.stages[STAGES.len() - 1].record(f.presented_us.saturating_sub(f.sampled_us));
        self.frames += 1;
    }

    /// Frames counted.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The stages in the order of [`STAGES`].
    pub fn stages(&self) -> &[Latency; STAGES.len()] {
        &self.stages
    }

    /// Frames in each class by their total, and those beyond the last.
    pub fn histogram(&self) -> Vec<u64> {
        let total = &self.stages[STAGES.len() - 1];
        let bound = |us: &u64| total.at_most(*us);
        let upto: Vec<u64> = CLASSES_US.iter().map(bound).chain([self.frames]).collect();
        let below = [0].into_iter().chain(upto.iter().copied());
        upto.iter().zip(below).map(|(upto, below)| upto - below).collect()
    }

    /// The summary; `None` before the first frame.
    pub fn summary(&self) -> Option<PresentSummary> {
        let stage = |(name, stage): (&&'static str, &Latency)| StageQuantiles {
            name,
            quantiles: stage.quantiles(),
        };
        (self.frames > 0).then(|| PresentSummary {
            frames: self.frames,
            stages: STAGES.iter().zip(&self.stages).map(stage).collect(),
            histogram: self.histogram(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stages_make_up_the_total_and_each_frame_is_in_one_class() {
        let mut latency = PresentLatency::default();
        assert_eq!(latency.summary(), None);
        for i in 0..100 {
            let t = 1_000_000 + i * 20_000;
            latency.record(&PresentedFrame {
                sampled_us: t,
                ticked_us: t + 4_000,
                begun_us: t + 9_000,
                submitted_us: t + 9_000 + i * 100,
                presented_us: t + 10_000 + i * 100,
            });
        }
        let summary = latency.summary().expect("frames");
        let max = |name: &str| {
            let stage = summary.stages.iter().find(|s| s.name == name).expect("a stage");
            stage.quantiles.max
        };
        // A quantile is at most a quarter too high.
        for (name, true_us) in [
            ("tick", 4_000),
            ("wait", 5_000),
            ("draw", 9_900),
            ("present", 1_000),
            ("total", 19_900),
        ] {
            assert!((true_us..=true_us * 5 / 4).contains(&max(name)), "{name}: {}", max(name));
        }
        assert_eq!(summary.histogram.iter().sum::<u64>(), 100);
        // From 10.0 to 16.3 ms, and from 16.4 to 19.9.
        assert_eq!((summary.histogram[6], summary.histogram[7]), (64, 36));
    }
}
