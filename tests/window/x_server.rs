//! A real X server on a dummy screen, whose tablet, mouse and touch screen a test feeds through the
//! server's own test driver (inputtestdrv(4), Debian's `xserver-xorg-core`).

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Command, Stdio};

use glam::DVec2;

use super::stage::{Ended, wait};

/// The dummy screen, pixels.
pub const SCREEN: (u32, u32) = (1280, 720);
const XORG: &str = "/usr/lib/xorg/Xorg";

/// One device of the X server's test driver. A message is its length and kind, 32 bits each, and a
/// body; `xf86-input-inputtest-protocol.h` has the layouts.
pub struct Driven(UnixStream);

impl Driven {
    pub fn connect(path: &Path) -> Driven {
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

    /// Encodes a flag for the second values; a mask of the axes that follow, eight bytes; then, at
    /// a multiple of eight bytes, 64 values, twice.
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

    pub fn motion(&mut self, absolute: bool, at: DVec2) {
        let mut body = u64::from(absolute).to_ne_bytes().to_vec();
        body.extend(Driven::axes(&[at.x, at.y]));
        self.send(2, &body);
    }

    /// To a share of the screen.
    pub fn place(&mut self, share: DVec2) {
        self.motion(true, share * 65535.0);
    }

    pub fn near(&mut self, near: bool) {
        let mut body = u64::from(near).to_ne_bytes().to_vec();
        body.extend(Driven::axes(&[]));
        self.send(3, &body);
    }

    /// A finger of a touch screen, at a share of the screen.
    pub fn finger(&mut self, number: u32, step: Finger, share: DVec2) {
        let kind: u32 = match step {
            // XI_TouchBegin, XI_TouchUpdate and XI_TouchEnd of the X input extension.
            Finger::Begin => 18,
            Finger::Move => 19,
            Finger::End => 20,
        };
        let mut body = number.to_ne_bytes().to_vec();
        body.extend(kind.to_ne_bytes());
        let at = share * 65535.0;
        body.extend(Driven::axes(&[at.x, at.y]));
        self.send(6, &body);
    }

    pub fn button(&mut self, down: bool) {
        let mut body = 0u32.to_ne_bytes().to_vec();
        body.extend(1u32.to_ne_bytes());
        body.extend(u64::from(down).to_ne_bytes());
        body.extend(Driven::axes(&[]));
        self.send(4, &body);
    }
}

/// Action of a finger.
#[derive(Debug, Clone, Copy)]
pub enum Finger {
    Begin,
    Move,
    End,
}

/// The server's settings: a screen without a card, a tablet with proximity, a mouse, a touch
/// screen.
fn settings(dir: &Path) -> String {
    let (w, h) = SCREEN;
    let device = |name: &str, kind: &str| {
        format!(
            "Section \"InputDevice\"\nIdentifier \"{name}\"\nDriver \"inputtest\"\n\
             Option \"SocketPath\" \"{}/{name}.sock\"\nOption \"DeviceType\" \"{kind}\"\n\
             Option \"TouchCount\" \"10\"\n\
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
         EndSection\n{}{}{}Section \"ServerLayout\"\nIdentifier \"layout\"\nScreen \"screen\"\n\
         InputDevice \"tablet\" \"CorePointer\"\nInputDevice \"mouse\" \"SendCoreEvents\"\n\
         InputDevice \"touch\" \"SendCoreEvents\"\nEndSection\n",
        device("tablet", "PointerAbsoluteProximity"),
        device("mouse", "Pointer"),
        device("touch", "Touch"),
    )
}

/// A desktop with its tablet and mouse, or why there is none.
#[allow(clippy::disallowed_methods)] // Nobody reads half of it.
pub fn desktop(dir: &Path) -> Result<(Ended, String), String> {
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
