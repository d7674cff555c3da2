//! Agreement with the Linux kernel's own decode (wacom.ko, through evdev) of the same recordings.

use std::collections::BTreeMap;
use std::path::Path;

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::{Player, hid_recorder};
use sculptd_devices::{Body, DeviceId, Pen, Tool};

/// The kernel's state after one report.
struct Row<'a>(BTreeMap<&'a str, &'a str>);

impl Row<'_> {
    fn n(&self, column: &str) -> i64 {
        self.0[column].parse().unwrap()
    }
}

#[derive(Default)]
struct Tally {
    compared: usize,
    placed: usize,
    /// Rows that differ, by what differs.
    differ: BTreeMap<&'static str, usize>,
    worst_xy: i64,
    worst_tilt: f64,
    worst_distance: f64,
}

impl Tally {
    fn check(&mut self, what: &'static str, same: bool) {
        *self.differ.entry(what).or_default() += usize::from(!same);
    }
}

/// The header's `# abs ranges: {"P": ["0", "2047"], ...}`.
fn range(header: &str, axis: &str) -> i64 {
    let json = header.split_once(':').unwrap().1;
    let all: serde_json::Value = serde_json::from_str(json).unwrap();
    all[axis][1].as_str().unwrap().parse().unwrap()
}

fn compare(oracle: &str, recording: &Path) -> Tally {
    let mut lines = oracle.lines().skip(1);
    let ranges = lines.next().unwrap();
    let (max_pressure, max_distance) = (range(ranges, "P"), range(ranges, "D"));
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows = lines.map(|l| Row(columns.iter().copied().zip(l.split(',')).collect()));
    let text = String::from_utf8_lossy(&std::fs::read(recording).unwrap()).into_owned();
    let reports = hid_recorder::parse(&text).unwrap().reports;
    let mut player = Player::open(recording, DeviceId(0), &Catalogue::builtin().unwrap()).unwrap();
    let mut pen: Option<Pen> = None;
    let mut tally = Tally::default();
    for row in rows {
        let due = reports[row.n("i") as usize].t_us;
        player.advance(due, &mut |s| {
            if let Body::Pen(p) = s.body {
                pen = Some(p);
            }
        });
        tally.compared += 1;
        let kernel_in = row.n("tool_pen") + row.n("tool_rubber") > 0;
        // The kernel reports its puck as a separate tool, which the oracle does not record.
        let ours_in = pen.is_some_and(|p| p.in_range && p.tool != Tool::Mouse);
        tally.check("proximity", kernel_in == ours_in);
        let Some(p) = pen.filter(|_| kernel_in && ours_in) else { continue };
        tally.placed += 1;
        tally.check("touch", p.tip == (row.n("btn_touch") == 1));
        tally.check("tool", (p.tool == Tool::Eraser) == (row.n("tool_rubber") == 1));
        let pressure = (f64::from(p.pressure.unwrap()) * max_pressure as f64).round() as i64;
        tally.check("pressure", pressure == row.n("pressure"));
        tally.check(
            "buttons",
            i64::from(p.buttons) == row.n("btn_stylus") + 2 * row.n("btn_stylus2"),
        );
        let off =
            (i64::from(p.raw[0]) - row.n("x")).abs().max((i64::from(p.raw[1]) - row.n("y")).abs());
        tally.worst_xy = tally.worst_xy.max(off);
        if let Some(t) = p.tilt {
            let off = |ours: f32, theirs: &str| {
                (f64::from(ours).to_degrees() - row.n(theirs) as f64).abs()
            };
            tally.worst_tilt = tally.worst_tilt.max(off(t.x, "tilt_x")).max(off(t.y, "tilt_y"));
        }
        if max_distance > 0 {
            let off = (f64::from(p.distance.unwrap_or(0.0)) - row.n("distance") as f64).abs();
            tally.worst_distance = tally.worst_distance.max(off);
        }
    }
    tally
}

#[test]
fn every_recording_with_an_oracle_agrees_with_the_kernel() {
    let Some(corpus) = super::devices() else { return };
    let oracles = super::files(&corpus.join("oracle"), ".csv");
    assert!(oracles.len() >= 8, "{oracles:?}");
    println!(
        "recording                              reports placed  prox tool touch press butt    xy  \
         tilt  dist"
    );
    for path in oracles {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let plain = corpus.join(format!("hid/{name}.hid"));
        let joined = corpus.join(format!("hid/{}.hid", name.replace("005E_005B", "005E+005B")));
        let recording = if plain.is_file() { plain } else { joined };
        let t = compare(&std::fs::read_to_string(&path).unwrap(), &recording);
        let d = |what: &str| t.differ.get(what).copied().unwrap_or(0);
        println!(
            "{name:38} {:7} {:6} {:5} {:4} {:5} {:5} {:4} {:5} {:5.2} {:5.1}",
            t.compared,
            t.placed,
            d("proximity"),
            d("tool"),
            d("touch"),
            d("pressure"),
            d("buttons"),
            t.worst_xy,
            t.worst_tilt,
            t.worst_distance
        );
        assert!(t.placed > 100, "{name}: only {} reports placed", t.placed);
        assert_eq!(t.differ.values().sum::<usize>(), 0, "{name}: exact columns differ");
        assert!(t.worst_xy <= 4, "{name}: beyond the kernel's fuzz");
        assert!(t.worst_tilt < 1.001 && t.worst_distance <= 1.0, "{name}");
    }
}
