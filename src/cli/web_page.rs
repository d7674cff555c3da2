//! The page by which browsers join, and the option that serves it.

use std::net::SocketAddr;

use sculptd_daemon::kiosk::KioskConfig;
use sculptd_daemon::web::{PageFile, WebOptions};

/// Port that is served if none is named.
const PORT: &str = "8710";

macro_rules! files {
    ($($name:literal: $kind:literal),* $(,)?) => {
        &[$(PageFile {
            path: concat!("/", $name),
            kind: $kind,
            bytes: include_bytes!(concat!("../web/dist/", $name)),
        }),*]
    };
}

/// The page as `src/web` builds it.
const FILES: &[PageFile] = files! {
    "index.html": "text/html; charset=utf-8",
    "app.js": "text/javascript; charset=utf-8",
    "style.css": "text/css; charset=utf-8",
    "manifest.webmanifest": "application/manifest+json",
    "icon.svg": "image/svg+xml",
};

#[derive(Debug, Clone, Default, clap::Args)]
pub struct WebArgs {
    /// Serve a page by which browsers join: they see the sculpture, and their pens sculpt it. A
    /// port alone means the loopback; 0.0.0.0:8710 lets the whole network join, with the links that
    /// are printed.
    #[arg(
        long,
        value_name = "PORT|ADDRESS:PORT",
        value_parser = sculptd_daemon::metrics::address,
        num_args = 0..=1,
        default_missing_value = PORT
    )]
    pub web: Option<SocketAddr>,
    /// Name or address by which others reach this machine, for the links.
    #[arg(long, value_name = "NAME", requires = "web", default_value = "")]
    pub web_name: String,
}

impl WebArgs {
    /// Returns the options of the page, if it is wanted: by these arguments, or by the settings of
    /// an installation.
    pub fn options(&self, kiosk: Option<&KioskConfig>) -> Result<Option<WebOptions>, String> {
        let settings = kiosk.map_or(Ok(None), KioskConfig::web_address)?;
        let Some(at) = self.web.or(settings) else { return Ok(None) };
        let name = match (self.web, kiosk) {
            (None, Some(kiosk)) => kiosk.web_name.clone(),
            _ => self.web_name.clone(),
        };
        let own_views = kiosk.is_none();
        Ok(Some(WebOptions { at, name, files: FILES, lasts: None, own_views }))
    }
}
