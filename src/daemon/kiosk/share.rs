//! A visitor's sculpture on the local network, for a while: a link that nobody can guess, and its
//! QR code for the screen.
//!
//! The link leads to a page that shows the work in 3-D, offers it as GLB and STL, and deletes it on
//! request. Only this work is served, to whoever has the link, until it expires; there is no list.
//! `Host` must be an address of ours or the name in the settings. The files are also served to our
//! own page, and to no other.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use hyper::header::ACCEPT_LANGUAGE;
use hyper::{Method, Request, StatusCode};

use super::Language;
use super::gallery;
use super::names::OUTGOING;
use crate::http::answer::{permitted, permitted_post, permitted_to_page};
use crate::http::{Answer, HttpServer, Refusal};
use crate::qr_code::Code;
use crate::random_token::random_token;
use crate::web::own_address;
use sculptd_devices::Clock;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;

/// Links that are good at a time; the oldest goes first.
const LINKS: usize = 1024;
/// Sources that the page may load.
const PAGE_LOADS: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'self'; connect-src 'self'";
/// Shows the work, and deletes it.
const SCRIPT: &str = include_str!("share_page.js");
/// Its name behind each link.
const SCRIPT_NAME: &str = "share_page.js";
const STYLE: &str = "body{margin:0;background:#1d1f21;color:#eceae4;font:1.2em system-ui,\
                     sans-serif}main{padding:1em}canvas{display:block;width:100%;height:70vh;\
                     touch-action:none}a,button{display:inline-block;margin:.3em .5em .3em 0;\
                     padding:.7em 1.4em;border:0;border-radius:.5em;background:#3a3d42;\
                     color:inherit;font:inherit;text-decoration:none}";

/// A link, for the screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    pub url: String,
    pub code: Code,
    /// On the clock, when it expires.
    pub until_us: u64,
}

/// The works that are shared, by the token of their link.
type SharedWorks = Mutex<BTreeMap<String, SharedWork>>;

#[derive(Debug, Clone)]
struct SharedWork {
    file: PathBuf,
    /// The same as STL, as long as the link is good.
    stl: PathBuf,
    until_us: u64,
}

impl SharedWork {
    fn delete_stl(&self) -> std::io::Result<()> {
        match std::fs::remove_file(&self.stl) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(e),
            _ => Ok(()),
        }
    }

    fn remove_stl(&self) {
        if let Err(e) = self.delete_stl() {
            tracing::warn!("share: {}: {e}", self.stl.display());
        }
    }
}

/// Has a work deleted in other places too; called before it is deleted here.
pub type Deleted = Box<dyn Fn(&Path) -> std::io::Result<()> + Send + Sync>;

/// Texts of a share's pages.
pub struct ShareTexts {
    /// The page speaks the first of these that the visitor's browser asks for. Never empty.
    pub languages: Vec<Language>,
    pub deleted: Deleted,
}

impl std::fmt::Debug for ShareTexts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ShareTexts").field("languages", &self.languages.len()).finish()
    }
}

/// The listener; closed when dropped.
#[derive(Debug)]
pub struct Share {
    server: HttpServer,
    name: String,
    lasts: Duration,
    links: Arc<SharedWorks>,
    clock: Clock,
}

impl Share {
    /// Listens. `name`: the address that visitors' telephones reach this machine by; empty: the one
    /// that is listened on.
    pub fn start(
        at: SocketAddr,
        name: &str,
        (lasts, clock): (Duration, Clock),
        texts: ShareTexts,
    ) -> std::io::Result<Share> {
        let links: Arc<SharedWorks> = Arc::default();
        let (known, good, time) = (name.to_owned(), links.clone(), clock.clone());
        let server = HttpServer::start(at, "sculptd-share", |at, _| {
            // Without a name the address that is listened on is the only one.
            let known = if known.is_empty() { at.ip().to_string() } else { known };
            move |request: &Request<()>| {
                let now_us = time.now_us();
                answer(request, (at, &known), (&good, now_us), &texts).unwrap_or_else(Answer::from)
            }
        })?;
        Ok(Share { server, name: name.to_owned(), lasts, links, clock })
    }

