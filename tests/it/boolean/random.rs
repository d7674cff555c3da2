//! Random operands: the real meshes in random places and against themselves, small integer
//! polyhedra against exact arithmetic, long sequences on one mesh.

use glam::{DMat3, DQuat, DVec3};
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, shapes};

use super::oracle;

/// SplitMix64 (Steele et al. 2014).
pub struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub fn below(&mut self, n: u64) -> u64 {
        self.roll() % n
    }
    pub fn unit(&mut self) -> f64 {
        (self.roll() >> 11) as f64 / (1u64 << 53) as f64
    }
    fn turn(&mut self) -> DMat3 {
        let mut g = || self.unit() + self.unit() + self.unit() - 1.5;
        DMat3::from_quat(DQuat::from_xyzw(g(), g(), g(), g()).normalize())
    }
}

fn long() -> bool {
    std::env::var_os("SCULPTD_LONG").is_some()
}

/// The corpus' closed solids that do not cross themselves, of at most `most` faces, in a box of
/// size 1.
fn solids(most: usize) -> Vec<(String, PolyMesh)> {
    let Some(folder) = crate::corpus() else { return Vec::new() };
    let mut files: Vec<_> = std::fs::read_dir(folder.join("meshes"))
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.path())
        .collect();
    files.sort();
    let job = Job::default();
    files
        .iter()
        .filter_map(|f| {
            let mut mesh = read_mesh(f, &job).ok()?.mesh;
            sculptd_geometry::repair::weld(&mut mesh, 0.0);
            if mesh.face_count() > most {
                return None;
            }
            let facts = check::report(&mesh, true, &job).ok()?;
            let sound = facts.closed && facts.volume? > 0.0 && facts.self_intersections == Some(0);
            let (lo, hi) = (facts.bounds.min, facts.bounds.max);
            let size = (hi - lo).max_element();
            mesh.positions.iter_mut().for_each(|p| *p = (*p - (lo + hi) * 0.5) / size);
            sound.then(|| (f.file_stem().unwrap_or_default().to_string_lossy().into_owned(), mesh))
        })
        .collect()
}

fn placed(mesh: &PolyMesh, turn: DMat3, shift: DVec3) -> PolyMesh {
    let mut out = mesh.clone();
    out.positions.iter_mut().for_each(|p| *p = turn * *p + shift);
    out
}

#[derive(Default, Debug)]
struct Tally {
    good: usize,
    other_tolerance: usize,
    global: usize,
    faults: Vec<String>,
}

impl Tally {
    fn pair(&mut self, name: &str, a: &PolyMesh, b: &PolyMesh) {
        let job = Job::default();
        let (made, report) =
            match compute([a, b], &Operation::ALL, &BooleanOptions::default(), &job, || 0.0) {
                Ok(x) => x,
                Err(e) => return self.faults.push(format!("{name}: {e}")),
            };
        if report.warnings.iter().any(|w| w.contains("global")) {
            self.global += 1;
            println!("{name}: {:?}", report.warnings);
        } else if !report.warnings.is_empty() {
            self.other_tolerance += 1;
            println!("{name}: {:?}", report.warnings);
        } else {
            self.good += 1;
        }
        let volume =
            |m: &PolyMesh| check::report(m, false, &job).ok().and_then(|r| r.volume).unwrap_or(0.0);
        let (va, vb) = (volume(a), volume(b));
        let v: Vec<f64> = made.iter().map(|m| m.facts.volume).collect();
        for (off, what) in [
            (v[0] + v[1] - va - vb, "A or B, A and B"),
            (v[2] + v[1] - va, "A - B, A and B"),
            (v[3] + v[1] - vb, "B - A, A and B"),
        ] {
            // Places in contact were brought together: the surface moved by no more than that.
            let contact = report.contact.farthest;
            // The possible rounding error of cut corners on a thin sheet, beside that of the volume
            // itself.
            let area: f64 = made.iter().map(|m| m.facts.area).sum();
            if off.abs() > 1e-12 * (va + vb) + (4e-16 + contact) * area {
                self.faults.push(format!("{name}: {what}: off by {:e}", off / (va + vb)));
            }
        }
        for m in &made {
            let facts = check::report(&m.mesh, false, &job).expect("not cancelled");
            if m.mesh.face_count() > 0 && !(facts.closed && facts.manifold && facts.oriented) {
                self.faults.push(format!("{name}: {:?}: {facts:?}", m.operation));
            }
        }
    }

    fn told(self, what: &str) {
        println!(
            "{what}: {} good, {} by another tolerance, {} by the global engine",
            self.good, self.other_tolerance, self.global
        );
        assert!(
            self.faults.is_empty(),
            "{} faults:\n{}",
            self.faults.len(),
            self.faults.join("\n")
        );
    }
}

