//! Booleans one after another by the library alone, for `chain.py`, which makes the operands and
//! compares.
//!
//! `chain FILE [one-by-one]` reads a list of triangle meshes: for each a byte (`+` union, `-`
//! difference, `&` intersection), the numbers of vertices and triangles as 64 bits, the vertices
//! as doubles and the corners as 32 bits, little-endian. The first mesh is the part. Then for each
//! line of standard input it runs the chain and prints one line of JSON. `one-by-one`: each step as
//! a Boolean of its own.

#![allow(clippy::print_stdout)] // What `chain.py` reads.

use std::io::{BufRead, Read};
use std::process::ExitCode;
use std::time::Instant;

use glam::DVec3;
use sculptd_geometry::boolean::{BooleanChain, BooleanOptions, Operation, compute};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check};

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("{e}");
            ExitCode::FAILURE
        }
    }
}

/// The operands of a file, and how each is joined with those before it.
fn operands(file: &str) -> Result<Vec<(Operation, PolyMesh)>, Failure> {
    let bytes = std::fs::read(file)?;
    let mut rest = &bytes[..];
    let mut out = Vec::new();
    while !rest.is_empty() {
        let mut take = |n: usize| -> Result<Vec<u8>, Failure> {
            let mut part = vec![0; n];
            rest.read_exact(&mut part)?;
            Ok(part)
        };
        let operation = match take(1)?[0] {
            b'+' => Operation::Union,
            b'&' => Operation::Intersection,
            _ => Operation::Difference,
        };
        let mut count = || -> Result<usize, Failure> {
            Ok(u64::from_le_bytes(take(8)?.try_into().unwrap_or_default()) as usize)
        };
        let (vertices, triangles) = (count()?, count()?);
        let number = |c: &[u8; 8]| f64::from_le_bytes(*c);
        let values: Vec<f64> = take(24 * vertices)?.as_chunks::<8>().0.iter().map(number).collect();
        let corner = |c: &[u8; 4]| u32::from_le_bytes(*c);
        let corners: Vec<u32> =
            take(12 * triangles)?.as_chunks::<4>().0.iter().map(corner).collect();
        let mesh = PolyMesh {
            positions: values.chunks_exact(3).map(DVec3::from_slice).collect(),
            face_starts: (0..=triangles as u32).map(|i| 3 * i).collect(),
            corners,
            ..PolyMesh::new()
        };
        out.push((operation, mesh));
    }
    Ok(out)
}

#[expect(clippy::disallowed_methods, reason = "a bench of a crate that knows no clock")]
fn run() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else { return Err("expected a file".into()) };
    let one_by_one = arguments.next().is_some_and(|a| a == "one-by-one");
    let (job, options) = (Job::default(), BooleanOptions::default());
    let operands = operands(&file)?;
    let Some(((_, part), tools)) = operands.split_first() else { return Err("no part".into()) };
    println!("{{\"triangles\":{}}}", operands.iter().map(|o| o.1.face_count()).sum::<usize>());
    let started = Instant::now();
    let now = || started.elapsed().as_secs_f64();
    for line in std::io::stdin().lock().lines() {
        // The look at the result for crossings, as a line of its own.
        let look = line? == "look";
        let begun = now();
        let (mesh, facts, phases, local) = if one_by_one {
            let (mut mesh, mut facts) = (part.clone(), None);
            let mut phases = Vec::new();
            for (operation, tool) in tools {
                let (made, report) = compute([&mesh, tool], &[*operation], &options, &job, now)?;
                phases.extend(report.phases);
                for solid in made {
                    (mesh, facts) = (solid.mesh, Some(solid.facts));
                }
            }
            (mesh, facts, phases, 0)
        } else {
            let mut chain = BooleanChain::new(part, tools.len(), options);
            for (operation, tool) in tools {
                chain.step(*operation, tool, None, &job, now)?;
            }
            let local = chain.local_steps();
            let (solid, report) = chain.finish(&job)?;
            (solid.mesh, Some(solid.facts), report.phases, local)
        };
        let seconds = now() - begun;
        let Some(facts) = facts else { return Err("no tool".into()) };
        let crossings = if look {
            let found = check::report(&mesh, true, &job)?;
            format!(",\"crossings\":{}", found.self_intersections.unwrap_or(0))
        } else {
            String::new()
        };
        let mut sums: Vec<(&str, f64)> = Vec::new();
        for (name, seconds) in phases {
            match sums.iter_mut().find(|s| s.0 == name) {
                Some(sum) => sum.1 += seconds,
                None => sums.push((name, seconds)),
            }
        }
        let sums: Vec<String> = sums.iter().map(|s| format!("\"{}\":{:.5}", s.0, s.1)).collect();
        println!(
            "{{\"seconds\":{seconds},\"triangles\":{},\"volume\":{:?},\"area\":{:?},\
             \"components\":{},\"closed\":{},\"local\":{local},\"phases\":{{{}}}{crossings}}}",
            mesh.face_count(),
            facts.volume,
            facts.area,
            facts.components,
            facts.closed && facts.manifold,
            sums.join(",")
        );
    }
    Ok(())
}
