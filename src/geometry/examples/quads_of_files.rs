//! Quad remeshing of files: their figures, one line a file.
//!
//!     cargo run --release -p sculptd-geometry --example quads_of_files -- 5000 30 a.obj b.stl
//!
//! The first number is how many quads, the second the angle of creases in degrees (0: none). With
//! `QUADS_OUT=DIR` the meshes are written there.
#![allow(clippy::print_stdout)] // An example tells what it did.

use std::path::{Path, PathBuf};

use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::quads::{QuadSettings, metrics, quad_remesh};
use sculptd_geometry::{check, repair};

/// One digit; a dash where there are no quads.
fn shown(angle: Option<f64>) -> String {
    angle.map_or("-".into(), |a| format!("{a:.1}"))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let quads = args.next().ok_or("how many quads?")?.parse()?;
    let degrees: f64 = args.next().ok_or("which angle of creases?")?.parse()?;
    let creases = (degrees > 0.0).then_some(degrees);
    for name in args {
        let job = Job::default();
        let mut mesh = read_mesh(Path::new(&name), &job)?.mesh;
        repair::weld(&mut mesh, 0.0);
        let before = check::report(&mesh, false, &job)?;
        let settings = QuadSettings { quads, creases, guides: Vec::new() };
        let made = match quad_remesh(&mesh, &settings, &job) {
            Ok(made) => made.mesh,
            Err(e) => {
                println!("{name}: {e}");
                continue;
            }
        };
        let f = metrics(&made, &mesh, &job)?;
        let r = check::report(&made, true, &job)?;
        let size = (r.bounds.max - r.bounds.min).length();
        println!(
            "{name}: {} quads, {} triangles, closed {} -> {}, manifold {}, genus {:?} -> {:?}, \
             regular {:.3}, angles {} to {}, off by {}, distance {:.4} and {:.4} of the \
             diagonal, {:?} crossings",
            f.quads,
            f.triangles,
            before.closed,
            r.closed,
            r.manifold,
            before.genus,
            r.genus,
            f.regular,
            shown(f.least_angle),
            shown(f.greatest_angle),
            shown(f.mean_deviation),
            f.hausdorff[0] / size,
            f.hausdorff[1] / size,
            r.self_intersections,
        );
        if let Some(folder) = std::env::var_os("QUADS_OUT") {
            let stem = Path::new(&name).file_stem().unwrap_or_default();
            write_mesh(&PathBuf::from(folder).join(stem).with_extension("obj"), &made)?;
        }
    }
    Ok(())
}
