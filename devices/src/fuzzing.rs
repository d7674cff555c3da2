//! Properties that hold for any bytes at all. `cargo fuzz` (in `devices/fuzz`) looks for bytes that
//! violate them; a test runs the kept ones.

use std::sync::OnceLock;

use glam::{Vec2, Vec3};

use crate::catalogue::{Catalogue, Found};
use crate::descriptor::Descriptor;
use crate::hid::decoder::Decoder;
use crate::leap::{self, FrameFile, Message};
use crate::report::Batch;
use crate::sample::{Body, DeviceId, Hands, Sample};
use crate::serial::{self, Protocol};
use crate::sim::PenScript;

/// One thing that reads bytes.
pub type Target = fn(&[u8]);

/// Everything that reads bytes from outside, by name.
pub const TARGETS: [(&str, Target); 4] = [
    ("leap", leap_bytes),
    ("serial", serial_bytes),
    ("descriptor", descriptor_bytes),
    ("report", report_bytes),
];

/// A tracker's message, and the same bytes as a file of frames.
pub fn leap_bytes(data: &[u8]) {
    if let Ok(Ok(Message::Frame(frame))) = std::str::from_utf8(data).map(leap::parse_message) {
        check_hands(&frame.hands);
    }
    let Ok(file) = FrameFile::from_reader(std::io::Cursor::new(data.to_vec())) else { return };
    let mut last = 0;
    // An error of the source comes again and again: the first ends it.
    for (t, _) in file.map_while(Result::ok) {
        assert!(t >= last, "time runs back in a frame file");
        last = t;
    }
}

/// The first byte chooses the protocol, the rest is the line.
pub fn serial_bytes(data: &[u8]) {
    let Some((&which, line)) = data.split_first() else { return };
    let protocols = [Protocol::Isdv4, Protocol::WacomIv, Protocol::WacomV, Protocol::SummaMm];
    let protocol = protocols[usize::from(which) % protocols.len()];
    let (facts, _) = crate::sim::serial::stream(protocol, &PenScript::default(), 0..0);
    let (mut decoder, mut visit) =
        (serial::SerialDecoder::new(&facts, DeviceId(0)), Visit::default());
    for (i, chunk) in line.chunks(16).enumerate() {
        decoder.feed(chunk, i as u64 * 7_000, &mut |s| visit.see(&s));
        if which & 0x80 != 0 {
            decoder.quiet(&mut |s| visit.see(&s));
        }
    }
    decoder.leave(1 << 40, &mut |s| visit.see(&s));
    visit.ended();
}

/// A report descriptor.
pub fn descriptor_bytes(data: &[u8]) {
    // Whatever came of it must read any report without a panic.
    if let Ok(descriptor) = Descriptor::parse(data) {
        let mut report = [0xa5; 64];
        report[0] = data.first().copied().unwrap_or(0);
        for length in [0, 1, 8, 64] {
            crate::hid::digitiser::parse(&report[..length], &descriptor, &mut Batch::default());
        }
    }
}

/// The first two bytes choose a model and a firmware, then each report is led by its length.
pub fn report_bytes(data: &[u8]) {
    static MODELS: OnceLock<Vec<Found>> = OnceLock::new();
    let models = MODELS.get_or_init(|| {
        let catalogue = Catalogue::builtin().unwrap_or_default();
        let ways = |t: &std::sync::Arc<crate::tablet::Tablet>| {
            let tablet = t.clone();
            (0..t.id.len()).map(move |at| Found::new(tablet.clone(), at))
        };
        catalogue.tablets().iter().flat_map(ways).collect()
    });
    let [low, high, rest @ ..] = data else { return };
    let Some(found) =
        models.get(usize::from(u16::from_le_bytes([*low, *high])) % models.len().max(1))
    else {
        return;
    };
    let (mut decoder, mut visit) = (Decoder::new(found, &[], DeviceId(0)), Visit::default());
    let (mut rest, mut t) = (rest, 0);
    while let Some((&length, tail)) = rest.split_first() {
        let (report, after) = tail.split_at(usize::from(length).min(tail.len()));
        decoder.feed(report, t, &mut |s| visit.see(&s));
        t += 5_000;
        decoder.tick(t, &mut |s| visit.see(&s));
        rest = after;
    }
    decoder.leave(t, &mut |s| visit.see(&s));
    visit.ended();
}

