use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::{
    ExtractError, FaceSetPart, HIDDEN, Partition, SetsEdit, SetsError, extract, partition,
};
use crate::brush::mask_all::MaskAll;
use crate::brush::{GaussianBrush, MaskAction};
use crate::local_boolean::local;
use crate::page::Page;
use crate::{Clay, Detail, Ray, Reach, Workers};
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::shapes::{cuboid, icosphere};
use sculptd_geometry::thickness::refine::refine;
use sculptd_geometry::{PolyMesh, TriMesh, job::Job};

fn of(plain: &TriMesh) -> Clay {
    Clay::build(plain, &Job::default()).expect("clay")
}

/// A ball whose vertices above a height are masked.
fn ball(above: f32) -> Clay {
    let plain = icosphere(1.0, 30);
    let masks: Vec<f32> = plain.positions.iter().map(|p| f32::from(p.z > above)).collect();
    Clay::build_masked(&plain, &masks, &Job::default()).expect("clay")
}

fn edit(clay: &mut Clay, edit: &SetsEdit) -> Result<u16, SetsError> {
    let (before, steps) = (clay.hash(), clay.undo_steps());
    clay.begin_step();
    let made = clay.edit_sets(edit);
    clay.end_step();
    assert_eq!(clay.verify_invariants(), Ok(()), "after {edit:?}");
    match made {
        Ok(_) => {
            let after = clay.hash();
            assert_ne!(after, before, "{edit:?} changes the object");
            assert!(clay.undo() && clay.hash() == before, "undo of {edit:?}");
            assert!(clay.redo() && clay.hash() == after, "redo of {edit:?}");
        }
        Err(_) => assert_eq!((clay.hash(), clay.undo_steps()), (before, steps)),
    }
    assert_eq!(clay.verify_invariants(), Ok(()), "after undo of {edit:?}");
    made
}

fn down() -> Ray {
    Ray { origin: Vec3::Z * 3.0, dir: -Vec3::Z }
}

#[test]
fn a_set_of_what_is_masked_is_hidden_isolated_shown_and_undone() {
    let mut clay = ball(0.5);
    let vertices = clay.vertex_count() as u64;
    let (start, weight) = (clay.hash(), clay.weight());
    assert_eq!(edit(&mut clay, &SetsEdit::Hide(1)), Err(SetsError::NoSet(1)));
    assert_eq!(edit(&mut clay, &SetsEdit::ShowAll), Err(SetsError::Nothing));
    assert!(clay.weight() == weight && !clay.has_sets(), "an object without sets has none");

    assert_eq!(edit(&mut clay, &SetsEdit::FromMask), Ok(1));
    let sets = clay.snapshot().face_sets();
    let cap = sets[1].1;
    assert!(sets == [(0, vertices - cap, 0), (1, cap, 0)] && cap > vertices / 5, "{sets:?}");
    assert_eq!(clay.pick(down()).map(|hit| clay.set_at(&hit)), Some(1));

    // The ray does not hit the hidden part: it meets the far side from within.
    assert_eq!(edit(&mut clay, &SetsEdit::Hide(1)), Ok(1));
    assert_eq!(clay.snapshot().face_sets()[1], (1, cap, cap));
    for hit in [clay.pick(down()), clay.snapshot().pick(down())] {
        let hit = hit.expect("the bottom");
        assert!((hit.t - 4.0).abs() < 0.01 && clay.set_at(&hit) == 0);
    }
    assert_eq!(edit(&mut clay, &SetsEdit::Invert), Ok(0));
    assert!(clay.pick(down()).is_some_and(|hit| (hit.t - 2.0).abs() < 0.01));
    assert_eq!(clay.snapshot().face_sets()[0], (0, vertices - cap, vertices - cap));
    assert_eq!(edit(&mut clay, &SetsEdit::Isolate(1)), Err(SetsError::Nothing));
    assert_eq!(edit(&mut clay, &SetsEdit::Isolate(0)), Ok(0));
    // Only what is shown becomes a set, and the hidden one keeps its number.
    assert_eq!(edit(&mut clay, &SetsEdit::FromVisible), Ok(2));
    assert_eq!(edit(&mut clay, &SetsEdit::ShowAll), Ok(0));
    assert_eq!(clay.snapshot().face_sets(), [(1, cap, 0), (2, vertices - cap, 0)]);
    assert_eq!(edit(&mut clay, &SetsEdit::HideMasked), Ok(0));
    assert_eq!(edit(&mut clay, &SetsEdit::Clear), Ok(0));
    assert_eq!(clay.snapshot().face_sets(), [(0, vertices, cap)]);
    assert_eq!(edit(&mut clay, &SetsEdit::ShowAll), Ok(0));
    assert!(!clay.has_sets() && clay.weight() == weight, "nothing is left of them");
    while clay.undo() {}
    assert_eq!(clay.hash(), start);
}

