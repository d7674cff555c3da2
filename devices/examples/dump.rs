#![allow(clippy::print_stdout)]
use sculptd_devices::catalogue::{Catalogue, Params};
use sculptd_devices::descriptor::Descriptor;
fn main() {
    let _c = Catalogue::builtin().unwrap();
    for path in std::env::args().skip(1) {
        let name = path.rsplit('/').next().unwrap_or("").to_owned();
        let t = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let r = sculptd_devices::recording::hid_recorder::parse(&t).unwrap();
        println!("{name}");
        for w in &r.interfaces {
            println!(
                "  if {:?} {:04x}:{:04x} '{}' seen {:?} params {:?} s201 {:?} s121 {:?} s5 {:?}",
                w.interface,
                w.vid,
                w.pid,
                w.name,
                w.seen_lengths,
                Params::of(w),
                w.string(201),
                w.string(121),
                w.string(5)
            );
            match Descriptor::parse(&w.descriptor) {
                Ok(d) => {
                    println!("     lens {:?} kinds {:?}", d.input_lengths, d.kinds);
                    for p in &d.pens {
                        let f = |b: &Option<sculptd_devices::descriptor::Bits>| {
                            b.as_ref().map(|b| {
                                format!(
                                    "{}..{} phys {:?} u{:x} e{} @{}+{}",
                                    b.min, b.max, b.physical, b.unit, b.exponent, b.start, b.len
                                )
                            })
                        };
                        println!(
                            "     pen id {:?} x {:?} y {:?} p {:?} tilt {:?} inr {:?}",
                            p.report_id,
                            f(&p.x),
                            f(&p.y),
                            f(&p.pressure),
                            p.tilt[0].is_some(),
                            p.in_range.as_ref().map(|b| b.start)
                        );
                    }
                }
                Err(e) => println!("     {e} {}", w.descriptor.len()),
            }
        }
    }
}
