//! The parts of a dab, each by itself: `cargo bench --bench clay`.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use sculptd_clay::brush::{GaussianBrush, SmoothBrush};
use sculptd_clay::{Clay, Ray, Reach, Workers};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

const VERTICES: usize = 1_000_000;

fn ball() -> Clay {
    Clay::build(&shapes::sphere_of_about(VERTICES), &Job::default()).expect("a ball builds")
}

/// The radius of a cap of `k` of the ball's vertices.
fn radius(k: usize) -> f32 {
    2.0 * (k as f32 / VERTICES as f32).sqrt()
}

fn dabs(c: &mut Criterion) {
    let mut mesh = ball();
    for workers in [1, 2] {
        let workers = Workers::new(workers);
        for k in [1_000, 10_000, 100_000] {
            let r = radius(k);
            let reach = Reach::Sphere { centre: Vec3::Z, radius: r };
            let mut sign = 1.0;
            c.bench_function(&format!("gaussian {k}, {} workers", workers.count()), |b| {
                b.iter(|| {
                    sign = -sign;
                    mesh.dab(
                        &reach,
                        &GaussianBrush::new(Vec3::Z, r, Vec3::Z, 0.02 * r * sign),
                        &workers,
                    )
                });
            });
            c.bench_function(&format!("smooth {k}, {} workers", workers.count()), |b| {
                b.iter(|| mesh.dab(&reach, &SmoothBrush::new(Vec3::Z, r, 0.5), &workers));
            });
        }
    }
}

fn reads(c: &mut Criterion) {
    let mut mesh = ball();
    let mut turn = 0.0f32;
    c.bench_function("pick", |b| {
        b.iter(|| {
            turn += 0.1;
            let d = Vec3::new(turn.cos(), turn.sin() * 0.7, 0.3).normalize();
            mesh.pick(Ray { origin: d * 3.0, dir: -d })
        });
    });
    let r = radius(10_000);
    let workers = Workers::new(1);
    c.bench_function("dab of 10,000 and snapshot", |b| {
        b.iter(|| {
            mesh.dab(
                &Reach::Sphere { centre: Vec3::Z, radius: r },
                &SmoothBrush::new(Vec3::Z, r, 0.5),
                &workers,
            );
            mesh.snapshot()
        });
    });
}

criterion_group! {
    name = clay;
    config = Criterion::default()
        .sample_size(20)
        .measurement_time(std::time::Duration::from_secs(2));
    targets = dabs, reads
}
criterion_main!(clay);
