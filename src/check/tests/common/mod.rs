//! Parts made by formula, and the presets that the program carries.
#![allow(dead_code, clippy::print_stdout)] // Says when it skips.

use glam::{DQuat, DVec3, EulerRot};
use sculptd_check::preset::CheckPreset;
use sculptd_check::{
    CheckAnswer, CheckRequest, CheckSettings, Finding, FindingKind, PresetLibrary, check_part,
};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::preset::Preset;

macro_rules! texts {
    ($folder:literal: $($name:literal),+) => {
        [$(($name, include_str!(concat!("../../../../config/", $folder, "/", $name, ".toml")))),+]
    };
}

pub fn library() -> PresetLibrary {
    let checks = texts!("check": "fdm", "sla", "sls", "moulding", "pla", "resin", "pa12", "abs",
        "fdm-220", "press-1000");
    let walls = texts!("thickness": "fdm", "sla", "sls", "abs");
    PresetLibrary {
        checks: checks.iter().map(|(n, t)| CheckPreset::read(n, t).expect("valid")).collect(),
        walls: walls.iter().map(|(n, t)| Preset::read(n, t).expect("valid")).collect(),
    }
}

pub fn settings(process: &str, up: DVec3) -> CheckSettings {
    let library = library();
    let process = library.process(process).expect("known");
    CheckSettings::new(&library, process, None, None, up).expect("settings")
}

pub fn checked_with(mesh: &PolyMesh, settings: &CheckSettings) -> CheckAnswer {
    let job = Job::default();
    check_part("part", mesh, 1.0, settings, CheckRequest::default(), &job, || 0.0)
        .expect("not cancelled")
        .answer
}

pub fn checked(mesh: &PolyMesh, process: &str) -> CheckAnswer {
    checked_with(mesh, &settings(process, DVec3::Z))
}

/// The findings of a kind.
pub fn of(answer: &CheckAnswer, kind: FindingKind) -> Vec<&Finding> {
    answer.findings.iter().filter(|f| f.kind == kind).collect()
}

/// The finding of a kind, as it is found on the part, turned with its build direction, and in
/// another place. Values must agree.
pub fn found_everywhere(
    mesh: &PolyMesh,
    process: &str,
    kind: FindingKind,
    value: f64,
    place: impl Fn(DVec3) -> bool,
) {
    for (turn, shift) in poses() {
        let moved = placed(mesh, turn, shift);
        let answer = checked_with(&moved, &settings(process, turn * DVec3::Z));
        let found = of(&answer, kind);
        let first = found.first().unwrap_or_else(|| {
            panic!("{kind:?} of {value} not found, turned {turn}: {:#?}", answer.findings)
        });
        let got = first.value.expect("a value");
        assert!((got - value).abs() <= 0.01 * value.abs().max(1e-6), "{kind:?}: {got} for {value}");
        let at = turn.inverse() * (DVec3::from(first.position.expect("a place")) - shift);
        assert!(place(at), "{kind:?} at {at}");
        assert!(!first.message.is_empty() && !first.unit.is_empty());
    }
}

/// No finding of a kind in any pose.
pub fn found_nowhere(mesh: &PolyMesh, process: &str, kind: FindingKind) {
    for (turn, shift) in poses() {
        let moved = placed(mesh, turn, shift);
        let answer = checked_with(&moved, &settings(process, turn * DVec3::Z));
        let found = of(&answer, kind);
        assert!(found.is_empty(), "turned {turn}: {found:#?}");
        assert!(of(&answer, FindingKind::NotChecked).is_empty(), "{:#?}", answer.findings);
    }
}

pub fn poses() -> Vec<(DQuat, DVec3)> {
    vec![
        (DQuat::IDENTITY, DVec3::ZERO),
        (DQuat::from_euler(EulerRot::XYZ, 0.4, 1.1, 2.0), DVec3::new(30.0, -50.0, 200.0)),
        (DQuat::from_euler(EulerRot::XYZ, std::f64::consts::PI, 0.0, 0.3), DVec3::ZERO),
    ]
}

