//! Use of a pen's pressure range, and whether a saturated pen was pressed that hard.
//!
//! A report in contact is saturated if its pressure is the maximum of the range with which it is
//! read. There are three causes, and the raw counts distinguish them:
//!
//! * **The person presses that hard.** The pen then sends its highest count again and again:
//!   exactly the maximum, and none above it. It gets there through the counts below.
//! * **The maximum is too low.** Counts above it are sent; read by them, the pen would not be
//!   saturated.
//! * **The bytes are misread.** The pressure is at its maximum without ever having risen: it jumps
//!   there from a light touch, and there are few counts between.

/// Saturated reports up to this share need no explanation.
const USUAL: f64 = 0.01;
/// A pen that reached its maximum had this share of it in the report before, mostly: at 100 reports
/// a second a hand that strikes takes 20 ms to full pressure (recordings of the corpus).
const NEAR: f64 = 0.25;
/// Counts that a pen uses between nothing and its maximum, at least, in classes of 1/32.
const LEAST_CLASSES: u32 = 6;
const CLASSES: u32 = 32;
/// A pen without pressure in so many reports in contact has none.
const LEAST_UNPRESSED: u64 = 4;

/// Figures of the reports of one pen that touch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PressureUse {
    /// Reports in contact that have a pressure.
    pub contacts: u64,
    /// Those at the maximum or above it.
    pub saturated: u64,
    /// Those above it.
    pub above: u64,
    /// The maximum that they are read with, counts.
    pub maximum: u32,
    /// The highest count in contact.
    pub highest: u32,
    /// Number of times that the maximum was reached from a lower count, within a contact.
    pub rises: u64,
    /// Those of them that came from a count near it.
    pub near: u64,
    /// Contacts that were saturated from their first report.
    pub begun: u64,
    /// One bit for each class of counts that was met.
    classes: u32,
    last: Option<u32>,
}

/// Why a pen is saturated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saturation {
    /// At most one report of a hundred is.
    Usual,
    /// The person presses that hard.
    Pressed,
    /// Counts above the maximum are sent.
    MaximumTooLow,
    /// The pressure does not rise to its maximum: the bytes are misread.
    Misread,
    /// The pressure is 0 in every report: the tip alone says whether the pen touches.
    AlwaysZero,
}

impl PressureUse {
    /// Takes a report: its pressure in counts, whether it touches, and the maximum it is read with.
    pub fn take(&mut self, counts: Option<u32>, touches: bool, maximum: u32) {
        let Some(counts) = counts.filter(|_| touches && maximum > 0) else {
            self.last = None;
            return;
        };
        self.contacts += 1;
        self.maximum = maximum;
        self.highest = self.highest.max(counts);
        self.above += u64::from(counts > maximum);
        let class = u64::from(counts) * u64::from(CLASSES) / (u64::from(maximum) + 1);
        self.classes |= 1 << class.min(u64::from(CLASSES - 1));
        if counts >= maximum {
            self.saturated += 1;
            match self.last {
                None => self.begun += 1,
                Some(last) if last < maximum => {
                    self.rises += 1;
                    self.near += u64::from(f64::from(last) >= NEAR * f64::from(maximum));
                }
                Some(_) => {}
            }
        }
        self.last = Some(counts);
    }

    /// The figures of two interfaces of one device together.
    pub fn and(mut self, other: PressureUse) -> PressureUse {
        if other.contacts == 0 {
            return self;
        }
        self.contacts += other.contacts;
        self.saturated += other.saturated;
        self.above += other.above;
        self.maximum = self.maximum.max(other.maximum);
        self.highest = self.highest.max(other.highest);
        self.rises += other.rises;
        self.near += other.near;
        self.begun += other.begun;
        self.classes |= other.classes;
        self
    }

    /// Part of the reports in contact that are saturated, 0 to 1.
    pub fn share(&self) -> f64 {
        if self.contacts == 0 { 0.0 } else { self.saturated as f64 / self.contacts as f64 }
    }

