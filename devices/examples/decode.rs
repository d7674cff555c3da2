//! Decodes a recording of a pen tablet, a serial pen or a hand tracker and prints its samples.
//!
//! ```text
//! cargo run -p sculptd-devices --example decode [RECORDING]
//! ```
//!
//! A recording is what `sculptd devices record` or the `hid-recorder` tool writes. Without one, the
//! program decodes a few reports of a Huion H640P that stand below.

#![allow(clippy::print_stdout)] // It prints what it decodes.

use std::error::Error;
use std::path::Path;

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::{Player, hid_recorder};
use sculptd_devices::{Body, DeviceId, Sample};

/// A stroke in the format of `hid-recorder`: the pen comes near, touches, moves and leaves. String
/// 201 (hexadecimal c9) is the firmware's name, `HUION_T173_190619`.
const STROKE: &str = "\
D: 0
N: HUION Huion Tablet
I: 3 256c 006d
# USB-STRING S c9 24034800550049004f004e005f0054003100370033005f00310039003000360031003900
R: 18 06 00 ff 09 01 a1 01 85 08 75 08 95 0b 09 01 81 02 c0
E: 0.000 12 08 80 10 27 88 13 00 00 00 00 0a f6
E: 0.004 12 08 81 20 27 90 13 00 02 00 00 0a f6
E: 0.008 12 08 81 60 27 b0 13 00 08 00 00 0b f6
E: 0.012 12 08 81 a0 27 d0 13 00 10 00 00 0b f5
E: 0.016 12 08 80 c0 27 e0 13 00 00 00 00 0b f5
E: 0.020 12 08 00 c0 27 e0 13 00 00 00 00 0b f5
";

fn main() -> Result<(), Box<dyn Error>> {
    let catalogue = Catalogue::builtin()?;
    let mut player = match std::env::args_os().nth(1) {
        Some(path) => Player::open(path.as_ref(), DeviceId(0), &catalogue)?,
        None => {
            let recording = hid_recorder::parse(STROKE).map_err(|bad| bad.what)?;
            Player::of(Path::new("the stroke above"), recording, DeviceId(0), &catalogue)?
        }
    };
    let device = player.device();
    println!("{}, {} x {} mm", device.name, device.area_mm.x, device.area_mm.y);
    for note in &device.notes {
        println!("  {note}");
    }
    player.advance(u64::MAX / 2, &mut |sample| print(&sample));
    Ok(())
}

fn print(sample: &Sample) {
    let t_us = sample.t_us;
    match sample.body {
        Body::Pen(p) => println!(
            "{t_us:>9} us  {:?} in range {} touching {} at {:.2}, {:.2} mm, pressure {:?}",
            p.tool, p.in_range, p.tip, p.pos_mm.x, p.pos_mm.y, p.pressure
        ),
        Body::Pad(p) => println!(
            "{t_us:>9} us  keys {:032b} wheels {:?} strips {:?}",
            p.keys, p.wheels, p.strips
        ),
        Body::Hands(h) => {
            let palms: Vec<_> = h.as_slice().iter().map(|hand| hand.palm).collect();
            println!("{t_us:>9} us  {} hands, palms at {palms:.1?} mm", h.count);
        }
    }
}