#[test]
fn what_is_hidden_is_not_changed() {
    let mut clay = ball(0.5);
    edit(&mut clay, &SetsEdit::HideMasked).expect("hidden");
    let bits = |clay: &mut Clay| {
        let hidden = |p: &Page| {
            let rows = (0..p.own()).filter(|&v| p.is_hidden(v));
            rows.map(|v| p.point_rows()[v].to_array().map(f32::to_bits)).collect::<Vec<_>>()
        };
        clay.snapshot().pages().flat_map(|p| hidden(p)).collect::<Vec<_>>()
    };
    let before = bits(&mut clay);
    let w = Workers::new(1);
    // The masks go first, or they would protect it.
    clay.begin_step();
    let clear = MaskAll { action: MaskAction::Clear, extent: 1.0 };
    clay.dab(&MaskAction::reach(), &clear, &w);
    assert_eq!(bits(&mut clay), before, "masks of what is hidden stay");
    let centre = Vec3::new(0.0, 0.75f32.sqrt(), 0.5);
    let reach = Reach::Sphere { centre, radius: 0.5 };
    let report = clay.dab(&reach, &GaussianBrush::new(centre, 0.5, centre, 0.2), &w);
    assert!(report.moved > 20);
    clay.end_step();
    assert_eq!(bits(&mut clay), before, "a dab moves only what is shown");
    assert_eq!(clay.verify_invariants(), Ok(()));
}

#[test]
fn dynamic_topology_carries_sets_and_leaves_what_is_hidden() {
    let mut all = Vec::new();
    for workers in [1, 2, 7, 16] {
        let w = Workers::new(workers);
        let mut clay = ball(0.5);
        edit(&mut clay, &SetsEdit::FromMask).expect("a set");
        edit(&mut clay, &SetsEdit::HideMasked).expect("hidden");
        edit(&mut clay, &SetsEdit::FromVisible).expect("a set");
        let hidden = clay.snapshot().face_sets()[0];
        let start = clay.hash();
        clay.begin_step();
        let clear = MaskAll { action: MaskAction::Clear, extent: 1.0 };
        clay.dab(&MaskAction::reach(), &clear, &w);
        let mut splits = 0;
        for k in 0..24 {
            let turn = k as f32 * 0.26;
            let centre = Vec3::new(turn.cos() * 0.87, turn.sin() * 0.87, 0.5);
            let edge = if k % 3 == 2 { 0.12 } else { 0.02 };
            let detail = Detail { centre, radius: 0.3, edge, split: true, collapse: true };
            let cuts = clay.adapt_topology(&[detail], 1 << 20, &w);
            splits += cuts.splits + cuts.collapses;
            assert_eq!(clay.verify_invariants(), Ok(()), "cut {k}");
        }
        clay.end_step();
        assert!(splits > 500, "{splits}");
        let sets = clay.snapshot().face_sets();
        // Nothing that is shown came of what is hidden, nor the other way round.
        assert!(sets.len() == 2 && sets[0] == hidden && sets[1].2 == 0, "{sets:?}");
        all.push(clay.hash());
        assert!(clay.undo() && clay.hash() == start);
    }
    assert!(all.iter().all(|h| *h == all[0]), "{all:x?}");
}