/// Turned and moved, rounded as STL rounds.
pub fn placed(mesh: &PolyMesh, turn: DQuat, shift: DVec3) -> PolyMesh {
    let mut out = mesh.clone();
    for p in &mut out.positions {
        *p = (turn * *p + shift).as_vec3().as_dvec3();
    }
    out
}

fn poly(positions: Vec<DVec3>, faces: &[Vec<u32>]) -> PolyMesh {
    let mut mesh = PolyMesh { positions, ..PolyMesh::new() };
    faces.iter().for_each(|f| mesh.push_face(f));
    mesh
}

/// A profile in x and z, counter-clockwise seen from -y, drawn out along y.
pub fn drawn_out(profile: &[[f64; 2]], length: f64) -> PolyMesh {
    let n = profile.len() as u32;
    let at = |y: f64| profile.iter().map(move |p| DVec3::new(p[0], y, p[1]));
    let positions = at(0.0).chain(at(length)).collect();
    let mut faces = vec![(0..n).collect(), (n..2 * n).rev().collect()];
    faces.extend((0..n).map(|i| vec![i, i + n, (i + 1) % n + n, (i + 1) % n]));
    poly(positions, &faces)
}

/// A profile of radius and z turned around the z axis; from the axis to the axis, or a closed ring
/// that does not reach it. Outside is to the right of the way.
pub fn revolved(profile: &[[f64; 2]], around: u32) -> PolyMesh {
    let mut positions = Vec::new();
    let mut starts = Vec::new();
    for &[r, z] in profile {
        starts.push((positions.len() as u32, r > 0.0));
        if r > 0.0 {
            positions.extend((0..around).map(|i| {
                let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(around)).sin_cos();
                DVec3::new(r * c, r * s, z)
            }));
        } else {
            positions.push(DVec3::new(0.0, 0.0, z));
        }
    }
    let closed = starts.iter().all(|s| s.1);
    let mut faces = Vec::new();
    let mut link = |(a, wide_a): (u32, bool), (b, wide_b): (u32, bool)| {
        for i in 0..around {
            let j = (i + 1) % around;
            match (wide_a, wide_b) {
                (true, true) => faces.push(vec![a + i, a + j, b + j, b + i]),
                (true, false) => faces.push(vec![a + i, a + j, b]),
                (false, true) => faces.push(vec![a, b + j, b + i]),
                (false, false) => {}
            }
        }
    };
    starts.windows(2).for_each(|w| link(w[0], w[1]));
    if closed {
        link(starts[starts.len() - 1], starts[0]);
    }
    poly(positions, &faces)
}

/// The area of a regular polygon in a circle.
pub fn ring_area(radius: f64, around: u32) -> f64 {
    let n = f64::from(around);
    0.5 * n * radius * radius * (std::f64::consts::TAU / n).sin()
}

pub fn block(lo: [f64; 3], hi: [f64; 3]) -> PolyMesh {
    sculptd_geometry::shapes::cuboid(lo.into(), hi.into())
}

/// A block that is narrower or wider at the top.
pub fn frustum(bottom: f64, top: f64, height: f64) -> PolyMesh {
    let mut mesh = block([-1.0, -1.0, 0.0], [1.0, 1.0, height]);
    for p in &mut mesh.positions {
        let half = if p.z > 0.0 { top } else { bottom };
        (p.x, p.y) = (p.x * half, p.y * half);
    }
    mesh
}

