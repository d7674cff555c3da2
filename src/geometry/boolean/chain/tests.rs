//! Chains against formulas, and against each step as a Boolean of its own.

use glam::{DMat3, DVec3};

use super::*;
use crate::boolean::ResultFaces;
use crate::check;
use crate::shapes::{cuboid, cylinder, icosphere, torus};

/// A sequence of numbers from 0 to 1.
struct SeededNumbers(u64);

impl SeededNumbers {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    fn place(&mut self, reach: f64) -> DVec3 {
        DVec3::from([(); 3].map(|()| self.within(-reach, reach)))
    }

    fn turn(&mut self) -> DMat3 {
        let axis = self.place(1.0).normalize_or(DVec3::Z);
        DMat3::from_axis_angle(axis, self.within(0.1, 3.0))
    }
}

fn placed(mut mesh: PolyMesh, turn: DMat3, shift: DVec3) -> PolyMesh {
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p + shift);
    mesh
}

/// A solid of random kind and place.
fn solid(random: &mut SeededNumbers, size: f64) -> PolyMesh {
    let mesh = match (random.unit() * 4.0) as u32 {
        0 => cuboid(DVec3::splat(-0.7 * size), DVec3::new(0.6, 0.8, 0.9) * size),
        1 => cylinder(0.6 * size, 2.5 * size, 5 + (random.unit() * 20.0) as u32),
        2 => torus(size, 0.4 * size, 16, 9),
        _ => icosphere(1.0, 2 + (random.unit() * 5.0) as u32).to_poly(),
    };
    let scale = if mesh.face_count() % 20 == 0 { size } else { 1.0 };
    placed(mesh, random.turn() * scale, random.place(1.3))
}

type Step = (Operation, PolyMesh);

/// The chain, and how many of its steps were local.
fn chained(first: &PolyMesh, steps: &[Step], options: BooleanOptions) -> (ChainSolid, usize) {
    let job = Job::default();
    let mut chain = BooleanChain::new(first, steps.len(), options);
    for (n, (operation, tool)) in steps.iter().enumerate() {
        let made = chain.step(*operation, tool, None, &job, || 0.0);
        made.unwrap_or_else(|e| panic!("step {n}: {e}"));
    }
    let local = chain.local_steps();
    (chain.finish(&job).expect("a solid").0, local)
}

/// Each step as a Boolean of its own, and the most pairs of triangles that cross after one.
fn one_by_one(
    first: &PolyMesh,
    steps: &[Step],
    options: BooleanOptions,
) -> (PolyMesh, Option<usize>) {
    let (mut mesh, mut crossed) = (first.clone(), None);
    for (n, (operation, tool)) in steps.iter().enumerate() {
        let made = compute([&mesh, tool], &[*operation], &options, &Job::default(), || 0.0);
        let (made, _) = made.unwrap_or_else(|e| panic!("step {n}: {e}"));
        mesh = made.into_iter().next().expect("a result").mesh;
        let facts = check::report(&mesh, true, &Job::default()).expect("a report");
        crossed = crossed.max(facts.self_intersections);
    }
    (mesh, crossed)
}

/// Checks that a result is a closed manifold with no more than `crossed` pairs of triangles that
/// cross, that its facts are its own, and that each face is in the plane of the face that it came
/// from.
fn sound(made: &ChainSolid, first: &PolyMesh, steps: &[Step], crossed: usize, what: &str) {
    let facts = check::report(&made.mesh, true, &Job::default()).expect("a report");
    assert!(made.facts.closed && made.facts.manifold, "{what}: {:?}", made.facts);
    if made.mesh.face_count() > 0 {
        assert!(facts.closed && facts.manifold, "{what}: {facts:?}");
    }
    assert!(facts.self_intersections <= Some(crossed), "{what}: {facts:?}");
    assert_eq!(facts.components, made.facts.components, "{what}");
    assert_eq!(made.origins.len(), made.mesh.face_count(), "{what}");
    for (face, origin) in made.mesh.faces().zip(&made.origins) {
        let source = match origin.operand {
            0 => first,
            n => &steps[n as usize - 1].1,
        };
        let from = source.face(origin.face as usize);
        let normal = crate::triangulate::area_vector(&source.positions, from).normalize();
        let foot = source.positions[from[0] as usize];
        let off = |v: &u32| (made.mesh.positions[*v as usize] - foot).dot(normal).abs();
        assert!(face.iter().map(off).fold(0.0, f64::max) < 1e-5, "{what}: {origin:?}");
    }
}