#[test]
fn a_local_boolean_keeps_the_sets_of_what_it_leaves() {
    let plain = icosphere(1.0, 60);
    let masks: Vec<f32> = plain.positions.iter().map(|p| f32::from(p.z > 0.5)).collect();
    let mut clay = Clay::build_masked(&plain, &masks, &Job::default()).expect("clay");
    edit(&mut clay, &SetsEdit::FromMask).expect("a set");
    edit(&mut clay, &SetsEdit::FromVisible).expect("a set");
    edit(&mut clay, &SetsEdit::FromMask).expect("a set");
    let before = clay.snapshot().face_sets();
    assert_eq!(before.iter().map(|s| s.0).collect::<Vec<_>>(), [2, 3]);
    let (start, at) = (clay.hash(), DVec3::new(0.86, 0.02, 0.5));
    // Of as many vertices as it takes away: else the pages around could not hold the result.
    let mut tool = icosphere(0.1, 6).to_poly();
    tool.positions.iter_mut().for_each(|p| *p += at);
    for operation in [Operation::Difference, Operation::Union] {
        let (options, job) = (BooleanOptions::default(), Job::default());
        let cut = local(&clay.snapshot(), &tool, operation, &options, &job).expect("a cut");
        clay.begin_step();
        let made = clay.graft(&cut.expect("local")).expect("made");
        clay.end_step();
        assert!(made.shared > 0 && clay.verify_invariants() == Ok(()));
        let after = clay.snapshot().face_sets();
        assert_eq!(after.iter().map(|s| s.0).collect::<Vec<_>>(), [0, 2, 3]);
        // New vertices are in no set; a few vertices of both sets are gone.
        assert!(after[0].1 < 400, "{after:?}");
        for k in [0, 1] {
            let gone = before[k].1 - after[k + 1].1;
            assert!((1..200).contains(&gone), "{before:?} {after:?}");
        }
        assert!(clay.undo() && clay.hash() == start);
    }
}

#[test]
fn pages_with_sets_come_back_from_their_bytes() {
    let mut clay = ball(0.5);
    edit(&mut clay, &SetsEdit::FromMask).expect("a set");
    edit(&mut clay, &SetsEdit::HideMasked).expect("hidden");
    let rest = clay.rest();
    let again = |p: &Page| Page::from_bytes(&p.to_bytes(), p.topology().clone(), p.revision());
    let pages = clay.snapshot().pages().map(|p| again(p).expect("a page").into()).collect();
    let read = Clay::of_stored(pages, &rest).expect("clay");
    assert_eq!((read.hash(), read.verify_invariants()), (clay.hash(), Ok(())));
    let snapshot = clay.snapshot();
    let page = snapshot.pages().find(|p| p.sets().is_some()).expect("one with sets");
    let mut bytes = page.to_bytes();
    bytes.pop();
    assert!(Page::from_bytes(&bytes, page.topology().clone(), 1).is_err(), "a byte is missing");
}

/// Three balls and a cube of twelve triangles, apart.
fn parts() -> TriMesh {
    let mut plain = TriMesh::default();
    let cube = cuboid(DVec3::splat(-1.0), DVec3::ONE).triangulate().0;
    let ball = icosphere(1.0, 8);
    for (k, one) in [&ball, &cube, &ball, &ball].into_iter().enumerate() {
        let first = plain.positions.len() as u32;
        plain.positions.extend(one.positions.iter().map(|p| *p + Vec3::X * 4.0 * k as f32));
        plain.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    plain
}

fn parted(clay: &mut Clay, by: Partition) -> Vec<(u16, u64, u64)> {
    let made = partition(&clay.snapshot(), by, &Job::default()).expect("sets");
    edit(clay, &made).expect("put in place");
    clay.snapshot().face_sets()
}

#[test]
fn loose_parts_become_sets_in_the_order_of_the_mesh() {
    let mut clay = of(&parts());
    let ball = icosphere(1.0, 8).positions.len() as u64;
    let sets = parted(&mut clay, Partition::Loose);
    assert_eq!(sets, [(1, ball, 0), (2, 8, 0), (3, ball, 0), (4, ball, 0)]);
    // Hidden vertices keep their set, and no number is given twice.
    edit(&mut clay, &SetsEdit::Hide(4)).expect("hidden");
    let sets = parted(&mut clay, Partition::Loose);
    assert_eq!(sets, [(4, ball, ball), (5, ball, 0), (6, 8, 0), (7, ball, 0)]);
    // Sets that were computed of another revision are refused.
    let late = partition(&clay.snapshot(), Partition::Loose, &Job::default()).expect("sets");
    edit(&mut clay, &SetsEdit::ShowAll).expect("shown");
    assert_eq!(edit(&mut clay, &late), Err(SetsError::Changed));
}

/// Cuts each triangle into four in its plane.
fn quarter(plain: &mut TriMesh) {
    let mut middles = BTreeMap::new();
    let mut cut = Vec::new();
    for [a, b, c] in std::mem::take(&mut plain.triangles) {
        let [x, y, z] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
            *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                let ends = [u, v].map(|w| plain.positions[w as usize]);
                plain.positions.push((ends[0] + ends[1]) * 0.5);
                plain.positions.len() as u32 - 1
            })
        });
        cut.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
    }
    plain.triangles = cut;
}