pub fn joined(a: &PolyMesh, b: &PolyMesh) -> PolyMesh {
    let mut out = a.clone();
    let base = a.positions.len() as u32;
    out.positions.extend(&b.positions);
    b.faces().for_each(|f| out.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
    out
}

pub fn flipped(mesh: &PolyMesh) -> PolyMesh {
    let mut out = mesh.clone();
    sculptd_geometry::repair::flip(&mut out);
    out
}

/// The support of a part as rays find it.
pub struct RaySupport {
    pub volume: f64,
    /// At least one standard deviation of `volume`.
    pub error: f64,
    pub area: f64,
}

/// Volume of support and area of the overhangs by rays against every triangle, in double precision.
pub fn by_rays(mesh: &PolyMesh, limit: f64, rays: usize) -> RaySupport {
    let (triangles, _) = mesh.triangles();
    let corners: Vec<[DVec3; 3]> =
        triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize])).collect();
    let cross = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
    let plate = mesh.positions.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let down: Vec<&[DVec3; 3]> = corners
        .iter()
        .filter(|t| {
            let n = cross(t).normalize_or_zero();
            let on_plate = t.iter().all(|p| p.z <= plate + 0.01);
            -n.z > (limit + 0.01).to_radians().sin() && !on_plate
        })
        .collect();
    let weight = |t: &[DVec3; 3]| -cross(t).z * 0.5;
    let all: f64 = down.iter().map(|t| weight(t)).sum();
    let area: f64 = down.iter().map(|t| cross(t).length() * 0.5).sum();
    let (mut state, mut sum, mut squares) = (7u64, 0.0, 0.0);
    let mut unit = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut sums = vec![0.0];
    down.iter().for_each(|t| sums.push(sums[sums.len() - 1] + weight(t)));
    for i in 0..rays {
        let at = (i as f64 + unit()) / rays as f64 * all;
        let k = sums.partition_point(|&s| s <= at).clamp(1, down.len().max(1)) - 1;
        let Some(t) = down.get(k) else { break };
        let (mut u, mut v) = (unit(), unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let p = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
        let mut floor = plate;
        for q in &corners {
            let n = cross(q);
            let [a, b, c] = q.map(|x| x.truncate() - p.truncate());
            let signs = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
            if n.z > 0.0 && signs.iter().all(|s| *s >= 0.0) {
                let z = q[0].z - ((p - q[0]).x * n.x + (p - q[0]).y * n.y) / n.z;
                if z < p.z - 1e-9 {
                    floor = floor.max(z);
                }
            }
        }
        sum += p.z - floor;
        squares += (p.z - floor).powi(2);
    }
    let count = rays as f64;
    let variance = (squares / count - (sum / count).powi(2)).max(0.0) / count;
    RaySupport { volume: sum / count * all, error: variance.sqrt() * all, area }
}

/// Closed meshes of the corpus, 60 mm large: four, or 20 with `SCULPTD_LONG`. Without a corpus,
/// none.
pub fn corpus_parts() -> Vec<(String, PolyMesh)> {
    let Some(corpus) = std::env::var_os("SCULPTD_CORPUS").map(std::path::PathBuf::from) else {
        println!("skipped: SCULPTD_CORPUS is not set");
        return Vec::new();
    };
    let count = if std::env::var_os("SCULPTD_LONG").is_some() { 20 } else { 4 };
    let entries = std::fs::read_dir(corpus.join("meshes")).expect("a folder");
    let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    let job = Job::default();
    let mut out = Vec::new();
    for path in paths {
        let Ok(loaded) = sculptd_geometry::io::read_mesh(&path, &job) else { continue };
        let mut mesh = loaded.mesh;
        sculptd_geometry::repair::weld(&mut mesh, 0.0);
        if mesh.face_count() > 30_000 {
            continue;
        }
        let facts = sculptd_geometry::check::report(&mesh, true, &job).expect("not cancelled");
        let sound = facts.closed && facts.manifold && facts.oriented;
        if !sound || facts.self_intersections != Some(0) || facts.volume.is_none_or(|v| v <= 0.0) {
            continue;
        }
        let size = (facts.bounds.max - facts.bounds.min).max_element();
        mesh.positions.iter_mut().for_each(|p| *p = (*p - facts.bounds.min) * (60.0 / size));
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        out.push((name, mesh));
        if out.len() == count {
            break;
        }
    }
    assert_eq!(out.len(), count, "closed meshes in the corpus");
    out
}