fn volume(mesh: &PolyMesh) -> f64 {
    emit::measure(mesh).0
}

#[test]
fn random_chains_are_what_single_steps_make() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let (mut local, mut all) = (0, 0);
    for seed in 0..if long { 400 } else { 24 } {
        let mut random = SeededNumbers(seed * 77 + 5);
        let first = solid(&mut random, 1.4);
        let steps: Vec<Step> = (0..8)
            .map(|_| {
                let operation = match (random.unit() * 8.0) as u32 {
                    0..=3 => Operation::Difference,
                    4..=6 => Operation::Union,
                    _ => Operation::Intersection,
                };
                let size = if operation == Operation::Intersection { 1.5 } else { 0.5 };
                (operation, solid(&mut random, size))
            })
            .collect();
        let faces = match seed % 3 {
            0 => ResultFaces::AsOperands,
            1 => ResultFaces::Triangles,
            _ => ResultFaces::ConvexPolygons,
        };
        let options = BooleanOptions { faces, ..BooleanOptions::default() };
        let (made, steps_local) = chained(&first, &steps, options);
        let (other, crossed) = one_by_one(&first, &steps, options);
        // Polygons of more corners than three are bent by rounding, so that their triangles may
        // cross, in single steps too.
        let crossed = crossed.filter(|_| faces == ResultFaces::ConvexPolygons).unwrap_or(0);
        sound(&made, &first, &steps, crossed, &format!("seed {seed}"));
        let (own, want) = (made.facts.volume, volume(&other));
        assert!((own - want).abs() <= 1e-9 * want.max(1.0), "seed {seed}: {own} for {want}");
        if faces == ResultFaces::Triangles {
            assert!(made.mesh.faces().all(|f| f.len() == 3), "seed {seed}");
        }
        local += steps_local;
        all += steps.iter().filter(|s| s.0 != Operation::Intersection).count();
    }
    println!("{local} of {all} unions and differences were local");
    assert!(local * 20 > all * 19, "{local} of {all}");
}

#[test]
fn cubes_that_touch_become_one_and_nothing_again() {
    let cubes: Vec<PolyMesh> = (0..27)
        .map(|i| {
            let low = DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64);
            cuboid(low, low + 1.0)
        })
        .collect();
    let turns = [DMat3::IDENTITY, SeededNumbers(3).turn()];
    for turn in turns {
        let cubes: Vec<PolyMesh> =
            cubes.iter().map(|c| placed(c.clone(), turn, DVec3::ZERO)).collect();
        let mut steps: Vec<Step> =
            cubes[1..].iter().map(|c| (Operation::Union, c.clone())).collect();
        let (made, local) = chained(&cubes[0], &steps, BooleanOptions::default());
        assert!((made.facts.volume - 27.0).abs() < 1e-11, "{}", made.facts.volume);
        assert!((made.facts.area - 54.0).abs() < 1e-11, "{}", made.facts.area);
        assert_eq!(made.facts.components, 1);
        assert_eq!(local, 26);
        // Away again, in another order, but for the first; then that too.
        let away = (1..27).map(|i| i * 7 % 27).chain([0]);
        steps.extend(away.map(|i| (Operation::Difference, cubes[i].clone())));
        let (made, _) = chained(&cubes[0], &steps[..steps.len() - 1], BooleanOptions::default());
        assert!((made.facts.volume - 1.0).abs() < 1e-11, "{}", made.facts.volume);
        let (made, _) = chained(&cubes[0], &steps, BooleanOptions::default());
        assert_eq!((made.mesh.face_count(), made.facts.volume), (0, 0.0));
    }
}

#[test]
fn a_tool_inside_makes_a_cavity_and_one_outside_a_second_shell() {
    let first = cuboid(DVec3::ZERO, DVec3::splat(10.0));
    let small = |at: f64| cuboid(DVec3::splat(at), DVec3::splat(at + 1.0));
    let steps = [
        (Operation::Difference, small(2.0)),
        (Operation::Union, small(20.0)),
        (Operation::Difference, small(30.0)),
        (Operation::Union, small(5.0)),
        (Operation::Difference, small(7.0)),
        // The cavity again, and all of the second shell.
        (Operation::Union, small(2.0)),
        (Operation::Difference, cuboid(DVec3::splat(19.0), DVec3::splat(22.0))),
    ];
    let volumes = [1000.0, 999.0, 1000.0, 1000.0, 1000.0, 999.0, 1000.0, 999.0];
    let shells = [1, 2, 3, 3, 3, 4, 3, 2];
    for n in 1..=steps.len() {
        let (made, _) = chained(&first, &steps[..n], BooleanOptions::default());
        assert_eq!((made.facts.volume, made.facts.components), (volumes[n], shells[n]), "{n}");
        sound(&made, &first, &steps, 0, &format!("{n} steps"));
    }
}

