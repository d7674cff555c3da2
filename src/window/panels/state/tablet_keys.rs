//! The keys of tablets: what is bound, and what a person is about to bind.

use std::sync::Arc;

use sculptd_daemon::tablet_controls::WorkedControl;
use sculptd_devices::pad_actions::{ActionTable, Control};

/// What panels see of the controls of tablets.
#[derive(Debug, Clone)]
pub struct TabletKeys {
    /// What the person has bound.
    pub own: Arc<ActionTable>,
    /// The control that was pressed or turned last.
    pub last: Option<WorkedControl>,
}

/// What the page of the pens has open.
#[derive(Debug, Default)]
pub struct TabletKeysPage {
    /// The control whose action is being chosen.
    pub chosen: Option<Control>,
    /// While it waits for a control: the count of the last one before.
    pub listens_from: Option<u32>,
}
