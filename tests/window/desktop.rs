//! A desktop that moves its pointer by the same pen that the daemon reads: a real X server on a
//! dummy screen, whose pointer and mouse this test feeds through the server's own test driver
//! (inputtestdrv(4), Debian's `xserver-xorg-core`), beside a simulated serial pen on a
//! pseudo-terminal. One pen is one stroke, wherever the desktop puts it.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use glam::{DVec2, Vec2};
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, Shape, Stroke};
use sculptd_devices::sim::{SerialPen, SerialPenConfig};

use super::stage::{Ended, Stage, long, pause, wait};

/// The dummy screen, pixels.
const SCREEN: (u32, u32) = (1280, 720);
const AREA_MM: Vec2 = Vec2::new(200.0, 125.0);
const XORG: &str = "/usr/lib/xorg/Xorg";

/// One device of the X server's test driver. A message is its length and kind, 32 bits each, and a
/// body; `xf86-input-inputtest-protocol.h` has the layouts.
struct Driven(UnixStream);

impl Driven {
    fn connect(path: &Path) -> Driven {
        let stream =
            wait("the X server listens for its devices", || UnixStream::connect(path).ok());
        let mut driven = Driven(stream);
        driven.send(0, &[1u16.to_ne_bytes(), 1u16.to_ne_bytes()].concat());
        let mut head = [0; 8];
        driven.0.read_exact(&mut head).expect("an answer");
        let length = u32::from_ne_bytes(head[..4].try_into().expect("four bytes")) as usize;
        driven.0.read_exact(&mut vec![0; length - 8]).expect("the rest of it");
        driven
    }

    fn send(&mut self, kind: u32, body: &[u8]) {
        let mut message = (8 + body.len() as u32).to_ne_bytes().to_vec();
        message.extend(kind.to_ne_bytes());
        message.extend(body);
        self.0.write_all(&message).expect("the server listens");
    }

    /// Whether the second values are used; a mask of the axes that follow, eight bytes; then, at a
    /// multiple of eight bytes, 64 values, twice.
    fn axes(values: &[f64]) -> Vec<u8> {
        let mut body = vec![0; 4];
        body.extend(((1u64 << values.len()) - 1).to_le_bytes());
        body.extend([0; 4]);
        for _ in 0..2 {
            let value = |i| values.get(i).copied().unwrap_or(0.0f64).to_ne_bytes();
            (0..64).for_each(|i| body.extend(value(i)));
        }
        body
    }

    fn motion(&mut self, absolute: bool, at: DVec2) {
        let mut body = u64::from(absolute).to_ne_bytes().to_vec();
        body.extend(Driven::axes(&[at.x, at.y]));
        self.send(2, &body);
    }

    /// To a share of the screen.
    fn place(&mut self, share: DVec2) {
        self.motion(true, share * 65535.0);
    }

    fn near(&mut self, near: bool) {
        let mut body = u64::from(near).to_ne_bytes().to_vec();
        body.extend(Driven::axes(&[]));
        self.send(3, &body);
    }

    fn button(&mut self, down: bool) {
        let mut body = 0u32.to_ne_bytes().to_vec();
        body.extend(1u32.to_ne_bytes());
        body.extend(u64::from(down).to_ne_bytes());
        body.extend(Driven::axes(&[]));
        self.send(4, &body);
    }
}

/// The server's settings: a screen without a card, a tablet with proximity, a mouse.
fn settings(dir: &Path) -> String {
    let (w, h) = SCREEN;
    let device = |name: &str, kind: &str| {
        format!(
            "Section \"InputDevice\"\nIdentifier \"{name}\"\nDriver \"inputtest\"\n\
             Option \"SocketPath\" \"{}/{name}.sock\"\nOption \"DeviceType\" \"{kind}\"\n\
             EndSection\n",
            dir.display()
        )
    };
    format!(
        "Section \"ServerFlags\"\nOption \"AutoAddDevices\" \"false\"\nEndSection\n\
         Section \"Device\"\nIdentifier \"card\"\nDriver \"dummy\"\nVideoRam 64000\nEndSection\n\
         Section \"Monitor\"\nIdentifier \"monitor\"\nHorizSync 5-1000\nVertRefresh 5-200\n\
         Modeline \"{w}x{h}\" 74.5 {w} 1344 1472 1664 {h} 723 728 748\nEndSection\n\
         Section \"Screen\"\nIdentifier \"screen\"\nDevice \"card\"\nMonitor \"monitor\"\n\
         DefaultDepth 24\nSubSection \"Display\"\nDepth 24\nModes \"{w}x{h}\"\nEndSubSection\n\
         EndSection\n{}{}Section \"ServerLayout\"\nIdentifier \"layout\"\nScreen \"screen\"\n\
         InputDevice \"tablet\" \"CorePointer\"\nInputDevice \"mouse\" \"SendCoreEvents\"\n\
         EndSection\n",
        device("tablet", "PointerAbsoluteProximity"),
        device("mouse", "Pointer"),
    )
}

