//! What a person sets on a brush. Plain data: it travels in a [`crate::command::Command`] and is part of the world.

use serde::{Deserialize, Serialize};

/// How pressure (0 to 1) becomes a factor: `at_zero + (1 - at_zero) * pressure^gamma`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PressureCurve {
    /// The factor at no pressure, 0 to 1. 1: pressure does not matter.
    pub at_zero: f32,
    /// Above 1 the light touch is finer, below 1 it is bolder. 0.1 to 10.
    pub gamma: f32,
}

impl Default for PressureCurve {
    fn default() -> Self {
        PressureCurve { at_zero: 0.0, gamma: 1.0 }
    }
}

impl PressureCurve {
    pub fn factor(&self, pressure: f32) -> f32 {
        let p = pressure.clamp(0.0, 1.0);
        let bent = if self.gamma == 1.0 { p } else { p.powf(self.gamma.clamp(0.1, 10.0)) };
        let at_zero = self.at_zero.clamp(0.0, 1.0);
        at_zero + (1.0 - at_zero) * bent
    }
}

/// Which kernel a dab runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrushKind {
    /// A bell along the surface normal (Cipollini 2020).
    #[default]
    Gaussian,
    /// Cotangent-weighted Laplacian.
    Smooth,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BrushSettings {
    pub kind: BrushKind,
    /// Share of the work's bounding radius at load; 0.001 to 1. Multiplied out once, when the work is loaded or the
    /// setting changes, so that the brush does not breathe while the form grows.
    pub radius: f32,
    /// 0 to 1. Gaussian: the height of one full dab is `strength * radius`.
    pub strength: f32,
    /// Carve instead of raise.
    pub negative: bool,
    /// Distance between dabs as a share of the radius; 0.02 to 1.
    pub spacing: f32,
    pub pressure_strength: PressureCurve,
    pub pressure_radius: PressureCurve,
    /// Mirror over the planes x = 0, y = 0, z = 0 through the work's own middle at load.
    pub symmetry: [bool; 3],
}

impl Default for BrushSettings {
    fn default() -> Self {
        BrushSettings {
            kind: BrushKind::Gaussian,
            radius: 0.15,
            strength: 0.08,
            negative: false,
            spacing: 0.2,
            pressure_strength: PressureCurve::default(),
            pressure_radius: PressureCurve { at_zero: 0.5, gamma: 1.0 },
            symmetry: [false; 3],
        }
    }
}

impl BrushSettings {
    /// Every number within its stated range; a NaN becomes the default.
    #[must_use]
    pub fn clamped(mut self) -> Self {
        let d = BrushSettings::default();
        let keep =
            |v: f32, lo: f32, hi: f32, default: f32| if v.is_finite() { v.clamp(lo, hi) } else { default };
        self.radius = keep(self.radius, 0.001, 1.0, d.radius);
        self.strength = keep(self.strength, 0.0, 1.0, d.strength);
        self.spacing = keep(self.spacing, 0.02, 1.0, d.spacing);
        for (curve, default) in [
            (&mut self.pressure_strength, d.pressure_strength),
            (&mut self.pressure_radius, d.pressure_radius),
        ] {
            curve.at_zero = keep(curve.at_zero, 0.0, 1.0, default.at_zero);
            curve.gamma = keep(curve.gamma, 0.1, 10.0, default.gamma);
        }
        self
    }
}
