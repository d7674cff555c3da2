//! Events sent to a subscribed client: one line for each change.

use serde::{Deserialize, Serialize};

use crate::brush::BrushSettings;
use crate::status::Losses;

/// The name of an event, as `subscribe` lists it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EventName {
    /// The mesh changed.
    Work,
    /// A step was made, undone or redone.
    History,
    /// The brush or one of its settings changed.
    Brush,
    /// Samples were lost between a device and the loop.
    Losses,
    /// The session file stopped or resumed taking what is written.
    Journal,
}

impl EventName {
    /// Every event, in the order in which `subscribe` lists them.
    pub const ALL: [EventName; 5] = [
        EventName::Work,
        EventName::History,
        EventName::Brush,
        EventName::Losses,
        EventName::Journal,
    ];
}

/// Reply of `subscribe`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SubscribeReply {
    /// The events that follow from now on.
    pub events: Vec<EventName>,
}

/// The `params` of a line `{"jsonrpc": "2.0", "method": "event", "params": ...}`.
///
/// ```
/// use sculptd_control::event::{Event, EventNotice};
/// let text = r#"{"event":"history","tick":7,"now":{"undo_steps":3,"redo_steps":0}}"#;
/// let notice: EventNotice = serde_json::from_str(text)?;
/// assert!(matches!(notice.event, Event::History(h) if h.undo_steps == 3));
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct EventNotice {
    /// The tick at which the change was seen.
    pub tick: u64,
    /// Kind of the change, and the new state.
    #[serde(flatten)]
    pub event: Event,
}

/// Kind of a change, and the new state. Changes within 50 ms of each other are one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "event", content = "now", rename_all = "kebab-case")]
pub enum Event {
    /// The mesh changed.
    Work(MeshState),
    /// A step was made, undone or redone.
    History(HistoryState),
    /// The brush or one of its settings changed.
    Brush(Box<BrushSettings>),
    /// Samples were lost between a device and the loop.
    Losses(Losses),
    /// The session file stopped or resumed taking what is written.
    Journal(JournalState),
}

impl Event {
    /// Its name.
    pub fn name(&self) -> EventName {
        match self {
            Event::Work(_) => EventName::Work,
            Event::History(_) => EventName::History,
            Event::Brush(_) => EventName::Brush,
            Event::Losses(_) => EventName::Losses,
            Event::Journal(_) => EventName::Journal,
        }
    }
}

/// The mesh, by its counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MeshState {
    /// Rises with every change.
    pub revision: u64,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
}

/// Reach of `undo` and `redo`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HistoryState {
    /// Number of steps that `undo` can reach.
    pub undo_steps: u64,
    /// Number of steps that `redo` can reach.
    pub redo_steps: u64,
}

/// State of the session file's writes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JournalState {
    /// The fault; `null` while all is well, or if no session is recorded.
    pub fault: Option<String>,
}
