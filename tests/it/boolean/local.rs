//! A tool out of paged clay: as right as the long way, and only the pages around it are written.

use glam::{DMat3, DVec3};
use sculptd_clay::Clay;
use sculptd_clay::local_boolean::local;
use sculptd_devices::Clock;
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, shapes};

use super::random::Dice;

fn placed(mesh: &PolyMesh, scale: f64, turn: DMat3, shift: DVec3) -> PolyMesh {
    let mut out = mesh.clone();
    out.positions.iter_mut().for_each(|p| *p = turn * *p * scale + shift);
    out
}

fn facts(mesh: &PolyMesh) -> check::MeshReport {
    check::report(mesh, false, &Job::default()).expect("not cancelled")
}

#[test]
fn a_tool_out_of_clay_and_onto_it_as_the_long_way_has_it() {
    let job = Job::default();
    let mut clay = Clay::build(&shapes::icosphere(1.0, 40), &job).expect("a sphere");
    let ball = shapes::icosphere(1.0, 8).to_poly();
    let cube = shapes::cuboid(DVec3::splat(-0.7), DVec3::splat(0.7));
    let mut dice = Dice(17);
    let mut elsewhere = 0;
    for n in 0..60 {
        let turn =
            DMat3::from_rotation_z(6.0 * dice.unit()) * DMat3::from_rotation_x(6.0 * dice.unit());
        let on = turn.x_axis * (0.75 + 0.3 * dice.unit());
        let tool =
            placed(if n % 3 == 0 { &cube } else { &ball }, 0.05 + 0.2 * dice.unit(), turn, on);
        let what = if n % 2 == 0 { Operation::Difference } else { Operation::Union };
        let before = clay.snapshot();
        let plain = before.to_tri().to_poly();
        let long = compute([&plain, &tool], &[what], &BooleanOptions::default(), &job, || 0.0)
            .expect("a result")
            .0;
        let cut = local(&before, &tool, what, &BooleanOptions::default(), &job).expect("a result");
        let Some(cut) = cut.filter(|c| c.can_be_made(&before)) else {
            // Nothing was given, so nothing wrong was: the long way it is.
            println!("{n}: not done locally");
            elsewhere += 1;
            clay = Clay::build(&long[0].mesh.triangulate().0, &job).expect("clay");
            continue;
        };
        clay.begin_step();
        let done = clay.graft(&cut).unwrap_or_else(|| panic!("{n}: not made"));
        clay.end_step();
        clay.verify_invariants().unwrap_or_else(|e| panic!("{n}: {e}"));
        // There and back, unless the tool was within the clay or beside it.
        if done.written > 0 {
            let (made, hash) = (clay.vertex_count(), clay.hash());
            assert!(clay.undo());
            clay.verify_invariants().unwrap_or_else(|e| panic!("{n}, taken back: {e}"));
            assert_eq!(clay.hash(), before.hash(), "{n}");
            assert!(clay.redo());
            assert_eq!((clay.vertex_count(), clay.hash()), (made, hash), "{n}");
        }
        let after = clay.snapshot().to_tri().to_poly();
        let (f, want) = (facts(&after), long[0].facts);
        assert!(f.closed && f.oriented, "{n}: {f:?}");
        assert_eq!((f.vertices, f.triangles), (clay.vertex_count(), clay.triangle_count()), "{n}");
        assert_eq!(f.unused_vertices, 0, "{n}");
        // The clay is in single precision.
        let off = (f.volume.unwrap_or(0.0) - want.volume).abs();
        assert!(off < 2e-7, "{n}: volume {:?} instead of {}", f.volume, want.volume);
        assert_eq!(f.components, want.components, "{n}");
    }
    assert!(elsewhere <= 20, "{elsewhere} of 60 were not done locally");
}

#[test]
fn what_is_far_from_the_tool_is_shared_and_costs_nothing() {
    let (job, clock) = (Job::default(), Clock::monotonic());
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let tool = shapes::icosphere(1.0, 10).to_poly();
    for frequency in if long { vec![63, 316, 632] } else { vec![63, 126] } {
        let mut clay = Clay::build(&shapes::icosphere(1.0, frequency), &job).expect("a sphere");
        let triangles = clay.triangle_count();
        // As large as the clay's triangles: the same number of them is cut, whatever the clay.
        let radius = 5.0 / f64::from(frequency);
        let mut times = Vec::new();
        let mut pages = (0, 0);
        for n in 0..9 {
            let turn = DMat3::from_rotation_z(0.3 + 0.61 * f64::from(n));
            let tool = placed(&tool, radius, turn, turn * DVec3::new(0.8, 0.6, 0.02));
            let work = clay.snapshot();
            let start = clock.now_us();
            let cut = local(&work, &tool, Operation::Difference, &BooleanOptions::default(), &job)
                .expect("a result");
            clay.begin_step();
            let done = clay.graft(&cut.expect("done locally")).expect("made");
            clay.end_step();
            times.push((clock.now_us() - start) as f64 * 1e-3);
            let after = clay.snapshot();
            let same = work
                .pages()
                .zip(after.pages())
                .filter(|(a, b)| std::sync::Arc::ptr_eq(a, b))
                .count();
            assert_eq!((done.written + done.shared, same), (after.page_count(), done.shared));
            pages = (done.written, done.shared);
            assert!(clay.undo());
        }
        times.sort_by(f64::total_cmp);
        println!(
            "a tool of 2,000 out of {} triangles: {:.1} ms (least {:.1}); {} pages written, {} \
                shared",
            triangles, times[4], times[0], pages.0, pages.1
        );
        assert!(pages.0 <= 24, "{} pages written", pages.0);
        assert!(pages.1 > 10 * pages.0);
    }
}
