//! Decodes a recording and prints one line a sample.

#![allow(clippy::print_stdout)]

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::Player;
use sculptd_devices::{Body, DeviceId};

fn main() {
    for path in std::env::args().skip(1) {
        let name = path.rsplit('/').next().unwrap_or("").to_owned();
        let mut p = match Player::open(path.as_ref(), DeviceId(0), &Catalogue::builtin().unwrap()) {
            Ok(p) => p,
            Err(e) => {
                let e = e.to_string();
                println!("{name} DECLINED {}", e.rsplit('/').next().unwrap());
                continue;
            }
        };
        let info = p.device().clone();
        let (mut n, mut tips, mut sat, mut lo, mut hi, mut edge) =
            (0, 0, 0, [i32::MAX; 2], [i32::MIN; 2], 0);
        let mut maxp = 0f32;
        p.advance(u64::MAX / 2, &mut |s| {
            if let Body::Pen(p) = s.body {
                n += 1;
                if p.in_range {
                    for k in 0..2 {
                        lo[k] = lo[k].min(p.raw[k]);
                        hi[k] = hi[k].max(p.raw[k]);
                    }
                    if p.pos_mm.x >= p.area_mm.x || p.pos_mm.y >= p.area_mm.y {
                        edge += 1
                    }
                }
                if p.tip {
                    tips += 1;
                    if p.pressure == Some(1.0) {
                        sat += 1
                    }
                }
                maxp = maxp.max(p.pressure.unwrap_or(0.0));
            }
        });
        println!(
            "{name} | {} | {}x{} | n {n} tips {tips} sat {sat} edge {edge} maxp {maxp:.3} lo {lo:?} hi {hi:?} | {}",
            info.name,
            info.area_mm.x,
            info.area_mm.y,
            info.notes.join(" ; ")
        );
    }
}
