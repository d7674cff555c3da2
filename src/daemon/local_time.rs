//! The time on the wall where this machine is. SQLite asks the system for the time zone, so no
//! table of zones is needed here.

use rusqlite::Connection;

/// A time on the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LocalTime {
    /// 0 Monday to 6 Sunday.
    pub weekday: u32,
    /// Minutes since midnight.
    pub minute: u32,
    /// A number that is different for each date.
    pub day: i64,
}

/// Converts times.
#[derive(Debug)]
pub struct LocalClock {
    connection: Connection,
}

impl LocalClock {
    /// # Errors
    /// Returns SQLite's error.
    pub fn new() -> Result<LocalClock, rusqlite::Error> {
        Ok(LocalClock { connection: Connection::open_in_memory()? })
    }

    /// Returns the local time at `seconds` since 1970 (UTC). `None`: the system has no calendar for
    /// it.
    pub fn at(&self, seconds: u64) -> Option<LocalTime> {
        let text = "select cast(strftime('%w', t) as integer), \
                    cast(strftime('%H', t) as integer) * 60 + cast(strftime('%M', t) as integer), \
                    cast(julianday(date(t)) as integer) \
                    from (select datetime(?1, 'unixepoch', 'localtime') as t)";
        let mut statement = self.connection.prepare_cached(text).ok()?;
        let row = statement.query_row([i64::try_from(seconds).ok()?], |row| {
            Ok((row.get::<_, u32>(0)?, row.get::<_, u32>(1)?, row.get::<_, i64>(2)?))
        });
        let (sunday_first, minute, day) = row.ok()?;
        Some(LocalTime { weekday: (sunday_first + 6) % 7, minute, day })
    }

    /// Returns the local time now.
    pub fn now(&self) -> Option<LocalTime> {
        self.at(unix_s())
    }

    /// Returns the last midnight, in seconds since 1970 (UTC): an hour off on the two days of the
    /// year on which the clock is changed.
    pub fn midnight(&self) -> u64 {
        let now = unix_s();
        now - u64::from(self.at(now).map_or(0, |time| time.minute)) * 60 - now % 60
    }
}

/// Seconds since 1970 (UTC).
#[allow(clippy::disallowed_methods)] // The edge: opening hours are of the calendar.
pub fn unix_s() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_later_is_the_next_weekday_at_the_same_minute() {
        let clock = LocalClock::new().expect("SQLite");
        // 2026-01-14, a Wednesday, at noon UTC: far from a change of summer time.
        let noon = 1_768_392_000;
        let (a, b) = (clock.at(noon).expect("a time"), clock.at(noon + 86_400).expect("a time"));
        assert_eq!((b.weekday, b.minute, b.day), ((a.weekday + 1) % 7, a.minute, a.day + 1));
        // Noon in UTC is Wednesday wherever people live, but for the last hours before the date
        // line.
        assert!((2..=3).contains(&a.weekday), "{a:?}");
        assert_eq!(a.minute % 15, 0, "{a:?}");
    }
}