#[test]
fn a_part_that_comes_apart_at_an_edge_or_a_corner_stays_a_manifold() {
    // Two blocks are left that have an edge in common, then two that have a corner.
    let block = |lo: [f64; 3], hi: [f64; 3]| cuboid(DVec3::from(lo), DVec3::from(hi));
    let first = block([0.0; 3], [2.0, 2.0, 2.0]);
    let steps = [
        (Operation::Difference, block([1., -1., -1.], [3., 1., 3.])),
        (Operation::Difference, block([-1., 1., -1.], [1., 3., 3.])),
        (Operation::Difference, block([-1., -1., -1.], [1., 1., 1.])),
        (Operation::Difference, block([1., 1., 1.], [3., 3., 3.])),
    ];
    let (made, local) = chained(&first, &steps[..2], BooleanOptions::default());
    assert_eq!((made.facts.volume, made.facts.components), (4.0, 2));
    sound(&made, &first, &steps, 0, "an edge");
    assert_eq!(local, 2);
    let (made, _) = chained(&first, &steps, BooleanOptions::default());
    assert_eq!((made.facts.volume, made.facts.components), (2.0, 2));
    sound(&made, &first, &steps, 0, "a corner");
}

#[test]
fn colours_groups_and_their_names_are_those_of_single_steps() {
    let mut first = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    first.colours = Some(first.positions.iter().map(|p| [(p.x * 60.0) as u8, 9, 0, 255]).collect());
    first.groups = Some((0..6).collect());
    let tool = |n: u32| {
        let low = DVec3::new(f64::from(n) + 0.25, 1.0, -1.0);
        let mut mesh = cuboid(low, low + DVec3::new(0.5, 1.0, 7.0));
        mesh.groups = Some(vec![n; 6]);
        mesh
    };
    let steps: Vec<Step> = (0..3).map(|n| (Operation::Difference, tool(n))).collect();
    let (made, local) = chained(&first, &steps, BooleanOptions::default());
    assert_eq!(local, 3);
    let (other, _) = one_by_one(&first, &steps, BooleanOptions::default());
    // Faces and vertices may come in another order.
    let key = |m: &PolyMesh| {
        let (colours, groups) =
            (m.colours.as_ref().expect("some"), m.groups.as_ref().expect("some"));
        let mut at: Vec<([u64; 3], [u8; 4])> = m
            .positions
            .iter()
            .map(|p| p.to_array().map(f64::to_bits))
            .zip(colours.iter().copied())
            .collect();
        at.sort_unstable();
        let mut groups = groups.clone();
        groups.sort_unstable();
        (at, groups)
    };
    assert_eq!(key(&made.mesh), key(&other));
}

#[test]
fn the_bits_are_the_same_with_any_number_of_workers() {
    let mut random = SeededNumbers(11);
    let first = icosphere(1.0, 20).to_poly();
    let steps: Vec<Step> =
        (0..12).map(|_| (Operation::Difference, solid(&mut random, 0.3))).collect();
    let made: Vec<ChainSolid> = [1, 2, 3, 7, 16]
        .into_iter()
        .map(|workers| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(workers).build().expect("one");
            pool.install(|| chained(&first, &steps, BooleanOptions::default()).0)
        })
        .collect();
    let bits = |m: &PolyMesh| -> Vec<u64> {
        m.positions.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect()
    };
    for other in &made[1..] {
        assert_eq!(bits(&other.mesh), bits(&made[0].mesh));
        assert_eq!(other.mesh.corners, made[0].mesh.corners);
        assert_eq!(other.origins, made[0].origins);
        assert_eq!(other.facts, made[0].facts);
    }
}

