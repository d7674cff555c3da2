use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::{LeapConfig, start};
use crate::clock::Clock;
use crate::queue::channel;
use crate::sample::{Body, Hand};

/// The webcam's bridge, with a made-up hand in place of the camera.
#[test]
fn the_webcam_bridge_speaks_the_protocol() {
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("bridges/webcam_hands.py");
    let mut python = Command::new("python3");
    let python =
        python.arg(script).args(["--port", "0", "--synthetic", "3"]).stdout(Stdio::piped());
    let Ok(mut child) = python.spawn() else { return println!("skipped: no python3") };
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    let (factory, mut rx) = channel(1024);
    let config = LeapConfig { url: url.trim().into(), ..LeapConfig::default() };
    let handle = start(config, Clock::monotonic(), factory.sender()).unwrap();
    let mut hands: Vec<Hand> = Vec::new();
    let (mut empty, mut frames) = (0, 0);
    while let Some(s) = rx.next_within(Duration::from_secs(4)) {
        let Body::Hands(h) = s.body else { panic!("{s:?}") };
        frames += 1;
        empty += usize::from(h.count == 0);
        hands.extend(h.as_slice());
        if child.try_wait().unwrap().is_some() {
            break;
        }
    }
    child.wait().unwrap();
    let status = handle.status();
    assert!(
        frames > 60 && status.errors == 0 && status.version == Some(6),
        "{frames} frames, {status:?}"
    );
    let gap = |h: &Hand| h.fingers[0].unwrap().tip.distance(h.fingers[1].unwrap().tip);
    let gaps: Vec<f32> = hands.iter().map(gap).collect();
    let (least, most) = gaps.iter().fold((f32::MAX, 0.0f32), |(a, b), g| (a.min(*g), b.max(*g)));
    assert!(
        least < 20.0 && most > 45.0,
        "thumb and index finger meet and part: {least} to {most} mm"
    );
    let ids: std::collections::BTreeSet<i32> = hands.iter().map(|h| h.id).collect();
    assert!(empty > 0 && ids.len() > 1, "gone for a moment, and another id afterwards: {ids:?}");
    for h in &hands {
        assert_eq!(h.left, Some(false));
        assert!(h.fingers.iter().flatten().all(|f| f.joints.iter().all(Option::is_some)));
        assert!(
            h.direction.unwrap().y > 0.9 && h.palm_normal.unwrap().z.abs() > 0.9,
            "upright before the camera: {h:?}"
        );
        assert!(
            (100.0..350.0).contains(&h.palm.y) && h.palm.z.abs() < 150.0,
            "over the tracker: {}",
            h.palm
        );
    }
}
