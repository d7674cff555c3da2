//! A visitor's cycle, tick by tick.

/// Wrong numbers in a row before the keypad is locked.
const TRIES: u32 = 3;
/// Duration of the lock after that, in seconds.
const LOCKED_S: f64 = 60.0;
/// Time without a touch after which the staff page closes by itself, in seconds.
const STAFF_S: f64 = 180.0;
/// Time without a touch after which the farewell ends, in seconds: with a question, and without.
const FAREWELL_S: [f64; 2] = [60.0, 15.0];
/// Time that a visit in progress has after closing time, in seconds.
const GRACE_S: f64 = 300.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stage {
    /// No visitor: recordings play.
    #[default]
    Attract,
    Working,
    /// Nobody has touched anything for a while; any touch goes back to `Working`.
    Countdown,
    /// The visit is over and its work is put away; the visitor may take it home. Touches begin no
    /// visit.
    Farewell,
    /// No visitor may come: outside the opening hours, or during cleaning.
    Closed,
}

/// Action that the cycle requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KioskAct {
    /// A visitor came: remove the result of the attract loop.
    Begin,
    /// The visitor left: keep the sculpture if configured, then reset everything.
    End { seconds: u64 },
}

/// The next opening time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NextOpening {
    /// Day of the week, Monday is 0; `None`: it is less than a day away.
    pub weekday: Option<u32>,
    /// Minute of the day.
    pub minute: u32,
}

