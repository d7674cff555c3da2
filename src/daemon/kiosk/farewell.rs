//! The farewell: a visitor whose work is kept is asked for consent, and then gets a link to it.

use std::path::PathBuf;
use std::sync::atomic::Ordering::Relaxed;
#[cfg(unix)]
use std::time::Duration;

use super::desk::KioskDesk;
#[cfg(unix)]
use super::share;
use super::spool::Spool;
use super::{KioskConfig, Language};
use sculptd_devices::Clock;

/// The work of the visitor who leaves.
#[derive(Debug, Default)]
pub(super) struct Farewell {
    #[cfg(unix)]
    share: Option<share::Share>,
    work: Option<PathBuf>,
}

impl Farewell {
    /// Listens for visitors' telephones if the settings share works. A deleted work is deleted
    /// where `spool` sent it too.
    ///
    /// # Errors
    /// Names the address and the reason.
    #[cfg(unix)]
    pub fn start(
        config: &KioskConfig,
        languages: &[Language],
        spool: Option<&Spool>,
        clock: &Clock,
    ) -> Result<Farewell, String> {
        if config.share.is_empty() {
            return Ok(Farewell::default());
        }
        // Visitors' telephones are in the network: a port alone is one of all addresses.
        let port = config.share.trim().trim_start_matches(':').parse::<u16>();
        let at = match port {
            Ok(port) => std::net::SocketAddr::from(([0, 0, 0, 0], port)),
            Err(_) => crate::metrics::address(&config.share).map_err(|e| format!("share: {e}"))?,
        };
        share::remove_leftovers(&config.gallery)
            .map_err(|e| format!("{}: {e}", config.gallery.display()))?;
        let deleted: share::Deleted = match spool {
            None => Box::new(|_| Ok(())),
            Some(spool) => Box::new(spool.withdrawer(&config.gallery)),
        };
        let lasts = Duration::from_secs_f64(config.share_minutes * 60.0);
        let texts = share::ShareTexts { languages: languages.to_vec(), deleted };
        let share = share::Share::start(at, &config.share_name, (lasts, clock.clone()), texts);
        let share = share.map_err(|e| format!("share {at}: {e}"))?;
        Ok(Farewell { share: Some(share), work: None })
    }

    /// Nothing is shared on this system.
    ///
    /// # Errors
    /// None.
    #[cfg(not(unix))]
    pub fn start(
        _: &KioskConfig,
        _: &[Language],
        _: Option<&Spool>,
        _: &Clock,
    ) -> Result<Farewell, String> {
        Ok(Farewell::default())
    }

    /// Asks the visitor for consent to share this work.
    pub fn ask(&mut self, work: PathBuf, desk: &KioskDesk) {
        self.work = Some(work);
        desk.asks_consent.store(true, Relaxed);
    }

    /// Shares the work once the visitor consents.
    ///
    /// # Errors
    /// Names the work and the reason.
    pub fn share(&mut self, desk: &KioskDesk) -> Result<(), String> {
        if !desk.consents.swap(false, Relaxed) {
            return Ok(());
        }
        desk.asks_consent.store(false, Relaxed);
        #[cfg(unix)]
        if let Some((share, work)) = self.share.as_ref().zip(self.work.take()) {
            let link = share.link(&work).map_err(|e| format!("{}: {e}", work.display()))?;
            if let Ok(mut shown) = desk.link.lock() {
                *shown = Some(link);
            }
        }
        Ok(())
    }

    /// Forgets links that are not good any more; their code is not shown.
    pub fn drop_expired(&self, desk: &KioskDesk) {
        #[cfg(unix)]
        if let Some(share) = &self.share {
            share.drop_expired();
            if let Ok(mut shown) = desk.link.lock() {
                *shown = shown.take().filter(|link| share.is_good(link));
            }
        }
        #[cfg(not(unix))]
        let _ = desk; // It has no link.
    }

    /// Shows the next visitor nothing of this one.
    pub fn clear(&mut self, desk: &KioskDesk) {
        self.work = None;
        desk.asks_consent.store(false, Relaxed);
        desk.consents.store(false, Relaxed);
        #[cfg(unix)]
        if let Ok(mut shown) = desk.link.lock() {
            *shown = None;
        }
    }
}
