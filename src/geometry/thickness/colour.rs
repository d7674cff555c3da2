//! The colour map: thin is dark red, thick pale yellow, missing blue. Lightness rises all the way,
//! so that it reads in grey print and without red-green vision.

use super::Thickness;

/// Missing values.
pub const NONE: [u8; 3] = [40, 90, 220];

const STOPS: [[f32; 3]; 5] = [
    [88.0, 0.0, 24.0],
    [176.0, 12.0, 32.0],
    [230.0, 85.0, 30.0],
    [252.0, 178.0, 72.0],
    [255.0, 250.0, 205.0],
];

/// The colour of a value on a scale from `low` to `high`; sRGB.
pub fn colour(value: f32, low: f32, high: f32) -> [u8; 3] {
    if !value.is_finite() {
        return NONE;
    }
    let span = if high > low { high - low } else { 1.0 };
    mixed(&STOPS, (value - low) / span)
}

/// Places of a later version that are not compared with the earlier one.
pub const NOT_COMPARED: [u8; 3] = [128, 128, 128];

/// Thinner is red, thicker blue; both darken away from the pale middle.
const CHANGES: [[f32; 3]; 5] = [
    [158.0, 28.0, 32.0],
    [228.0, 138.0, 92.0],
    [238.0, 236.0, 228.0],
    [104.0, 160.0, 214.0],
    [24.0, 62.0, 150.0],
];

/// The colour of a change of a wall, on a scale from minus to plus `most`; sRGB.
pub fn change_colour(change: f32, most: f32) -> [u8; 3] {
    if !change.is_finite() {
        return NOT_COMPARED;
    }
    mixed(&CHANGES, 0.5 + 0.5 * change / most.max(f32::MIN_POSITIVE))
}

/// The colour at a share of a scale.
fn mixed(stops: &[[f32; 3]; 5], share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let i = (at as usize).min(stops.len() - 2);
    let f = at - i as f32;
    std::array::from_fn(|k| (stops[i][k] + (stops[i + 1][k] - stops[i][k]) * f).round() as u8)
}

impl Thickness {
    /// The scale of the map: from the smallest value, or 0 if it is far below, to the 98th
    /// percentile, so that one deep corner does not take all the colours.
    pub fn scale(&self) -> (f32, f32) {
        (self.quantile(0.0).unwrap_or(0.0), self.quantile(0.98).unwrap_or(1.0))
    }

    /// One colour a vertex.
    pub fn colours(&self, (low, high): (f32, f32)) -> Vec<[u8; 3]> {
        self.values.iter().map(|&v| colour(v, low, high)).collect()
    }
}
