//! The window in which keys are changed.

use super::action::Action;

#[derive(Debug, Default)]
pub struct KeysPage {
    pub open: bool,
    /// Words of the actions that are shown.
    pub filter: String,
    /// The action whose new keys are the next press.
    pub listening: Option<Action>,
}
