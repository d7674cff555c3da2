//! Every recording and descriptor of the corpus: known or declined with a reason, and what comes
//! out is lawful.

use std::collections::BTreeMap;
use std::path::Path;

use sculptd_devices::catalogue::{Catalogue, Identification};
use sculptd_devices::recording::{Player, RecordingError, hid_recorder};
use sculptd_devices::{Body, DeviceId, Sample, Tool};

/// Checks the properties of any stream of pen samples.
fn lawful(name: &str, samples: &[Sample]) {
    let mut last = 0;
    let mut tip = false;
    for s in samples {
        assert!(s.t_us >= last, "{name}: time runs backward at {}", s.t_us);
        last = s.t_us;
        let Body::Pen(p) = s.body else { continue };
        tip = p.tip;
        let at = format!("{name} at {} us: {p:?}", s.t_us);
        assert!(!p.tip || p.in_range, "contact out of range: {at}");
        assert!(p.in_range || p.buttons == 0, "a button held out of range: {at}");
        assert!(!(p.tip && p.tool == Tool::Mouse), "a puck presses: {at}");
        assert!(
            (0.0..=p.area_mm.x).contains(&p.pos_mm.x) && (0.0..=p.area_mm.y).contains(&p.pos_mm.y),
            "{at}"
        );
        assert!(p.pressure.is_none_or(|v| (0.0..=1.0).contains(&v)), "{at}");
        assert!(
            p.tilt.is_none_or(|t| t.abs().max_element() <= std::f32::consts::FRAC_PI_2 + 1e-6),
            "{at}"
        );
    }
    assert!(!tip, "{name}: the last contact has no end");
    let visit = samples
        .iter()
        .rev()
        .find_map(|s| if let Body::Pen(p) = s.body { Some(p.in_range) } else { None });
    assert_ne!(visit, Some(true), "{name}: the last visit has no end");
}

fn play(path: &Path, catalogue: &Catalogue) -> Result<(Player, Vec<Sample>), RecordingError> {
    let mut player = Player::open(path, DeviceId(0), catalogue)?;
    let mut samples = Vec::new();
    while let Some(due) = player.next_due_us() {
        player.advance(due, &mut |s| samples.push(s));
    }
    player.advance(u64::MAX / 2, &mut |s| samples.push(s));
    assert!(player.finished());
    Ok((player, samples))
}

#[test]
fn every_recording_is_read_or_declined_with_a_reason() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let (mut read, mut declined, mut silent) = (0, 0, Vec::new());
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match play(&path, &catalogue) {
            Ok((player, samples)) => {
                read += 1;
                lawful(&name, &samples);
                let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
                let reports = hid_recorder::parse(&text).unwrap().reports.len();
                let pens = samples.iter().filter(|s| matches!(s.body, Body::Pen(_))).count();
                println!(
                    "{name:50} {:30} {reports:5} reports {pens:5} samples",
                    player.device().name
                );
                if reports > 0 && pens == 0 {
                    silent.push(name);
                }
            }
            Err(RecordingError::Unknown { why, .. }) => {
                declined += 1;
                println!("{name:50} declined: {why}");
                assert!(!why.is_empty(), "{name}");
            }
            Err(e) => panic!("{name}: {e}"),
        }
    }
    println!("{read} read, {declined} declined");
    // These two were recorded with fingers only.
    assert_eq!(silent, ["Wacom_Bamboo_2FG_056a_00D0.hid", "n-trig_1b96_0c03.hid"]);
    assert!(read >= 100 && declined > 0);
}

#[test]
fn playing_in_steps_gives_what_playing_at_once_gives() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    for name in
        ["DIGImend_Huion_K58.hid", "Wacom_Intuos4_4x6_056a_00B8.hid", "DIGImend_Ugee_M708_v2.hid"]
    {
        let path = corpus.join("hid").join(name);
        let (_, stepped) = play(&path, &catalogue).unwrap();
        let mut player = Player::open(&path, DeviceId(0), &catalogue).unwrap();
        player.start_at(7_000_000);
        let mut ticked = Vec::new();
        let mut now = 0;
        while !player.finished() {
            now += 8333;
            player.advance(now, &mut |s| ticked.push(s));
        }
        let moved: Vec<Sample> =
            stepped.iter().map(|s| Sample { t_us: s.t_us + 7_000_000, ..*s }).collect();
        assert_eq!(ticked, moved, "{name}");
    }
}

#[test]
fn the_models_that_can_be_known_are_known() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let mut got = BTreeMap::new();
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        for who in hid_recorder::parse(&text).unwrap().interfaces {
            if let Identification::Identified(found) = catalogue.identify(&who)
                && catalogue.tablets().iter().any(|t| t.name == found.tablet.name)
            {
                got.entry(name.clone()).or_insert_with(|| found.tablet.name.clone());
            }
        }
    }
    for (file, model) in [
        ("DIGImend_Huion_HS610.hid", "Huion HS610"),
        ("DIGImend_XP-Pen_Deco_01.hid", "XP-Pen Deco 01"),
        ("DIGImend_XP-Pen_Artist_10S.hid", "XP-Pen Artist 10S"),
        ("WHD_Huion_H640P.hid", "Huion H640P"),
        ("Wacom_Intuos5_touch_S_056a_0026.hid", "Wacom PTH-450"),
        ("Wacom_Cintiq_24HD_056a_00F4.hid", "Wacom Cintiq 24HD"),
        ("WACOM_Pen_Tablet_056a_0081.hid", "Wacom Graphire Bluetooth 6x8"),
    ] {
        assert_eq!(got.get(file).map(String::as_str), Some(model), "{file}");
    }
}
