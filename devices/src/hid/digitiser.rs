//! Any pen that its report descriptor describes.

use super::descriptor::{Descriptor, PenLayout};
use super::report::{Parsed, PenReport};
use crate::Tool;

pub fn parse(b: &[u8], descriptor: &Descriptor) -> Parsed {
    let of_id = |l: &&PenLayout| l.report_id.is_none_or(|id| b.first() == Some(&id));
    let Some(layout) = descriptor.pens.iter().find(of_id) else { return Parsed::Nothing };
    let set = |bits: &Option<super::descriptor::Bits>| bits.as_ref().and_then(|f| f.set(b));
    if set(&layout.in_range) == Some(false) {
        return Parsed::Away;
    }
    let read = |bits: &Option<super::descriptor::Bits>| bits.as_ref().and_then(|f| f.read(b));
    let (Some(x), Some(y)) = (read(&layout.x), read(&layout.y)) else { return Parsed::Broken };
    let (tip, eraser) = (set(&layout.tip), set(&layout.eraser));
    let inverted = set(&layout.invert).unwrap_or(false) || eraser.unwrap_or(false);
    let barrel = |i: usize| u32::from(set(&layout.barrel[i]).unwrap_or(false)) << i;
    let degrees = |bits: &Option<super::descriptor::Bits>, full: f64| {
        bits.as_ref().and_then(|f| f.read(b).map(|v| f.degrees(v, full) as f32))
    };
    let tilt = match (degrees(&layout.tilt[0], 90.0), degrees(&layout.tilt[1], 90.0)) {
        (Some(x), Some(y)) => Some([x, y]),
        _ => None,
    };
    Parsed::Pen(PenReport {
        tool: Some(if inverted { Tool::Eraser } else { Tool::Pen }),
        tip: match (tip, eraser) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(false) || b.unwrap_or(false)),
        },
        pos: Some([x, y]),
        pressure: layout
            .pressure
            .as_ref()
            .and_then(|f| f.read(b).map(|v| v.saturating_sub(f.min).max(0) as u32)),
        tilt,
        twist: degrees(&layout.twist, 360.0).map(f32::to_radians),
        distance: read(&layout.distance).map(|d| d.max(0) as u32),
        buttons: Some(barrel(0) | barrel(1) | barrel(2)),
    })
}
