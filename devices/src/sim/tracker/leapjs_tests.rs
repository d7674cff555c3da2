use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use crate::sim::{Tracker, TrackerConfig, journal};

/// A client that is not ours takes every frame of the simulated tracker for a real one's.
/// `devices/tests/leapjs/run` sets it up.
#[test]
fn leapjs_takes_the_simulated_tracker_for_a_real_one() {
    let Some(dir) = std::env::var_os("SCULPTD_LEAPJS").map(PathBuf::from) else {
        return println!("skipped: SCULPTD_LEAPJS not set (devices/tests/leapjs/run sets it)");
    };
    let mut tracker = Tracker::new(journal().hands, TrackerConfig::default()).unwrap();
    // From the time at which both hands are in view.
    tracker.skip_to(10_400_000);
    let port = tracker.address().port().to_string();
    let mut node = Command::new("node");
    let node = node.arg("check.cjs").args([&port, "500"]).current_dir(dir);
    let child = node.stdout(std::process::Stdio::piped()).spawn().unwrap();
    assert!(
        tracker.wait_for_client(std::time::Duration::from_secs(20)),
        "leapjs has not connected"
    );
    let (_hold, stop) = crate::device_thread::pair();
    let mut us = 10_400_000;
    while tracker.clients() > 0 && us < 20_000_000 {
        us += 9_091;
        tracker.advance(us);
        stop.wait(std::time::Duration::from_millis(4));
    }
    let out = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&out.stdout);
    println!("{}", text.trim());
    let seen: Value = serde_json::from_str(text.lines().last().unwrap_or_default()).unwrap();
    assert!(out.status.success() && seen["faults"] == serde_json::json!([]), "{seen}");
    assert_eq!(seen["frames"], 500);
    assert!(
        seen["both"].as_u64() > Some(200) && seen["types"]["left"].as_u64() > Some(200),
        "{seen}"
    );
    assert_eq!(seen["bones"].as_u64(), seen["hands"].as_u64().map(|h| 20 * h));
    assert!(
        tracker.requests().iter().any(|w| w.contains("background")),
        "{:?}",
        tracker.requests()
    );
}
