//! Finds what prevents sculpting on this machine, and reports how to fix it.
//!
//! Every check reports the subject, the finding and, if something is wrong, the exact repair. A
//! check makes no lasting change.

mod camera;
#[cfg(target_os = "linux")]
mod kernel_drivers;
#[cfg(target_os = "linux")]
mod tablets;

use std::net::{TcpStream, ToSocketAddrs};
use std::path::{Path, PathBuf};
use std::time::Duration;

use glam::Vec2;
use serde::Serialize;

use super::priority::raise_priority;
use crate::config::{Config, LoopConfig};
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// Free space that an evening's session needs, bytes: a pen at 250 Hz writes 55 MB an hour, a start
/// mesh 100 MB at most.
pub const ROOM: u64 = 1 << 30;
/// With less than this the journal stops within minutes.
pub const ROOM_LEAST: u64 = 64 << 20;
/// Vertices of the ball that the rate is measured on.
const PROBE_VERTICES: usize = 20_000;
/// Duration of the rate measurement, in microseconds.
const PROBE_US: u64 = 500_000;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    Pass,
    /// Works, but not as well as it could.
    Warn,
    Fail,
    /// Not looked at, for the reason given.
    Skip,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    pub name: &'static str,
    pub verdict: Verdict,
    /// The finding, and its consequence if it is bad.
    pub cause: String,
    /// The line to type or to write; absent if nothing needs to be done.
    pub repair: Option<String>,
}

impl Check {
    pub fn pass(name: &'static str, cause: impl Into<String>) -> Self {
        Check { name, verdict: Verdict::Pass, cause: cause.into(), repair: None }
    }

    pub fn skip(name: &'static str, cause: impl Into<String>) -> Self {
        Check { name, verdict: Verdict::Skip, cause: cause.into(), repair: None }
    }

    pub fn warn(name: &'static str, cause: impl Into<String>, repair: impl Into<String>) -> Self {
        Check { name, verdict: Verdict::Warn, cause: cause.into(), repair: Some(repair.into()) }
    }

    pub fn fail(name: &'static str, cause: impl Into<String>, repair: impl Into<String>) -> Self {
        Check { name, verdict: Verdict::Fail, cause: cause.into(), repair: Some(repair.into()) }
    }
}

/// The paths to inspect; a test passes different ones.
#[derive(Debug, Clone)]
pub struct Places {
    /// Folder of the `hidraw*` nodes.
    pub dev: PathBuf,
    /// Folder of the sessions.
    pub state: PathBuf,
    /// The control socket.
    pub socket: PathBuf,
}

