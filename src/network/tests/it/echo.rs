//! The own stroke is shown in the tick in which it is made, whatever the network does, and changes
//! nothing of what all get.

use crate::simulated::{BAD, Faults, GOOD, Simulation};
use sculptd_network::local_echo::LocalEcho;

/// Duration of the strokes, in seconds.
const STROKES_S: f64 = 4.0;

/// Ticks of strokes in which the picture moved, and in which it did not.
type Moved = (u64, u64);

/// Three people over a network, with an echo or without; the hash of all in the end.
fn sculpted(faults: Faults, seed: u64, echo: bool) -> (u64, Vec<[Moved; 2]>, Vec<u64>) {
    let mut s = Simulation::new(seed, faults);
    s.run(0.5, |_| false);
    s.join_sculptor();
    s.join_sculptor();
    s.run(6.0, |_| false);
    for replica in &mut s.replicas {
        let person = replica.station.person();
        assert!(person != 0);
        replica.echo = echo.then(|| LocalEcho::new(crate::simulated::RATE, person));
    }
    s.run(STROKES_S, |_| true);
    s.run(6.0, |_| false);
    s.verify();
    let ahead = |e: &mut LocalEcho| e.ahead().is_some();
    let left = s
        .replicas
        .iter_mut()
        .filter_map(|r| r.echo.as_mut())
        .filter_map(|e| ahead(e).then_some(()));
    assert_eq!(left.count(), 0, "in the end the world of all is shown");
    let hash = s.replicas[0].world.as_ref().map(|w| w.hash()).expect("a world");
    let forks = s.replicas.iter().filter_map(|r| r.echo.as_ref()).map(LocalEcho::forks);
    (hash, s.replicas.iter().map(|r| [r.shown, r.alone.1]).collect(), forks.collect())
}

#[test]
fn a_stroke_is_shown_in_its_own_tick_and_the_clay_is_that_of_a_run_without_echo() {
    for (faults, seed) in [(GOOD, 41), (BAD, 42)] {
        let (with, shown, forks) = sculpted(faults, seed, true);
        let (without, ..) = sculpted(faults, seed, false);
        println!(
            "{} us of delay: ticks of strokes in which the picture moved, and not, and the same of \
             a world alone: {shown:?}; forks {forks:?}",
            faults.delay_us
        );
        assert_eq!(with, without, "the echo changes nothing");
        for [(moved, still), (alone, still_alone)] in shown {
            assert!(moved > 150 && moved + still == alone + still_alone);
            let late = alone.abs_diff(moved);
            assert!(late * 50 <= alone, "{moved} ticks shown at once, {alone} alone");
        }
    }
}
