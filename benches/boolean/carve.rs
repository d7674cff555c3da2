//! A tool out of clay of several sizes, the clay's pages and trees as they stand: `cargo run
//! --release --example carve`.
//!
//! Median and least wall time of a difference and a union until the clay is cut, the part of it
//! that the tick waits for, the pages that were written and shared, and the ratio of the largest
//! clay to the smallest. The tool has 2,000 triangles and is as large as ten of the clay's, so that
//! the same number of them is cut in any clay. `--hold N`: only N of each out of 2 million, for a
//! profiler.

#![allow(clippy::print_stdout)] // Its table.

use glam::{DMat3, DVec3};
use sculptd_clay::Clay;
use sculptd_clay::local_boolean::local;
use sculptd_devices::Clock;
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, shapes};

fn placed(tool: &PolyMesh, n: u32, radius: f64) -> PolyMesh {
    let turn = DMat3::from_rotation_z(0.3 + 0.61 * f64::from(n))
        * DMat3::from_rotation_x(0.2 * f64::from(n));
    let on = turn * DVec3::new(0.8, 0.6, 0.02).normalize();
    let mut out = tool.clone();
    out.positions.iter_mut().for_each(|p| *p = turn * *p * radius + on);
    out
}

fn main() {
    let hold: Option<u32> =
        std::env::args().skip_while(|a| a != "--hold").nth(1).and_then(|n| n.parse().ok());
    let (job, clock) = (Job::default(), Clock::monotonic());
    let tool = shapes::icosphere(1.0, 10).to_poly();
    let mut medians: Vec<f64> = Vec::new();
    println!(
        "{:>10} {:>6} {:>9} {:>9} {:>8} {:>8} {:>8}",
        "triangles", "", "median ms", "least ms", "tick ms", "written", "shared"
    );
    for frequency in if hold.is_some() { vec![316] } else { vec![63, 316, 632] } {
        let mut clay = match Clay::build(&shapes::icosphere(1.0, frequency), &job) {
            Ok(clay) => clay,
            Err(e) => return eprintln!("no clay: {e}"),
        };
        let work = clay.snapshot();
        let radius = 5.0 / f64::from(frequency);
        for operation in [Operation::Difference, Operation::Union] {
            let (mut times, mut ticks, mut pages) = (Vec::new(), Vec::new(), (0, 0));
            for n in 0..hold.unwrap_or(21) {
                let tool = placed(&tool, n, radius);
                let start = clock.now_us();
                let cut = local(&work, &tool, operation, &BooleanOptions::default(), &job);
                let computed = clock.now_us();
                clay.begin_step();
                let done = cut.ok().flatten().and_then(|c| clay.graft(&c));
                clay.end_step();
                let made = clock.now_us();
                times.push((made - start) as f64 * 1e-3);
                ticks.push((made - computed) as f64 * 1e-3);
                match done {
                    Some(done) => pages = (done.written, done.shared),
                    None => eprintln!("{n}: not done locally"),
                }
                clay.undo();
            }
            times.sort_by(f64::total_cmp);
            ticks.sort_by(f64::total_cmp);
            let median = times[times.len() / 2];
            if operation == Operation::Difference {
                medians.push(median);
            }
            println!(
                "{:>10} {:>6} {median:>9.2} {:>9.2} {:>8.2} {:>8} {:>8}",
                work.triangle_count(),
                &operation.name()[..5],
                times[0],
                ticks[ticks.len() / 2],
                pages.0,
                pages.1
            );
        }
    }
    if let [first, .., last] = medians[..] {
        println!("largest to smallest clay, difference: {:.2}", last / first);
    }
}