#[test]
fn real_meshes_in_random_places() {
    let all = solids(if long() { 120_000 } else { 3_000 });
    if all.is_empty() {
        return;
    }
    let mut dice = Dice(7);
    let mut tally = Tally::default();
    for n in 0..if long() { 2000 } else { 60 } {
        let (a, b) = (
            &all[dice.below(all.len() as u64) as usize],
            &all[dice.below(all.len() as u64) as usize],
        );
        let (turn, other) = (dice.turn(), dice.turn());
        let shift = DVec3::new(dice.unit() - 0.5, dice.unit() - 0.5, dice.unit() - 0.5) * 0.6;
        tally.pair(
            &format!("{n}: {} and {}", a.0, b.0),
            &placed(&a.1, turn, DVec3::ZERO),
            &placed(&b.1, other, shift),
        );
    }
    tally.told("random places");
}

#[test]
fn real_meshes_against_themselves() {
    let mut tally = Tally::default();
    let mut dice = Dice(11);
    for (name, m) in solids(if long() { 120_000 } else { 6_000 }) {
        let axis = dice.turn().x_axis;
        tally.pair(&format!("{name} shifted by nothing"), &m, &m);
        tally.pair(&format!("{name} shifted"), &m, &placed(&m, DMat3::IDENTITY, axis * 1e-9));
        let turn = DMat3::from_axis_angle(axis, 1e-4f64.to_radians());
        tally.pair(&format!("{name} turned"), &m, &placed(&m, turn, DVec3::ZERO));
    }
    tally.told("against themselves");
}

#[test]
fn small_integer_polyhedra() {
    let mut dice = Dice(3);
    let mut faults = Vec::new();
    let (mut cases, mut global) = (0, 0);
    while cases < if long() { 1_000_000 } else { 10_000 } && faults.len() < 20 {
        let side = 2 + dice.below(3) as i64;
        let (Some(a), Some(b)) =
            (oracle::polyhedron(&mut dice, side), oracle::polyhedron(&mut dice, side))
        else {
            continue;
        };
        cases += 1;
        let want = oracle::expected(&a, &b);
        let (ma, mb) = (a.mesh(), b.mesh());
        let (made, report) = match compute(
            [&ma, &mb],
            &Operation::ALL,
            &BooleanOptions::default(),
            &Job::default(),
            || 0.0,
        ) {
            Ok(x) => x,
            Err(e) => {
                faults.push(format!("{a:?}\n{b:?}\n{e}"));
                continue;
            }
        };
        global += usize::from(!report.warnings.is_empty());
        for (m, (volume, area)) in made.iter().zip(want) {
            let off = (m.facts.volume - volume).abs().max((m.facts.area - area).abs());
            if off > 1e-10 {
                faults.push(format!(
                    "{a:?}\n{b:?}\n{:?}: volume {} for {volume}, area {} for {area}; {:?}",
                    m.operation, m.facts.volume, m.facts.area, report.warnings
                ));
                break;
            }
        }
    }
    println!("{cases} pairs, {global} not by the first tolerance");
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn a_long_sequence_on_one_mesh() {
    let mut dice = Dice(5);
    let mut clay = shapes::icosphere(1.0, 6).to_poly();
    // Few faces and large, so that the surface is made new over and over.
    let tool = shapes::icosphere(0.4, 1).to_poly();
    let (mut failed, mut most) = (0, 0);
    let count = if long() { 10_000 } else { 200 };
    let mut thin = Vec::new();
    for n in 0..count {
        let on = dice.turn().x_axis * (0.7 + 0.35 * dice.unit());
        let tool = placed(&tool, dice.turn(), on);
        // Carve, add, carve, so that it neither vanishes nor fills.
        let what = if n % 2 == 0 { Operation::Difference } else { Operation::Union };
        match compute([&clay, &tool], &[what], &BooleanOptions::default(), &Job::default(), || 0.0)
        {
            Ok((mut made, _)) => {
                let m = made.remove(0);
                let facts = check::report(&m.mesh, false, &Job::default()).expect("not cancelled");
                assert!(facts.closed && facts.manifold && facts.oriented, "{n}: {facts:?}");
                clay = m.mesh;
            }
            Err(e) => {
                println!("{n}: {e}");
                failed += 1;
            }
        }
        most = most.max(clay.face_count());
        if (n + 1) % (count / 10) == 0 {
            let (slivers, triangles) = slivers(&clay);
            println!(
                "after {}: {} faces, {slivers} of {triangles} triangles are slivers",
                n + 1,
                clay.face_count()
            );
            thin.push(slivers as f64 / triangles as f64);
        }
    }
    println!("{} faces, at most {most}; {failed} refused", clay.face_count());
    assert_eq!(failed, 0);
    // Their share does not grow without bound.
    assert!(thin.iter().all(|&share| share < 0.2), "{thin:?}");
}

/// Triangles less high than a thousandth of their longest side, and all.
fn slivers(mesh: &PolyMesh) -> (usize, usize) {
    let triangles = mesh.triangles().0;
    let thin = triangles.iter().filter(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).cross(c - a).length() < 1e-3 * longest * longest
    });
    (thin.count(), triangles.len())
}