#[test]
fn creases_and_turns_part_a_finely_cut_cube_at_its_edges() {
    let mut cube = cuboid(DVec3::splat(-1.0), DVec3::ONE).triangulate().0;
    (0..4).for_each(|_| quarter(&mut cube));
    let mut clay = of(&cube);
    for by in [Partition::Crease(40.0), Partition::Normals(40.0)] {
        let sets = parted(&mut clay, by);
        assert_eq!(sets.len(), 6, "{by:?}: {sets:?}");
        edit(&mut clay, &SetsEdit::Clear).expect("cleared");
    }
    // A ball has no crease, but turns.
    let mut ball = ball(2.0);
    assert_eq!(parted(&mut ball, Partition::Crease(40.0)).len(), 1);
    let turned = parted(&mut ball, Partition::Normals(40.0)).len();
    assert!((8..60).contains(&turned), "{turned}");
}

#[test]
fn a_slab_with_two_walls_is_parted_where_the_wall_changes() {
    // 2 mm up to x = 30, then 5 mm.
    let profile = [[0.0, 0.0], [60.0, 0.0], [60.0, 5.0], [30.0, 5.0], [30.0, 2.0], [0.0, 2.0]];
    let mut slab = PolyMesh::new();
    for y in [0.0, 20.0] {
        slab.positions.extend(profile.map(|[x, z]| DVec3::new(x, y, z)));
    }
    let mut faces: Vec<Vec<u32>> = vec![(0..6).collect(), (6..12).rev().collect()];
    faces.extend((0..6).map(|i| vec![i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6]));
    for corners in faces {
        slab.corners.extend(corners);
        slab.face_starts.push(slab.corners.len() as u32);
    }
    let job = Job::default();
    let mut clay = of(&refine(&slab.triangulate().0, 1.0).mesh);
    let sets = parted(&mut clay, Partition::Walls(Some(3)));
    assert!(sets.len() >= 2, "{sets:?}");
    let shown = clay.snapshot();
    let down = |x: f32| {
        let ray = Ray { origin: Vec3::new(x, 10.0, 50.0), dir: -Vec3::Z };
        shown.set_at(&shown.pick(ray).expect("the slab"))
    };
    assert_eq!(down(8.0), down(22.0));
    assert_eq!(down(38.0), down(52.0));
    assert_ne!(down(22.0), down(38.0));
    let senseless = partition(&clay.snapshot(), Partition::Walls(Some(0)), &job);
    assert_eq!(senseless, Err(SetsError::Levels));
    job.cancel();
    let cancelled = partition(&clay.snapshot(), Partition::Walls(None), &job);
    assert_eq!(cancelled, Err(SetsError::Cancelled));
}

