//! Opening hours: spans of the day on days of the week, in local time.

use super::cycle::NextOpening;
use crate::local_time::LocalTime;

/// Minutes of a day.
const DAY: u32 = 24 * 60;
/// Names of the days, Monday first.
const DAYS: [&str; 7] = ["mon", "tue", "wed", "thu", "fri", "sat", "sun"];

/// The times at which visitors may come.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Hours {
    /// Minutes since Monday midnight, first and last (excluded); a span may run into the next week.
    spans: Vec<(u32, u32)>,
}

impl Hours {
    /// Reads spans such as `mon-fri 10:00-18:00`, `sat,sun 10:00-20:00` and `daily 22:00-02:00`.
    /// Without any the installation is always open.
    ///
    /// # Errors
    /// Names the span and what was expected.
    pub fn parse(spans: &[String]) -> Result<Hours, String> {
        let mut hours = Hours::default();
        for text in spans {
            let wrong = || {
                format!("\"{text}\": expected days and times, for example \"mon-fri 10:00-18:00\"")
            };
            let (days, times) = text.trim().split_once(' ').ok_or_else(wrong)?;
            let (from, to) = times.trim().split_once('-').ok_or_else(wrong)?;
            let times = minute(from).zip(minute(to)).filter(|(from, to)| from != to);
            let (from, to) = times.ok_or_else(wrong)?;
            // A span that ends before it begins ends on the next day.
            let length = (to + DAY - from - 1) % DAY + 1;
            for day in days_of(days).ok_or_else(wrong)? {
                let begin = day * DAY + from;
                hours.spans.push((begin, begin + length));
            }
        }
        Ok(hours)
    }

    /// Returns true if visitors may come at this time.
    pub fn is_open(&self, now: LocalTime) -> bool {
        let now = now.weekday * DAY + now.minute;
        // A span that runs into the next week holds the times at its beginning too.
        let holds = |&(from, to): &(u32, u32)| {
            (from..to).contains(&now) || (from..to).contains(&(now + 7 * DAY))
        };
        self.spans.is_empty() || self.spans.iter().any(holds)
    }

    /// Returns the next opening time; `None` without opening hours.
    pub fn opens_next(&self, now: LocalTime) -> Option<NextOpening> {
        let now = now.weekday * DAY + now.minute;
        let until = |&(from, _): &(u32, u32)| (from + 7 * DAY - now - 1) % (7 * DAY) + 1;
        let soonest = self.spans.iter().min_by_key(|span| until(span))?;
        let far = until(soonest) >= DAY;
        let weekday = far.then_some(soonest.0 / DAY % 7);
        Some(NextOpening { weekday, minute: soonest.0 % DAY })
    }
}

/// The darkness of the screen by times of the week.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DimHours(Vec<(Hours, f32)>);

impl DimHours {
    /// Reads spans with a darkness from 0 to 1, such as `daily 18:00-22:00 0.5`.
    ///
    /// # Errors
    /// Names the span and what was expected.
    pub fn parse(spans: &[String]) -> Result<DimHours, String> {
        let read = |text: &String| {
            let wrong = || {
                format!(
                    "\"{text}\": expected days, times and a darkness from 0 to 1, for example \
                         \"daily 18:00-22:00 0.5\""
                )
            };
            let (span, dim) = text.trim().rsplit_once(' ').ok_or_else(wrong)?;
            let dim = dim.parse().ok().filter(|dim| (0.0..=1.0).contains(dim));
            let hours = Hours::parse(&[span.to_owned()]).map_err(|_| wrong())?;
            Ok((hours, dim.ok_or_else(wrong)?))
        };
        spans.iter().map(read).collect::<Result<_, String>>().map(DimHours)
    }

    /// Returns the darkness at this time: that of the first span that holds it, or 0.
    pub fn at(&self, now: LocalTime) -> f32 {
        self.0.iter().find(|(hours, _)| hours.is_open(now)).map_or(0.0, |(_, dim)| *dim)
    }
}

/// A time of the day such as `9:30`; 24:00 is the end of the day.
fn minute(text: &str) -> Option<u32> {
    let (hour, minute) = text.trim().split_once(':')?;
    let digits = |t: &str| (1..=2).contains(&t.len()) && t.bytes().all(|b| b.is_ascii_digit());
    if !digits(hour) || !digits(minute) || minute.len() != 2 {
        return None;
    }
    let (hour, minute): (u32, u32) = (hour.parse().ok()?, minute.parse().ok()?);
    (minute < 60 && hour * 60 + minute <= DAY).then_some(hour * 60 + minute)
}

