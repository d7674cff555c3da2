use super::*;
use crate::check::report;
use crate::shapes;

fn made(mesh: &PolyMesh, quads: usize, creases: Option<f64>) -> (PolyMesh, QuadFigures) {
    let job = Job::default();
    let settings = QuadSettings { quads, creases, guides: Vec::new() };
    let out = quad_remesh(mesh, &settings, &job).expect("a quad mesh").mesh;
    let f = figures(&out, mesh, &job).unwrap();
    println!("{f:?}");
    (out, f)
}

#[test]
fn a_sphere_becomes_quads_alone() {
    let sphere = shapes::icosphere(10.0, 24).to_poly();
    let (mesh, f) = made(&sphere, 1500, None);
    let r = report(&mesh, true, &Job::default()).unwrap();
    assert!(r.closed && r.manifold && r.oriented && r.genus == Some(0), "{r:?}");
    assert!(f.quads.abs_diff(1500) < 75 && f.triangles * 100 <= f.quads, "{f:?}");
    assert_eq!(r.self_intersections, Some(0));
}
