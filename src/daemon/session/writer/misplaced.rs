//! A session file that is moved, replaced or deleted while it is written.

use super::{JournalThread, LOOK};
use crate::session::acknowledgement::ENDED;
use crate::session::place::Standing;

impl JournalThread {
    /// Checks once a second whether the file has moved, follows it if so, and writes the session to
    /// another file if it is gone.
    pub(super) fn watch_place(&mut self) {
        let now = self.clock.now_us();
        if now < self.looked_us + LOOK.as_micros() as u64 || self.misplaced.is_some() {
            return;
        }
        self.looked_us = now;
        let Ok(mut place) = self.place.lock() else { return };
        match place.look() {
            Standing::Here => {}
            Standing::Moved(to) => match place.follow(to.clone()) {
                Ok(()) => tracing::warn!("journal: the session was moved to {}", to.display()),
                Err(e) => {
                    self.misplaced = Some(format!(
                        "the session was moved to {}, and its log could not follow ({e}): keep \
                         the file beside its log until the session ends",
                        to.display()
                    ));
                }
            },
            Standing::Gone => {
                let (path, tick) = (place.path.get(), self.end.tick);
                let path = path.display();
                self.misplaced = Some(match place.rescue(&self.db, self.end.known([0, 0])) {
                    Ok(to) => format!(
                        "{path} was deleted or replaced: what was sculpted up to tick {tick} is \
                         in {}, and the rest is written there when the session ends",
                        to.display()
                    ),
                    Err(e) => format!(
                        "{path} was deleted or replaced, and the session cannot be written \
                         elsewhere ({e}): nothing that is sculpted is kept. Export it"
                    ),
                });
            }
        }
        drop(place);
        if let Some(text) = &self.misplaced {
            tracing::error!("journal: {text}");
            if let Ok(mut fault) = self.health.fault.lock() {
                *fault = Some(text.clone());
            }
        }
    }

    /// Writes the session to where it was rescued once more, with all that came since.
    pub(super) fn rescue_again(&mut self) {
        let Ok(mut place) = self.place.lock() else { return };
        if place.look() != Standing::Gone {
            return;
        }
        let path = place.path.get();
        let text = match place.rescue(&self.db, self.end.known(ENDED)) {
            Ok(to) if self.groups.is_empty() && !self.closed => format!(
                "{} was deleted or replaced: all of the session is in {}",
                path.display(),
                to.display()
            ),
            Ok(to) => format!(
                "{} was deleted or replaced: the session up to tick {} is in {}; later input is \
                 lost",
                path.display(),
                self.end.tick,
                to.display()
            ),
            Err(e) => format!(
                "{} was deleted or replaced, and the session could not be written elsewhere: {e}",
                path.display()
            ),
        };
        if let Ok(mut fault) = self.health.fault.lock() {
            *fault = Some(text);
        }
    }
}
