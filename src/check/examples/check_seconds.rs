//! Times the checks of a lumpy ball.
//!
//! cargo run --release -p sculptd-check --example check_seconds -- 1000000 config
//!
//! The first argument is the number of triangles, the second the folder of the presets, which has
//! `check` and `thickness` in it. Processes after these replace the list of all four with and
//! without a search for the orientation.
#![allow(clippy::disallowed_methods, clippy::print_stdout)] // It measures, and prints.

use std::time::Instant;

use glam::DVec3;
use sculptd_check::preset::CheckPreset;
use sculptd_check::{CheckRequest, CheckSettings, PresetLibrary, check_part};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::sphere_of_about;
use sculptd_geometry::thickness::preset::Preset;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let triangles: usize = arguments.next().unwrap_or_else(|| "131000".into()).parse()?;
    let config = arguments.next().unwrap_or_else(|| "config".into());
    let mut library = PresetLibrary::default();
    for entry in std::fs::read_dir(format!("{config}/check"))? {
        let path = entry?.path();
        let name = path.display().to_string();
        library.checks.push(CheckPreset::read(&name, &std::fs::read_to_string(&path)?)?);
    }
    for entry in std::fs::read_dir(format!("{config}/thickness"))? {
        let path = entry?.path();
        let name = path.display().to_string();
        library.walls.push(Preset::read(&name, &std::fs::read_to_string(&path)?)?);
    }
    let mut mesh = sphere_of_about(triangles / 2).to_poly();
    for p in &mut mesh.positions {
        let bump = (p.x * 7.0).sin() * (p.y * 6.0).cos() * (p.z * 5.0).sin();
        *p *= 40.0 * (1.0 + 0.2 * bump);
    }
    println!("{} triangles", mesh.face_count());
    let (job, clock) = (Job::default(), Instant::now());
    let named: Vec<String> = arguments.collect();
    let all = ["fdm", "sla", "sls", "moulding"].map(String::from).to_vec();
    for process in if named.is_empty() { &all } else { &named } {
        for &orient in if named.is_empty() { &[false, true][..] } else { &[false] } {
            let process = library.process(process)?;
            let settings = CheckSettings::new(&library, process, None, None, DVec3::Z)?;
            let seconds = || clock.elapsed().as_secs_f64();
            let request = CheckRequest { orient, ..Default::default() };
            let done = check_part("ball", &mesh, 1.0, &settings, request, &job, seconds)?;
            let a = done.answer;
            println!("{}: {:.3} s, {} findings", a.process, a.seconds, a.findings.len());
            for c in &a.checks {
                println!("    {:14} {:.3} s", c.name, c.seconds);
            }
        }
    }
    Ok(())
}
