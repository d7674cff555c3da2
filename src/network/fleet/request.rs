//! What staff ask of an installation, and what it answers: JSON, sealed ([`super::access`]).

use serde::{Deserialize, Serialize};

/// Bytes of a request or an answer before it is sealed.
pub const MAX_REQUEST: usize = 1 << 20;
/// Bytes of a message to the staff of a hall.
pub const MAX_MESSAGE: usize = 500;
/// Lines of the log that one answer brings.
pub const MAX_LOG_LINES: u32 = 1000;
/// Bytes of a settings file.
pub const MAX_SETTINGS: usize = 64 << 10;
/// Seconds that settings may be on trial: a week.
pub const MAX_TRIAL_S: u32 = 7 * 86_400;

/// A request to one installation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FleetRequest {
    /// Names the request: 16 hexadecimal digits, drawn by who asks. The same request may come more
    /// than once and is carried out once.
    pub id: String,
    /// The run that is asked: [`super::state::InstallationState::run`].
    pub run: String,
    /// Greater than that of any request that this run has taken.
    pub sequence: u64,
    /// The requested action.
    pub action: FleetAction,
}

/// Action that staff request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "do", rename_all = "kebab-case")]
pub enum FleetAction {
    /// Shows a text to the staff on the spot, until somebody presses it away.
    Message {
        /// At most 500 bytes; empty: what is shown goes.
        text: String,
    },
    /// Ends the visit as if the visitor had pressed "finished", and puts everything back.
    RestartVisit,
    /// A button of the installation's staff page.
    Staff {
        /// The button.
        order: StaffOrder,
    },
    /// The newest lines of the log.
    Logs {
        /// Number of lines, 1 to 1000.
        lines: u32,
    },
    /// Replaces the installation's settings file, on trial, and starts a new run with it. The
    /// installation keeps the settings that are its own. If the file is in place already, nothing
    /// is done.
    TrySettings {
        /// The text of the file, with the settings that a roll-out may change; at most 64 KiB.
        text: String,
        /// After so many seconds without [`FleetAction::KeepSettings`] the file before it comes
        /// back: 1 to 604800.
        trial_s: u32,
    },
    /// Ends the trial: the file stays.
    KeepSettings {
        /// The revision on trial.
        revision: String,
    },
    /// The file before it comes back, and a new run begins with that.
    TakeBackSettings {
        /// Only where this revision is in place; absent: whichever is.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        revision: Option<String>,
    },
}

/// A button of an installation's staff page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StaffOrder {
    /// Closes for cleaning.
    Clean,
    /// Opens again after cleaning.
    Open,
    /// Packs the works of today into one file in the gallery.
    Export,
    /// Ends the program and starts it again.
    Restart,
    /// Ends the program for good.
    End,
}

impl FleetAction {
    /// Checks that it is within its bounds.
    ///
    /// # Errors
    /// The text names the expected range.
    pub fn check(&self) -> Result<(), String> {
        let least = |what: &str, found: u32, most: u32| match (1..=most).contains(&found) {
            true => Ok(()),
            false => Err(format!("{what}: expected 1 to {most}, found {found}")),
        };
        match self {
            FleetAction::Message { text } if text.len() > MAX_MESSAGE => {
                Err(format!("a message: expected at most {MAX_MESSAGE} bytes"))
            }
            FleetAction::Logs { lines } => least("lines", *lines, MAX_LOG_LINES),
            FleetAction::TrySettings { text, .. } if text.len() > MAX_SETTINGS => {
                Err(format!("settings: expected at most {MAX_SETTINGS} bytes"))
            }
            FleetAction::TrySettings { trial_s, .. } => least("trial_s", *trial_s, MAX_TRIAL_S),
            _ => Ok(()),
        }
    }
}

/// An installation's answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FleetAnswer {
    /// The request's.
    pub id: String,
    /// Result of the request.
    #[serde(flatten)]
    pub outcome: FleetOutcome,
}

/// Result of a request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "outcome", rename_all = "kebab-case")]
pub enum FleetOutcome {
    /// It is done, or begun.
    Done {
        /// For a person.
        note: String,
    },
    /// The lines that were asked for, the oldest first.
    Logs {
        /// Without the ends of lines.
        lines: Vec<String>,
    },
    /// It is not done.
    Refused {
        /// For a person.
        why: String,
    },
    /// It names another run, or a sequence that is used up. It may be asked again with these.
    Stale {
        /// The run that answers.
        run: String,
        /// The highest sequence that this run has taken.
        accepted: u64,
    },
}

/// Reads a request or an answer.
///
/// # Errors
/// Says what was expected.
pub fn from_json<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, String> {
    if bytes.len() > MAX_REQUEST {
        return Err(format!("expected at most {MAX_REQUEST} bytes, found {}", bytes.len()));
    }
    serde_json::from_slice(bytes).map_err(|e| e.to_string())
}

/// As it is sealed.
pub fn to_json(message: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(message).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_and_answers_have_the_form_that_the_schema_says() {
        let request = FleetRequest {
            id: "00".into(),
            run: "11".into(),
            sequence: 3,
            action: FleetAction::Logs { lines: 20 },
        };
        let text = r#"{"id":"00","run":"11","sequence":3,"action":{"do":"logs","lines":20}}"#;
        assert_eq!(to_json(&request), text.as_bytes());
        assert_eq!(from_json(text.as_bytes()), Ok(request));
        let text = r#"{"id":"00","outcome":"refused","why":"no"}"#;
        let answer: FleetAnswer = from_json(text.as_bytes()).expect("an answer");
        assert_eq!(answer.outcome, FleetOutcome::Refused { why: "no".into() });
        assert_eq!(to_json(&answer), text.as_bytes());
    }

    #[test]
    fn what_is_out_of_bounds_is_refused() {
        let long = "x".repeat(MAX_SETTINGS + 1);
        for action in [
            FleetAction::Message { text: "x".repeat(MAX_MESSAGE + 1) },
            FleetAction::Logs { lines: 0 },
            FleetAction::Logs { lines: MAX_LOG_LINES + 1 },
            FleetAction::TrySettings { text: long, trial_s: 9 },
            FleetAction::TrySettings { text: String::new(), trial_s: 0 },
        ] {
            assert!(action.check().is_err(), "{action:?}");
        }
        assert!(FleetAction::Logs { lines: MAX_LOG_LINES }.check().is_ok());
    }
}