    /// Returns the address of the listening socket.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Returns a link to a work of a gallery, valid from now on.
    pub fn link(&self, file: &Path) -> std::io::Result<Link> {
        let token = random_token()?;
        let stl = file.with_file_name(OUTGOING).join(format!("{token}.stl"));
        std::fs::create_dir_all(file.with_file_name(OUTGOING))?;
        // Without it the page still offers the file of the gallery.
        let mesh = read_mesh(file, &Job::default()).map_err(std::io::Error::other);
        let written = mesh.and_then(|m| write_mesh(&stl, &m.mesh).map_err(std::io::Error::other));
        if let Err(e) = written {
            tracing::error!("share: {}: no STL file of it: {e}", file.display());
        }
        let ip = match self.server.address().ip() {
            // It listens everywhere: visitors come by the address that this machine has now.
            all if all.is_unspecified() => own_address(),
            ip => Some(ip),
        };
        let known = if self.name.is_empty() { None } else { Some(self.name.clone()) };
        let name = known.or(ip.map(|ip| ip.to_string())).ok_or_else(|| {
            std::io::Error::other("this machine has no way into a network; set share_name")
        })?;
        let host = match name.parse::<IpAddr>() {
            Ok(IpAddr::V6(ip)) => format!("[{ip}]"),
            _ => name,
        };
        let url = format!("http://{host}:{}/{token}", self.server.address().port());
        let code = Code::of(&url)
            .ok_or_else(|| std::io::Error::other("the link is too long for a code"))?;
        let until_us = self.clock.now_us() + self.lasts.as_micros() as u64;
        self.drop_expired();
        if let Ok(mut links) = self.links.lock() {
            while links.len() >= LINKS {
                let Some(oldest) = links.iter().min_by_key(|l| l.1.until_us).map(|l| l.0.clone())
                else {
                    break;
                };
                if let Some(work) = links.remove(&oldest) {
                    work.remove_stl();
                }
            }
            links.insert(token, SharedWork { file: file.to_path_buf(), stl, until_us });
        }
        Ok(Link { url, code, until_us })
    }

    /// Returns true until the link expires or its work is deleted.
    pub fn is_good(&self, link: &Link) -> bool {
        let token = link.url.rsplit('/').next().unwrap_or_default();
        let known = self.links.lock().is_ok_and(|links| links.contains_key(token));
        known && link.until_us > self.clock.now_us()
    }

    /// Forgets the links that are not good any more.
    pub fn drop_expired(&self) {
        let now = self.clock.now_us();
        if let Ok(mut links) = self.links.lock() {
            links.retain(|_, work| {
                let good = work.until_us > now;
                if !good {
                    work.remove_stl();
                }
                good
            });
        }
    }
}

/// Removes the STL files that an earlier run left in a gallery.
///
/// # Errors
/// Returns the system's error.
pub fn remove_leftovers(gallery: &Path) -> std::io::Result<()> {
    let entries = match std::fs::read_dir(gallery.join(OUTGOING)) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        entries => entries?,
    };
    let paths = entries.filter_map(Result::ok).map(|entry| entry.path());
    let mut stls = paths.filter(|path| path.extension().is_some_and(|e| e == "stl"));
    stls.try_for_each(std::fs::remove_file)
}

impl Drop for Share {
    fn drop(&mut self) {
        if let Ok(links) = self.links.lock() {
            links.values().for_each(SharedWork::remove_stl);
        }
    }
}