#[test]
fn a_part_or_a_tool_that_crosses_itself_is_solved_as_in_single_steps() {
    let balls = |far: f64| {
        let mut mesh = icosphere(1.0, 5).to_poly();
        let first = mesh.positions.len() as u32;
        let other = mesh.clone();
        mesh.positions.extend(other.positions.iter().map(|p| *p + DVec3::new(far, 0.3, 0.1)));
        other.faces().for_each(|f| mesh.push_face(&[f[0] + first, f[1] + first, f[2] + first]));
        mesh
    };
    let tool = placed(balls(0.5), DMat3::IDENTITY * 0.3, DVec3::new(0.9, 0.1, 0.0));
    let block = cuboid(DVec3::new(-0.5, 0.2, -2.0), DVec3::new(0.4, 0.6, 2.0));
    for first in [balls(0.7), icosphere(1.0, 6).to_poly()] {
        let steps = [
            (Operation::Difference, block.clone()),
            (Operation::Difference, tool.clone()),
            (Operation::Union, placed(block.clone(), DMat3::from_rotation_x(1.0), DVec3::X)),
        ];
        let (made, _) = chained(&first, &steps, BooleanOptions::default());
        let want = volume(&one_by_one(&first, &steps, BooleanOptions::default()).0);
        assert!((made.facts.volume - want).abs() < 1e-9, "{} for {want}", made.facts.volume);
        let facts = check::report(&made.mesh, true, &Job::default()).expect("a report");
        assert_eq!((facts.closed, facts.self_intersections), (true, Some(0)));
    }
}

#[test]
fn errors_name_the_operand_and_leave_the_chain_as_it_was() {
    let job = Job::default();
    let first = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    let mut open = cuboid(DVec3::splat(1.0), DVec3::splat(2.0));
    open.face_starts.pop();
    open.corners.truncate(20);
    let mut chain = BooleanChain::new(&first, 3, BooleanOptions::default());
    let drill = cuboid(DVec3::new(1.0, 1.0, -1.0), DVec3::new(2.0, 2.0, 5.0));
    chain.step(Operation::Difference, &drill, None, &job, || 0.0).expect("a step");
    let failed = chain.step(Operation::Difference, &open, None, &job, || 0.0).expect_err("open");
    assert_eq!(failed, BooleanError::Open { operand: "B", edges: 4 });
    let (made, _) = chain.finish(&job).expect("a solid");
    assert!((made.facts.volume - 60.0).abs() < 1e-12);
    let mut chain = BooleanChain::new(&open, 3, BooleanOptions::default());
    let failed = chain.step(Operation::Difference, &drill, None, &job, || 0.0).expect_err("open");
    assert_eq!(failed, BooleanError::Open { operand: "A", edges: 4 });
}

#[test]
fn every_state_stays_readable() {
    let job = Job::default();
    let first = icosphere(1.0, 6).to_poly();
    let begun = SolidState::new(&first, BooleanOptions::default(), &job);
    let mut states = vec![begun.expect("a solid").expect("clean")];
    let mut random = SeededNumbers(29);
    let steps: Vec<Step> =
        (0..6).map(|_| (Operation::Difference, solid(&mut random, 0.3))).collect();
    for (operation, tool) in &steps {
        let last = states.last().expect("one");
        let (next, _) = last.step(*operation, tool, &job).expect("a step").expect("local");
        states.push(next);
    }
    for (n, state) in states.iter().enumerate() {
        let want = match n {
            0 => first.clone(),
            n => chained(&first, &steps[..n], BooleanOptions::default()).0.mesh,
        };
        let off = (volume(&state.mesh()) - volume(&want)).abs();
        assert!(off < 1e-12, "{n}: off by {off:e}");
        let facts = check::report(&state.mesh(), true, &job).expect("a report");
        assert!(facts.closed && facts.self_intersections == Some(0), "{n}: {facts:?}");
    }
    // Only the last goes on; an earlier one needs the whole.
    assert!(states[2].step(Operation::Union, &first, &job).expect("runs").is_none());
}

#[test]
fn one_step_is_the_single_boolean() {
    let (a, b) = (icosphere(1.0, 8).to_poly(), cuboid(DVec3::splat(0.2), DVec3::splat(2.0)));
    for operation in Operation::ALL {
        let options = BooleanOptions::default();
        let (made, _) = chained(&a, &[(operation, b.clone())], options);
        let (want, _) = one_by_one(&a, &[(operation, b.clone())], options);
        assert_eq!(made.mesh, want);
    }
}
