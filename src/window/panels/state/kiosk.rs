//! The state of an installation's screen.

/// What the person at the screen has chosen; forgotten with each visit.
#[derive(Debug, Default)]
pub struct KioskPad {
    /// Index into the screen's languages.
    pub language: usize,
    /// What staff has typed so far, while the keypad is open.
    pub typed: Option<String>,
    pub(in crate::panels) visits: u64,
    /// Buttons of the last frame that can be pressed.
    pub(in crate::panels) targets: usize,
}
