//! How long a station that may host looks for who hosts already.

/// Time without a sign of others, in microseconds: longer than the living need to find that their
/// host is gone.
const QUIET_US: u64 = 2_000_000;
/// The longest search, in microseconds, whatever is heard.
const LONGEST_US: u64 = 15_000_000;

/// The search of a station that wants to host.
#[derive(Debug)]
pub struct HostSearch {
    until_us: u64,
    latest_us: u64,
    /// It found nobody, and [`crate::core::Event::NobodyHosts`] was reported.
    pub claimed: bool,
}

impl HostSearch {
    pub fn begin(now_us: u64) -> HostSearch {
        HostSearch { until_us: now_us + QUIET_US, latest_us: now_us + LONGEST_US, claimed: false }
    }

    /// Somebody hosts, or is about to: there will be an answer.
    pub fn sees_a_sign(&mut self, now_us: u64) {
        self.until_us = (now_us + QUIET_US).min(self.latest_us);
    }

    /// The host does not know this station's key: signs of that sculpture count no more.
    pub fn is_refused(&mut self) {
        self.latest_us = self.until_us;
    }

    /// Returns true once nobody is found, the first time.
    pub fn ends(&mut self, now_us: u64) -> bool {
        let ends = !self.claimed && now_us >= self.until_us;
        self.claimed |= ends;
        ends
    }
}
