#![allow(clippy::print_stdout)]
use sculptd_devices::descriptor::Descriptor;
fn main() {
    for path in std::env::args().skip(1) {
        let t = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let r = sculptd_devices::recording::hid_recorder::parse(&t).unwrap();
        println!("{}", path.rsplit('/').next().unwrap());
        for w in &r.interfaces {
            if let Ok(d) = Descriptor::parse(&w.descriptor) {
                for f in &d.facts {
                    let p = f.usage >> 16;
                    if p == 0xff0d && (f.usage & 0xffff) >= 0x100
                        || p == 0x0d && (f.usage & 0xffff) == 0x39
                        || (p == 0xff00 && false)
                        || p == 9 && f.report_id.is_some_and(|i| i >= 0x11)
                    {
                        println!(
                            "   id {:02x?} {:08x} @{}+{} {}..{}",
                            f.report_id, f.usage, f.start, f.len, f.min, f.max
                        );
                    }
                }
            }
        }
    }
}
