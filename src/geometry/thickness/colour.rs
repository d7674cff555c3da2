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
    let at = ((value - low) / span).clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let i = (at as usize).min(STOPS.len() - 2);
    let f = at - i as f32;
    std::array::from_fn(|k| (STOPS[i][k] + (STOPS[i + 1][k] - STOPS[i][k]) * f).round() as u8)
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