/// All checks that need a valid configuration, in the order in which a person would repair.
pub fn all(config: &Config, places: &Places) -> Vec<Check> {
    let mut checks = vec![pen_tablets(config, &places.dev)];
    #[cfg(target_os = "linux")]
    if config.devices.hid
        && let Ok(catalogue) = crate::adaptors::tablets(&config.devices)
    {
        let class = Path::new("/sys/class/hidraw");
        checks.push(kernel_drivers::check(class, &catalogue));
    }
    checks.extend(config.devices.serial.iter().map(|p| serial(p)));
    checks.push(tracker(&config.devices.leap));
    checks.push(camera::check(&config.devices));
    #[cfg(unix)]
    checks.push(socket(&places.socket));
    checks.push(folder(&places.state));
    #[cfg(unix)]
    checks.push(room(&places.state, config.undo.history_bytes));
    checks.push(scheduling());
    checks.push(rate(&config.r#loop));
    checks
}

/// Checks that every tablet opens for reading on its separate node.
fn pen_tablets(config: &Config, dev: &Path) -> Check {
    const NAME: &str = "pen tablets";
    if !config.devices.hid {
        return Check::skip(NAME, "devices.hid is off");
    }
    #[cfg(target_os = "linux")]
    return match crate::adaptors::tablets(&config.devices) {
        Ok(catalogue) => tablets::check(dev, Path::new("/sys/class/hidraw"), &catalogue),
        Err(e) => Check::fail(NAME, e.to_string(), "mend the tablet file named"),
    };
    #[cfg(not(target_os = "linux"))]
    Check::skip(NAME, format!("there is no {} on this system", dev.join("hidraw*").display()))
}

/// The group that may use a serial port: the one that the port has, as Debian's `dialout` and
/// Arch's `uucp`.
fn serial_group(port: &Path, groups: &str) -> String {
    #[cfg(unix)]
    let gid = std::os::unix::fs::MetadataExt::gid;
    let named = |wanted: &dyn Fn(&str, &str) -> bool| {
        groups.lines().find_map(|line| {
            let mut parts = line.split(':');
            let (name, id) = (parts.next()?, parts.nth(1)?);
            wanted(name, id).then(|| name.to_owned())
        })
    };
    #[cfg(unix)]
    if let Some(of_port) = std::fs::metadata(port).ok().map(|m| gid(&m)).filter(|id| *id != 0)
        && let Some(name) = named(&|_, id| id.parse() == Ok(of_port))
    {
        return name;
    }
    named(&|name, _| matches!(name, "dialout" | "uucp")).unwrap_or_else(|| "dialout".to_owned())
}

fn serial(port: &Path) -> Check {
    const NAME: &str = "serial pen";
    let shown = port.display();
    match std::fs::OpenOptions::new().read(true).write(true).custom(port) {
        Ok(()) => Check::pass(NAME, format!("{shown} can be opened")),
        Err(e) if e.kind() == std::io::ErrorKind::PermissionDenied => Check::fail(
            NAME,
            format!("{shown}: {e}"),
            format!(
                "sudo usermod -aG {} \"$(id -un)\"   # then log in again",
                serial_group(port, &std::fs::read_to_string("/etc/group").unwrap_or_default())
            ),
        ),
        Err(e) => Check::fail(
            NAME,
            format!("{shown}: {e}"),
            format!("plug the pen in, or take \"{shown}\" out of devices.serial"),
        ),
    }
}

/// Opening without waiting for a carrier, which a plain serial line never gives.
trait OpenPort {
    fn custom(&mut self, port: &Path) -> std::io::Result<()>;
}

impl OpenPort for std::fs::OpenOptions {
    fn custom(&mut self, port: &Path) -> std::io::Result<()> {
        #[cfg(unix)]
        {
            use std::os::unix::fs::OpenOptionsExt;
            let flags = rustix::fs::OFlags::NONBLOCK | rustix::fs::OFlags::NOCTTY;
            self.custom_flags(flags.bits() as i32);
        }
        self.open(port).map(drop)
    }
}

/// Checks that something listens at the tracker's address.
fn tracker(url: &str) -> Check {
    const NAME: &str = "hand tracking";
    if url.is_empty() {
        return Check::skip(NAME, "devices.leap is empty: no tracker is configured");
    }
    let repair = "start the tracker's service, or set devices.leap = \"\"";
    let Some(host) =
        url.strip_prefix("ws://").and_then(|r| r.split('/').next()).filter(|h| !h.is_empty())
    else {
        return Check::fail(
            NAME,
            format!("devices.leap = \"{url}\": expected ws://HOST:PORT/PATH"),
            "set devices.leap = \"ws://127.0.0.1:6437/v6.json\"",
        );
    };
    let port_given = host.rsplit_once(':').is_some_and(|(_, p)| p.parse::<u16>().is_ok());
    let full = if port_given { host.to_owned() } else { format!("{host}:80") };
    let found = full.to_socket_addrs().map(|mut a| a.next());
    match found {
        Ok(Some(at)) => match TcpStream::connect_timeout(&at, Duration::from_secs(1)) {
            Ok(_) => Check::pass(NAME, format!("{full} answers")),
            Err(e) => Check::fail(NAME, format!("{full}: {e}"), repair),
        },
        Ok(None) => Check::fail(NAME, format!("{full}: the name has no address"), repair),
        Err(e) => Check::fail(NAME, format!("{full}: {e}"), repair),
    }
}

/// The socket's folder is ours alone, and either nobody or one daemon listens there.
#[cfg(unix)]
fn socket(path: &Path) -> Check {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    const NAME: &str = "control socket";
    let dir = path.parent().unwrap_or(Path::new("/"));
    let user = super::control::user_id();
    match std::fs::metadata(dir) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            match dir.parent().filter(|p| p.is_dir()) {
                Some(_) => Check::pass(NAME, format!("{} will be made", dir.display())),
                None => Check::fail(
                    NAME,
                    format!("{}: {e}", dir.display()),
                    format!(
                        "mkdir -p -m 700 '{d}' or export XDG_RUNTIME_DIR=/run/user/{user}",
                        d = dir.display()
                    ),
                ),
            }
        }
        Err(e) => Check::fail(
            NAME,
            format!("{}: {e}", dir.display()),
            "export XDG_RUNTIME_DIR=/run/user/$(id -u)",
        ),
        Ok(m) if !m.is_dir() => Check::fail(
            NAME,
            format!("{} is not a folder", dir.display()),
            "export XDG_RUNTIME_DIR=/run/user/$(id -u)",
        ),
        Ok(m) if m.uid() != user => Check::fail(
            NAME,
            format!("{} belongs to user {}", dir.display(), m.uid()),
            format!("export XDG_RUNTIME_DIR=/run/user/{user}"),
        ),
        Ok(m) if m.permissions().mode() & 0o022 != 0 => Check::warn(
            NAME,
            format!(
                "{} can be written by others (mode {:o})",
                dir.display(),
                m.permissions().mode() & 0o777
            ),
            format!("chmod 700 '{}'", dir.display()),
        ),
        Ok(_) if std::os::unix::net::UnixStream::connect(path).is_ok() => {
            Check::pass(NAME, format!("a daemon listens on {}", path.display()))
        }
        Ok(_) => Check::pass(NAME, format!("{} is free", path.display())),
    }
}

