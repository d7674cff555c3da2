//! When the window draws: only after something changed, and at most at the screen's rate.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use sculptd_devices::Clock;

/// Time between two looks at the published state, microseconds: on a graphics card, and where a
/// processor draws and would otherwise take the tick thread's time.
const POLL_US: [u64; 2] = [16_667, 50_000];
/// Shortest time between two frames where a processor draws, microseconds.
const SOFTWARE_FRAME_US: u64 = 33_333;
/// Of a screen that does not tell its rate, millihertz.
const USUAL_RATE: u32 = 60_000;
const SECOND_US: u64 = 1_000_000;

/// All times are microseconds on the daemon's clock.
#[derive(Debug)]
pub(super) struct Pacing {
    wanted: bool,
    last_frame_us: u64,
    frame_us: u64,
    next_poll_us: u64,
    poll_us: u64,
    /// Time of the next frame that egui requested; `u64::MAX`: none.
    egui_us: Arc<AtomicU64>,
    /// Beginnings of the frames of the last second.
    frames: VecDeque<u64>,
}

impl Pacing {
    /// `rate_mhz` is the screen's refresh rate in millihertz, where it is known.
    pub(super) fn new(software: bool, rate_mhz: Option<u32>) -> Pacing {
        let rate = rate_mhz.filter(|r| *r > 0).unwrap_or(USUAL_RATE);
        let screen_us = 1_000_000_000 / u64::from(rate);
        let frame_us = if software { screen_us.max(SOFTWARE_FRAME_US) } else { screen_us };
        Pacing {
            wanted: true,
            last_frame_us: 0,
            frame_us,
            next_poll_us: 0,
            poll_us: POLL_US[usize::from(software)],
            egui_us: Arc::new(AtomicU64::new(u64::MAX)),
            frames: VecDeque::new(),
        }
    }

    /// Lets egui ask for frames: animations, tooltips, pictures that another thread has read.
    pub(super) fn listen(&self, context: &egui::Context, clock: &Clock) {
        let (at, clock) = (self.egui_us.clone(), clock.clone());
        context.set_request_repaint_callback(move |info| {
            let delay = u64::try_from(info.delay.as_micros()).unwrap_or(u64::MAX);
            at.fetch_min(clock.now_us().saturating_add(delay), Relaxed);
        });
    }

    /// After a pass egui says itself when it wants the next: a click within one frame takes two.
    pub(super) fn egui_wants(&self, now_us: u64, delay: Duration) {
        let delay = u64::try_from(delay.as_micros()).unwrap_or(u64::MAX);
        self.egui_us.fetch_min(now_us.saturating_add(delay), Relaxed);
    }

    /// Something that is shown has changed.
    pub(super) fn want(&mut self) {
        self.wanted = true;
    }

    /// Returns true if it is time to read the published state.
    pub(super) fn poll_is_due(&mut self, now_us: u64) -> bool {
        let due = now_us >= self.next_poll_us;
        if due {
            self.next_poll_us = now_us + self.poll_us;
        }
        due
    }

    /// Returns true if a frame must be requested now; the request counts as made.
    pub(super) fn frame_is_due(&mut self, now_us: u64) -> bool {
        self.wanted |= self.egui_us.load(Relaxed) <= now_us;
        let due = self.wanted && now_us >= self.last_frame_us + self.frame_us;
        if due {
            self.wanted = false;
        }
        due
    }

    /// A frame begins: whatever was asked for before is in it.
    pub(super) fn begin_frame(&mut self, now_us: u64) {
        self.wanted = false;
        self.last_frame_us = now_us;
        self.egui_us.store(u64::MAX, Relaxed);
        self.frames.push_back(now_us);
        while self.frames.front().is_some_and(|t| t + SECOND_US < now_us) {
            self.frames.pop_front();
        }
    }

    /// Frames begun within the last second.
    pub(super) fn frames_a_second(&self) -> usize {
        self.frames.len()
    }

    /// Microseconds until the event loop has to wake up again.
    pub(super) fn wait_us(&self, now_us: u64) -> u64 {
        let egui_us = self.egui_us.load(Relaxed);
        let frame = self.last_frame_us.saturating_add(self.frame_us);
        let next = if self.wanted { frame } else { egui_us.max(frame) };
        self.next_poll_us.min(next).saturating_sub(now_us).max(200)
    }
}

/// The window's own work on the processor over some frames, without waiting for the card.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FrameSum {
    frames: u32,
    total_ms: f64,
    worst_ms: f64,
}

impl FrameSum {
    pub(super) fn take(&mut self, own_ms: f64) {
        self.frames += 1;
        self.total_ms += own_ms;
        self.worst_ms = self.worst_ms.max(own_ms);
    }

    /// Logs the sums of the drawn frames and resets them. Logs nothing if nothing was drawn.
    pub(super) fn tell(&mut self, (in_view, pages): (usize, usize)) {
        let FrameSum { frames, total_ms, worst_ms } = std::mem::take(self);
        if frames > 0 {
            let mean_ms = total_ms / f64::from(frames);
            tracing::debug!(frames, mean_ms, worst_ms, in_view, pages, "frames");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_comes_after_a_change_and_never_faster_than_the_screen() {
        let mut p = Pacing::new(false, Some(50_000));
        assert!(p.frame_is_due(20_000), "the first");
        p.begin_frame(20_000);
        assert!(!p.frame_is_due(60_000), "nothing has changed");
        let mut frames = 0;
        // The pointer moves a thousand times a second for a second.
        for t in (60_000..1_060_000).step_by(1000) {
            p.want();
            if p.frame_is_due(t) {
                p.begin_frame(t);
                frames += 1;
            }
        }
        assert_eq!(frames, 50);
        assert_eq!(p.frames_a_second(), 50);
    }

    #[test]
    fn egui_is_given_the_frame_that_it_asks_for_and_no_more() {
        let p = &mut Pacing::new(false, None);
        let context = egui::Context::default();
        let clock = Clock::manual();
        p.listen(&context, &clock);
        p.begin_frame(0);
        context.request_repaint_after(Duration::from_secs(2));
        assert!(!p.frame_is_due(1_000_000));
        assert!(p.wait_us(20_000) <= 2_000_000);
        assert!(p.frame_is_due(2_100_000));
        p.begin_frame(2_100_000);
        assert!(!p.frame_is_due(9_000_000));
    }
}
