//! Files in a real window: the window's own chooser where no desktop has one, a large mesh that is
//! seen while it loads.

use std::time::Instant;

use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;

use super::stage::{Stage, long};

#[test]
fn a_mesh_is_opened_and_exported_where_no_desktop_has_a_dialog() {
    let Some(mut s) = Stage::open(&[]) else { return };
    // The folder of the stage is the person's home.
    let ball = s.dir.path().join("small-ball.obj");
    write_mesh(&ball, &shapes::sphere_of_about(5_000).to_poly()).expect("written");
    let before = s.figure("vertices");
    s.seen("files-1-start");
    s.answer("ctrl+o", "small-ball.obj");
    s.until("it is opened", |s| s.figure("vertices") != before);
    s.seen("files-3-opened");
    s.answer("ctrl+e", "out.stl");
    let out = s.dir.path().join("out.stl");
    s.until("it is written", |_| out.exists());
    // A file that is not there is a message, and nothing else changes.
    let opened = s.figure("vertices");
    s.answer("ctrl+o", "no-such.obj");
    s.seen("files-5-message");
    assert_eq!(s.figure("vertices"), opened);
}

#[test]
#[allow(clippy::disallowed_methods)] // What a person waits for is measured.
fn a_large_mesh_is_seen_while_it_loads() {
    if !long() {
        println!("skipped: SCULPTD_LONG=1 runs it");
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("large.ply");
    // Twice as wide as the ball that a run begins with.
    let mut wide = shapes::sphere_of_about(2_500_000);
    wide.positions.iter_mut().for_each(|p| p.x *= 2.0);
    write_mesh(&path, &wide.to_poly()).expect("written");
    let bytes = std::fs::metadata(&path).expect("a file").len();
    let begun = Instant::now();
    let mesh = path.display().to_string();
    let Some(mut s) = Stage::open(&["--mesh", &mesh]) else { return };
    s.until("something is drawn", |s| s.look("load-1").pixels().any(|p| p.0[0] > 0));
    let first = begun.elapsed();
    // The mesh is seen, and how far it is, before there is clay of it.
    // Beside the ball, within the mesh: clay is red.
    let wide = |s: &mut Stage| s.look("load-2-progress").get_pixel(345, 360).0[0] > 100;
    s.until("the mesh is seen", wide);
    let seen = begun.elapsed();
    assert!(s.figure("vertices") < 2_000_000, "only when there was clay of it:\n{}", s.log());
    s.until("it is loaded", |s| s.figure("vertices") > 2_000_000);
    let loaded = begun.elapsed();
    println!(
        "{bytes} bytes: the window after {first:.1?}, the mesh after {seen:.1?}, the clay after \
         {loaded:.1?}"
    );
    s.log().lines().filter(|l| l.contains("large.ply:")).for_each(|l| println!("{l}"));
    s.look("load-3-clay");
}