/// The nearest folder at or above `path` that exists.
fn standing(path: &Path) -> &Path {
    path.ancestors().find(|p| p.exists()).unwrap_or(Path::new("/"))
}

fn folder(state: &Path) -> Check {
    const NAME: &str = "session folder";
    let at = standing(state);
    let probe = at.join(format!(".sculptd-doctor-{}", std::process::id()));
    let tried = std::fs::OpenOptions::new().write(true).create_new(true).open(&probe);
    let _ = std::fs::remove_file(&probe);
    match tried {
        Ok(_) => Check::pass(NAME, format!("{} can be written", at.display())),
        Err(e) => Check::fail(
            NAME,
            format!("{}: {e}", at.display()),
            format!("mkdir -p '{s}' && chmod u+rwx '{s}'", s = state.display()),
        ),
    }
}

#[cfg(unix)]
fn room(state: &Path, history: u64) -> Check {
    const NAME: &str = "free space";
    let at = standing(state);
    let free = match rustix::fs::statvfs(at) {
        Ok(v) => v.f_bavail.saturating_mul(v.f_frsize),
        Err(e) => return Check::skip(NAME, format!("{}: {e}", at.display())),
    };
    let most = history >> 20;
    let cause = format!(
        "{} MiB free for {}; a session's history takes {most} MiB at most (undo.history_bytes)",
        free >> 20,
        state.display()
    );
    let repair =
        format!("sculptd session prune '{}'   # shows what would go; add --yes", state.display());
    match free {
        f if f < ROOM_LEAST => Check::fail(NAME, cause, repair),
        f if f < ROOM => Check::warn(NAME, cause, repair),
        f if f < history => {
            let repair = format!(
                "set undo.history_bytes = {}, or make room: {repair}",
                (f / 2).max(1 << 20)
            );
            Check::warn(NAME, cause, repair)
        }
        _ => Check::pass(NAME, cause),
    }
}