/// A desktop with its tablet and mouse, or why there is none.
#[allow(clippy::disallowed_methods)] // Nobody reads half of it.
fn desktop(dir: &Path) -> Result<(Ended, String), String> {
    let driver = Path::new(XORG).with_file_name("modules/input/inputtest_drv.so");
    if !Path::new(XORG).exists() || !driver.exists() {
        return Err("no X server with its test driver".into());
    }
    if !rustix::process::geteuid().is_root() {
        return Err("the X server without a seat needs root".into());
    }
    let file = dir.join("xorg.conf");
    std::fs::write(&file, settings(dir)).expect("written");
    let told = dir.join("display");
    let server = Command::new(XORG)
        .args(["-displayfd", "1", "-noreset", "-novtswitch", "-sharevts", "-nolisten", "tcp"])
        .arg("-config")
        .arg(&file)
        .arg("-logfile")
        .arg(dir.join("xorg.log"))
        .stdout(std::fs::File::create(&told).expect("a file"))
        .stderr(Stdio::null())
        .spawn()
        .expect("the X server starts");
    let display = wait("the X server has chosen a display", || {
        std::fs::read_to_string(&told).ok().filter(|d| d.ends_with('\n'))
    });
    Ok((Ended(server), format!(":{}", display.trim())))
}

/// The desktop's own map from shares of the tablet to shares of the screen: the tablet covers the
/// middle of the screen only, as a person may set it.
fn to_screen(share: DVec2) -> DVec2 {
    DVec2::new(0.05, 0.1) + share * DVec2::new(0.9, 0.85)
}

/// A stroke from one pixel of the screen to another.
fn stroke(from_us: u64, [from, to]: [(f64, f64); 2]) -> Stroke {
    let mm = |(x, y): (f64, f64)| {
        let screen = DVec2::new(x / f64::from(SCREEN.0), y / f64::from(SCREEN.1));
        let share = (screen - DVec2::new(0.05, 0.1)) / DVec2::new(0.9, 0.85);
        share.as_vec2() * AREA_MM
    };
    Stroke {
        from_us,
        to_us: from_us + 260_000,
        shape: Shape::Line(mm(from), mm(to)),
        pressure: 0.7,
        tilt: Vec2::ZERO,
        eraser: false,
        buttons: 0,
    }
}

#[test]
#[allow(clippy::disallowed_methods)] // The pen moves in the time of the people who hold it.
fn a_pen_that_the_desktop_follows_makes_each_stroke_once() {
    // It measures what two programs make of the same moment: a loaded machine is no place for it.
    if !long() {
        println!("skipped: SCULPTD_LONG=1 runs it");
        return;
    }
    let count = 200;
    // The first strokes are on the panel on the right: on its way there and from there to the clay
    // the pen hovers for a second, and its place is learned.
    let panel = |i: u64| stroke(300_000 + i * 600_000, [(1150.0, 600.0), (1180.0, 640.0)]);
    let clay = |i: u64| {
        let (x, y) = (600.0 + (i % 7) as f64 * 12.0, 320.0 + (i % 5) as f64 * 16.0);
        stroke(300_000 + i * 600_000, [(x, y), (x + 30.0, y + 8.0)])
    };
    let on_panel = |i: &u64| *i < 2 || i.is_multiple_of(6);
    let strokes = (0..count).map(|i| if on_panel(&i) { panel(i) } else { clay(i) }).collect();
    let expected = (0..count).filter(|i| !on_panel(i)).count() as u64;
    let config = SerialPenConfig::new(Protocol::Isdv4, AREA_MM);
    let script = PenScript::new(strokes);
    let mut pen = SerialPen::new(script.clone(), config).expect("a pseudo-terminal");

    let settings = format!("[devices]\nhid = false\nserial = [\"{}\"]\n", pen.port());
    let Some(mut s) = Stage::on(desktop, &settings) else { return };
    let mut tablet = Driven::connect(&s.dir.path().join("tablet.sock"));
    let mut mouse = Driven::connect(&s.dir.path().join("mouse.sock"));
    s.until("the daemon reads the pen", |_| pen.streaming());
    s.seen("desktop-start");

    let (mut near, mut tip) = (false, false);
    let end_us = 300_000 + count * 600_000 + 500_000;
    let begun = Instant::now();
    loop {
        let t_us = begun.elapsed().as_micros() as u64;
        if t_us > end_us {
            break;
        }
        let pose = script.at(t_us);
        pen.advance(t_us);
        if pose.in_range != near {
            tablet.near(pose.in_range);
            near = pose.in_range;
        }
        if pose.in_range {
            tablet.place(to_screen((pose.pos_mm / AREA_MM).as_dvec2()));
        }
        if pose.tip != tip {
            tablet.button(pose.tip);
            tip = pose.tip;
        }
        pause(7);
    }
    let steps = |s: &Stage| s.figure("undo_steps");
    s.soon(|s| steps(s) >= expected);
    pause(500);
    let came = steps(&s);
    println!("{came} of {expected} strokes came");
    s.look("desktop-strokes");

    // The pen is away, and the mouse is a pen of its own. How far a mouse moves the pointer is the
    // desktop's affair (it may accelerate): it is steered by where the pointer is.
    let place = |s: &Stage| {
        let said = s.tool("xdotool", &["getmouselocation", "--shell"]).expect("the pointer");
        let value = |name: &str| {
            let line = said.lines().find_map(|l| l.strip_prefix(name)).expect("a coordinate");
            line.parse::<f64>().expect("a number")
        };
        DVec2::new(value("X="), value("Y="))
    };
    let goal = DVec2::new(600.0, 330.0);
    s.until("the mouse is over the clay", |s| {
        let by = goal - place(s);
        if by.length() > 8.0 {
            mouse.motion(false, by.clamp_length_max(20.0) * 0.5);
            pause(16);
        }
        by.length() <= 8.0
    });
    pause(200);
    mouse.button(true);
    for _ in 0..10 {
        mouse.motion(false, DVec2::new(3.0, 1.0));
        pause(16);
    }
    mouse.button(false);
    s.until("the mouse has sculpted", |s| steps(s) == came + 1);
    assert_eq!(came, expected, "strokes: none twice, none on a panel");
}
