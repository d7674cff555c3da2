//! Records as a page writes them, and what cannot be one.

use proptest::prelude::*;

use super::*;

fn record(us: f64, at: [u16; 2], pressure: u16, tilt: [i8; 2], bits: u8, kind: u8) -> Vec<u8> {
    let mut out = us.to_le_bytes().to_vec();
    for value in [at[0], at[1], pressure] {
        out.extend(value.to_le_bytes());
    }
    out.extend(tilt.map(|t| t as u8));
    out.extend(350u16.to_le_bytes());
    out.extend([bits, kind]);
    out
}

fn pen(sample: &Sample) -> Pen {
    match sample.body {
        Body::Pen(pen) => pen,
        _ => Pen::default(),
    }
}

#[test]
fn a_record_is_the_pen_that_the_page_saw() {
    let mut browser = BrowserPen::new(DeviceId(0x8000));
    let mut batch = record(1e6, [0, 65_535], 0, [0, 0], IN_RANGE | HAS_PRESSURE, 0);
    let bits = IN_RANGE | TIP | HAS_PRESSURE | HAS_TILT | 8;
    batch.extend(record(1.004e6, [32_768, 16_384], 32_768, [30, -45], bits, 0));
    let samples = browser.take(&batch, 1.5, 9_000_000).expect("a batch");
    let (hover, down) = (pen(&samples[0]), pen(&samples[1]));
    assert!(hover.in_range && !hover.tip);
    assert_eq!((hover.pos_mm, hover.area_mm), (Vec2::new(0.0, 200.0), Vec2::new(300.0, 200.0)));
    assert!(down.tip && (down.pressure.unwrap_or(0.0) - 0.5).abs() < 1e-4);
    let tilt = down.tilt.unwrap_or_default();
    assert!((tilt.x.to_degrees() - 30.0).abs() < 1e-4 && (tilt.y.to_degrees() + 45.0).abs() < 1e-4);
    assert!((down.twist.unwrap_or(0.0).to_degrees() + 10.0).abs() < 1e-4);
    assert_eq!((down.buttons, down.tool), (1, Tool::Pen));
    // A burst keeps the times of its events.
    assert_eq!(samples[1].t_us - samples[0].t_us, 4000);
    assert!(samples[1].t_us <= 9_000_000);
}

#[test]
fn a_page_that_leaves_lifts_its_pen_once() {
    let mut browser = BrowserPen::new(DeviceId(1));
    assert_eq!(browser.leave(5), None);
    let down = record(0.0, [9, 9], 65_535, [0, 0], IN_RANGE | TIP | HAS_PRESSURE | ERASER, 0);
    let _ = browser.take(&down, 1.0, 10).expect("a batch");
    let lifted = pen(&browser.leave(20).expect("it was down"));
    assert!(!lifted.in_range && !lifted.tip && lifted.tool == Tool::Eraser);
    assert_eq!(browser.leave(30), None);
}

proptest! {
    #[test]
    fn no_bytes_make_a_sample_that_is_out_of_range(
        bytes in proptest::collection::vec(any::<u8>(), 0..RECORD * 9),
        aspect in any::<f32>(),
    ) {
        let mut browser = BrowserPen::new(DeviceId(7));
        match browser.take(&bytes, if aspect.is_finite() { aspect } else { 1.0 }, 1000) {
            Err(BatchError::Length(n)) => prop_assert_ne!(n % RECORD, 0),
            Err(BatchError::Records(n)) => prop_assert!(n > MAX_RECORDS),
            Ok(samples) => for sample in samples {
                let pen = pen(&sample);
                prop_assert!(pen.pos_mm.is_finite() && pen.pos_mm.cmple(pen.area_mm).all());
                prop_assert!(pen.in_range || !pen.tip);
                prop_assert!(pen.pressure.is_none_or(|p| (0.0..=1.0).contains(&p)));
                prop_assert!(sample.t_us <= 1000);
            }
        }
    }
}
