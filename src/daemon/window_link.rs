//! State shared by a run and its window, so that the run survives the loss of the window.
//!
//! Laws kept here:
//! * Losing the window, by the end of its X server or compositor or by an error in the window,
//!   affects nothing else: the loop, the devices, the session and the control socket continue.
//! * The window's temporary settings are reverted: strokes end as if the pen were lifted, a lent
//!   brush is returned, and no tablet pen begins an unseen stroke.
//! * One process can create one window. A new window therefore opens after the run has ended and
//!   the process has restarted with the same session. A run without a session cannot keep the
//!   sculpture and refuses.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::present_latency::{PresentLatency, PresentedFrame};
use glam::DVec2;
use sculptd_clay::brush::BrushSettings;
use sculptd_devices::DeviceId;
use sculptd_engine::desktop_layout::{DesktopLayout, PenPlace};

/// Environment variables that name a screen, and their values.
pub type DisplayVariables = BTreeMap<String, String>;

/// State of a run's window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WindowStanding {
    /// No window was requested, or it could not be opened.
    #[default]
    Headless,
    /// The window is being created; nothing is drawn yet.
    Opening,
    /// It is shown.
    Open,
    /// Its X server or compositor has ended, or it has failed.
    Lost,
}

/// The sculpture that a window goes on with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NextSculpture {
    /// A new one.
    New,
    /// The one in this session file.
    Session(PathBuf),
}

/// Temporary settings of a window in the world.
#[derive(Debug, Clone, Copy, Default)]
pub struct WindowClaims {
    /// The desktop as last reported by the window.
    pub desktop: DesktopLayout,
    /// The brush to restore while a key lends another.
    pub lent: Option<BrushSettings>,
}

impl WindowClaims {
    /// The desktop after the window is lost: every pen stays where it is, and none begins a stroke.
    /// `in_range`: tablets that no desktop may know yet.
    pub fn desktop_without_window(
        &self,
        in_range: impl IntoIterator<Item = DeviceId>,
    ) -> DesktopLayout {
        let mut desktop = DesktopLayout { away: true, ..self.desktop };
        for id in in_range {
            if desktop.place(id).is_none()
                && let Some(slot) = desktop.tablets.iter_mut().find(|t| t.is_none())
            {
                *slot = Some((id, PenPlace::Area));
            }
        }
        desktop
    }
}

/// The shared state of a run and its window. Cloning it gives another handle to the same.
#[derive(Debug, Clone, Default)]
pub struct WindowLink(Arc<Mutex<LinkState>>);

#[derive(Debug, Default)]
struct LinkState {
    standing: WindowStanding,
    claims: WindowClaims,
    view: Option<[DVec2; 2]>,
    presented: PresentLatency,
    walls: bool,
    session: Option<PathBuf>,
    wanted: Option<DisplayVariables>,
}

/// Why no new window can open.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoNewWindow {
    #[error("this run keeps no session, so nothing can carry the sculpture to a new window")]
    NoSession,
    #[error("the window is open already")]
    Open,
}

impl WindowLink {
    /// Of a run that records into `session`.
    pub fn new(session: Option<&Path>) -> Self {
        let state = LinkState { session: session.map(Path::to_path_buf), ..Default::default() };
        WindowLink(Arc::new(Mutex::new(state)))
    }

