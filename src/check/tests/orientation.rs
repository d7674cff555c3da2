//! The search for an orientation, and answers that do not depend on threads.

mod common;

use common::*;
use glam::DVec3;
use sculptd_check::orientation::{measured, orientations, turn_upright};
use sculptd_check::part::PreparedPart;
use sculptd_check::{CheckProgress, CheckRequest, check_count, check_part};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn parts() -> Vec<PolyMesh> {
    let t = [
        [0.0, 20.0],
        [-15.0, 20.0],
        [-15.0, 16.0],
        [-2.0, 16.0],
        [-2.0, 0.0],
        [2.0, 0.0],
        [2.0, 16.0],
        [15.0, 16.0],
        [15.0, 20.0],
    ];
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.7, 0.4, 0.2);
    vec![
        drawn_out(&t.iter().rev().copied().collect::<Vec<_>>(), 12.0),
        placed(&drawn_out(&t.iter().rev().copied().collect::<Vec<_>>(), 12.0), turn, DVec3::ONE),
        shapes::torus(9.0, 3.0, 40, 20),
        placed(&shapes::cone(8.0, 15.0, 40), turn, DVec3::ZERO),
        frustum(4.0, 12.0, 10.0),
    ]
}

#[test]
fn the_best_orientation_is_never_worse_than_the_axes() {
    let job = Job::default();
    let settings = settings("fdm", DVec3::Z);
    for (n, mesh) in parts().iter().enumerate() {
        let part = PreparedPart::new(mesh, 1.0, &job).expect("prepared");
        let found = orientations(&part, &settings, &job).expect("not cancelled").expect("faces");
        assert!(found.tried >= 1000);
        let best = found.orientations[0];
        for d in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|d| [d, -d]) {
            let axis = measured(&part, &settings, d, &job).expect("run").expect("faces");
            let slack = 1e-6 * part.sizes.dimensions.iter().product::<f64>();
            assert!(best.support_volume <= axis.support_volume + slack, "{n}: {best:?} {axis:?}");
        }
        // Turned upright, the part has what the search says.
        let turn = turn_upright(DVec3::from(best.direction));
        let turned = placed(mesh, turn, DVec3::ZERO);
        let part = PreparedPart::new(&turned, 1.0, &job).expect("prepared");
        let again = measured(&part, &settings, DVec3::Z, &job).expect("run").expect("faces");
        assert!((again.height - best.height).abs() < 1e-3 * best.height);
        let (a, b) = (again.support_volume, best.support_volume);
        assert!((a - b).abs() < 0.02 * b + 0.5, "{n}: {a} {b}");
    }
}

#[test]
fn a_t_is_laid_down_and_a_tilted_cone_stands_on_its_base() {
    let job = Job::default();
    let settings = settings("fdm", DVec3::Z);
    let best = |mesh: &PolyMesh| {
        let part = PreparedPart::new(mesh, 1.0, &job).expect("prepared");
        orientations(&part, &settings, &job).expect("not cancelled").expect("faces")
    };
    let all = parts();
    let t = best(&all[0]);
    assert!(t.orientations[0].support_volume == 0.0 && !t.reasons.is_empty(), "{t:#?}");
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.7, 0.4, 0.2);
    let cone = best(&all[3]);
    let d = DVec3::from(cone.orientations[0].direction);
    assert!(d.dot(turn * DVec3::Z) > 0.999, "{cone:#?}");
    // Already as good as it gets.
    let wide = best(&frustum(12.0, 4.0, 10.0));
    assert!(wide.reasons.is_empty() && wide.orientations[0].direction == [0.0, 0.0, 1.0]);
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let mesh = &parts()[1];
    let answer = |threads: usize, process: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let settings = settings(process, DVec3::Z);
            let request = CheckRequest { orient: true, ..Default::default() };
            let job = Job::default();
            let done = check_part("p", mesh, 1.0, &settings, request, &job, || 0.0);
            serde_json::to_string(&done.expect("not cancelled").answer).expect("JSON")
        })
    };
    for process in ["fdm", "sla", "moulding"] {
        let one = answer(1, process);
        assert_eq!(one, answer(2, process));
        assert_eq!(one, answer(5, process));
    }
}

#[test]
fn a_cancelled_job_gives_no_answer() {
    let job = Job::default();
    job.cancel();
    let settings = settings("fdm", DVec3::Z);
    let request = CheckRequest { orient: true, ..Default::default() };
    assert!(check_part("p", &parts()[0], 1.0, &settings, request, &job, || 0.0).is_err());
}

#[test]
fn every_check_is_counted_once() {
    for process in ["fdm", "sla", "sls", "moulding"] {
        let settings = settings(process, DVec3::Z);
        for orient in [false, true] {
            let all = check_count(&settings, orient);
            let progress = CheckProgress::new(all);
            let request = CheckRequest { orient, progress: Some(&progress) };
            let job = Job::default();
            let done = check_part("p", &parts()[0], 1.0, &settings, request, &job, || 0.0);
            assert_eq!(done.expect("not cancelled").answer.checks.len(), all, "{process}");
            assert_eq!(progress.count(), (all, all), "{process}");
        }
    }
}
