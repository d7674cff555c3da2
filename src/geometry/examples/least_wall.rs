//! The least wall of mesh files as the command line finds it: `least_wall LIMIT METHOD MESH...`

use sculptd_geometry::CentredMesh;
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::check::{ThicknessLimits, add_places, check};
use sculptd_geometry::thickness::{ThicknessMethod, ThicknessSettings};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let limit: f32 = args[0].parse().expect("a number");
    let method = match &args[1][..] {
        "cone" => ThicknessMethod::Cone,
        "sphere" => ThicknessMethod::Sphere,
        _ => ThicknessMethod::Ray,
    };
    let settings = ThicknessSettings { method, ..ThicknessSettings::default() };
    for path in &args[2..] {
        let loaded = read_mesh(path.as_ref(), &Job::default()).expect("a mesh");
        let mut part = CentredMesh::new(&loaded.mesh, 1.0);
        let walls = add_places(&mut part.mesh, None, 40.0);
        let limits = ThicknessLimits {
            fail_below: (limit > 0.0).then_some(limit),
            ..ThicknessLimits::default()
        };
        let start = std::time::Instant::now();
        let seconds = || start.elapsed().as_secs_f64();
        let found = check(path, &part, walls.as_ref(), &settings, limits, &Job::default(), seconds);
        let a = found.expect("checked").answer;
        let s = &a.summary;
        println!(
            "{path}: {:?} | {} | min {:?} median {:?} mean {:?} max {:?} | below {:?} | bound {} | {:.3} s, {} triangles",
            a.verdict,
            a.statement,
            s.min,
            s.median,
            s.mean,
            s.max,
            a.below,
            s.error_bound,
            a.seconds,
            a.triangles
        );
    }
}
