//! A settings file rolled out over a fleet: to one installation first, the canary, which is watched
//! for a time; then to the others, which are watched as well. If one of them is lost, restarts,
//! logs an error or refuses the file, the roll-out is reverted everywhere.
//!
//! All of this is on trial until the end: an installation that can no longer be reached reverts the
//! file by itself. An offline one is named in the end; repeating the same roll-out completes it
//! there, and changes nothing on those that have the file.

use std::collections::BTreeMap;

use super::registry::FleetRegistry;
use super::request::{FleetAction, FleetOutcome};
use super::requester::RequestEnd;

/// An installation has begun its run with the new file after so long, microseconds.
pub const START_US: u64 = 90_000_000;
/// Seconds of a trial beyond the times that the roll-out needs.
const SPARE_S: u64 = 60;

/// Content and parameters of a roll-out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RolloutPlan {
    /// The settings file.
    pub text: String,
    /// Its revision: [`super::settings_files::revision_of`].
    pub revision: String,
    /// The installation that is first.
    pub canary: String,
    /// The others.
    pub others: Vec<String>,
    /// Time for which each is watched, in microseconds.
    pub watch_us: u64,
}

impl RolloutPlan {
    fn trial_s(&self) -> u32 {
        let s = 2 * (self.watch_us + START_US) / 1_000_000 + SPARE_S;
        u32::try_from(s).unwrap_or(u32::MAX).min(super::request::MAX_TRIAL_S)
    }
}

/// Next action of a roll-out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RolloutStep {
    /// Send a request to an installation; [`Rollout::ended`] receives its result.
    Ask {
        /// Name of the installation.
        installation: String,
        /// For what.
        action: FleetAction,
    },
    /// For a person.
    Note(String),
}

