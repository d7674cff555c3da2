use std::sync::Arc;

use glam::Vec3;
use proptest::prelude::*;

use crate::brush::GaussianBrush;
use crate::layers::{LayerEdit, LayerError, LayerId, LayerOffsets};
use crate::{Clay, LayerOperation, Page, Reach, Workers};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::icosphere;

fn ball() -> Clay {
    Clay::build(&icosphere(1.0, 30), &Job::default()).expect("clay")
}

fn positions(clay: &Clay) -> Vec<[u32; 3]> {
    clay.to_tri().positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn edit(clay: &mut Clay, edit: &LayerEdit, workers: &Workers) -> Result<LayerId, LayerError> {
    clay.begin_step();
    let made = clay.edit_layers(edit, workers);
    if let Ok(job) = &made {
        // In portions, as ticks do it.
        for some in job.pages.chunks(3) {
            clay.run_layers(&job.operation, some, workers);
        }
    }
    clay.end_step();
    let found = clay.verify_layers().and_then(|_| clay.verify_invariants());
    assert_eq!(found, Ok(()), "after {edit:?}");
    made.map(|job| job.layer.unwrap_or_default())
}

fn stroke(clay: &mut Clay, at: Vec3, height: f32, workers: &Workers) {
    clay.begin_step();
    for k in 0..4 {
        let centre = at + Vec3::new(0.05, 0.02, 0.0) * k as f32;
        let reach = Reach::Sphere { centre, radius: 0.4 };
        clay.dab(&reach, &GaussianBrush::new(centre, 0.4, at, height), workers);
    }
    let mut pages = Vec::new();
    clay.touched_by_step(&mut pages);
    for some in pages.chunks(4) {
        clay.run_layers(&LayerOperation::Capture, some, workers);
    }
    clay.end_step();
    let found = clay.verify_layers().and_then(|_| clay.verify_invariants());
    assert_eq!(found, Ok(()), "after a stroke");
}

fn set(id: LayerId, intensity: f32, visible: bool) -> LayerEdit {
    LayerEdit::Set { id, intensity: Some(intensity), visible: Some(visible), live: false }
}

#[test]
fn layers_at_intensity_1_are_the_surface_that_strokes_left_to_the_bit() {
    let w = Workers::new(1);
    let mut clay = ball();
    let start = (positions(&clay), clay.hash());
    let first = edit(&mut clay, &LayerEdit::Add("wrinkles".into()), &w).expect("room");
    stroke(&mut clay, Vec3::X, 0.05, &w);
    let one = positions(&clay);
    let second = edit(&mut clay, &LayerEdit::Add("scar".into()), &w).expect("room");
    stroke(&mut clay, Vec3::new(0.8, 0.6, 0.0), -0.03, &w);
    let both = positions(&clay);
    assert!(one != start.0 && both != one);
    edit(&mut clay, &set(second, 1.0, false), &w).expect("there");
    assert!(positions(&clay) == one);
    edit(&mut clay, &set(first, 0.37, false), &w).expect("there");
    assert!(positions(&clay) == start.0);
    edit(&mut clay, &set(first, 0.37, true), &w).expect("there");
    assert!(positions(&clay) != start.0 && positions(&clay) != one);
    for id in [first, second] {
        edit(&mut clay, &set(id, 1.0, true), &w).expect("there");
    }
    assert!(positions(&clay) == both);
    // A stroke while a layer counts for another intensity than 1.
    edit(&mut clay, &set(second, -0.7, true), &w).expect("there");
    stroke(&mut clay, Vec3::new(0.7, 0.7, 0.1), 0.02, &w);
    edit(&mut clay, &set(second, 1.0, true), &w).expect("there");
    let seen = positions(&clay);
    edit(&mut clay, &LayerEdit::Bake, &w).expect("there");
    assert!(positions(&clay) == seen && clay.layer_count() == 0);
    while clay.undo() {
        assert_eq!(clay.verify_layers(), Ok(()));
    }
    assert!(clay.hash() == start.1 && clay.layers().is_none());
    while clay.redo() {}
    assert!(positions(&clay) == seen);
}

#[test]
fn a_stroke_on_the_base_lies_below_the_layers() {
    let w = Workers::new(1);
    let mut clay = ball();
    let places = |clay: &Clay| clay.to_tri().positions;
    let start = places(&clay);
    let id = edit(&mut clay, &LayerEdit::Add("top".into()), &w).expect("room");
    stroke(&mut clay, Vec3::X, 0.05, &w);
    let raised = places(&clay);
    edit(&mut clay, &LayerEdit::Activate(None), &w).expect("base");
    stroke(&mut clay, Vec3::X, 0.04, &w);
    let both = places(&clay);
    edit(&mut clay, &set(id, 1.0, false), &w).expect("there");
    let base = places(&clay);
    let mut farthest = 0.0f32;
    for v in 0..start.len() {
        let layer = raised[v] - start[v];
        assert!((base[v] + layer - both[v]).length() < 1e-6);
        farthest = farthest.max((base[v] - start[v]).length());
    }
    assert!(farthest > 0.02, "the base moved by {farthest}");
    edit(&mut clay, &set(id, 1.0, true), &w).expect("there");
    assert!(places(&clay) == both);
}

#[test]
fn merging_duplicating_and_clearing_do_what_they_say() {
    let w = Workers::new(1);
    let mut clay = ball();
    let start = positions(&clay);
    let a = edit(&mut clay, &LayerEdit::Add("a".into()), &w).expect("room");
    stroke(&mut clay, Vec3::X, 0.05, &w);
    edit(&mut clay, &set(a, 0.5, true), &w).expect("there");
    let b = edit(&mut clay, &LayerEdit::Add("b".into()), &w).expect("room");
    stroke(&mut clay, Vec3::Y, 0.05, &w);
    edit(&mut clay, &set(b, 2.0, true), &w).expect("there");
    let seen = positions(&clay);
    edit(&mut clay, &set(a, 0.5, false), &w).expect("there");
    assert_eq!(edit(&mut clay, &LayerEdit::MergeDown(b), &w), Err(LayerError::Hidden(a)));
    edit(&mut clay, &set(a, 0.5, true), &w).expect("there");
    assert_eq!(edit(&mut clay, &LayerEdit::MergeDown(b), &w), Ok(a));
    assert!(positions(&clay) == seen && clay.layer_count() == 1);
    let twin = edit(&mut clay, &LayerEdit::Duplicate(a), &w).expect("room");
    assert!(positions(&clay) == seen);
    edit(&mut clay, &set(a, 1.0, false), &w).expect("there");
    edit(&mut clay, &set(twin, 1.0, true), &w).expect("there");
    assert!(positions(&clay) == seen);
    edit(&mut clay, &LayerEdit::Clear(twin), &w).expect("there");
    assert!(positions(&clay) == start && clay.layer_count() == 2);
    edit(&mut clay, &set(a, 1.0, true), &w).expect("there");
    edit(&mut clay, &LayerEdit::Remove(twin), &w).expect("there");
    assert_eq!(clay.layers().and_then(|s| s.active), Some(a));
    edit(&mut clay, &LayerEdit::MergeDown(a), &w).expect("into the base");
    assert!(positions(&clay) == seen && clay.layer_count() == 0);
    assert!(clay.pages.iter().skip(1).all(|p| p.layers().is_none()));
}

#[test]
fn layers_come_in_by_vertex_numbers_and_pages_come_back_from_their_bytes() {
    let w = Workers::new(1);
    let mut clay = ball();
    let start = clay.to_tri().positions;
    let offsets = (0..start.len() as u32).step_by(3).map(|v| (v, [0.5, 0.0, -0.25])).collect();
    let layers = vec![LayerOffsets { name: "in".into(), intensity: 0.5, visible: true, offsets }];
    edit(&mut clay, &LayerEdit::Import(Arc::new(layers)), &w).expect("room");
    for (v, (p, q)) in start.iter().zip(&clay.to_tri().positions).enumerate() {
        let by = if v % 3 == 0 { Vec3::new(0.25, 0.0, -0.125) } else { Vec3::ZERO };
        assert!((*p + by - *q).length() < 1e-6);
    }
    for page in &clay.pages {
        let bytes = page.to_bytes();
        let back = Page::from_bytes(&bytes, page.topology().clone(), page.revision());
        let back = back.expect("a page");
        assert!(back.layers() == page.layers() && back.point_rows() == page.point_rows());
        for cut in [1, 7, 60] {
            let torn = &bytes[..bytes.len() - cut];
            assert!(Page::from_bytes(torn, page.topology().clone(), 1).is_err());
        }
    }
}

#[derive(Debug, Clone)]
enum Act {
    Stroke(f32, f32),
    Edit(LayerEdit),
    Undo,
    Redo,
}

fn acts() -> impl Strategy<Value = Act> {
    let id = || (0..5u32).prop_map(LayerId);
    let edit = prop_oneof![
        Just(LayerEdit::Add("layer".into())),
        id().prop_map(LayerEdit::Remove),
        (id(), 0..4u32).prop_map(|(id, to)| LayerEdit::Move(id, to)),
        (id(), -2.5f32..2.5, any::<bool>()).prop_map(|(id, i, v)| set(id, i, v)),
        proptest::option::of(id()).prop_map(LayerEdit::Activate),
        id().prop_map(LayerEdit::MergeDown),
        id().prop_map(LayerEdit::Duplicate),
        id().prop_map(LayerEdit::Clear),
        Just(LayerEdit::Bake),
    ];
    prop_oneof![
        4 => (-3.0f32..3.0, -1.5f32..1.5).prop_map(|(a, b)| Act::Stroke(a, b)),
        6 => edit.prop_map(Act::Edit),
        1 => Just(Act::Undo),
        1 => Just(Act::Redo),
    ]
}

fn run(acts: &[Act], workers: usize) -> (u64, u64) {
    let w = Workers::new(workers);
    let mut clay = ball();
    let start = clay.hash();
    for act in acts {
        match act {
            Act::Stroke(a, b) => {
                let at = Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin());
                if clay.takes_strokes() {
                    stroke(&mut clay, at, 0.03, &w);
                }
            }
            Act::Edit(e) => {
                let _ = edit(&mut clay, e, &w);
            }
            Act::Undo => drop(clay.undo()),
            Act::Redo => drop(clay.redo()),
        }
        assert_eq!(clay.verify_layers(), Ok(()));
    }
    let end = clay.hash();
    while clay.undo() {}
    assert_eq!(clay.hash(), start);
    while clay.redo() {}
    (end, clay.hash())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn random_edits_keep_the_sum_and_give_the_same_bits_with_any_number_of_workers(
        acts in proptest::collection::vec(acts(), 1..24)
    ) {
        let one = run(&acts, 1);
        for workers in [2, 3] {
            prop_assert_eq!(run(&acts, workers), one);
        }
    }
}