/// Asserts that a mesh is closed and oriented, each vertex in one fan; its components and volume.
fn solid(plain: &TriMesh) -> (usize, f32) {
    let mut opposite = BTreeMap::new();
    let mut about = vec![0u32; plain.positions.len()];
    let mut joined = DisjointSets::new(plain.positions.len());
    let mut volume = 0.0;
    for t in &plain.triangles {
        for k in 0..3 {
            let twice = opposite.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
            assert_eq!(twice, None, "an edge twice in one direction");
            about[t[k] as usize] += 1;
            joined.join(t[0], t[k]);
        }
        let [a, b, c] = t.map(|v| plain.positions[v as usize]);
        volume += a.dot(b.cross(c)) / 6.0;
    }
    for &(v, first) in opposite.keys() {
        assert!(opposite.contains_key(&(first, v)), "an open edge");
        let (mut k, mut steps) = (opposite[&(v, first)], 1);
        while k != first && steps < 1000 {
            (k, steps) = (opposite[&(v, k)], steps + 1);
        }
        assert_eq!(steps, about[v as usize], "vertex {v} has several fans");
    }
    (joined.count(), volume)
}

#[test]
fn an_extracted_part_is_closed_and_holds_its_thickness() {
    let mut clay = ball(0.5);
    for (thickness, least, most) in [(0.05f32, 0.1535, 0.1651), (-0.05, 0.139, 0.1494)] {
        let shell = extract(&clay.snapshot(), FaceSetPart::Masked, thickness).expect("a shell");
        let (components, volume) = solid(&shell);
        assert_eq!(components, 1);
        // The cap from the height 1/2 on, between two spheres: pi/3 times the difference of their
        // radii's cubes. Its border follows whole triangles, which costs some percent.
        assert!((least..most).contains(&volume), "{thickness}: {volume}");
    }
    assert_eq!(extract(&clay.snapshot(), FaceSetPart::Set(3), 0.1), Err(ExtractError::Nothing));
    assert_eq!(extract(&clay.snapshot(), FaceSetPart::Masked, 0.0), Err(ExtractError::Thickness));
    assert_eq!(
        extract(&clay.snapshot(), FaceSetPart::Masked, f32::NAN),
        Err(ExtractError::Thickness)
    );
    edit(&mut clay, &SetsEdit::HideMasked).expect("hidden");
    assert_eq!(extract(&clay.snapshot(), FaceSetPart::Masked, 0.1), Err(ExtractError::Nothing));
}

#[test]
fn pieces_that_only_touch_make_shells_that_are_manifold() {
    // Two of four quarters of a plane, which meet in its middle.
    let plane = sculptd_geometry::shapes::grid(2.0, 2.0, 8, 8).triangulate().0;
    let middle = |t: &[u32; 3]| t.iter().map(|&v| plane.positions[v as usize]).sum::<Vec3>();
    let mut plain = plane.clone();
    let centre = plane.positions.iter().sum::<Vec3>();
    plain.triangles.retain(|t| {
        let at = middle(t) - centre * (3.0 / plane.positions.len() as f32);
        let low = at.abs().min_element();
        let [u, v]: [f32; 2] = match at.abs() {
            a if a.x == low => [at.y, at.z],
            a if a.y == low => [at.x, at.z],
            _ => [at.x, at.y],
        };
        (u > 0.0) == (v > 0.0)
    });
    assert!(plain.triangles.len() == plane.triangles.len() / 2);
    let masks = vec![1.0; plain.positions.len()];
    let mut clay = Clay::build_masked(&plain, &masks, &Job::default()).expect("clay");
    let shell = extract(&clay.snapshot(), FaceSetPart::Masked, 0.1).expect("a shell");
    let (components, volume) = solid(&shell);
    assert!(components == 2 && (volume - 0.2).abs() < 1e-4, "{components}, {volume}");
}

#[test]
fn a_triangle_is_hidden_with_its_last_corner() {
    let mut clay = ball(0.5);
    edit(&mut clay, &SetsEdit::HideMasked).expect("hidden");
    let (mut gone, mut left) = (0, 0);
    for page in clay.snapshot().pages() {
        for (i, t) in page.triangles().iter().enumerate() {
            let hidden = t.iter().filter(|&&v| page.is_hidden(v as usize)).count();
            assert_eq!(page.is_triangle_hidden(i), hidden == 3);
            assert!(t.iter().all(|&v| page.set_bits(v as usize) & !HIDDEN == 0));
            if hidden == 3 { gone += 1 } else { left += 1 }
        }
    }
    assert!(gone > 1000 && left > 1000);
}