    /// Returns the conclusion from the figures.
    pub fn saturation(&self) -> Saturation {
        let classes = self.classes.count_ones();
        let climbs = self.near * 2 >= self.rises + self.begun && classes >= LEAST_CLASSES;
        let varied = classes * 2 >= CLASSES;
        if self.contacts >= LEAST_UNPRESSED && self.highest == 0 {
            Saturation::AlwaysZero
        } else if self.above * 100 > self.contacts {
            Saturation::MaximumTooLow
        } else if self.share() <= USUAL {
            Saturation::Usual
        } else if climbs || varied {
            Saturation::Pressed
        } else {
            Saturation::Misread
        }
    }

    /// One line for people; `None` without a contact.
    pub fn in_words(&self) -> Option<String> {
        let why = match self.saturation() {
            Saturation::Usual => "as usual".to_owned(),
            Saturation::AlwaysZero => "always 0, so the pen draws with full strength wherever its \
                                       tip touches; try another battery or nib, or calibrate the \
                                       tablet in its vendor's software"
                .to_owned(),
            Saturation::Pressed => format!(
                "the person pressed that hard: reached {} times, {} of them from nearby, over {} \
                 of {CLASSES} classes of counts, and never exceeded",
                self.rises + self.begun,
                self.near,
                self.classes.count_ones()
            ),
            Saturation::MaximumTooLow => {
                format!(
                    "the maximum is wrong: {} reports are above it, up to {}",
                    self.above, self.highest
                )
            }
            Saturation::Misread => format!(
                "its bytes are misread: reached {} times, {} of them from nearby, over {} of \
                 {CLASSES} classes of counts",
                self.rises + self.begun,
                self.near,
                self.classes.count_ones()
            ),
        };
        (self.contacts > 0).then(|| {
            format!(
                "pressure: {} of {} reports in contact at the maximum of {} counts; {why}",
                self.saturated, self.contacts, self.maximum
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes that rise to `top` of the pen's own 2047 counts and rest there, as a hand does.
    fn pressed(top: f64, maximum: u32) -> PressureUse {
        let mut used = PressureUse::default();
        for _ in 0..4 {
            for i in 0..100 {
                let s = (f64::from(i) / 12.0).min(1.0) * top * 2047.0;
                used.take(Some((s as u32).min(2047)), true, maximum);
            }
            used.take(Some(0), false, maximum);
        }
        used
    }

    #[test]
    fn a_hard_press_is_told_from_a_wrong_maximum() {
        assert_eq!(pressed(0.8, 2047).saturation(), Saturation::Usual);
        let hard = pressed(1.3, 2047);
        assert!(hard.share() > 0.8);
        assert_eq!(hard.saturation(), Saturation::Pressed);
        // The same pen, read with half of its maximum.
        assert_eq!(pressed(1.3, 1023).saturation(), Saturation::MaximumTooLow);
        assert!(pressed(1.3, 1023).in_words().is_some_and(|w| w.contains("up to 2047")));
    }

    #[test]
    fn a_pen_without_pressure_is_reported() {
        let mut used = PressureUse::default();
        (0..60).for_each(|_| used.take(Some(0), true, 1023));
        assert_eq!(used.saturation(), Saturation::AlwaysZero);
        assert!(used.in_words().is_some_and(|w| w.contains("always 0")));
    }

    #[test]
    fn a_pressure_that_never_rises_is_misread() {
        let mut used = PressureUse::default();
        for i in 0..200 {
            // Two values alone: a bit that was taken for a pressure.
            let counts = if i % 4 == 0 { 12 } else { 8191 };
            used.take(Some(counts), true, 8191);
        }
        assert_eq!(used.saturation(), Saturation::Misread);
        assert_eq!(PressureUse::default().in_words(), None);
    }
}
