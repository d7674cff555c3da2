//! Finished works on their way: a place that refuses for a while, restarts in between, and links
//! that expire.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, SystemTime};

use crate::waiting::until;
use sculptd_daemon::kiosk::KioskConfig;
use sculptd_daemon::kiosk::share::{Share, ShareTexts, remove_leftovers};
use sculptd_daemon::kiosk::spool::Spool;
use sculptd_daemon::kiosk::{gallery, spool};
use sculptd_daemon::qr_code::Code;
use sculptd_devices::Clock;
use sculptd_geometry::shapes;

fn waiting(folder: &Path) -> Vec<String> {
    spool::waiting(folder).expect("listed")
}

/// A sender runs beside visitors who finish works as fast as they can.
#[test]
fn a_work_is_sent_once_with_its_picture_whenever_the_sender_looks() {
    let dir = tempfile::tempdir().expect("a folder");
    let (here, there) = (dir.path().join("works"), dir.path().join("store"));
    let spool = Spool::start(&here, &there.display().to_string()).expect("a place");
    for n in 1..=30 {
        gallery::keep(&here, &shapes::uv_sphere(1.0, 4 + n, 8)).expect("kept");
        spool.wake();
    }
    until("all is sent", || waiting(&here).is_empty());
    let page = || std::fs::read(there.join("index.html")).ok();
    let last = std::fs::read(here.join("index.html")).expect("the page");
    until("the last page", || page().as_ref() == Some(&last));
    assert_eq!(spool.stand.sent.load(Relaxed), 30);
    for n in 1..=30 {
        assert!(there.join(format!("work-{n:06}.png")).exists(), "the picture of work {n}");
    }
}

#[test]
fn a_dead_network_loses_nothing_and_the_order_is_kept() {
    let dir = tempfile::tempdir().expect("a folder");
    let (here, there) = (dir.path().join("works"), dir.path().join("store"));
    let place = there.display().to_string();
    let work = |n: u32| shapes::uv_sphere(1.0, 4 + n, 8);
    let keep = |n: u32, spool: Option<&Spool>| {
        gallery::keep(&here, &work(n)).expect("kept");
        if let Some(spool) = spool {
            spool.wake();
        }
    };
    let first = Spool::start(&here, &place).expect("a place");
    keep(1, Some(&first));
    until("the first work arrives", || first.stand.sent.load(Relaxed) == 1);
    // The place is gone: in its stead a file, in which nothing can be put.
    std::fs::rename(&there, dir.path().join("moved")).expect("moved");
    #[allow(clippy::disallowed_methods)] // It stands for a network that is down.
    std::fs::write(&there, b"").expect("written");
    keep(2, Some(&first));
    keep(3, Some(&first));
    until("the place refuses", || first.stand.refused.load(Relaxed) >= 2);
    assert_eq!(waiting(&here), ["work-000002.glb", "work-000003.glb"]);
    // The machine is switched off, and a work is finished before the network is back.
    drop(first);
    keep(4, None);
    std::fs::remove_file(&there).expect("removed");
    std::fs::rename(dir.path().join("moved"), &there).expect("back");
    let second = Spool::start(&here, &place).expect("a place");
    let page = || std::fs::read_to_string(there.join("index.html")).unwrap_or_default();
    until("all is sent", || waiting(&here).is_empty() && page().contains("4 works"));
    drop(second);
    let names: Vec<String> = (1..=4).map(|n| format!("work-{n:06}.glb")).collect();
    assert_eq!(gallery::works(&there).expect("listed"), names);
    let mut before = SystemTime::UNIX_EPOCH;
    for name in &names {
        let (a, b) = (std::fs::read(here.join(name)), std::fs::read(there.join(name)));
        assert!(a.expect("here") == b.expect("there"), "{name} is another one there");
        let at = std::fs::metadata(there.join(name)).and_then(|m| m.modified()).expect("a time");
        assert!(at >= before, "{name} came before the one before it");
        assert!(there.join(name.replace(".glb", ".png")).exists(), "the picture of {name}");
        before = at;
    }
}

