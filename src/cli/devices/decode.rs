//! `devices decode`: every sample of a recording as a row.

use std::io::Write;
use std::path::Path;

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::Player;
use sculptd_devices::{Body, DeviceId, Hand, Hands, Pad, Pen, Sample, Tool};
use serde::Serialize;

use super::super::{Outcome, answer};
use super::{recording_fail, write_text};

/// One sample as a row. Raw axes, tilt (degrees) and distance are the device's own counts.
#[derive(Debug, Serialize)]
struct DecodedRow {
    t_us: u64,
    device: u16,
    /// `pen`, `eraser`, `mouse`, `touch`; `pad` for a tablet's keys and wheels; `hands` for a
    /// tracker's frame, whose position is its first palm's x and y and whose buttons count hands.
    tool: &'static str,
    in_range: bool,
    tip: bool,
    pressure: Option<f32>,
    x_mm: f32,
    y_mm: f32,
    x_raw: i32,
    y_raw: i32,
    tilt_x: Option<f64>,
    tilt_y: Option<f64>,
    distance: Option<f32>,
    buttons: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    hands: Option<Vec<Hand>>,
    /// Of a pad: steps turned since the recording began, one count a wheel or dial.
    #[serde(skip_serializing_if = "Option::is_none")]
    wheels: Option<[i32; 2]>,
    /// Of a pad: where each ring or strip is touched, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    strips: Option<[Option<f32>; 2]>,
}

const HEADER: &str =
    "t_us,device,tool,in_range,tip,pressure,x_mm,y_mm,x_raw,y_raw,tilt_x,tilt_y,distance,buttons";

#[derive(Debug, Serialize)]
struct Decoded {
    device: String,
    area_mm: [f32; 2],
    notes: Vec<String>,
    rows: Vec<DecodedRow>,
}

pub(super) fn decode(
    path: &Path,
    csv: Option<&Path>,
    catalogue: &Catalogue,
    json: bool,
) -> Outcome {
    let mut player = Player::open(path, DeviceId(0), catalogue).map_err(recording_fail)?;
    let mut rows = Vec::new();
    player.advance(u64::MAX / 4, &mut |sample| rows.push(row(&sample)));
    let used = player.pressure_use().in_words();
    let info = player.device();
    let notes: Vec<String> = info.notes.iter().cloned().chain(used).collect();
    for note in &notes {
        eprintln!("{note}");
    }
    if let Some(out) = csv {
        let mut text = String::from(HEADER);
        text.push('\n');
        rows.iter().for_each(|r| r.line(&mut text));
        if out.as_os_str() == "-" {
            let _ = std::io::stdout().lock().write_all(text.as_bytes());
            return Ok(());
        }
        write_text(out, &text)?;
    }
    let area = info.area_mm;
    let decoded = Decoded { device: info.name.clone(), area_mm: [area.x, area.y], notes, rows };
    if csv.is_some() && !json {
        return Ok(());
    }
    answer(json, &decoded, |out| {
        writeln!(out, "{HEADER}")?;
        let mut text = String::new();
        decoded.rows.iter().for_each(|r| r.line(&mut text));
        out.write_all(text.as_bytes())
    });
    Ok(())
}

fn row(s: &Sample) -> DecodedRow {
    let p = match &s.body {
        Body::Pen(p) => p,
        Body::Hands(h) => return hands_row(s, h),
        Body::Pad(pad) => return pad_row(s, pad),
    };
    // A thousandth of a degree: radians and back leaves dust that no device means.
    let degrees = |r: f32| (f64::from(r).to_degrees() * 1000.0).round() / 1000.0;
    DecodedRow {
        t_us: s.t_us,
        device: s.device.0,
        tool: tool(p),
        in_range: p.in_range,
        tip: p.tip,
        pressure: p.pressure,
        x_mm: p.pos_mm.x,
        y_mm: p.pos_mm.y,
        x_raw: p.raw[0],
        y_raw: p.raw[1],
        tilt_x: p.tilt.map(|t| degrees(t.x)),
        tilt_y: p.tilt.map(|t| degrees(t.y)),
        distance: p.distance,
        buttons: p.buttons,
        hands: None,
        wheels: None,
        strips: None,
    }
}

fn hands_row(s: &Sample, h: &Hands) -> DecodedRow {
    let palm = h.as_slice().first().map_or(glam::Vec3::ZERO, |hand| hand.palm);
    DecodedRow {
        t_us: s.t_us,
        device: s.device.0,
        tool: "hands",
        in_range: h.count > 0,
        tip: false,
        pressure: None,
        x_mm: palm.x,
        y_mm: palm.y,
        x_raw: 0,
        y_raw: 0,
        tilt_x: None,
        tilt_y: None,
        distance: None,
        buttons: u32::from(h.count),
        hands: Some(h.as_slice().to_vec()),
        wheels: None,
        strips: None,
    }
}

/// Keys are the buttons, steps of the two wheels the raw axes.
fn pad_row(s: &Sample, pad: &Pad) -> DecodedRow {
    DecodedRow {
        t_us: s.t_us,
        device: s.device.0,
        tool: "pad",
        in_range: false,
        tip: false,
        pressure: None,
        x_mm: 0.0,
        y_mm: 0.0,
        x_raw: pad.wheels[0],
        y_raw: pad.wheels[1],
        tilt_x: None,
        tilt_y: None,
        distance: None,
        buttons: pad.keys,
        hands: None,
        wheels: Some(pad.wheels),
        strips: Some(pad.strips),
    }
}

fn tool(p: &Pen) -> &'static str {
    match p.tool {
        Tool::Pen => "pen",
        Tool::Eraser => "eraser",
        Tool::Mouse => "mouse",
        Tool::Touch => "touch",
    }
}

impl DecodedRow {
    fn line(&self, out: &mut String) {
        use std::fmt::Write as _;
        fn or_empty<T: std::fmt::Display>(v: Option<T>) -> String {
            v.map_or(String::new(), |v| v.to_string())
        }
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            self.t_us,
            self.device,
            self.tool,
            u8::from(self.in_range),
            u8::from(self.tip),
            or_empty(self.pressure),
            self.x_mm,
            self.y_mm,
            self.x_raw,
            self.y_raw,
            or_empty(self.tilt_x),
            or_empty(self.tilt_y),
            or_empty(self.distance),
            self.buttons
        );
    }
}
