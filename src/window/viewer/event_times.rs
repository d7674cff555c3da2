//! Gives pointer events the times at which they happened, as far as that can be known.
//!
//! The window system hands events over without their times. A window that is busy, with a slow
//! frame or a stalled screen, takes them late and all at once; taken for simultaneous, they would
//! have no order with the brush and no speed. Events that waited are spread evenly over the time in
//! which the window was busy; those that woke it happened when it woke.

use winit::event::WindowEvent;

/// A window that waited for longer than this was idle, and the event woke it, in microseconds.
const IDLE_US: u64 = 1_000;

/// Events that wait for their times, and when the window was busy.
#[derive(Debug, Default)]
pub(super) struct EventTimes {
    waiting: Vec<WindowEvent>,
    turns: Turns,
}

/// When the turns of the event loop began and ended, in microseconds.
#[derive(Debug, Default)]
struct Turns {
    began: u64,
    ended: u64,
    /// Nothing of this turn happened before this time.
    earliest: u64,
    /// Time of the last event.
    last: u64,
}

impl Turns {
    fn begin(&mut self, now_us: u64) {
        let idle = now_us.saturating_sub(self.ended) > IDLE_US;
        self.earliest = if idle { now_us } else { self.began };
        self.began = now_us;
    }

    /// Returns the times of `count` events that have been taken by now, each later than the last.
    fn times(&mut self, count: u64, now_us: u64) -> impl Iterator<Item = u64> + use<> {
        let from = self.earliest.max(self.last);
        let span = now_us.saturating_sub(from);
        let mut last = self.last;
        self.last = self.last.max(now_us).max(self.last + count);
        // What is still taken in this turn comes after these.
        self.earliest = self.last;
        (1..=count).map(move |i| {
            last = (last + 1).max(from + span * i / count);
            last
        })
    }
}

impl EventTimes {
    /// Keeps an event of the pointer or of the modifier keys until its time is known. Gives back
    /// any other event.
    pub(super) fn keep(&mut self, event: WindowEvent) -> Option<WindowEvent> {
        let kept = matches!(
            event,
            WindowEvent::ModifiersChanged(_)
                | WindowEvent::CursorMoved { .. }
                | WindowEvent::CursorLeft { .. }
                | WindowEvent::MouseInput { .. }
                | WindowEvent::MouseWheel { .. }
                | WindowEvent::PinchGesture { .. }
                | WindowEvent::Touch(_)
        );
        if !kept {
            return Some(event);
        }
        self.waiting.push(event);
        None
    }

    /// The event loop woke.
    pub(super) fn wake(&mut self, now_us: u64) {
        self.turns.begin(now_us);
    }

    /// The event loop is about to wait.
    pub(super) fn rest(&mut self, now_us: u64) {
        self.turns.ended = now_us;
    }

    /// Takes the events that waited, in their order, each with its time.
    pub(super) fn take(&mut self, now_us: u64) -> impl Iterator<Item = (u64, WindowEvent)> + use<> {
        let events = std::mem::take(&mut self.waiting);
        self.turns.times(events.len() as u64, now_us).zip(events)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_of_a_stall_are_spread_over_it_and_others_happen_now() {
        let mut turns = Turns::default();
        // The window waited until 10 ms: the event woke it.
        turns.begin(10_000);
        assert_eq!(turns.times(1, 10_100).collect::<Vec<_>>(), [10_100]);
        // A frame takes until 310 ms, and three events wait then.
        turns.ended = 310_000;
        turns.begin(310_050);
        let times: Vec<u64> = turns.times(3, 310_100).collect();
        assert_eq!(times, [110_100, 210_100, 310_100]);
        assert_eq!(turns.times(2, 310_100).collect::<Vec<_>>(), [310_101, 310_102]);
        assert!(turns.times(1, 310_101).all(|t| t > 310_102), "no two events have one time");
    }

    #[test]
    fn the_speed_of_a_steady_hand_does_not_depend_on_stalls() {
        // A hand moves a point a millisecond; frames take from 1 ms to 3 s.
        let mut turns = Turns::default();
        let (mut now, mut taken) = (0u64, 0u64);
        let mut seen = Vec::new();
        for (i, frame) in [16, 16, 200, 3000, 16, 1, 700, 16, 16].into_iter().enumerate() {
            turns.begin(now);
            let come = now / 1000 - taken;
            let times = turns.times(come, now).collect::<Vec<_>>();
            seen.extend(times.into_iter().enumerate().map(|(k, t)| (t, taken + k as u64 + 1)));
            taken = now / 1000;
            now += frame * 1000 + i as u64;
            turns.ended = now;
        }
        for (t, n) in seen {
            assert!(t.abs_diff(n * 1000) <= 1000, "event {n} at {t}");
        }
    }
}
