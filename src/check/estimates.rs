//! Rough figures of a part: weight, time, cooling, clamping.

use crate::preset::{MaterialPreset, ProcessPreset};

/// The weight in grams of a volume in cubic millimetres.
pub fn weight(volume: f64, material: &MaterialPreset) -> f64 {
    volume * material.density * 1e-3
}

/// The time in seconds that a part of this volume (mm3) and so many layers takes: the material laid
/// down at the process's rate, and the time of each layer. `None` for a process without layers.
pub fn build_time(volume: f64, layers: usize, process: &ProcessPreset) -> Option<f64> {
    let each = process.layer_seconds?;
    let laid = process.extrusion.map_or(0.0, |rate| volume / rate);
    Some(laid + layers as f64 * each)
}

/// The time in seconds until the middle of the thickest wall (mm) has cooled to the temperature of
/// ejection: t = s2 / (pi2 a) ln(4/pi (Tm - Tw) / (Te - Tw)), with the wall s, the effective
/// thermal diffusivity a, and the temperatures of the melt, the mould's wall and ejection (Ballman
/// and Shusman, "Easy way to calculate injection molding setup time", Modern Plastics, 1959;
/// Menges, Michaeli and Mohren, "How to Make Injection Molds", 2001). `None` where the material
/// does not state its constants.
pub fn cooling_time(thickest: f64, material: &MaterialPreset) -> Option<f64> {
    let (a, melt) = (material.diffusivity?, material.melt?);
    let (wall, eject) = (material.mould?, material.eject?);
    let pi = std::f64::consts::PI;
    let ratio = 4.0 / pi * (melt - wall) / (eject - wall);
    let time = thickest * thickest / (pi * pi * a) * ratio.ln();
    Some(time.max(0.0))
}

/// The force in kN that keeps a mould closed: the projected area (mm2) times the pressure in the
/// cavity.
pub fn clamping_force(projected_area: f64, material: &MaterialPreset) -> Option<f64> {
    Some(projected_area * material.cavity_pressure? * 1e-3)
}
