//! A visitor's cycle, tick by tick.

/// Wrong numbers in a row before the keypad is locked.
const TRIES: u32 = 3;
/// Duration of the lock after that, in seconds.
const LOCKED_S: f64 = 60.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// No visitor: recordings play.
    Attract,
    Working,
    /// Nobody has touched anything for a while; any touch goes back to `Working`.
    Countdown,
}

/// Action that the cycle requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KioskAct {
    /// A visitor came: remove the result of the attract loop.
    Begin,
    /// The visitor left: keep the sculpture if configured, then reset everything.
    End { seconds: u64 },
    /// Staff entered the correct PIN.
    Quit,
}

/// For a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct View {
    pub stage: Stage,
    /// Whole seconds left of the countdown, rounded up; 0 otherwise.
    pub seconds_left: u64,
    /// Visits that have ended.
    pub visits: u64,
    /// The keypad takes no number now.
    pub locked: bool,
    /// Wrong numbers that were typed so far.
    pub wrong: u64,
}

#[derive(Debug)]
pub struct Cycle {
    rate_hz: f64,
    idle: u64,
    countdown: u64,
    stage: Stage,
    now: u64,
    begun: u64,
    touched: u64,
    visits: u64,
    /// Wrong numbers in a row, and all of them.
    wrong: u32,
    all_wrong: u64,
    locked_until: u64,
}

impl Cycle {
    /// Ticks come `rate_hz` times a second.
    pub fn new(rate_hz: f64, idle_s: f64, countdown_s: f64) -> Self {
        let ticks = |s: f64| (s * rate_hz).ceil() as u64;
        Cycle {
            rate_hz,
            idle: ticks(idle_s),
            countdown: ticks(countdown_s),
            stage: Stage::Attract,
            now: 0,
            begun: 0,
            touched: 0,
            visits: 0,
            wrong: 0,
            all_wrong: 0,
            locked_until: 0,
        }
    }

    /// A cycle that begins within a visit, as if the visitor had touched something just now.
    pub fn resumed(self) -> Self {
        Cycle { stage: Stage::Working, ..self }
    }

    /// Ends a visit that is in progress.
    pub fn interrupt(&mut self) -> Option<KioskAct> {
        (self.stage != Stage::Attract).then(|| self.end())
    }

    /// One tick. `touched`: a visitor's pen or hand was felt in it. `done`: the visitor pressed
    /// "finished".
    pub fn step(&mut self, touched: bool, done: bool) -> Option<KioskAct> {
        self.now += 1;
        if touched {
            self.touched = self.now;
        }
        match self.stage {
            Stage::Attract if touched => {
                self.stage = Stage::Working;
                self.begun = self.now;
                return Some(KioskAct::Begin);
            }
            Stage::Attract => {}
            _ if done => return Some(self.end()),
            Stage::Working if self.now - self.touched >= self.idle => self.stage = Stage::Countdown,
            Stage::Countdown if touched => self.stage = Stage::Working,
            Stage::Countdown if self.now - self.touched >= self.idle + self.countdown => {
                return Some(self.end());
            }
            Stage::Working | Stage::Countdown => {}
        }
        None
    }

    fn end(&mut self) -> KioskAct {
        self.stage = Stage::Attract;
        self.visits += 1;
        KioskAct::End { seconds: ((self.touched - self.begun) as f64 / self.rate_hz) as u64 }
    }

    /// Staff typed `number`. An empty `pin` lets nobody out; after some wrong ones nothing is taken
    /// for a while.
    pub fn staff(&mut self, number: &str, pin: &str) -> Option<KioskAct> {
        if pin.is_empty() || self.now < self.locked_until {
            return None;
        }
        if number == pin {
            self.wrong = 0;
            return Some(KioskAct::Quit);
        }
        self.wrong += 1;
        self.all_wrong += 1;
        if self.wrong >= TRIES {
            self.wrong = 0;
            self.locked_until = self.now + (LOCKED_S * self.rate_hz) as u64;
        }
        None
    }

    pub fn view(&self) -> View {
        let left = (self.touched + self.idle + self.countdown).saturating_sub(self.now);
        View {
            stage: self.stage,
            seconds_left: if self.stage == Stage::Countdown {
                (left as f64 / self.rate_hz).ceil() as u64
            } else {
                0
            },
            visits: self.visits,
            locked: self.now < self.locked_until,
            wrong: self.all_wrong,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn idle(cycle: &mut Cycle, ticks: u64) -> Option<KioskAct> {
        (0..ticks).find_map(|_| cycle.step(false, false))
    }

    #[test]
    fn any_touch_stops_the_countdown_and_without_one_the_visit_ends() {
        let mut c = Cycle::new(10.0, 2.0, 1.0);
        assert_eq!(idle(&mut c, 1000), None);
        assert_eq!(c.step(true, false), Some(KioskAct::Begin));
        assert_eq!(idle(&mut c, 25), None);
        assert_eq!((c.view().stage, c.view().seconds_left), (Stage::Countdown, 1));
        assert_eq!(c.step(true, false), None);
        assert_eq!(c.view().stage, Stage::Working);
        assert_eq!(idle(&mut c, 29), None);
        assert_eq!(idle(&mut c, 1), Some(KioskAct::End { seconds: 2 }));
        assert_eq!((c.view().stage, c.view().visits), (Stage::Attract, 1));
        c.step(true, false);
        assert_eq!(c.step(false, true), Some(KioskAct::End { seconds: 0 }));
    }

    #[test]
    fn the_staff_s_number_lets_out_and_guessing_is_slow() {
        let mut c = Cycle::new(10.0, 2.0, 1.0);
        assert_eq!(c.staff("", ""), None);
        assert_eq!(c.staff("1234", "1234"), Some(KioskAct::Quit));
        for n in ["0000", "0001", "0002"] {
            assert_eq!(c.staff(n, "1234"), None);
        }
        assert!(c.view().locked && c.view().wrong == 3);
        assert_eq!(c.staff("1234", "1234"), None);
        idle(&mut c, 600);
        assert_eq!(c.staff("1234", "1234"), Some(KioskAct::Quit));
    }
}
