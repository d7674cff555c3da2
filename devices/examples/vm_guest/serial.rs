//! Serial pens: the same simulated pen twice, each on a separate pseudo-terminal. The kernel's
//! driver reads one (attached by `inputattach`), our adaptor the other; after every packet both
//! must report the same state.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use sculptd_devices::serial::{self, Protocol};
use sculptd_devices::sim::{SerialPen, SerialPenConfig, journal};
use sculptd_devices::{Body, Clock, DeviceId, Pen, Tool, queue};

use super::{Kernel, NONBLOCK, nodes, tell};

const PATIENCE: Duration = Duration::from_secs(20);
/// Simulated time of a comparison: the serial pen's three strokes begin at 14.3 s of the journal.
const SPAN_US: std::ops::Range<u64> = 14_000_000..20_500_000;

fn events() -> BTreeSet<PathBuf> {
    nodes("/dev/input", "event")
}

/// Compares the kernel's driver with our adaptor; `levels`: what the kernel counts pressure in.
pub fn compare(protocol: Protocol, flag: &str, levels: f32) -> io::Result<bool> {
    let journal = journal();
    let config = SerialPenConfig::new(protocol, journal.area_mm);
    let mut theirs = SerialPen::new(journal.serial_pen.clone(), config)?;
    let mut ours = SerialPen::new(journal.serial_pen, config)?;
    let before = events();
    let mut attached =
        Command::new("/bin/inputattach").args(["--always", flag, theirs.port()]).spawn()?;
    let clock = Clock::manual();
    let (factory, mut samples) = queue::channel(1024);
    let config = serial::SerialConfig {
        port: Some(ours.port().into()),
        protocol: Some(protocol),
        device: DeviceId(1),
        ..serial::SerialConfig::default()
    };
    let _adaptor = serial::start(config, clock.clone(), factory.sender())?;
    let mut node = None;
    for _ in 0..200 {
        std::thread::sleep(Duration::from_millis(50));
        node = events().difference(&before).next().cloned();
        if node.is_some() && theirs.streaming() && ours.streaming() {
            break;
        }
    }
    let good = match node {
        Some(node) if ours.streaming() => {
            let mut node = OpenOptions::new().read(true).custom_flags(NONBLOCK).open(node)?;
            follow(&mut theirs, &mut ours, &mut node, &clock, &mut samples, flag, levels)?
        }
        _ => tell(false, &format!("{flag}: the kernel's driver found the pen, our adaptor too")),
    };
    let _ = attached.kill();
    let _ = attached.wait();
    Ok(good)
}

fn follow(
    theirs: &mut SerialPen,
    ours: &mut SerialPen,
    node: &mut File,
    clock: &Clock,
    samples: &mut queue::Receiver,
    flag: &str,
    levels: f32,
) -> io::Result<bool> {
    let (mut kernel, mut last) = (Kernel::default(), None::<Pen>);
    let (mut placed, mut differ, mut worst, mut touched) = (0, 0, 0, 0);
    theirs.skip_to(SPAN_US.start);
    ours.skip_to(SPAN_US.start);
    for t in SPAN_US.step_by(7_519) {
        clock.set_us(t);
        theirs.advance(t);
        for _ in 0..ours.advance(t) {
            let sample = samples
                .next_within(PATIENCE)
                .ok_or_else(|| io::Error::other("a sample did not come"))?;
            if let Body::Pen(pen) = sample.body {
                last = Some(pen);
            }
        }
        std::thread::sleep(Duration::from_millis(6));
        kernel.read(node);
        let there = kernel.pen || kernel.rubber;
        let Some(p) = last.filter(|p| p.in_range) else {
            differ += usize::from(there);
            continue;
        };
        placed += 1;
        touched += usize::from(p.tip);
        let pressure = (p.pressure.unwrap_or(0.0) * levels).round() as i32;
        let same = there
            && kernel.rubber == (p.tool == Tool::Eraser)
            && (kernel.pressure - pressure).abs() <= 1;
        if !same && differ < 3 {
            println!("   at {t} us: kernel {kernel:?}, ours {p:?}");
        }
        differ += usize::from(!same);
        worst = worst
            .max(i64::from(kernel.x - p.raw[0]).abs().max(i64::from(kernel.y - p.raw[1]).abs()));
    }
    let what = format!(
        "{flag}: the kernel's driver agrees on {placed} placed packets ({touched} pressed): \
         {differ} differ, x and y within {worst} counts"
    );
    Ok(tell(placed > 200 && touched > 50 && differ == 0 && worst <= 4, &what))
}