/// Result of a roll-out.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(tag = "result", rename_all = "kebab-case")]
pub enum RolloutEnd {
    /// Every installation has it, except the offline ones.
    Kept {
        /// They have it.
        kept: Vec<String>,
        /// They were not there, or did not answer at the end.
        missed: Vec<String>,
    },
    /// It was reverted.
    TakenBack {
        /// Who failed.
        failed: String,
        /// How.
        why: String,
        /// They have the file that they had before.
        taken_back: Vec<String>,
        /// They did not answer: they take it back by themselves when their trial is over.
        silent: Vec<String>,
    },
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum TargetStage {
    /// The run that was there was offered the file; the next is to have begun with it by then.
    Offered { run: String, until_us: u64 },
    /// It runs with the file since then.
    Watched { run: String, since_us: u64 },
    /// It was watched for long enough.
    Good,
    /// It is asked to keep the file, or to take it back.
    Closing,
    /// It did.
    Closed,
    /// It did not answer, or was not there.
    Missed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RolloutPhase {
    Canary,
    Others,
    Keeping,
    TakingBack,
}

/// A roll-out under way.
#[derive(Debug)]
pub struct Rollout {
    plan: RolloutPlan,
    phase: RolloutPhase,
    targets: BTreeMap<String, TargetStage>,
    failed: Option<(String, String)>,
    steps: Vec<RolloutStep>,
    end: Option<RolloutEnd>,
}

impl Rollout {
    /// Begins with the canary.
    pub fn new(plan: RolloutPlan, registry: &FleetRegistry, now_us: u64) -> Rollout {
        let mut rollout = Rollout {
            phase: RolloutPhase::Canary,
            targets: BTreeMap::new(),
            failed: None,
            steps: Vec::new(),
            end: None,
            plan,
        };
        let canary = rollout.plan.canary.clone();
        rollout.note(format!("{canary} is the first"));
        rollout.offer(&canary, registry, now_us);
        rollout
    }

    /// Returns the result; `None` while it is under way.
    pub fn end(&self) -> Option<&RolloutEnd> {
        self.end.as_ref()
    }

    /// Passes time and looks at the list; what is to be done now.
    pub fn advance(&mut self, registry: &FleetRegistry, now_us: u64) -> Vec<RolloutStep> {
        if self.end.is_none() {
            self.watch(registry, now_us);
            self.go_on(registry, now_us);
        }
        std::mem::take(&mut self.steps)
    }

    /// A request that this asked for has ended.
    pub fn ended(&mut self, installation: &str, end: &RequestEnd) {
        let Some(stage) = self.targets.get_mut(installation) else { return };
        let refused = match end {
            RequestEnd::Answered(FleetOutcome::Done { .. }) => None,
            RequestEnd::Answered(FleetOutcome::Refused { why }) => Some(why.clone()),
            RequestEnd::Answered(_) => Some("it answers something else".into()),
            RequestEnd::Silent => Some("it does not answer".into()),
        };
        match (stage.clone(), refused) {
            (TargetStage::Closing, None) => *stage = TargetStage::Closed,
            (TargetStage::Closing, Some(why)) => {
                *stage = TargetStage::Missed;
                self.note(format!("{installation}: {why}"));
            }
            (TargetStage::Offered { .. }, Some(why)) => self.fail(installation, why),
            _ => {}
        }
    }

    fn note(&mut self, text: String) {
        self.steps.push(RolloutStep::Note(text));
    }

    fn offer(&mut self, installation: &str, registry: &FleetRegistry, now_us: u64) {
        let entry = registry.get(installation);
        let Some(entry) = entry.filter(|e| e.is_here()) else {
            if self.phase == RolloutPhase::Canary {
                self.fail(installation, "it is not there".into());
            } else {
                self.note(format!("{installation} is not there"));
            }
            self.targets.insert(installation.into(), TargetStage::Missed);
            return;
        };
        let settings = &entry.state.settings;
        if settings.revision == self.plan.revision && !settings.trial {
            self.note(format!("{installation} has it already"));
            self.targets.insert(installation.into(), TargetStage::Closed);
            return;
        }
        let (run, until_us) = (entry.state.run.clone(), now_us + START_US);
        self.targets.insert(installation.into(), TargetStage::Offered { run, until_us });
        let (text, trial_s) = (self.plan.text.clone(), self.plan.trial_s());
        let action = FleetAction::TrySettings { text, trial_s };
        self.steps.push(RolloutStep::Ask { installation: installation.into(), action });
    }

    fn fail(&mut self, installation: &str, why: String) {
        self.note(format!("{installation} fails: {why}"));
        self.failed.get_or_insert((installation.into(), why));
    }

    /// Watches the installations that were offered the file.
    fn watch(&mut self, registry: &FleetRegistry, now_us: u64) {
        let mut seen = Vec::new();
        for (name, stage) in &self.targets {
            let Some(entry) = registry.get(name) else { continue };
            let (state, has) = (&entry.state, entry.state.settings.revision == self.plan.revision);
            let next = match stage {
                TargetStage::Offered { .. } if has && entry.is_here() => {
                    let run = state.run.clone();
                    Ok(TargetStage::Watched { run, since_us: now_us })
                }
                TargetStage::Offered { run, .. }
                    if !has && entry.is_here() && state.run != *run =>
                {
                    Err("it has begun anew without the file".into())
                }
                TargetStage::Offered { until_us, .. } if now_us >= *until_us => {
                    Err("it has not begun with the file".into())
                }
                TargetStage::Watched { run, since_us } => {
                    let last = state.errors.last.as_deref().unwrap_or_default();
                    match () {
                        () if !entry.is_here() => Err("it is lost".into()),
                        () if !has => Err("it has taken the file back".into()),
                        () if state.run != *run => Err("it has begun anew".into()),
                        () if state.errors.errors > 0 => Err(format!("it logs an error: {last}")),
                        () if now_us >= since_us + self.plan.watch_us => Ok(TargetStage::Good),
                        () => continue,
                    }
                }
                // It stays online until the end, or the file is reverted everywhere.
                TargetStage::Good if !entry.is_here() => Err("it is lost".into()),
                TargetStage::Good if !has => Err("it has taken the file back".into()),
                TargetStage::Good if state.errors.errors > 0 => Err("it logs an error".into()),
                _ => continue,
            };
            seen.push((name.clone(), next));
        }
        for (name, next) in seen {
            match next {
                Ok(stage) => {
                    if stage == TargetStage::Good {
                        self.note(format!("{name} is well"));
                    } else {
                        self.note(format!("{name} runs with it"));
                    }
                    self.targets.insert(name, stage);
                }
                Err(why) => self.fail(&name, why),
            }
        }
    }

    fn go_on(&mut self, registry: &FleetRegistry, now_us: u64) {
        let open = |s: &TargetStage| {
            matches!(s, TargetStage::Offered { .. } | TargetStage::Watched { .. })
        };
        match self.phase {
            RolloutPhase::Canary | RolloutPhase::Others if self.failed.is_some() => {
                self.phase = RolloutPhase::TakingBack;
                self.close(|plan| FleetAction::TakeBackSettings {
                    revision: Some(plan.revision.clone()),
                });
            }
            RolloutPhase::Canary if !self.targets.values().any(open) => {
                self.phase = RolloutPhase::Others;
                for other in self.plan.others.clone() {
                    if other != self.plan.canary {
                        self.offer(&other, registry, now_us);
                    }
                }
            }
            RolloutPhase::Others if !self.targets.values().any(open) => {
                self.phase = RolloutPhase::Keeping;
                self.close(|plan| FleetAction::KeepSettings { revision: plan.revision.clone() });
            }
            _ => {}
        }
        let closes = matches!(self.phase, RolloutPhase::Keeping | RolloutPhase::TakingBack);
        if closes && !self.targets.values().any(|s| *s == TargetStage::Closing) {
            let of = |wanted: &TargetStage| {
                let all = self.targets.iter().filter(|(_, s)| *s == wanted);
                all.map(|(name, _)| name.clone()).collect::<Vec<_>>()
            };
            let (closed, missed) = (of(&TargetStage::Closed), of(&TargetStage::Missed));
            self.end = Some(match self.failed.clone() {
                None => RolloutEnd::Kept { kept: closed, missed },
                Some((failed, why)) => {
                    RolloutEnd::TakenBack { failed, why, taken_back: closed, silent: missed }
                }
            });
        }
    }

    /// Asks all that were offered the file for the last thing.
    fn close(&mut self, action: impl Fn(&RolloutPlan) -> FleetAction) {
        // An installation that had the file before this roll-out keeps it.
        let back = self.failed.is_some();
        self.targets
            .retain(|_, s| !back || !matches!(s, TargetStage::Closed | TargetStage::Missed));
        let action = action(&self.plan);
        for (name, stage) in &mut self.targets {
            if !matches!(stage, TargetStage::Closed | TargetStage::Missed) {
                *stage = TargetStage::Closing;
                let (installation, action) = (name.clone(), action.clone());
                self.steps.push(RolloutStep::Ask { installation, action });
            }
        }
    }
}
