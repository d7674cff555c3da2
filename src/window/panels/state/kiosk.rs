//! The state of an installation's screen.

/// Choices of the person at the screen; reset with each visit.
#[derive(Debug, Default)]
pub struct KioskPad {
    /// Index into the screen's languages.
    pub language: usize,
    /// The list of languages was unfolded.
    pub(in crate::panels) unfolded: bool,
    /// Digits that staff has typed so far, while the keypad is open.
    pub typed: Option<String>,
    /// [`sculptd_daemon::kiosk::View::wrong`] when the keypad was opened.
    pub(in crate::panels) wrong_before: u64,
    /// The visitor shows or hides the goal of an exhibit; `None`: as the exhibit says.
    pub ghost: Option<bool>,
    /// The clay is coloured by its distance from the goal.
    pub compares: bool,
    /// Staff pressed "end for good" once.
    pub(in crate::panels) ends: bool,
    pub(in crate::panels) visits: u64,
    /// Buttons of the last frame that can be pressed.
    pub(in crate::panels) targets: usize,
}
