//! Converts times of the tracker's clock to times of ours.
//!
//! A frame is read some time after it was taken. The least delay seen so far is the best estimate
//! of the offset between the two clocks. Frames that came late in a burst get the instants at which
//! they were taken, so that a speed computed from them is the hand's and not the network's.

/// Beyond this the clocks are held to have jumped, and the map starts afresh.
const JUMP_US: i64 = 1_000_000;

/// Greatest drift between the two clocks: 200 parts in a million, worse than any crystal.
const DRIFT_PARTS: i64 = 5_000;

/// Our time minus the tracker's, as the quickest frame so far showed it.
#[derive(Debug, Clone, Copy, Default)]
pub struct ClockMap {
    seen: Option<Seen>,
    last_us: u64,
}

#[derive(Debug, Clone, Copy)]
struct Seen {
    device: i64,
    offset: i64,
}

impl ClockMap {
    /// Returns the time of the frame on our clock: never later than `read_us`, never before the
    /// previous frame. Without a stamp of the tracker's it is the time of the read.
    pub fn map(&mut self, device_us: Option<u64>, read_us: u64) -> u64 {
        let taken = match device_us.and_then(|d| i64::try_from(d).ok()) {
            Some(device) => self.taken(device, read_us),
            None => read_us,
        };
        self.last_us = taken.clamp(self.last_us.min(read_us), read_us);
        self.last_us
    }

    /// Microseconds between the taking of a frame and its reading, over the least such time seen.
    pub fn delay_us(&self, read_us: u64) -> u64 {
        read_us.saturating_sub(self.last_us)
    }

    fn taken(&mut self, device: i64, read_us: u64) -> u64 {
        let apart = (read_us as i64).saturating_sub(device);
        let offset = match self.seen {
            Some(s)
                if device >= s.device
                    && apart.saturating_sub(s.offset).saturating_abs() <= JUMP_US =>
            {
                // Saturating: a device clock may say anything.
                let drift = device.saturating_sub(s.device) / DRIFT_PARTS;
                s.offset.saturating_add(drift).min(apart)
            }
            _ => apart,
        };
        self.seen = Some(Seen { device, offset });
        u64::try_from(device.saturating_add(offset)).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_spread_to_the_instants_it_was_taken() {
        let mut map = ClockMap::default();
        // Delay 3 ms, then a stall: three frames read together.
        let read = [1_003_000, 1_013_000, 1_048_000, 1_048_000, 1_048_000];
        let device = [500, 10_500, 20_500, 30_500, 40_500];
        let got: Vec<u64> = read.iter().zip(device).map(|(r, d)| map.map(Some(d), *r)).collect();
        assert_eq!(got, [1_003_000, 1_013_000, 1_023_002, 1_033_004, 1_043_006]);
        assert_eq!(map.delay_us(1_048_000), 4_994);
    }

    #[test]
    fn it_is_never_later_than_the_read_never_backwards_and_survives_any_stamp() {
        let mut map = ClockMap::default();
        let stamps = [
            Some(5),
            None,
            Some(u64::MAX),
            Some(0),
            Some(i64::MAX as u64),
            Some(7),
            Some(1 << 62),
            Some(3),
        ];
        let mut last = 0;
        for (i, stamp) in stamps.iter().cycle().take(64).enumerate() {
            let read = 1000 * (i as u64 / 3);
            let t = map.map(*stamp, read);
            assert!(t <= read && t >= last, "{t} after {last}, read at {read}");
            last = t;
        }
    }

    #[test]
    fn clocks_that_run_apart_are_followed() {
        let mut map = ClockMap::default();
        let mut worst = 0;
        for i in 0..100_000u64 {
            let read = 10_000 * i + 2_000 + (i * 7919) % 1500;
            let device = 10_000 * i - i; // The tracker loses 100 parts in a million.
            let t = map.map(Some(device), read);
            worst = worst.max(t.abs_diff(10_000 * i + 2_000));
        }
        assert!(worst < 1600, "{worst} us");
    }
}