#[test]
fn works_kept_while_nothing_is_sent_are_sent_and_no_number_is_given_twice() {
    let dir = tempfile::tempdir().expect("a folder");
    let (here, there) = (dir.path().join("works"), dir.path().join("store"));
    let place = there.display().to_string();
    let work = |n: u32| gallery::keep(&here, &shapes::uv_sphere(1.0, 4 + n, 8)).expect("kept");
    // Kept, and killed before they could be sent.
    work(1);
    work(2);
    let first = Spool::start(&here, &place).expect("a place");
    until("both are sent", || first.stand.sent.load(Relaxed) == 2 && waiting(&here).is_empty());
    drop(first);
    assert_eq!(spool::sent(&here), 2);
    // Sent sculptures are not sent again. Numbers of sculptures that staff removed from the folder
    // are not reused.
    std::fs::remove_file(here.join("work-000001.glb")).expect("removed");
    std::fs::remove_file(here.join("work-000002.glb")).expect("removed");
    assert!(work(3).ends_with("work-000003.glb"));
    let second = Spool::start(&here, &place).expect("a place");
    until("the third is sent", || second.stand.sent.load(Relaxed) == 1 && spool::sent(&here) == 3);
    assert!(waiting(&here).is_empty());
    drop(second);
    assert_eq!(gallery::works(&there).expect("listed").len(), 3);
}

#[test]
fn a_place_that_is_none_is_said_before_visitors_come() {
    let dir = tempfile::tempdir().expect("a folder");
    let said = |place: &str| Spool::start(dir.path(), place).expect_err("refused");
    assert!(said("nonsense://x").contains("nonsense://x"), "the place is named");
    if cfg!(not(feature = "s3")) {
        assert!(said("s3://bucket/works").contains("feature `s3`"));
    }
}

/// The texts of every language.
fn texts(deleted: impl Fn(&Path) -> std::io::Result<()> + Send + Sync + 'static) -> ShareTexts {
    let languages = KioskConfig::default().every_language(sculptd::settings::LANGUAGES);
    ShareTexts { languages: languages.expect("built-in"), deleted: Box::new(deleted) }
}

/// Status and body of a request.
fn get(at: SocketAddr, path: &str, head: &str) -> (u16, Vec<u8>) {
    ask("GET", at, path, head)
}

fn ask(method: &str, at: SocketAddr, path: &str, head: &str) -> (u16, Vec<u8>) {
    let mut stream = TcpStream::connect(at).expect("listens");
    write!(stream, "{method} {path} HTTP/1.1\r\n{head}\r\n\r\n").expect("sent");
    let mut all = Vec::new();
    stream.read_to_end(&mut all).expect("an answer");
    let end = all.windows(4).position(|w| w == b"\r\n\r\n").expect("a head") + 4;
    let status =
        std::str::from_utf8(&all[9..12]).ok().and_then(|s| s.parse().ok()).expect("a status");
    (status, all[end..].to_vec())
}

#[test]
fn a_link_gives_one_work_to_whoever_has_it_until_it_expires() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = gallery::keep(dir.path(), &shapes::uv_sphere(1.0, 6, 8)).expect("kept");
    gallery::keep(dir.path(), &shapes::uv_sphere(1.0, 9, 8)).expect("another");
    let clock = Clock::manual();
    let at = "127.0.0.1:0".parse().expect("an address");
    let minute = Duration::from_secs(60);
    let share = Share::start(at, "", (minute, clock.clone()), texts(|_| Ok(()))).expect("listens");
    let at = share.address();
    let link = share.link(&path).expect("a link");
    let rest = link.url.strip_prefix(&format!("http://{at}")).expect("our address").to_owned();
    assert_eq!(rest.len(), 33, "128 bits: {rest}");
    assert_ne!(share.link(&path).expect("another").url, link.url);
    let host = format!("Host: {at}");
    let (status, page) = get(at, &rest, &host);
    let page = String::from_utf8(page).expect("text");
    assert!(status == 200 && page.contains(&format!("href=\"{rest}/work-000001.glb\"")), "{page}");
    let file = format!("{rest}/work-000001.glb");
    assert_eq!(get(at, &file, &host), (200, std::fs::read(&path).expect("read")));
    // Nothing else, for nobody else.
    for path in ["/", "/index.html", "/00000000000000000000000000000000", "/work-000001.glb"] {
        assert_eq!(get(at, path, &host).0, 404, "{path}");
    }
    for other in ["work-000002.glb", "../work-000002.glb", "index.html", "..", "%2e%2e/index.html"]
    {
        assert_eq!(get(at, &format!("{rest}/{other}"), &host).0, 404, "{other}");
    }
    assert_eq!(get(at, &file, "Host: evil.example").0, 403);
    assert_eq!(get(at, &file, &format!("{host}\r\nOrigin: http://evil.example")).0, 403);
    clock.set_us(59_000_000);
    assert_eq!(get(at, &file, &host).0, 200);
    clock.set_us(61_000_000);
    assert_eq!(get(at, &file, &host).0, 404);
    check_code(&link.code);
}