/// Answers a request: `/TOKEN` returns a page, `/TOKEN/work-000001.glb` and `.stl` the sculpture,
/// a POST to `/TOKEN/delete` deletes it.
fn answer(
    request: &Request<()>,
    (at, name): (SocketAddr, &str),
    (links, now_us): (&SharedWorks, u64),
    texts: &ShareTexts,
) -> Result<Answer, Refusal> {
    const GONE: Refusal = (StatusCode::NOT_FOUND, "this does not exist, or no longer");
    const KEPT: Refusal = (
        StatusCode::INTERNAL_SERVER_ERROR,
        "the work was not deleted; try again, or ask the staff",
    );
    let path = match *request.method() {
        Method::POST => permitted_post(request, at, name)?,
        _ => permitted_to_page(request, at, name)?,
    };
    let mut parts = path.trim_start_matches('/').splitn(2, '/');
    let token = parts.next().unwrap_or("");
    let good = links.lock().ok().and_then(|l| l.get(token).cloned());
    let good = good.filter(|g| g.until_us > now_us).ok_or(GONE)?;
    let file = good.file.file_name().and_then(|n| n.to_str()).ok_or(GONE)?;
    let stem = file.trim_end_matches(".glb");
    let asked = parts.next().unwrap_or("");
    if *request.method() == Method::POST {
        return match asked {
            "delete" => {
                delete(&good.file, links, texts).map_err(|e| {
                    tracing::error!("share: {}: not deleted: {e}", good.file.display());
                    KEPT
                })?;
                Ok(Answer::text("text/plain; charset=utf-8", "deleted\n".into()))
            }
            _ => Err(GONE),
        };
    }
    // Only the one work that the link was made for, whatever is asked for.
    if asked.is_empty() {
        permitted(request, at, name)?;
        let words = language_of(request, &texts.languages).ok_or(GONE)?;
        let minutes = (good.until_us - now_us).div_ceil(60_000_000);
        Ok(Answer::page(page((token, stem), words, minutes), PAGE_LOADS))
    } else if asked == SCRIPT_NAME {
        Ok(Answer::of_program("text/javascript; charset=utf-8", SCRIPT.as_bytes(), PAGE_LOADS))
    } else if asked == file {
        Answer::file("model/gltf-binary", &good.file).map_err(|_| GONE)
    } else if asked.strip_suffix(".stl") == Some(stem) {
        Answer::file("model/stl", &good.stl).map_err(|_| GONE)
    } else {
        Err(GONE)
    }
}

/// Deletes a work, its copy as STL, and then every link to it. After an error the links are still
/// good, so that the visitor can try again.
fn delete(file: &Path, links: &SharedWorks, texts: &ShareTexts) -> std::io::Result<()> {
    (texts.deleted)(file)?;
    gallery::remove(file)?;
    let mut links = links.lock().map_err(|_| std::io::Error::other("a thread ended by a bug"))?;
    for work in links.values().filter(|work| work.file == file) {
        work.delete_stl()?;
    }
    links.retain(|_, work| work.file != file);
    tracing::info!("share: a visitor deleted {}", file.display());
    Ok(())
}

/// Returns the language that a browser prefers among ours, or our first one.
fn language_of<'a>(request: &Request<()>, all: &'a [Language]) -> Option<&'a Language> {
    let wanted = request.headers().get(ACCEPT_LANGUAGE).and_then(|value| value.to_str().ok());
    // A browser lists them in the order of its preference.
    let codes = wanted.unwrap_or("").split(',').filter_map(|one| one.trim().get(..2));
    let known = codes.filter_map(|code| all.iter().find(|words| words.code == code));
    known.chain(all.first()).next()
}

/// The page of a work. The token and the name are digits and fixed letters; the texts come from
/// files, which may have any letter.
fn page((token, stem): (&str, &str), words: &Language, minutes: u64) -> String {
    let expires = escaped(&words.expires.replace("{minutes}", &minutes.to_string()));
    let [code, kept, delete, sure, done] =
        [&words.code, &words.kept, &words.delete, &words.delete_sure, &words.deleted]
            .map(|text| escaped(text));
    format!(
        "<!doctype html><html lang=\"{code}\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>sculptd</title><style>{STYLE}</style>\
         <canvas data-work=\"/{token}/{stem}.stl\"></canvas><main><p>{kept}</p>\
         <p><a href=\"/{token}/{stem}.glb\" download>GLB</a>\
         <a href=\"/{token}/{stem}.stl\" download>STL</a>\
         <button data-at=\"/{token}/delete\" data-sure=\"{sure}\" data-done=\"{done}\">{delete}\
         </button></p><p>{expires}</p></main><script src=\"/{token}/{SCRIPT_NAME}\"></script>"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
