use std::path::PathBuf;

use glam::vec3;
use proptest::prelude::*;

use super::*;
use crate::leap::FrameFile;

const FRAME: &str = r#"{"id":7,"timestamp":1234567,"currentFrameRate":110.5,"hands":[
 {"id":9,"type":"left","palmPosition":[1,2,3],"palmNormal":[0,-2,0],"direction":[0,0,-1],
   "grabStrength":1.5,
  "pinchStrength":null,"confidence":"high","timeVisible":-4,"palmWidth":85,
   "wrist":[0,0,60],"elbow":[1,2]},
 {"id":4,"type":"right","palmPosition":[9,9,9]}, {"id":4,"palmPosition":[0,0,0]}, {"id":5}],
 "pointables":[
 {"id":91,"handId":9,"tipPosition":[5,6,7],"dipPosition":[5,6,8],"extended":true,"width":16},
 {"id":90,"handId":9,"type":0,"btipPosition":[1,1,1]},
 {"id":99,"handId":9,"tipPosition":[0,0,0]}, 
   {"id":1,"handId":9,"type":3,"tool":true,"tipPosition":[0,0,0]}]}"#;

#[test]
fn a_frame_reads_and_what_is_wrong_in_it_is_absent() {
    let f = parse_frame(FRAME).unwrap();
    assert_eq!(
        (f.hands.frame, f.device_t_us, f.rate, f.dropped_hands),
        (7, Some(1_234_567), Some(110.5), 2)
    );
    assert_eq!(
        f.hands.as_slice().iter().map(|h| h.id).collect::<Vec<_>>(),
        [4, 9],
        "in order of their ids"
    );
    let h = f.hands.hands[1];
    assert_eq!(
        (h.left, h.palm, h.palm_normal),
        (Some(true), vec3(1.0, 2.0, 3.0), Some(vec3(0.0, -1.0, 0.0)))
    );
    assert_eq!((h.grab, h.pinch, h.confidence, h.time_visible), (Some(1.0), None, None, None));
    assert_eq!((h.palm_width, h.wrist, h.elbow), (Some(85.0), Some(vec3(0.0, 0.0, 60.0)), None));
    assert!(
        h.orientation.unwrap().abs_diff_eq(Quat::IDENTITY, 1e-6),
        "flat, palm down, away from the user"
    );
    assert_eq!(h.fingers[1].unwrap().tip, vec3(5.0, 6.0, 7.0), "told by its id");
    assert_eq!(h.fingers[1].unwrap().joints[3], Some(vec3(5.0, 6.0, 8.0)));
    assert_eq!(h.fingers[0].unwrap().tip, vec3(1.0, 1.0, 1.0), "the bone's end stands for the tip");
    assert_eq!(
        (h.fingers[2], h.fingers[3], h.fingers[4]),
        (None, None, None),
        "no tool, no tenth finger"
    );
}

#[test]
fn the_other_messages() {
    assert_eq!(
        parse_message(r#"{"serviceVersion":"2.3","version":6}"#),
        Ok(Message::Version(Some(6)))
    );
    let event = r#"{"event":{"type":"deviceEvent","state":
        {"attached":true,"id":"x","streaming":false,"type":"p"}}}"#;
    assert_eq!(
        parse_message(event),
        Ok(Message::Device { attached: Some(true), streaming: Some(false) })
    );
    assert_eq!(parse_message("{}"), Ok(Message::Other));
    assert_eq!(parse_frame("{}"), Err(FrameError::NotAFrame));
}

#[test]
fn words_that_are_not_json_are_read_as_absent_numbers() {
    for word in ["nan", "-nan", "NaN", "-nan(ind)", "inf", "-Infinity"] {
        let text = format!(
            r#"{{"hands":[{{"id":1,"palmPosition":[1,2,3],"wrist":[{word},0,0],
                "type":"in\"f nan"}}],"timestamp":5}}"#
        );
        let f = parse_frame(&text).unwrap_or_else(|e| panic!("{word}: {e}"));
        assert!(f.repaired && f.hands.hands[0].wrist.is_none() && f.hands.count == 1, "{word}");
    }
    let sound = parse_frame(r#"{"hands":[],"x":[false,true,null,1e3]}"#).unwrap();
    assert!(!sound.repaired);
}