/// Holds the laws of a pen over one stream.
#[derive(Default)]
struct Visit {
    inside: bool,
    last_us: u64,
}

impl Visit {
    fn see(&mut self, s: &Sample) {
        let Body::Pen(p) = s.body else { return };
        assert!(
            p.pos_mm.cmpge(Vec2::ZERO).all() && p.pos_mm.cmple(p.area_mm).all(),
            "off the tablet: {p:?}"
        );
        assert!(p.pressure.is_none_or(|v| (0.0..=1.0).contains(&v)), "pressure: {p:?}");
        assert!(
            p.tilt.is_none_or(
                |t| t.is_finite() && t.abs().max_element() <= std::f32::consts::FRAC_PI_2
            ),
            "tilt: {p:?}"
        );
        assert!(p.twist.is_none_or(f32::is_finite), "twist: {p:?}");
        assert!(p.in_range || (!p.tip && p.buttons == 0), "pressed from afar: {p:?}");
        assert!(s.t_us >= self.last_us, "time runs back");
        (self.inside, self.last_us) = (p.in_range, s.t_us);
    }

    fn ended(&self) {
        assert!(!self.inside, "a visit without an end");
    }
}

fn check_hands(hands: &Hands) {
    let unit = |v: Option<Vec3>| v.is_none_or(|v| (v.length() - 1.0).abs() < 1e-3);
    let ratio = |v: Option<f32>| v.is_none_or(|v| (0.0..=1.0).contains(&v));
    assert!(hands.as_slice().windows(2).all(|w| w[0].id < w[1].id), "ids in order and each once");
    for h in hands.as_slice() {
        assert!(h.palm.is_finite() && unit(h.palm_normal) && unit(h.direction), "{h:?}");
        assert!(ratio(h.grab) && ratio(h.pinch) && ratio(h.confidence), "{h:?}");
        assert!(h.orientation.is_none_or(|q| q.is_normalized()), "{h:?}");
        let places = [h.palm_velocity, h.wrist, h.elbow];
        let joints =
            h.fingers.iter().flatten().flat_map(|f| f.joints.into_iter().chain([Some(f.tip)]));
        assert!(places.into_iter().chain(joints).flatten().all(Vec3::is_finite), "{h:?}");
        assert!(h.fingers.iter().flatten().all(|f| unit(f.direction)), "{h:?}");
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::sim::tablet::{self, SimTablet, TabletConfig};
    use crate::sim::{journal, tracker};

    fn corpus() -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus")
    }

    #[test]
    fn the_kept_bytes_break_nothing_whole_cut_or_changed() {
        for (name, run) in TARGETS {
            let mut paths: Vec<_> = std::fs::read_dir(corpus().join(name))
                .unwrap()
                .map(|e| e.unwrap().path())
                .collect();
            paths.sort();
            assert!(paths.len() >= 3, "{name}: {} files", paths.len());
            for path in &paths {
                let bytes = std::fs::read(path).unwrap();
                run(&bytes);
                let mut rng = crate::sim::faults::Rng::new(bytes.len() as u64);
                for _ in 0..200 {
                    let mut changed = bytes.clone();
                    changed.truncate(rng.below(bytes.len() as u64 + 1) as usize);
                    for _ in 0..rng.below(4) {
                        if let Some(b) = changed.get_mut(rng.below(bytes.len() as u64) as usize) {
                            *b = rng.next_u64() as u8;
                        }
                    }
                    run(&changed);
                }
            }
        }
    }

    /// Run by hand to rewrite the seeds: `cargo test -p sculptd-devices --lib write_seeds --
    /// --ignored`.
    #[test]
    #[ignore = "writes devices/fuzz/corpus"]
    #[allow(clippy::disallowed_methods)] // Seeds need no care against a crash.
    fn write_seeds() {
        let put = |target: &str, name: &str, bytes: &[u8]| {
            std::fs::create_dir_all(corpus().join(target)).unwrap();
            std::fs::write(corpus().join(target).join(name), bytes).unwrap();
        };
        let j = journal();
        for (name, us) in [("no-hand", 0), ("one-hand", 9_000_000), ("two-hands", 11_500_000)] {
            let frame = tracker::frame_json(&j.hands.at(us, 7), 3_600_000_000 + us, 110.0);
            put("leap", name, frame.as_bytes());
        }
        put("leap", "version", br#"{"serviceVersion":"2.3.1","version":6}"#);
        put(
            "leap",
            "device",
            br#"{"event":{"type":"deviceEvent",
                "state":{"attached":true,"id":"X","streaming":true}}}"#,
        );
        put(
            "leap",
            "nan",
            br#"{"id":1,"hands":[{"id":1,"palmPosition":[nan,1,-inf],"type":"left"}],
                "pointables":[]}"#,
        );
        put(
            "leap",
            "file",
            b"{\"version\":6}\n{\"timestamp\":5,\"hands\":[]}\n{\"timestamp\":9,\"hands\":[]}\n",
        );
        let protocols = [Protocol::Isdv4, Protocol::WacomIv, Protocol::WacomV, Protocol::SummaMm];
        for (i, protocol) in protocols.into_iter().enumerate() {
            let (_, packets) = crate::sim::serial::stream(protocol, &j.pen, 2_200_000..2_900_000);
            let mut bytes = vec![i as u8];
            packets.iter().for_each(|p| bytes.extend(p));
            put("serial", &format!("{protocol:?}").to_lowercase(), &bytes);
        }
        put("descriptor", "generic", &tablet::generic_identity().descriptor);
        put(
            "descriptor",
            "keyboard",
            &[
                5, 1, 9, 6, 0xa1, 1, 5, 7, 0x19, 0xe0, 0x29, 0xe7, 0x15, 0, 0x25, 1, 0x75, 1, 0x95,
                8, 0x81, 2, 0xc0,
            ],
        );
        put(
            "descriptor",
            "unclosed",
            &[5, 0xd, 9, 2, 0xa1, 1, 9, 0x20, 0xa1, 0, 9, 0x42, 0x75, 1, 0x95, 0xff, 0x81, 2],
        );
        let catalogue = Catalogue::builtin().unwrap();
        let mut at = 0u16;
        let mut families = std::collections::BTreeSet::new();
        for model in catalogue.tablets() {
            for i in 0..model.id.len() {
                let found = Found::new(model.clone(), i);
                let family = found.id().parser;
                if families.insert(family) {
                    let area = Vec2::new(model.area.width_mm as f32, model.area.height_mm as f32);
                    let script = j.pen.fitted(j.area_mm, area);
                    let config =
                        TabletConfig { rate: 40.0, keeps: 1000, ..TabletConfig::default() };
                    let (mut sim, mut end) = SimTablet::new(&found, script, config);
                    sim.skip_to(2_100_000);
                    sim.advance(2_900_000);
                    let mut bytes = at.to_le_bytes().to_vec();
                    let mut buffer = [0; 64];
                    use crate::hid::transport::Transport;
                    while let Ok(n @ 1..) = end.read(&mut buffer, 0) {
                        bytes.push(n as u8);
                        bytes.extend_from_slice(&buffer[..n]);
                    }
                    put("report", &format!("{family:?}").to_lowercase(), &bytes);
                }
                at += 1;
            }
        }
    }
}
