//! The state of an installation's screen.

/// Choices of the person at the screen; reset with each visit.
#[derive(Debug, Default)]
pub struct KioskPad {
    /// Index into the screen's languages.
    pub language: usize,
    /// Digits that staff has typed so far, while the keypad is open.
    pub typed: Option<String>,
    /// [`sculptd_daemon::kiosk::View::wrong`] when the keypad was opened.
    pub(in crate::panels) wrong_before: u64,
    pub(in crate::panels) visits: u64,
    /// Buttons of the last frame that can be pressed.
    pub(in crate::panels) targets: usize,
}