#[test]
fn a_work_that_cannot_be_deleted_is_not_said_to_be() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = gallery::keep(dir.path(), &shapes::uv_sphere(1.0, 6, 8)).expect("kept");
    let at = "127.0.0.1:0".parse().expect("an address");
    let lasts = (Duration::from_secs(600), Clock::manual());
    let share = Share::start(at, "", lasts, texts(|_| Ok(()))).expect("listens");
    let at = share.address();
    let link = share.link(&path).expect("a link");
    let rest = link.url.strip_prefix(&format!("http://{at}")).expect("our address").to_owned();
    let own = format!("Host: {at}\r\nOrigin: http://{at}");
    let delete = || ask("POST", at, &format!("{rest}/delete"), &own).0;
    // A folder of the picture's name cannot be removed as a file.
    let picture = path.with_extension("png");
    std::fs::remove_file(&picture).expect("removed");
    std::fs::create_dir(&picture).expect("made");
    assert_eq!(delete(), 500);
    std::fs::remove_dir(&picture).expect("removed");
    assert_eq!(delete(), 200, "the link is still good");
    assert!(!path.exists());
    assert_eq!(delete(), 404);
}

#[test]
fn a_visitor_sees_the_work_in_3_d_takes_it_home_and_deletes_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let (here, there) = (dir.path().join("works"), dir.path().join("store"));
    let spool = Spool::start(&here, &there.display().to_string()).expect("a place");
    let ball = shapes::uv_sphere(1.0, 6, 8);
    let (path, other) =
        (gallery::keep(&here, &ball).expect("kept"), gallery::keep(&here, &ball).expect("kept"));
    spool.wake();
    until("both are sent", || spool.stand.sent.load(Relaxed) == 2 && waiting(&here).is_empty());
    let clock = Clock::manual();
    let at = "127.0.0.1:0".parse().expect("an address");
    let lasts = (Duration::from_secs(600), clock.clone());
    let share = Share::start(at, "", lasts, texts(spool.withdrawer(&here))).expect("listens");
    let at = share.address();
    let link = share.link(&path).expect("a link");
    let rest = link.url.strip_prefix(&format!("http://{at}")).expect("our address").to_owned();
    let host = format!("Host: {at}");
    let page = |language: &str| {
        let (status, page) = get(at, &rest, &format!("{host}\r\nAccept-Language: {language}"));
        assert_eq!(status, 200);
        String::from_utf8(page).expect("text")
    };
    // In the visitor's language, or else in the installation's.
    assert!(page("ja,en;q=0.8").contains("作品を削除"));
    assert!(page("pt-BR,de;q=0.7").contains("Mein Werk löschen"));
    let text = page("xx");
    assert!(text.contains("Delete my work") && text.contains("works for 10 min"), "{text}");
    for file in ["work-000001.glb", "work-000001.stl", "share_page.js"] {
        assert!(text.contains(&format!("\"{rest}/{file}\"")), "{file}: {text}");
        assert_eq!(get(at, &format!("{rest}/{file}"), &host).0, 200, "{file}");
        let own = format!("{host}\r\nOrigin: http://{at}");
        assert_eq!(get(at, &format!("{rest}/{file}"), &own).0, 200, "{file}");
    }
    let stl = get(at, &format!("{rest}/work-000001.stl"), &host).1;
    let triangles = ball.triangulate().0.triangles.len();
    assert_eq!(stl.len(), 84 + 50 * triangles);
    // Only our page deletes, and only this work.
    let delete = format!("{rest}/delete");
    for head in [host.clone(), format!("{host}\r\nOrigin: http://evil.example")] {
        assert_eq!(ask("POST", at, &delete, &head).0, 403, "{head}");
    }
    let own = format!("{host}\r\nOrigin: http://{at}");
    assert_eq!(ask("POST", at, &rest, &own).0, 404);
    assert_eq!(ask("POST", at, "/00000000000000000000000000000000/delete", &own).0, 404);
    assert_eq!(get(at, &delete, &host).0, 404);
    assert!(path.exists());
    assert_eq!(ask("POST", at, &delete, &own).0, 200);
    assert!(!path.exists() && !path.with_extension("png").exists() && other.exists());
    assert_eq!(get(at, &rest, &host).0, 404);
    assert!(!share.is_good(&link));
    let listed = std::fs::read_to_string(here.join("index.html")).expect("the page");
    assert!(listed.contains("1 work<") && !listed.contains("work-000001"), "{listed}");
    // Nor where it was sent to.
    until("it is deleted there", || !there.join("work-000001.glb").exists());
    until("its picture too", || !there.join("work-000001.png").exists());
    assert!(there.join("work-000002.glb").exists());
    // The file for the download goes with its link.
    let stls = || {
        let files = std::fs::read_dir(here.join("outgoing")).expect("a folder");
        files
            .filter(|e| e.as_ref().is_ok_and(|e| e.path().extension() == Some("stl".as_ref())))
            .count()
    };
    assert_eq!(stls(), 0);
    share.link(&other).expect("a link");
    assert_eq!(stls(), 1);
    clock.set_us(601_000_000);
    share.drop_expired();
    assert_eq!(stls(), 0);
    // A killed run leaves its files, and the next start removes them.
    share.link(&other).expect("a link");
    std::mem::forget(share);
    assert_eq!(stls(), 1);
    remove_leftovers(&here).expect("removed");
    assert_eq!(stls(), 0);
}