    /// Every value here is replaced as a whole, so a thread that panicked has left it sound.
    fn state(&self) -> MutexGuard<'_, LinkState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn standing(&self) -> WindowStanding {
        self.state().standing
    }

    pub fn set_standing(&self, standing: WindowStanding) {
        self.state().standing = standing;
    }

    pub fn claims(&self) -> WindowClaims {
        self.state().claims
    }

    /// The window has told the daemon of another desktop.
    pub fn claim_desktop(&self, desktop: DesktopLayout) {
        self.state().claims.desktop = desktop;
    }

    /// The view's top left corner and its size, in pixels of the desktop; `None` before the window
    /// has drawn, and without one.
    pub fn view_on_desktop(&self) -> Option<[DVec2; 2]> {
        let state = self.state();
        state.view.filter(|_| state.standing == WindowStanding::Open)
    }

    /// The window has moved, or its panels leave another part of it free.
    pub fn set_view_on_desktop(&self, corner: DVec2, size: DVec2) {
        self.state().view = Some([corner, size]);
    }

    /// Records whether the window shows the map of wall thickness.
    pub fn show_walls(&self, shown: bool) {
        self.state().walls = shown;
    }

    /// Returns true while an open window shows the map of wall thickness.
    pub fn shows_walls(&self) -> bool {
        let state = self.state();
        state.walls && state.standing == WindowStanding::Open
    }

    /// A frame has shown a sample that none before it has.
    pub fn record_presented(&self, frame: &PresentedFrame) {
        self.state().presented.record(frame);
    }

    /// Returns the latency from samples to the screen.
    pub fn present_latency(&self) -> PresentLatency {
        self.state().presented.clone()
    }

    /// Records that the window has lent another brush, or returned it.
    pub fn claim_lent(&self, lent: Option<BrushSettings>) {
        self.state().claims.lent = lent;
    }

    /// The session that the run records into.
    pub fn session(&self) -> Option<PathBuf> {
        self.state().session.clone()
    }

    /// Asks for a new window on a screen; the session that it will show. The caller ends the run.
    ///
    /// # Errors
    /// [`NoNewWindow`], and nothing changes.
    pub fn want(&self, screen: DisplayVariables) -> Result<PathBuf, NoNewWindow> {
        let mut state = self.state();
        if matches!(state.standing, WindowStanding::Opening | WindowStanding::Open) {
            return Err(NoNewWindow::Open);
        }
        let session = state.session.clone().ok_or(NoNewWindow::NoSession)?;
        state.wanted = Some(screen);
        Ok(session)
    }

    /// The screen of the window that was asked for.
    pub fn wanted(&self) -> Option<DisplayVariables> {
        self.state().wanted.clone()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    #[test]
    fn a_lost_window_leaves_every_pen_where_it_is_and_lets_none_begin() {
        let mapped = PenPlace::Mapped { origin: Vec2::ZERO, across: Vec2::X, down: Vec2::Y };
        let mut claims = WindowClaims::default();
        claims.desktop.tablets[0] = Some((DeviceId(1), mapped));
        let desktop = claims.desktop_without_window([DeviceId(1), DeviceId(2)]);
        assert_eq!(desktop.place(DeviceId(1)), Some(mapped));
        for id in [1, 2] {
            let place = desktop.place(DeviceId(id));
            assert!(place.is_some() && !desktop.is_free(place, Vec2::splat(0.5)));
        }
        assert!(desktop.is_free(desktop.place(DeviceId(3)), Vec2::splat(0.5)));
        // More pens than there are places: the first ones are held.
        let many = claims.desktop_without_window((1..20).map(DeviceId));
        assert!(many.tablets.iter().all(Option::is_some) && many.is_sane());
    }

    #[test]
    fn a_new_window_needs_a_session_and_no_other_window() {
        let without = WindowLink::default();
        assert_eq!(without.want(DisplayVariables::new()), Err(NoNewWindow::NoSession));
        let link = WindowLink::new(Some(Path::new("/s.sculpt")));
        link.set_standing(WindowStanding::Open);
        assert_eq!(link.want(DisplayVariables::new()), Err(NoNewWindow::Open));
        assert_eq!(link.wanted(), None);
        link.set_standing(WindowStanding::Lost);
        let screen: DisplayVariables = [("DISPLAY".into(), ":1".into())].into();
        assert_eq!(link.want(screen.clone()), Ok("/s.sculpt".into()));
        assert_eq!(link.wanted(), Some(screen));
    }
}
