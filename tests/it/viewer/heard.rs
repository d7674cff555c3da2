//! Sounds of the published state: pens by their pressure, hands by their dabs.

use glam::{Vec2, Vec3};
use sculptd_devices::{DeviceId, Hand, Hands};
use sculptd_engine::stroke::PenPoint;
use sculptd_window::sound::heard::Heard;

use super::{published, world};

#[test]
fn a_pen_is_heard_by_its_pressure_and_speed() {
    let mut state = published(&mut world(500));
    let mut heard = Heard::default();
    let (touch, runs) = heard.touch(&state, 1_000_000);
    assert!(touch.pressure == 0.0 && !runs, "nobody is there");
    let mut pen = |x: f32, pressure: f32, now_us: u64| {
        let view = Vec2::new(x, 0.5);
        state.pens[0] = Some((DeviceId(3), PenPoint { view, pressure, ..PenPoint::default() }));
        heard.touch(&state, now_us)
    };
    let (near, runs) = pen(0.4, 0.0, 2_000_000);
    assert!(near.pressure == 0.0 && runs, "a pen that hovers wakes the device");
    let mut last = pen(0.4, 0.7, 2_020_000).0;
    assert_eq!((last.pressure, last.speed), (0.7, 0.0));
    for i in 1..=20u64 {
        last = pen(0.4 + 0.01 * i as f32, 0.7, 2_020_000 + i * 20_000).0;
    }
    // Half a width of the view a second, in heights of it.
    let wide = world(500).camera().aspect;
    assert!((last.speed - 0.5 * wide).abs() < 0.02, "{}", last.speed);
    // It lies still over the clay.
    assert!(pen(0.6, 0.0, 3_000_000).1);
    assert!(!pen(0.6, 0.0, 6_000_000).1, "the device rests with the pen");
    assert!(pen(0.7, 0.0, 6_020_000).1);
}

#[test]
fn a_hand_is_heard_while_it_makes_dabs() {
    let mut state = published(&mut world(500));
    let mut heard = Heard::default();
    let mut hands = Hands { count: 1, ..Hands::default() };
    let mut hand = |x: f32, dabs: u64, now_us: u64| {
        hands.hands[0] = Hand { palm: Vec3::new(x, 200.0, 0.0), ..Hand::default() };
        state.hands = Some(hands);
        state.figures.dabs = dabs;
        heard.touch(&state, now_us)
    };
    assert_eq!(hand(0.0, 0, 1_000_000).0.pressure, 0.0, "in the air");
    let (touch, runs) = hand(10.0, 3, 1_020_000);
    assert!(touch.pressure > 0.0 && touch.dabs == 3 && runs);
    assert!(hand(20.0, 5, 1_040_000).0.speed > 0.1);
    assert!(hand(30.0, 5, 1_060_000).0.pressure > 0.0, "between two dabs");
    assert_eq!(hand(40.0, 5, 1_200_000).0.pressure, 0.0, "it has left the clay");
}
