//! State exchanged between the keeper of an installation and its screen.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use super::exhibit::Exhibit;
use super::exhibit::score::Score;
use super::exhibit::score_thread::SharedScore;
#[cfg(unix)]
use super::share;
use super::staff::{StaffFacts, StaffRequest};
use super::{Language, ScreenSettings, View};
use crate::qr_code::Invitation;

/// No exhibit was chosen.
const NONE: usize = usize::MAX;

/// State exchanged with the screen.
#[derive(Debug)]
pub struct KioskDesk {
    pub view: Mutex<Option<View>>,
    /// True if something on the screen itself was pressed.
    pub touched: AtomicBool,
    /// The visitor pressed "finished".
    pub finished: AtomicBool,
    /// The visitor goes on to the exhibit's next step.
    pub next_step: AtomicBool,
    /// Index of the exhibit that the next visit begins with, if the visitor chose one.
    chosen: AtomicUsize,
    /// Score of the newest clay, during a visit to an exhibit with a goal.
    pub score: SharedScore,
    /// Result of the last visit to an exhibit with a goal, until the next visit.
    pub result: Mutex<Option<VisitResult>>,
    /// Input typed by staff.
    pub typed: Mutex<Option<String>>,
    /// Requests of the staff page, in order.
    pub requests: Mutex<Vec<StaffRequest>>,
    /// Requests of staff on another computer, in order.
    pub fleet_requests: Mutex<Vec<StaffRequest>>,
    /// Content of the staff page.
    pub staff: Mutex<StaffFacts>,
    /// Set before the end of the run if a new one is to follow it.
    pub again: AtomicBool,
    /// Set before the end of the run if the screen is gone: the visit goes on at the next start.
    pub screen_gone: AtomicBool,
    /// Message from the fleet's staff to those on site, until dismissed.
    pub message: Mutex<Option<String>>,
    /// The work of the visit that has ended is in the gallery.
    pub kept: AtomicBool,
    /// The visitor is asked for consent to share the work.
    pub asks_consent: AtomicBool,
    /// The visitor gave it.
    pub consents: AtomicBool,
    /// Link to the visitor's sculpture, until the farewell ends.
    #[cfg(unix)]
    pub link: Mutex<Option<share::Link>>,
}

impl Default for KioskDesk {
    fn default() -> Self {
        KioskDesk {
            view: Mutex::default(),
            touched: AtomicBool::default(),
            finished: AtomicBool::default(),
            next_step: AtomicBool::default(),
            chosen: AtomicUsize::new(NONE),
            score: SharedScore::default(),
            result: Mutex::default(),
            typed: Mutex::default(),
            requests: Mutex::default(),
            fleet_requests: Mutex::default(),
            staff: Mutex::default(),
            again: AtomicBool::default(),
            screen_gone: AtomicBool::default(),
            message: Mutex::default(),
            kept: AtomicBool::default(),
            asks_consent: AtomicBool::default(),
            consents: AtomicBool::default(),
            #[cfg(unix)]
            link: Mutex::default(),
        }
    }
}

impl KioskDesk {
    /// A visitor begins with this exhibit.
    pub fn choose(&self, exhibit: usize) {
        self.chosen.store(exhibit, Relaxed);
        self.touched.store(true, Relaxed);
    }

    /// Returns the exhibit that was chosen, once.
    pub(super) fn take_choice(&self) -> Option<usize> {
        Some(self.chosen.swap(NONE, Relaxed)).filter(|&exhibit| exhibit != NONE)
    }

    /// Adds a request of staff on another computer, which needs no open page.
    pub fn ask_from_fleet(&self, request: StaffRequest) {
        if let Ok(mut requests) = self.fleet_requests.lock() {
            requests.push(request);
        }
    }

    /// Returns the requests of staff, once. Those of the page count only while it is open.
    pub(super) fn take_requests(&self, page_is_open: bool) -> Vec<StaffRequest> {
        let take = |list: &Mutex<Vec<StaffRequest>>| {
            list.lock().map(|mut all| std::mem::take(&mut *all)).unwrap_or_default()
        };
        let mut all = take(&self.requests);
        if !page_is_open {
            all.clear();
        }
        all.extend(take(&self.fleet_requests));
        all
    }

    /// Adds a request of the staff page.
    pub fn ask(&self, request: StaffRequest) {
        if let Ok(mut requests) = self.requests.lock() {
            requests.push(request);
        }
    }
}

/// Result of a visit to an exhibit with a goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisitResult {
    /// Index of the exhibit.
    pub exhibit: usize,
    /// The work that was put away, against the goal of the visit's last step.
    pub score: Score,
}

/// Content of an installation's window.
#[derive(Debug, Clone)]
pub struct Screen {
    pub desk: Arc<KioskDesk>,
    /// Never empty; the first is shown to each new visitor.
    pub words: Vec<Language>,
    /// True if staff can exit with a PIN.
    pub staff: bool,
    /// Display settings of the screen.
    pub show: ScreenSettings,
    /// The page on which visitors watch.
    pub watch: Option<Invitation>,
    /// Exhibits to choose from; empty: free sculpting.
    pub exhibits: Vec<Arc<Exhibit>>,
    /// Minutes for which a link to a work is good.
    pub share_minutes: f64,
}
