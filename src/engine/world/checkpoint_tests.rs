//! Worlds as bytes: they come back to the bit with all that clay can have, in whatever pieces the
//! bytes come, and broken bytes are refused.

use glam::Vec2;

use super::World;
use super::scene_tests::{Dice, ask, operate, state, stroke, world};
use crate::checkpoint::{BadCheckpoint, Captured, Restoring, restore};
use crate::scene::SceneCommand;
use sculptd_clay::Workers;
use sculptd_clay::face_sets::SetsEdit;

fn in_pieces(bytes: &[u8], dice: &mut Dice) -> Result<World, BadCheckpoint> {
    let mut restoring = Restoring::default();
    let mut rest = bytes;
    while !rest.is_empty() {
        let (piece, after) = rest.split_at(rest.len().min(1 + dice.roll(40_000)));
        restoring.take(piece)?;
        rest = after;
    }
    restoring.finish(Workers::new(1))
}

#[test]
fn worlds_come_back_to_the_bit_and_go_on_alike() {
    let mut first = world(1, u64::MAX);
    let mut dice = Dice(11);
    let mut compared = 0;
    for round in 0..120 {
        operate(&mut first, &mut dice);
        if round % 9 == 4 {
            let edit = [SetsEdit::FromMask, SetsEdit::FromVisible, SetsEdit::Hide(1)];
            let _ = ask(&mut first, SceneCommand::Sets(edit[dice.roll(3)].clone()));
        }
        let Some(captured) = Captured::of(&mut first) else { continue };
        let bytes = captured.to_bytes();
        let mut again = in_pieces(&bytes, &mut dice).expect("the world again");
        again.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
        assert_eq!((state(&again), again.hash()), (state(&first), first.hash()), "round {round}");
        let (from, to) = (Vec2::new(0.35, 0.5), Vec2::new(0.6, 0.55));
        assert_eq!(stroke(&mut again, from, to), stroke(&mut first, from, to), "round {round}");
        compared += 1;
    }
    assert!(compared > 60, "{compared} times at rest");
}

#[test]
fn broken_bytes_are_refused() {
    let mut whole = world(1, u64::MAX);
    let bytes = Captured::of(&mut whole).expect("at rest").to_bytes();
    for cut in [0, 3, 4, bytes.len() / 2, bytes.len() - 1] {
        assert_eq!(restore(&bytes[..cut], Workers::new(1)).err(), Some(BadCheckpoint), "{cut}");
    }
    // More pages than the head announces.
    let first = 4 + u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize;
    let more = [&bytes[..], &bytes[first..]].concat();
    assert_eq!(restore(&more, Workers::new(1)).err(), Some(BadCheckpoint));
}
