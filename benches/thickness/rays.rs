//! Rays a second of the tree on one thread, and a whole measure's time on all. Used by `rates.py`,
//! which casts the same rays with Embree; useful by itself.
//!
//!     cargo run --release --no-default-features --example rays -- MESH [FOLDER]
//!
//! MESH is a file, `tube` (a hollow cylinder of 131,580 triangles) or `blob` (a dented globe of
//! 1,048,576).

use std::io::Write;
use std::path::Path;

use glam::{DVec3, Vec3};
use sculptd_devices::Clock;
use sculptd_geometry::TriMesh;
use sculptd_geometry::bvh::{Bvh8, Ray, TraversalStack};
use sculptd_geometry::io::{read_mesh, write_beside};
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::cone::frame;
use sculptd_geometry::thickness::{
    Cone, ThicknessMethod, ThicknessSettings, Weights, WeldedSurface, measure,
};

/// `around` by `along` vertices on a closed ring of quadrilaterals.
fn ring(around: u32, along: u32, at: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let mut mesh = TriMesh::default();
    for i in 0..around {
        for j in 0..along {
            mesh.positions.push(at(i as f64 / around as f64, j as f64 / along as f64).as_vec3());
        }
    }
    let id = |i: u32, j: u32| (i % around) * along + j % along;
    for i in 0..around {
        for j in 0..along {
            mesh.triangles.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            mesh.triangles.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    mesh
}

fn load(name: &str) -> TriMesh {
    let turn = std::f64::consts::TAU;
    match name {
        "tube" => ring(306, 215, |u, v| {
            // The section: a rectangle 2 by 30 at radius 8 to 10.
            let s = v * 64.0;
            let (r, z) = match s {
                s if s < 30.0 => (10.0, s),
                s if s < 32.0 => (40.0 - s, 30.0),
                s if s < 62.0 => (8.0, 62.0 - s),
                s => (s - 54.0, 0.0),
            };
            DVec3::new(r * (u * turn).cos(), r * (u * turn).sin(), z)
        }),
        "blob" => ring(1024, 512, |u, v| {
            let (a, b) = (u * turn, v * turn);
            let dent = 1.0
                + 0.15 * (7.0 * a).sin() * (5.0 * b).cos()
                + 0.03 * (31.0 * a).cos() * (17.0 * b).sin();
            let r = 10.0 + 4.0 * dent * b.cos();
            DVec3::new(r * a.cos(), r * a.sin(), 4.0 * dent * b.sin())
        }),
        file => match read_mesh(Path::new(file), &Job::default()) {
            Ok(loaded) => loaded.mesh.triangulate().0,
            Err(e) => {
                eprintln!("{e}");
                std::process::exit(6)
            }
        },
    }
}

/// Seconds that this thread ran, not waited: other work on the machine does not count.
fn cpu_seconds(clock: &Clock) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|s| s.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(clock.now_us() as f64 * 1e-6, |ns| ns * 1e-9)
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let clock = Clock::monotonic();
    let mesh = load(args.get(1).map_or("tube", String::as_str));
    let start = cpu_seconds(&clock);
    let tree = Bvh8::build(&mesh, &Job::default()).unwrap_or_else(|e| panic!("{e}"));
    let build = cpu_seconds(&clock) - start;

    let surface = WeldedSurface::new(&mesh, 0.7);
    let (lo, hi) = mesh.bounds();
    let step = (hi - lo).length() * 1e-4;
    let cone = Cone::new(10, 120f32.to_radians(), Weights::Plain);
    let mut rays = Vec::new();
    for (&p, &n) in surface.positions.iter().zip(&surface.normals) {
        let (x, y) = frame(n);
        rays.extend(cone.dirs.iter().map(|d| Ray::new(p - n * step, x * d.x + y * d.y - n * d.z)));
    }
    rays.truncate(4_000_000);
    // The second of two passes: Embree's script warms up, too.
    let mut stack = TraversalStack::new();
    let (mut hits, mut seconds, mut met) = (0, 0.0, Vec::new());
    for _ in 0..2 {
        let start = cpu_seconds(&clock);
        hits = 0;
        for some in rays.chunks(1000) {
            tree.closest_hits(&mut stack, some, |_, _| true, &mut met);
            hits += met.iter().flatten().count();
        }
        seconds = cpu_seconds(&clock) - start;
    }

    if let Some(folder) = args.get(2) {
        let put = |name: &str, bytes: Vec<u8>| {
            if let Err(e) = write_beside(&Path::new(folder).join(name), |w| w.write_all(&bytes)) {
                eprintln!("{name}: {e}");
            }
        };
        let floats = |v: &mut dyn Iterator<Item = Vec3>| {
            v.flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
        };
        put("vertices", floats(&mut mesh.positions.iter().copied()));
        put("origins", floats(&mut rays.iter().map(|r| r.origin)));
        put("directions", floats(&mut rays.iter().map(|r| r.dir)));
        put("triangles", mesh.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect());
    }
    let mut whole = Vec::new();
    if args.get(2).is_none() {
        for (rays, method) in [
            (1, ThicknessMethod::Ray),
            (10, ThicknessMethod::Cone),
            (100, ThicknessMethod::Cone),
            (1, ThicknessMethod::Sphere),
        ] {
            let settings =
                ThicknessSettings { rays, method, opening: 120.0, ..ThicknessSettings::default() };
            let start = clock.now_us();
            let done = measure(&mesh, &settings, &Job::default());
            let wall = (clock.now_us() - start) as f64 * 1e-6;
            whole.push(format!(
                "{{\"method\":\"{method:?}\",\"rays\":{rays},\"wall\":{wall:.4},\"ok\":{}}}",
                done.is_ok()
            ));
        }
    }
    let _ = writeln!(
        std::io::stdout(),
        "{{\"triangles\":{},\"rays\":{},\"hits\":{hits},\"seconds\":{seconds:.6},\
         \"build\":{build:.4},\"rate\":{:.3},\"measure\":[{}]}}",
        mesh.triangles.len(),
        rays.len(),
        rays.len() as f64 / seconds * 1e-6,
        whole.join(",")
    );
}
