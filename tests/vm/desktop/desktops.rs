//! The two desktops: Xorg, and sway as a Wayland compositor. Each says where its pointer and the
//! window are, and lays the tablet's area over another part of the screen.

use std::fs::Permissions;
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::sync::OnceLock;

use glam::{DMat3, DVec2};
use serde_json::Value;

use super::drive::{DISPLAY, Ended, spawn, tool, until};

/// The emulated card, drawn by the machine outside; the tablet comes and goes by itself.
const XORG: &str = r#"Section "Device"
Identifier "card"
Driver "modesetting"
EndSection
"#;
/// No bar, no frames, and the window where it is put.
const SWAY: &str = "xwayland disable\ndefault_border none\ndefault_floating_border none\n\
                    focus_follows_mouse no\nfor_window [title=\"^sculptd$\"] floating enable, \
                    resize set 940 580, move position 20 16\n";

/// Who runs the compositor, and where it keeps its sockets.
const PERSON: u32 = 1000;
const RUNTIME: &str = "/tmp/person";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Desktop {
    X11,
    Sway,
}

/// A part of the screen or a rotation, as configured on each desktop.
#[derive(Debug, Clone, Copy)]
pub struct Area {
    pub name: &'static str,
    /// From shares of the tablet to shares of the screen.
    pub to_screen: DMat3,
    /// The tablet's settings for swaymsg.
    sway: [&'static str; 2],
}

const WHOLE: Area = Area {
    name: "the whole area over the whole screen",
    to_screen: DMat3::IDENTITY,
    sway: ["left_handed disabled", "map_from_region 0x0 1x1"],
};

impl Desktop {
    /// As the machine was started.
    pub fn of_machine() -> Desktop {
        static CHOSEN: OnceLock<Desktop> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let line = std::fs::read_to_string("/proc/cmdline").unwrap_or_default();
            if line.contains("desktop=sway") { Desktop::Sway } else { Desktop::X11 }
        })
    }

    /// The desktop, once it answers.
    pub fn start(self) -> io::Result<Vec<Ended>> {
        match self {
            Desktop::X11 => {
                std::fs::write("/tmp/xorg.conf", XORG)?;
                let mut args =
                    vec![DISPLAY, "-config", "/tmp/xorg.conf", "-logfile", "/tmp/xorg.log"];
                args.extend(["-novtswitch", "-sharevts", "-noreset", "-nolisten", "tcp"]);
                let server = spawn("/usr/lib/xorg/Xorg", &args, "/tmp/desktop.log")?;
                match until(60, || !tool("xinput", &["list"]).is_empty()) {
                    true => Ok(vec![server]),
                    false => Err(io::Error::other("no X server")),
                }
            }
            Desktop::Sway => {
                std::fs::write("/tmp/sway.conf", SWAY)?;
                std::fs::create_dir_all(RUNTIME)?;
                std::os::unix::fs::chown(RUNTIME, Some(PERSON), None)?;
                std::fs::set_permissions(RUNTIME, Permissions::from_mode(0o700))?;
                let seat = spawn("seatd", &["-g", "render"], "/tmp/seatd.log")?;
                if !until(20, || std::path::Path::new("/run/seatd.sock").exists()) {
                    return Err(io::Error::other("no seat"));
                }
                let sway = person("sway", &["-c", "/tmp/sway.conf"])?;
                match until(60, || !self.message("-t", "get_outputs").is_empty()) {
                    true => Ok(vec![sway, seat]),
                    false => Err(io::Error::other("no compositor")),
                }
            }
        }
    }

    /// Returns the variables that name this desktop to its programs.
    pub fn variables(self) -> [(&'static str, &'static str); 1] {
        match self {
            Desktop::X11 => [("DISPLAY", DISPLAY)],
            Desktop::Sway => [("WAYLAND_DISPLAY", "/tmp/person/wayland-1")],
        }
    }

    /// Returns the answer of swaymsg.
    fn message(self, kind: &str, what: &str) -> String {
        let socket = std::fs::read_dir(RUNTIME).into_iter().flatten().flatten();
        let mut socket = socket.filter(|e| e.file_name().to_string_lossy().starts_with("sway-ipc"));
        let Some(socket) = socket.next() else { return String::new() };
        let socket = socket.path().display().to_string();
        tool("swaymsg", &["-r", "-s", &socket, kind, what])
    }

    /// Returns true if the desktop has made a pointer of the pen.
    pub fn has_pen(self) -> bool {
        match self {
            Desktop::X11 => !pen_ids().is_empty(),
            Desktop::Sway => self.message("-t", "get_inputs").contains("tablet_tool"),
        }
    }

    /// The desktop's pointer, pixels. A Wayland compositor tells nobody: there it is where the area
    /// puts the pen, which has come to `pen`.
    pub fn cursor(self, pen: DVec2) -> Option<DVec2> {
        if self == Desktop::Sway {
            return Some(pen);
        }
        let said = tool("xdotool", &["getmouselocation", "--shell"]);
        let value =
            |name: &str| said.lines().find_map(|l| l.strip_prefix(name)?.parse::<f64>().ok());
        Some(DVec2::new(value("X=")?, value("Y=")?))
    }

    /// Returns the origin of the window's pixels: the window knows its place on the screen under
    /// X11 alone.
    pub fn origin(self) -> DVec2 {
        fn find(node: &Value) -> Option<DVec2> {
            if node["name"] == "sculptd" && node["pid"].is_u64() {
                let at = |key: &str| {
                    Some(node["rect"][key].as_f64()? + node["window_rect"][key].as_f64()?)
                };
                return Some(DVec2::new(at("x")?, at("y")?));
            }
            let of = |key: &str| node[key].as_array().and_then(|all| all.iter().find_map(find));
            of("nodes").or_else(|| of("floating_nodes"))
        }
        match self {
            Desktop::X11 => DVec2::ZERO,
            Desktop::Sway => {
                let tree = serde_json::from_str(&self.message("-t", "get_tree"));
                tree.ok().and_then(|tree| find(&tree)).unwrap_or_default()
            }
        }
    }

    /// Gives the window the keyboard.
    pub fn focus(self) {
        if self == Desktop::X11 {
            tool("xdotool", &["windowfocus", &window()]);
        }
    }

    /// Moves the window; by how much, pixels.
    pub fn move_window(self) -> DVec2 {
        match self {
            Desktop::X11 => {
                let id = window();
                tool("xdotool", &["windowmove", &id, "-60", "35"]);
                let geometry = || tool("xdotool", &["getwindowgeometry", &id]);
                until(30, || geometry().contains("-60,35"));
                DVec2::new(-60.0, 35.0)
            }
            Desktop::Sway => {
                let before = self.origin();
                let what = "[title=\"^sculptd$\"] move position 64 50";
                self.message("--", what);
                until(30, || self.origin() != before);
                self.origin() - before
            }
        }
    }

    /// Areas that a person may lay the tablet over; the last one is the first again.
    pub fn areas(self) -> [Area; 3] {
        let turned = DMat3::from_cols_array(&[-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 1.0, 1.0]);
        let turned = Area {
            name: "the area turned by half a turn",
            to_screen: turned,
            sway: ["left_handed enabled", "map_from_region 0x0 1x1"],
        };
        let cropped = match self {
            // The whole tablet over a part of the screen.
            Desktop::X11 => [0.6, 0.0, 0.0, 0.0, 0.7, 0.0, 0.2, 0.15, 1.0],
            // A part of the tablet over the whole screen.
            Desktop::Sway => [1.25, 0.0, 0.0, 0.0, 1.25, 0.0, -0.125, -0.125, 1.0],
        };
        let cropped = Area {
            name: "the area cropped",
            to_screen: DMat3::from_cols_array(&cropped),
            sway: ["left_handed disabled", "map_from_region 0.1x0.1 0.9x0.9"],
        };
        [turned, cropped, WHOLE]
    }

    /// Lays the tablet over another part of the screen, as a person does.
    pub fn set_area(self, area: &Area) {
        match self {
            Desktop::X11 => {
                let m = area.to_screen.transpose().to_cols_array().map(|v| v.to_string());
                for id in pen_ids() {
                    let mut args = vec!["set-prop", &id, "Coordinate Transformation Matrix"];
                    args.extend(m.iter().map(String::as_str));
                    tool("xinput", &args);
                }
            }
            Desktop::Sway => {
                for what in area.sway {
                    self.message("--", &format!("input type:tablet_tool {what}"));
                }
            }
        }
    }
}