/// Where Node.js, Chromium and the packages of `src/web` are: the page in a real browser, on a
/// telephone and a desk.
#[test]
fn a_browser_shows_turns_and_deletes_the_work() {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/web");
    let runs = |name: &str| {
        let out = std::process::Command::new(name).arg("--version").output();
        out.is_ok_and(|out| out.status.success())
    };
    if !runs("node") || !runs("chromium") || !web.join("node_modules/ws").exists() {
        println!("skipped: no node, chromium or node_modules of src/web");
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let works = dir.path().join("works");
    let path = gallery::keep(&works, &shapes::uv_sphere(1.0, 24, 48)).expect("kept");
    let spool = Spool::start(&works, &dir.path().join("store").display().to_string());
    let spool = spool.expect("a place");
    let lasts = (Duration::from_secs(600), Clock::manual());
    let at = "127.0.0.1:0".parse().expect("an address");
    let share = Share::start(at, "", lasts, texts(spool.withdrawer(&works))).expect("listens");
    let link = share.link(&path).expect("a link");
    let mut test = std::process::Command::new("node");
    test.current_dir(&web).arg("test/work.mjs").arg(&link.url).arg(&path).arg("chromium");
    test.args(std::env::var_os("SCULPTD_SHOTS"));
    assert!(test.status().expect("runs").success());
    assert!(!path.exists() && !share.is_good(&link));
}

/// The three eyes of a QR code, seven squares each, at three corners and not at the fourth.
fn check_code(code: &Code) {
    let dark = |x: usize, y: usize| code.dark[y * code.side + x];
    let eye = |x0: usize, y0: usize| {
        (0..7).all(|y| {
            (0..7).all(|x| {
                let ring = x == 0 || y == 0 || x == 6 || y == 6;
                let middle = (2..5).contains(&x) && (2..5).contains(&y);
                dark(x0 + x, y0 + y) == (ring || middle)
            })
        })
    };
    let far = code.side - 7;
    assert!(eye(0, 0) && eye(far, 0) && eye(0, far) && !eye(far, far));
    // Version n has 17 + 4n squares a side.
    assert!(code.side >= 21 && (code.side - 17) % 4 == 0);
}

#[test]
fn a_name_of_ours_is_answered_to() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = gallery::keep(Path::new(dir.path()), &shapes::uv_sphere(1.0, 6, 8)).expect("kept");
    let at = "127.0.0.1:0".parse().expect("an address");
    let lasts = (Duration::from_secs(60), Clock::manual());
    let share = Share::start(at, "museum.local", lasts, texts(|_| Ok(()))).expect("listens");
    let at = share.address();
    let link = share.link(&path).expect("a link");
    let rest =
        link.url.strip_prefix(&format!("http://museum.local:{}", at.port())).expect("our name");
    assert_eq!(get(at, rest, &format!("Host: museum.local:{}", at.port())).0, 200);
    assert_eq!(get(at, rest, "Host: museum.local:1").0, 403);
}
