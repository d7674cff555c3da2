//! Who shares the sculpture, and where their pens are.

use serde::{Deserialize, Serialize};

/// Reply of `people`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PeopleReply {
    /// True if the sculpture is shared: the daemon hosts one or has joined one.
    pub shared: bool,
    /// The number of the person of this daemon; 0: none, as nothing is shared.
    pub own: u8,
    /// All who ever came, in the order of their numbers.
    pub people: Vec<PersonInfo>,
    /// The connection to the others; `null` if nothing is shared.
    #[serde(default)]
    pub link: Option<SharedLink>,
    /// Counts of the input of this daemon's devices and commands; `null` if nothing is shared.
    #[serde(default)]
    pub own_input: Option<OwnInput>,
    /// The newest refused undo or redo of this daemon's person, blocked by a step of somebody else;
    /// `null` if none was refused.
    #[serde(default)]
    pub undo_refused: Option<UndoRefused>,
}

/// The connection of this daemon to the others at a shared sculpture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SharedLink {
    /// State of the connection.
    pub state: SharedState,
    /// Name of the person whose daemon hosts; `null` if unknown.
    pub host: Option<String>,
    /// Whole seconds for which the state has been so.
    pub since_s: u64,
    /// Batches of local input that no host has ordered yet.
    pub waiting: u64,
    /// Batches of local input that never reached the others: only this daemon's sculpture and
    /// session contain them.
    pub undelivered: u64,
    /// Why the host sent this daemon away; `null` if it did not.
    pub reason: Option<String>,
    /// Number of the sculpture, eight hexadecimal digits: two of one name differ in it.
    pub sculpture: String,
    /// Other sculptures that are shared under the same name on this network: number, people, age.
    pub others: Vec<String>,
}

/// See [`SharedLink`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SharedState {
    /// It orders everybody's input.
    Hosts,
    /// It follows the host.
    Follows,
    /// It hears neither the host nor a successor. Its input waits.
    CutOff,
    /// The host sent it away. It goes on alone.
    SentAway,
}

/// Counts of the local input: all of it is in the sculpture when `ordered` is `batches`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct OwnInput {
    /// Samples that did more than move.
    pub transitions: u64,
    /// Batches that they, and the commands, were put in: at most one for each tick.
    pub batches: u64,
    /// Batches that are in the order that all step.
    pub ordered: u64,
    /// Batches that are in it, and that another replica has too.
    pub acknowledged: u64,
    /// Samples that only moved and were left out, as too much waited.
    pub dropped: u64,
    /// Batches that were acknowledged and are in no order that is left: none, but where a network
    /// was split for minutes.
    pub lost: u64,
}

/// An undo or redo that was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct UndoRefused {
    /// The tick in which it was asked for.
    pub tick: u64,
    /// It was a redo.
    pub redo: bool,
    /// The number of the person whose step is in the way.
    pub by: u8,
}

/// A person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PersonInfo {
    /// From 1; a person who comes back has the same.
    pub number: u8,
    /// As the person wants to be called.
    pub name: String,
    /// Permissions of the person.
    pub role: PersonRole,
    /// The person is connected.
    pub here: bool,
    /// The colour of the person in every window: `#` and six hexadecimal digits.
    pub colour: String,
    /// Contact points of the person's pens with the clay; empty for this daemon's person, whose
    /// pens are in `status`.
    #[serde(default)]
    pub pens: Vec<PersonPen>,
}

/// Permissions of a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PersonRole {
    /// Sculpts and sees.
    Sculptor,
    /// Sees.
    Viewer,
    /// Sends samples, and sees nothing.
    Device,
}

/// A pen over the clay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PersonPen {
    /// Position on the clay, in the world.
    pub position: [f32; 3],
    /// The surface's normal there, of length 1.
    pub normal: [f32; 3],
    /// The radius of its brush as it presses now, in the unit of the scene.
    pub radius: f32,
    /// The tip touches.
    pub down: bool,
    /// The object under it, as `scene.list` names it.
    pub object: u32,
}