fn scheduling() -> Check {
    const NAME: &str = "scheduling";
    // In a separate thread, so that this thread's scheduling stays unchanged.
    let got = std::thread::spawn(raise_priority).join().unwrap_or("normal");
    if got.starts_with("real-time") {
        return Check::pass(NAME, got);
    }
    Check::warn(
        NAME,
        format!("{got}: without real-time scheduling a busy machine delays ticks"),
        "echo \"$USER - rtprio 20\" | sudo tee /etc/security/limits.d/70-sculptd.conf   # then log \
            in again",
    )
}

/// Draws on a small ball for half a second and compares a tick's time with what the rate allows.
fn rate(config: &LoopConfig) -> Check {
    const NAME: &str = "tick rate";
    let allowed_ms = 1e3 / f64::from(config.rate_hz.max(1));
    let Some(mut ticks_ms) = probe(config) else {
        return Check::skip(NAME, "the ball could not be made");
    };
    ticks_ms.sort_unstable_by(f64::total_cmp);
    let late = ticks_ms[ticks_ms.len() * 99 / 100];
    let holds = (1e3 / late.max(1e-3)).min(1e5);
    let cause = format!(
        "99 of 100 ticks take {late:.2} ms or less (a stroke on {PROBE_VERTICES} vertices): \
            {holds:.0} Hz; {} Hz allow {allowed_ms:.2} ms",
        config.rate_hz
    );
    let slower = [60, 30].into_iter().find(|r| f64::from(*r) < holds * 0.7).unwrap_or(30);
    let repair = format!("set loop.rate_hz = {slower}, or close what else runs");
    match late / allowed_ms {
        share if share > 1.0 => Check::fail(NAME, cause, repair),
        share if share > 0.5 => Check::warn(NAME, cause, repair),
        _ => Check::pass(NAME, cause),
    }
}

/// Milliseconds of each tick of a stroke round the middle of the view; at least 30.
fn probe(config: &LoopConfig) -> Option<Vec<f64>> {
    let mesh = Clay::build(&shapes::sphere_of_about(PROBE_VERTICES), &Job::default()).ok()?;
    let settings = Config::default();
    let options =
        WorldOptions { dab_budget: config.dab_budget, undo_bytes: 64 << 20, hands: settings.hand };
    let workers = Workers::new(config.worker_count());
    let mut world = World::new(mesh, settings.camera.camera(), settings.brush, workers, options);
    let (clock, area) = (Clock::monotonic(), Vec2::new(160.0, 100.0));
    let begun = clock.now_us();
    let mut took = Vec::with_capacity(1 << 14);
    for tick in 1..100_000_u64 {
        let angle = tick as f32 * 0.05;
        let pen = Pen {
            in_range: true,
            tip: true,
            pos_mm: area * 0.5 + Vec2::new(angle.cos(), angle.sin()) * 15.0,
            area_mm: area,
            pressure: Some(0.5),
            ..Pen::default()
        };
        let t_us = tick * 1_000_000 / u64::from(config.rate_hz.max(1));
        let sample = Sample { device: DeviceId(1), t_us, device_t_us: None, body: Body::Pen(pen) };
        let before = clock.now_ns();
        world.step(tick, &[sample], &[]);
        took.push(clock.now_ns().saturating_sub(before) as f64 / 1e6);
        if took.len() >= 30 && clock.now_us() - begun > PROBE_US {
            break;
        }
    }
    Some(took)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_serial_group_is_the_systems_own() {
        let nowhere = Path::new("/nonexistent/ttyS0");
        let debian = "root:x:0:\ndialout:x:20:ann\nuucp:x:10:\n";
        let arch = "root:x:0:root\nuucp:x:986:\n";
        assert_eq!(serial_group(nowhere, arch), "uucp");
        assert_eq!(serial_group(nowhere, debian), "dialout");
        assert_eq!(serial_group(nowhere, ""), "dialout");
    }
}