/// Days such as `mon-fri`, `sat,sun` or `daily`; a range may run over the week's end.
fn days_of(text: &str) -> Option<Vec<u32>> {
    if text == "daily" {
        return Some((0..7).collect());
    }
    let day = |name: &str| DAYS.iter().position(|d| *d == name).map(|d| d as u32);
    let mut all = Vec::new();
    for part in text.split(',') {
        let (from, to) = part.split_once('-').unwrap_or((part, part));
        let (from, to) = (day(from)?, day(to)?);
        all.extend((0..=(to + 7 - from) % 7).map(|i| (from + i) % 7));
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hours(spans: &[&str]) -> Hours {
        let spans: Vec<String> = spans.iter().map(|s| (*s).to_owned()).collect();
        Hours::parse(&spans).expect("hours")
    }

    fn at(weekday: u32, hour: u32, minute: u32) -> LocalTime {
        LocalTime { weekday, minute: hour * 60 + minute, day: 0 }
    }

    #[test]
    fn a_museum_s_week() {
        let week = hours(&["tue-fri 10:00-18:00", "sat,sun 11:00-20:00"]);
        for (time, open) in [
            (at(0, 12, 0), false),
            (at(1, 9, 59), false),
            (at(1, 10, 0), true),
            (at(4, 17, 59), true),
            (at(4, 18, 0), false),
            (at(5, 10, 30), false),
            (at(6, 19, 59), true),
        ] {
            assert_eq!(week.is_open(time), open, "{time:?}");
        }
        let next = |now| week.opens_next(now).map(|next| (next.weekday, next.minute));
        assert_eq!(next(at(1, 9, 0)), Some((None, 600)));
        assert_eq!(next(at(4, 18, 0)), Some((None, 660)), "Saturday opens later");
        assert_eq!(next(at(6, 21, 0)), Some((Some(1), 600)), "Monday is closed");
        assert_eq!(next(at(0, 11, 0)), Some((None, 600)));
    }

    #[test]
    fn nights_and_week_ends_run_over() {
        let night = hours(&["sun 22:00-02:00"]);
        assert!(night.is_open(at(6, 23, 0)) && night.is_open(at(0, 1, 59)));
        assert!(!night.is_open(at(0, 2, 0)) && !night.is_open(at(6, 21, 59)));
        let long = hours(&["fri-mon 0:00-24:00"]);
        assert!(long.is_open(at(0, 0, 0)) && long.is_open(at(6, 23, 59)));
        assert!(!long.is_open(at(1, 0, 0)) && !long.is_open(at(3, 23, 59)));
        assert!(hours(&[]).is_open(at(3, 4, 5)), "always");
        assert_eq!(hours(&[]).opens_next(at(3, 4, 5)), None);
    }

    #[test]
    fn an_evening_is_darker_and_a_night_darker_still() {
        let spans = ["daily 22:00-6:00 0.9", "mon-fri 18:00-24:00 0.4"].map(String::from);
        let dim = DimHours::parse(&spans).expect("spans");
        for (time, expected) in [
            (at(0, 17, 59), 0.0),
            (at(0, 18, 0), 0.4),
            (at(0, 22, 0), 0.9),
            (at(1, 5, 59), 0.9),
            (at(1, 6, 0), 0.0),
            (at(5, 19, 0), 0.0),
        ] {
            assert_eq!(dim.at(time), expected, "{time:?}");
        }
        for text in ["daily 18:00-22:00", "daily 18:00-22:00 1.5", "daily 0.5", "18:00 0.5"] {
            let said = DimHours::parse(&[text.to_owned()]).expect_err(text);
            assert!(said.contains("daily 18:00-22:00 0.5"), "{said}");
        }
    }

    #[test]
    fn what_is_no_time_is_named() {
        for text in [
            "mon",
            "mon 10-18",
            "mun 10:00-18:00",
            "mon 10:00-10:00",
            "mon 25:00-26:00",
            "mon 9:5-10:00",
            "",
        ] {
            let said = Hours::parse(&[text.to_owned()]).expect_err(text);
            assert!(said.contains("mon-fri 10:00-18:00"), "{said}");
        }
    }
}