/// Starts the compositor, which refuses to be root, as somebody who may draw.
fn person(name: &str, args: &[&str]) -> io::Result<Ended> {
    let groups = std::fs::read_to_string("/etc/group")?;
    let number = |line: &str| line.strip_prefix("render:x:")?.split(':').next()?.parse().ok();
    let group = groups.lines().find_map(number).ok_or_else(|| io::Error::other("no group"))?;
    let log = std::fs::File::create("/tmp/desktop.log")?;
    let child = Command::new(name)
        .args(args)
        .uid(PERSON)
        .gid(group)
        .env("HOME", RUNTIME)
        .env("XDG_RUNTIME_DIR", RUNTIME)
        .env("WLR_BACKENDS", "drm,libinput")
        .env("WLR_LIBINPUT_NO_DEVICES", "1")
        .env("WLR_NO_HARDWARE_CURSORS", "1")
        .env("LIBSEAT_BACKEND", "seatd")
        .stdout(log.try_clone()?)
        .stderr(log)
        .spawn()?;
    Ok(Ended(child))
}

/// The X server's numbers of the tablet, and of its pen once that has been near.
fn pen_ids() -> Vec<String> {
    let list = tool("xinput", &["list"]);
    let pens = list.lines().filter(|l| l.contains("Pen") && l.contains("slave  pointer"));
    let number = |l: &str| Some(l.split_once("id=")?.1.split_whitespace().next()?.to_owned());
    pens.filter_map(number).collect()
}

/// The daemon's window, as xdotool names it.
fn window() -> String {
    let id = tool("xdotool", &["search", "--onlyvisible", "--name", "^sculptd$"]);
    id.lines().next().unwrap_or_default().to_owned()
}