#[test]
fn numbers_out_of_reason_are_absent() {
    for n in ["1e300", "-20000", "1e39"] {
        let f =
            parse_frame(&format!(r#"{{"hands":[{{"id":1,"palmPosition":[0,{n},0]}}]}}"#)).unwrap();
        assert_eq!((f.hands.count, f.dropped_hands), (0, 1), "{n}");
    }
    assert!(matches!(parse_frame(r#"{"hands":[{"id":1e999}]}"#), Err(FrameError::NotJson(_))));
}

#[test]
fn size_and_depth_are_capped_and_a_crowd_is_counted() {
    let deep = format!(r#"{{"hands":[],"x":{}{}}}"#, "[".repeat(5000), "]".repeat(5000));
    assert!(matches!(parse_frame(&deep), Err(FrameError::TooDeep(_))));
    let quoted = format!(r#"{{"hands":[],"x":"{}"}}"#, "[".repeat(5000));
    assert!(parse_frame(&quoted).is_ok(), "brackets in a string are text");
    assert!(matches!(parse_frame(&" ".repeat(MAX_MESSAGE + 1)), Err(FrameError::TooLong(_))));
    let crowd: Vec<String> =
        (0..500).map(|i| format!(r#"{{"id":{i},"palmPosition":[0,0,0]}}"#)).collect();
    let f = parse_frame(&format!(r#"{{"hands":[{}]}}"#, crowd.join(","))).unwrap();
    assert_eq!((f.hands.count as usize, f.dropped_hands), (MAX_HANDS, 496));
}

#[test]
fn every_cut_of_a_frame_is_an_error_and_no_panic() {
    for end in (0..FRAME.len()).filter(|e| FRAME.is_char_boundary(*e)) {
        assert!(parse_message(&FRAME[..end]).is_err(), "cut at {end}");
    }
}

fn all_finite(f: &Frame) -> bool {
    f.hands.as_slice().iter().all(|h| {
        let places = [Some(h.palm), h.palm_normal, h.direction, h.palm_velocity, h.wrist, h.elbow];
        let fingers = h
            .fingers
            .iter()
            .flatten()
            .flat_map(|f| f.joints.into_iter().chain([Some(f.tip), f.direction]));
        let mut all = places.into_iter().chain(fingers).flatten();
        all.all(Vec3::is_finite) && h.orientation.is_none_or(|q| q.is_finite())
    })
}

proptest! {
    #[test]
    fn a_frame_with_bytes_changed_never_panics(
        at in prop::collection::vec((0..FRAME.len(), 32u8..127), 1..8)
    ) {
        let mut text = FRAME.as_bytes().to_vec();
        for (i, b) in at { text[i] = b; }
        if let Ok(f) = parse_frame(&String::from_utf8(text).unwrap()) {
            prop_assert!(all_finite(&f));
        }
    }
}

#[test]
fn a_frame_file_tells_time_by_the_stamps() {
    let text = "{\"version\":6}\n{\"timestamp\":100,\"hands\":[]}\n\n\
               {\"timestamp\":9100,\"hands\":[]}\n\
                {\"timestamp\":50,\"hands\":[]}\n{\"hands\":[]}\n\
                {\"timestamp\":99000000,\"hands\":[]}";
    let times: Vec<u64> =
        FrameFile::from_reader(text.as_bytes()).unwrap().map(|l| l.unwrap().0).collect();
    assert_eq!(times, [0, 0, 9000, 19_000, 29_000, 39_000]);
}

#[test]
fn every_frame_of_every_real_recording_decodes() {
    let Some(dir) =
        std::env::var_os("SCULPTD_CORPUS").map(|c| PathBuf::from(c).join("devices/open/leap"))
    else {
        return println!("skipped: SCULPTD_CORPUS not set");
    };
    let mut names: Vec<_> = std::fs::read_dir(&dir).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    assert!(names.len() >= 12);
    println!(
        "{:32} {:>6} {:>6} {:>7} {:>8} {:>7}",
        "recording", "frames", "hands", "fingers", "seconds", "Hz"
    );
    for path in names {
        let (mut frames, mut hands, mut fingers, mut end) = (0, 0, 0, 0);
        for (i, line) in FrameFile::open(&path).unwrap().enumerate() {
            let (t, text) = line.unwrap();
            if i == 0 {
                assert_eq!(parse_message(&text), Ok(Message::Version(Some(6))));
                continue;
            }
            let f = parse_frame(&text)
                .unwrap_or_else(|e| panic!("{} line {}: {e}", path.display(), i + 1));
            assert!(all_finite(&f) && f.device_t_us.is_some() && f.dropped_hands == 0);
            assert!(f.hands.as_slice().iter().all(|h| h.orientation.is_some() && h.left.is_some()));
            frames += 1;
            hands += f.hands.count as usize;
            fingers += f.hands.as_slice().iter().flat_map(|h| h.fingers).flatten().count();
            end = t;
        }
        let (name, s) = (path.file_name().unwrap().to_string_lossy(), end as f64 / 1e6);
        println!(
            "{name:32} {frames:6} {hands:6} {fingers:7} {s:8.2} {:7.1}",
            f64::from(frames) / s
        );
        assert!(frames >= 100 && fingers == 5 * hands, "{name}: each hand has its five fingers");
    }
}
