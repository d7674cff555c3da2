//! The keys of tablets: what is bound, and what a person is about to bind.

use std::sync::Arc;

use sculptd_daemon::tablet_controls::WorkedControl;
use sculptd_devices::pad_actions::{ActionTable, Control};

/// Controls of tablets, as panels see them.
#[derive(Debug, Clone)]
pub struct TabletKeys {
    /// Bindings of the person.
    pub own: Arc<ActionTable>,
    /// The control that was pressed or turned last.
    pub last: Option<WorkedControl>,
}

/// State of the pens page.
#[derive(Debug, Default)]
pub struct TabletKeysPage {
    /// The control whose action is being chosen.
    pub chosen: Option<Control>,
    /// While it waits for a control: the count of the last one before.
    pub listens_from: Option<u32>,
}
