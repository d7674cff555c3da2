//! What an installation publishes: one JSON object, whole each time. A reader ignores fields that
//! it does not know; fields are added and never change their meaning within one [`SCHEMA_VERSION`].

use serde::{Deserialize, Serialize};

/// The version of the schema of this crate.
pub const SCHEMA_VERSION: u32 = 1;
/// Bytes that a state may take.
pub const MAX_STATE: usize = 16 << 10;
/// Bytes of the name of a fleet or an installation.
pub const MAX_FLEET_NAME: usize = 64;

/// The state of an installation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct InstallationState {
    /// The version of this schema: 1.
    pub schema: u32,
    /// The installation's name in the fleet: 1 to 64 letters, digits, `-`, `_` or `.`.
    pub name: String,
    /// The program's version.
    pub version: String,
    /// Names this run of the program: 16 hexadecimal digits, drawn at its start.
    pub run: String,
    /// Start of the run, in seconds since 1970 (UTC) by the installation's clock.
    pub started_s: u64,
    /// Counts the publications of this run, from 1.
    pub sequence: u64,
    /// Seconds since the run began.
    pub uptime_s: u64,
    /// Visitor state, and the number of visits.
    pub visit: VisitState,
    /// Errors and warnings of this run.
    pub errors: ErrorCounts,
    /// The hottest sensor, degrees Celsius; absent: there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub celsius: Option<f32>,
    /// Result of the last export of this run: the path of the file, or the reason for its failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exported: Option<String>,
    /// Bytes that are free where sculptures are kept; absent where that cannot be told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disk_free_bytes: Option<u64>,
    /// One line a device: what it is, how it stands, what is wrong.
    #[serde(default)]
    pub devices: Vec<DeviceLine>,
    /// Durations of the loop's ticks.
    pub ticks: TickTimes,
    /// Latency from a sample to the frame that shows it; absent without a window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<FrameTimes>,
    /// The settings file of the installation.
    pub settings: SettingsState,
    /// The highest sequence of a request that this run has taken; 0: none.
    pub accepted: u64,
}

/// Visitor state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct VisitState {
    /// Stage of the visit.
    pub stage: VisitStage,
    /// Visits of this run that have ended.
    pub visits: u64,
    /// Visits that ended today, and works of today in the gallery.
    #[serde(default)]
    pub today: u64,
    /// See `today`.
    #[serde(default)]
    pub kept_today: u64,
    /// Mean length of the visits of this run, seconds.
    #[serde(default)]
    pub mean_s: u64,
    /// True if no visitor may come: outside the opening hours, or during cleaning.
    #[serde(default)]
    pub closed: bool,
    /// True during cleaning.
    #[serde(default)]
    pub cleaning: bool,
}

/// Stage of a visit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum VisitStage {
    /// Nobody is there: recordings play.
    #[default]
    Attract,
    /// A visitor sculpts.
    Working,
    /// Nobody has touched anything for a while: the visit is about to end.
    Countdown,
}

/// Error counts of this run, from its log.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ErrorCounts {
    /// Lines of the level `ERROR`.
    pub errors: u64,
    /// Lines of the level `WARN`.
    pub warnings: u64,
    /// The newest error, at most 500 bytes; absent: there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<String>,
}

/// A device that an installation listens to.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DeviceLine {
    /// Kind of the device.
    pub kind: DeviceKind,
    /// Description and state of the device, for a person.
    pub text: String,
    /// True while samples can come from it.
    pub connected: bool,
}

/// The kinds of devices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum DeviceKind {
    /// A pen tablet.
    #[default]
    Tablet,
    /// A pen at a serial port.
    SerialPen,
    /// A tracker of hands.
    Tracker,
}

/// Durations of the loop's ticks in this run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TickTimes {
    /// The median, milliseconds.
    pub p50_ms: f64,
    /// The 99th percentile, milliseconds.
    pub p99_ms: f64,
    /// The longest, milliseconds.
    pub max_ms: f64,
    /// Ticks that came late.
    pub late: u64,
}

/// Latencies from a sample to the frame that showed it, in this run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FrameTimes {
    /// Number of frames that showed a new sample.
    pub count: u64,
    /// The median, milliseconds.
    pub p50_ms: f64,
    /// The 99th percentile, milliseconds.
    pub p99_ms: f64,
}

/// The settings file of an installation.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SettingsState {
    /// The first 16 hexadecimal digits of the SHA-256 of the file that this run began with; empty:
    /// the built-in settings.
    pub revision: String,
    /// True while the file is on trial: it is reverted unless staff keep it.
    pub trial: bool,
    /// The revision that a roll-back brings; absent: there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub previous: Option<String>,
}

impl InstallationState {
    /// Returns true if another state says the same, ignoring counters of time and of publications,
    /// and times of ticks and frames.
    pub fn says_the_same_as(&self, other: &InstallationState) -> bool {
        self.run == other.run
            && self.visit == other.visit
            && self.errors == other.errors
            && self.devices == other.devices
            && self.exported == other.exported
            && self.settings == other.settings
            && self.accepted == other.accepted
            && (&self.name, &self.version) == (&other.name, &other.version)
    }

    /// As it is published.
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// Reads what was published.
    ///
    /// # Errors
    /// Says what was expected.
    pub fn from_json(bytes: &[u8]) -> Result<InstallationState, String> {
        if bytes.len() > MAX_STATE {
            return Err(format!("expected at most {MAX_STATE} bytes, found {}", bytes.len()));
        }
        let state: InstallationState = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
        if state.schema != SCHEMA_VERSION {
            let found = state.schema;
            return Err(format!("expected version {SCHEMA_VERSION} of the schema, found {found}"));
        }
        fleet_name(&state.name)?;
        Ok(state)
    }
}

/// The name of a fleet or of an installation: it is a part of a key on the network.
///
/// # Errors
/// Says what is expected.
pub fn fleet_name(text: &str) -> Result<String, String> {
    let fine = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    match (1..=MAX_FLEET_NAME).contains(&text.len()) && text.chars().all(fine) {
        true => Ok(text.into()),
        false => Err("expected 1 to 64 letters, digits, '-', '_' or '.'".into()),
    }
}

/// At most so many bytes of a text, cut between two letters.
pub fn shortened(text: &str, most: usize) -> &str {
    let mut end = most.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    &text[..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_newer_state_is_read_and_another_schema_or_name_is_not() {
        let state = InstallationState {
            schema: SCHEMA_VERSION,
            name: "hall-3".into(),
            ..InstallationState::default()
        };
        let mut json: serde_json::Value =
            serde_json::from_slice(&state.to_json()).expect("an object");
        json["battery"] = 3.into();
        let read = InstallationState::from_json(json.to_string().as_bytes());
        assert_eq!(read.as_ref(), Ok(&state));
        json["name"] = "hall/*".into();
        assert!(InstallationState::from_json(json.to_string().as_bytes()).is_err());
        json["name"] = "hall-3".into();
        json["schema"] = 2.into();
        let why = InstallationState::from_json(json.to_string().as_bytes()).expect_err("newer");
        assert!(why.contains("found 2"), "{why}");
        assert!(InstallationState::from_json(&vec![b' '; MAX_STATE + 1]).is_err());
    }

    #[test]
    fn a_text_is_cut_between_letters() {
        assert_eq!((shortened("aé", 2), shortened("aé", 3), shortened("", 9)), ("a", "aé", ""));
    }
}