/// For a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct View {
    pub stage: Stage,
    /// Whole seconds left of the countdown, rounded up; 0 otherwise.
    pub seconds_left: u64,
    /// Whole seconds left of a visit with a limit, rounded up.
    pub visit_left_s: Option<u64>,
    /// Visits that have ended.
    pub visits: u64,
    /// The keypad takes no number now.
    pub locked: bool,
    /// Wrong numbers that were typed so far.
    pub wrong: u64,
    /// Index of the exhibit that is shown; `None`: free sculpting.
    pub exhibit: Option<usize>,
    /// Index of the exhibit's step.
    pub step: usize,
    /// The staff page is open. The visit's clocks stand still.
    pub staff: bool,
    /// It is closed for cleaning, and not outside the opening hours.
    pub cleaning: bool,
    /// Number of the gallery's work that is shown, 0 for one without a number.
    pub work: Option<u64>,
    /// Darkness of the screen, percent.
    pub dim_percent: u8,
    /// The next opening time; `None`: it is always open.
    pub opens_next: Option<NextOpening>,
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
    /// Tick at which the visit ends at the latest.
    ends: Option<u64>,
    /// Ticks of the farewell of a visitor who ends a visit.
    farewell: u64,
    /// No visitor may come.
    closed: bool,
    /// The tick of the staff's last touch while their page is open.
    staff: Option<u64>,
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
            ends: None,
            farewell: 0,
            closed: false,
            staff: None,
            wrong: 0,
            all_wrong: 0,
            locked_until: 0,
        }
    }

    /// A cycle in which visitors who end their visit get a farewell. `asks`: they are asked
    /// something in it.
    pub fn with_farewell(self, asks: bool) -> Self {
        let farewell = (FAREWELL_S[usize::from(!asks)] * self.rate_hz) as u64;
        Cycle { farewell, ..self }
    }

    /// A cycle that begins within a visit, as if the visitor had touched something just now.
    pub fn resumed(self) -> Self {
        Cycle { stage: Stage::Working, ..self }
    }

    /// Ends a visit that is in progress.
    pub fn interrupt(&mut self) -> Option<KioskAct> {
        self.is_visited().then(|| self.end(false))
    }

    /// Returns true if a visit is in progress.
    fn is_visited(&self) -> bool {
        matches!(self.stage, Stage::Working | Stage::Countdown)
    }

    /// Limits the visit that has just begun to `minutes` from now; 0: no limit.
    pub fn limit(&mut self, minutes: f64) {
        let ticks = (minutes * 60.0 * self.rate_hz).ceil() as u64;
        self.ends = (ticks > 0).then(|| self.now + ticks);
    }

    /// Closes or opens the installation. A visit in progress goes on for five minutes at most.
    pub fn set_closed(&mut self, closed: bool) {
        if closed && !self.closed && self.is_visited() {
            let latest = self.now + (GRACE_S * self.rate_hz) as u64;
            self.ends = Some(self.ends.map_or(latest, |ends| ends.min(latest)));
        }
        self.closed = closed;
        if !self.is_visited() && self.stage != Stage::Farewell {
            self.stage = self.unvisited();
        }
    }

    fn unvisited(&self) -> Stage {
        if self.closed { Stage::Closed } else { Stage::Attract }
    }

    /// Ends the farewell.
    pub fn end_farewell(&mut self) {
        if self.stage == Stage::Farewell {
            self.stage = self.unvisited();
        }
    }

    /// One tick. `touched`: a visitor's pen or hand was felt in it. `done`: the visitor pressed
    /// "finished".
    pub fn step(&mut self, touched: bool, done: bool) -> Option<KioskAct> {
        self.now += 1;
        if let Some(last) = &mut self.staff {
            *last = if touched { self.now } else { *last };
            if self.now - *last >= (STAFF_S * self.rate_hz) as u64 {
                self.staff = None;
            }
            // The visitor's time stands still.
            (self.begun, self.touched) = (self.begun + 1, self.touched + 1);
            self.ends = self.ends.map(|ends| ends + 1);
            return None;
        }
        if touched {
            self.touched = self.now;
        }
        match self.stage {
            Stage::Attract if touched => {
                self.stage = Stage::Working;
                self.begun = self.now;
                return Some(KioskAct::Begin);
            }
            Stage::Attract | Stage::Closed => {}
            Stage::Farewell => {
                if done || self.now - self.touched >= self.farewell {
                    self.end_farewell();
                }
            }
            _ if done || self.ends.is_some_and(|ends| self.now >= ends) => {
                return Some(self.end(self.farewell > 0));
            }
            Stage::Working if self.now - self.touched >= self.idle => self.stage = Stage::Countdown,
            Stage::Countdown if touched => self.stage = Stage::Working,
            Stage::Countdown if self.now - self.touched >= self.idle + self.countdown => {
                // Everybody has gone.
                return Some(self.end(false));
            }
            Stage::Working | Stage::Countdown => {}
        }
        None
    }

    fn end(&mut self, farewell: bool) -> KioskAct {
        let seconds = ((self.touched - self.begun) as f64 / self.rate_hz) as u64;
        self.stage = if farewell { Stage::Farewell } else { self.unvisited() };
        self.visits += 1;
        (self.ends, self.touched) = (None, self.now);
        KioskAct::End { seconds }
    }

    /// Staff typed `number`: the right one opens their page. An empty `pin` lets nobody in; after
    /// some wrong ones nothing is taken for a while.
    pub fn type_pin(&mut self, number: &str, pin: &str) {
        if pin.is_empty() || self.now < self.locked_until {
            return;
        }
        if number == pin {
            self.wrong = 0;
            self.staff = Some(self.now);
            return;
        }
        self.wrong += 1;
        self.all_wrong += 1;
        if self.wrong >= TRIES {
            self.wrong = 0;
            self.locked_until = self.now + (LOCKED_S * self.rate_hz) as u64;
        }
    }

    /// Closes the staff page.
    pub fn leave_staff(&mut self) {
        self.staff = None;
    }

    pub fn view(&self) -> View {
        let seconds = |ticks: u64| (ticks as f64 / self.rate_hz).ceil() as u64;
        let left = (self.touched + self.idle + self.countdown).saturating_sub(self.now);
        let visit_left = self.ends.filter(|_| self.is_visited());
        View {
            stage: self.stage,
            seconds_left: if self.stage == Stage::Countdown { seconds(left) } else { 0 },
            visit_left_s: visit_left.map(|ends| seconds(ends.saturating_sub(self.now))),
            visits: self.visits,
            locked: self.now < self.locked_until,
            wrong: self.all_wrong,
            staff: self.staff.is_some(),
            ..View::default()
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
    fn a_visitor_who_ends_a_visit_gets_a_farewell_and_one_who_left_does_not() {
        let mut c = Cycle::new(10.0, 2.0, 1.0).with_farewell(true);
        c.step(true, false);
        assert!(matches!(c.step(false, true), Some(KioskAct::End { .. })));
        assert_eq!((c.view().stage, c.view().visits), (Stage::Farewell, 1));
        assert_eq!(c.step(true, false), None, "a touch begins no visit");
        assert_eq!(idle(&mut c, 599), None);
        assert_eq!(c.view().stage, Stage::Farewell);
        idle(&mut c, 1);
        assert_eq!(c.view().stage, Stage::Attract);
        // By the visitor's press, and at closing time.
        c.step(true, false);
        c.step(false, true);
        c.set_closed(true);
        assert_eq!(c.view().stage, Stage::Farewell);
        c.step(false, true);
        assert_eq!(c.view().stage, Stage::Closed);
        c.set_closed(false);
        c.step(true, false);
        assert!(idle(&mut c, 30).is_some());
        assert_eq!(c.view().stage, Stage::Attract, "nobody is here");
    }

    #[test]
    fn the_staff_s_number_opens_their_page_and_guessing_is_slow() {
        let mut c = Cycle::new(10.0, 2.0, 1.0);
        c.type_pin("", "");
        assert!(!c.view().staff, "no PIN lets nobody in");
        c.type_pin("1234", "1234");
        assert!(c.view().staff);
        c.leave_staff();
        for n in ["0000", "0001", "0002"] {
            c.type_pin(n, "1234");
        }
        assert!(c.view().locked && c.view().wrong == 3);
        c.type_pin("1234", "1234");
        assert!(!c.view().staff);
        idle(&mut c, 600);
        c.type_pin("1234", "1234");
        assert!(c.view().staff);
    }

    #[test]
    fn a_visit_waits_while_the_staff_page_is_open() {
        let mut c = Cycle::new(10.0, 2.0, 1.0);
        c.step(true, false);
        c.limit(1.0);
        c.type_pin("1234", "1234");
        // Their touches neither end the visit nor begin one, and its clocks stand still.
        assert_eq!((0..500).find_map(|i| c.step(i % 10 == 0, false)), None);
        assert_eq!((c.view().stage, c.view().visit_left_s), (Stage::Working, Some(60)));
        c.leave_staff();
        assert_eq!(idle(&mut c, 19), None);
        assert_eq!(c.view().stage, Stage::Working);
        // It closes by itself.
        c.type_pin("1234", "1234");
        idle(&mut c, (STAFF_S * 10.0) as u64);
        assert!(!c.view().staff);
    }

    #[test]
    fn a_visit_ends_at_its_limit_and_nobody_comes_while_it_is_closed() {
        let mut c = Cycle::new(10.0, 1000.0, 1.0);
        c.step(true, false);
        c.limit(0.1);
        assert_eq!(idle(&mut c, 59), None);
        assert_eq!(c.step(true, false), Some(KioskAct::End { seconds: 6 }));
        c.set_closed(true);
        assert_eq!((c.step(true, false), c.view().stage), (None, Stage::Closed));
        c.set_closed(false);
        assert_eq!(c.step(true, false), Some(KioskAct::Begin));
        // At closing time the visit gets some minutes more.
        c.set_closed(true);
        assert_eq!((c.view().stage, c.view().visit_left_s), (Stage::Working, Some(300)));
        let end = (0..3000).find_map(|_| c.step(true, false));
        assert_eq!((end.is_some(), c.view().stage), (true, Stage::Closed));
    }
}
