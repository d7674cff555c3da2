//! One dab of the Gaussian brush where a ray meets a mesh: `cargo run --release -p sculptd-clay
//! --example dab_on_a_mesh [IN.obj OUT.obj]`. Without files it is done on a ball.
#![allow(clippy::print_stdout)] // An example tells what it did.

use std::path::Path;

use glam::Vec3;
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::{Clay, Ray, Reach, Workers};
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let plain = match files.first() {
        Some(path) => read_mesh(Path::new(path), &Job::default())?.mesh.triangulate().0,
        None => shapes::icosphere(1.0, 60),
    };
    let mut clay = Clay::build(&plain, &Job::default())?;
    clay.warnings().iter().for_each(|warning| eprintln!("{warning}"));

    // From outside along -Z, through the middle of the bounding box.
    let (lo, hi) = clay.bounds();
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).length());
    let ray = Ray { origin: middle + Vec3::Z * size, dir: Vec3::NEG_Z };
    let hit = clay.pick(ray).ok_or("the ray meets no triangle")?;

    let radius = size * 0.1;
    let reach = Reach::Sphere { centre: hit.position, radius };
    let brush = GaussianBrush::new(hit.position, radius, hit.normal, radius * 0.3);
    clay.begin_step();
    let report = clay.dab(&reach, &brush, &Workers::new(1));
    clay.end_step();

    let now = clay.pick(ray).ok_or("the surface is gone")?;
    println!(
        "{} of {} vertices moved in {} of {} pages; the surface rose by {:.4}",
        report.moved,
        clay.vertex_count(),
        report.pages,
        clay.page_count(),
        hit.t - now.t
    );
    if let Some(path) = files.get(1) {
        write_mesh(Path::new(path), &clay.to_tri().to_poly())?;
    }
    Ok(())
}
