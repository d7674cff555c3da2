//! The settings of a brush. Plain data: they travel in a command and are part of the world.
//!
//! [`super::preset`] holds the initial settings of each brush.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::BrushKind;
use super::alpha::Alpha;
use super::falloff::{CURVE, Falloff};
use super::options::{AutoMask, IMAGES, Mirror, PathSettings, TopologySettings};
use super::stamp::Stamp;
use sculptd_geometry::portable::PortableMath;

/// The curve from pressure (0 to 1) to a factor: `at_zero + (1 - at_zero) * pressure^gamma`.
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
    /// The factor for a pressure, which is clamped to 0 to 1.
    pub fn factor(&self, pressure: f32) -> f32 {
        let p = pressure.clamp(0.0, 1.0);
        let bent = if self.gamma == 1.0 { p } else { p.portable_powf(self.gamma.clamp(0.1, 10.0)) };
        let at_zero = self.at_zero.clamp(0.0, 1.0);
        at_zero + (1.0 - at_zero) * bent
    }
}

/// The number of extra settings of a brush; each brush's file names them.
pub const EXTRAS: usize = 4;

/// A brush as a person set it. Plain data: it is part of commands and of the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BrushSettings {
    /// The kind of brush.
    pub kind: BrushKind,
    /// Share of the work's bounding radius at load; 0.001 to 1. Multiplied out once, when the work
    /// is loaded or the setting changes, so that the brush does not breathe while the form grows.
    pub radius: f32,
    /// 0 to 1. For brushes that raise: over every fifth of the radius travelled a stroke lays down
    /// a dab `strength * radius` high, however many dabs that is made of
    /// ([`PathSettings::compensate`]).
    pub strength: f32,
    /// Carve instead of raise: what the brush does, the other way round.
    pub negative: bool,
    /// Distance between dabs as a share of the radius; 0.02 to 1.
    pub spacing: f32,
    /// The effect of pressure on the strength.
    pub pressure_strength: PressureCurve,
    /// The effect of pressure on the radius.
    pub pressure_radius: PressureCurve,
    /// Mirror over the planes x = 0, y = 0, z = 0 through the work's own middle at load.
    pub symmetry: [bool; 3],
    /// Any plane, and turns about an axis.
    pub mirror: Mirror,
    /// The fade of the brush from its middle to its rim.
    pub falloff: Falloff,
    /// Of a custom falloff: values at x = 0, 1/8, ... 1, each 0 to 1.
    pub curve: [f32; CURVE],
    /// The greatest distance that a stroke may move a vertex, in heights of one full dab: multiples
    /// of `strength * radius`. 0: no bound; else 1 to 1000. Other programs call 1 "accumulate off".
    pub saturation: f32,
    /// The share of the radius over which brushes that need a plane average the surface; 0.05 to 2.
    pub normal_radius: f32,
    /// Brushes that need a plane leave alone what is further from it than so many radii; 0:
    /// nothing; to 2.
    pub plane_trim: f32,
    /// Lean of the dab's direction from the surface normal to the pen's axis, 0 to 1. No effect
    /// without a tilt.
    pub tilt: f32,
    /// RGBA, sRGB: for brushes that paint.
    pub colour: [u8; 4],
    /// For brushes that press a picture of heights.
    pub alpha: Alpha,
    /// The placement of the alpha between the brush and the clay.
    pub stamp: Stamp,
    /// Automatic masking of dabs.
    pub auto: AutoMask,
    /// The conversion of the pen's path to dabs.
    pub path: PathSettings,
    /// Dynamic topology under the brush.
    pub topology: TopologySettings,
    /// The brush's own numbers, in the order of [`BrushKind::own_numbers`]; 0 beyond them.
    pub extra: [f32; EXTRAS],
    /// The share of the radius within which the brush works in full; the falloff runs over the
    /// rest. 0 to 0.95.
    pub hardness: f32,
    /// Evening after each dab, as the smooth brush does it at this strength; 0 to 1.
    pub auto_smooth: f32,
    /// On: a dab is measured on what the stroke has raised so far, and a stroke climbs upon itself.
    /// Off: on the surface as the stroke found it, for the brushes that can
    /// ([`super::Brush::FOUND`]), and where no triangles are cut.
    pub accumulate: bool,
    /// The brush follows the pen by a string of so many radii (at least a few pixels), which takes
    /// the tremble out of a hand and keeps a resting brush at rest. 0: no string; to 1.
    pub steady: f32,
    /// The preset that it began as: 0 the built-in one for its kind, else a user brush; see
    /// [`super::own_brush::preset_number`]. Does not change the brush's effect: the world remembers
    /// the settings of each brush by kind and preset.
    pub preset: u32,
}

impl Default for BrushSettings {
    fn default() -> Self {
        BrushSettings {
            kind: BrushKind::Draw,
            radius: 0.15,
            strength: 0.08,
            negative: false,
            spacing: 0.1,
            pressure_strength: PressureCurve::default(),
            pressure_radius: PressureCurve { at_zero: 0.5, gamma: 1.0 },
            symmetry: [false; 3],
            mirror: Mirror::default(),
            falloff: Falloff::Smooth,
            curve: [1.0, 0.95, 0.85, 0.7, 0.5, 0.3, 0.15, 0.05, 0.0],
            saturation: 0.0,
            normal_radius: 0.5,
            plane_trim: 0.0,
            tilt: 0.0,
            colour: [200, 90, 60, 255],
            alpha: Alpha::default(),
            stamp: Stamp::default(),
            auto: AutoMask::default(),
            path: PathSettings::default(),
            topology: TopologySettings::default(),
            extra: [0.0; EXTRAS],
            hardness: 0.0,
            auto_smooth: 0.0,
            accumulate: true,
            steady: 0.1,
            preset: 0,
        }
    }
}

impl BrushSettings {
    /// Returns the settings declared in the code: those of [`BrushSettings::default`] and the
    /// brush's extra numbers.
    pub fn new(kind: BrushKind) -> BrushSettings {
        let mut settings = BrushSettings { kind, ..BrushSettings::default() };
        for (value, number) in settings.extra.iter_mut().zip(kind.own_numbers()) {
            *value = number.value;
        }
        settings
    }

    /// Returns the key under which a brush's settings are remembered: its kind and its preset.
    pub fn key(&self) -> (BrushKind, u32) {
        (self.kind, self.preset)
    }

    /// Every number within its stated range; a NaN becomes the default.
    #[must_use]
    pub fn clamped(mut self) -> Self {
        let d = BrushSettings::default();
        self.each_number(|_, v, lo, hi, default| {
            *v = if v.is_finite() { v.clamp(lo, hi) } else { default }
        });
        if self.saturation < 1.0 {
            self.saturation = if self.saturation > 0.0 { 1.0 } else { 0.0 };
        }
        if !Vec3::from(self.mirror.plane).is_finite() {
            self.mirror.plane = d.mirror.plane;
        }
        self.mirror.radial = self.mirror.radial.clamp(1, 16);
        self.mirror.axis = self.mirror.axis.min(2);
        self.path.average = self.path.average.min(64);
        let extras = self.kind.own_numbers();
        for (v, e) in self.extra.iter_mut().zip(extras) {
            *v = if v.is_finite() { v.clamp(e.min, e.max) } else { e.value };
        }
        for v in &mut self.extra[extras.len().min(EXTRAS)..] {
            *v = 0.0;
        }
        self
    }

    /// Checks the range of every number.
    ///
    /// # Errors
    /// Returns the key, the value and the range of the first number out of range.
    pub fn check(&self) -> Result<(), String> {
        let mut wrong = None;
        let mut copy = *self;
        copy.each_number(|key, v, lo, hi, _| {
            if !(*v >= lo && *v <= hi) && wrong.is_none() {
                wrong = Some(format!("brush.{key} = {v}: expected a number from {lo} to {hi}"));
            }
        });
        for (v, e) in self.extra.iter().zip(self.kind.own_numbers()) {
            if !(*v >= e.min && *v <= e.max) && wrong.is_none() {
                wrong = Some(format!(
                    "brush.extra ({}) = {v}: expected {} to {}",
                    e.name, e.min, e.max
                ));
            }
        }
        let count = |key: &str, v: u32, lo: u32, hi: u32| {
            (v < lo || v > hi)
                .then(|| format!("brush.{key} = {v}: expected a whole number from {lo} to {hi}"))
        };
        let wrong = wrong
            .or_else(|| count("mirror.radial", self.mirror.radial.into(), 1, 16))
            .or_else(|| {
                let (radial, most) = (self.mirror.radial, self.most_copies());
                (radial > most).then(|| {
                    format!(
                        "brush.mirror.radial = {radial}: expected at most {most} with these \
                         mirrors, as a brush has at most {IMAGES} images"
                    )
                })
            })
            .or_else(|| count("mirror.axis", self.mirror.axis.into(), 0, 2))
            .or_else(|| count("path.average", self.path.average.into(), 0, 64));
        wrong.map_or(Ok(()), Err)
    }

    /// The most copies about the axis, 1 to 16, beside these mirrors: a brush has at most
    /// [`IMAGES`] images, and those beyond are left out.
    pub fn most_copies(&self) -> u8 {
        let planes = self.symmetry.iter().filter(|on| **on).count()
            + usize::from(self.mirror.plane != [0.0; 3]);
        (IMAGES >> planes).clamp(1, 16) as u8
    }

    /// Calls `f(key, value, least, most, default)` for each number with a plain range.
    fn each_number(&mut self, mut f: impl FnMut(&str, &mut f32, f32, f32, f32)) {
        let d = BrushSettings::default();
        f("radius", &mut self.radius, 0.001, 1.0, d.radius);
        f("strength", &mut self.strength, 0.0, 1.0, d.strength);
        f("spacing", &mut self.spacing, 0.02, 1.0, d.spacing);
        for (name, curve, default) in [
            ("strength", &mut self.pressure_strength, d.pressure_strength),
            ("radius", &mut self.pressure_radius, d.pressure_radius),
        ] {
            f(&format!("pressure_{name}.at_zero"), &mut curve.at_zero, 0.0, 1.0, default.at_zero);
            f(&format!("pressure_{name}.gamma"), &mut curve.gamma, 0.1, 10.0, default.gamma);
        }
        for (v, default) in self.curve.iter_mut().zip(d.curve) {
            f("curve", v, 0.0, 1.0, default);
        }
        f("saturation", &mut self.saturation, 0.0, 1000.0, 0.0);
        f("normal_radius", &mut self.normal_radius, 0.05, 2.0, d.normal_radius);
        f("plane_trim", &mut self.plane_trim, 0.0, 2.0, 0.0);
        f("stamp.size", &mut self.stamp.size, 0.05, 10.0, 1.0);
        f("stamp.turn_degrees", &mut self.stamp.turn_degrees, -180.0, 180.0, 0.0);
        for v in &mut self.stamp.at {
            f("stamp.at", v, -4.0, 4.0, 0.0);
        }
        f("tilt", &mut self.tilt, 0.0, 1.0, 0.0);
        f("mirror.offset", &mut self.mirror.offset, -10.0, 10.0, 0.0);
        f("auto.normal_degrees", &mut self.auto.normal_degrees, 0.0, 180.0, 0.0);
        f("auto.cavity", &mut self.auto.cavity, -1.0, 1.0, 0.0);
        f("topology.edge", &mut self.topology.edge, 0.002, 1.0, d.topology.edge);
        f("hardness", &mut self.hardness, 0.0, 0.95, 0.0);
        f("auto_smooth", &mut self.auto_smooth, 0.0, 1.0, 0.0);
        f("steady", &mut self.steady, 0.0, 1.0, d.steady);
        f("path.rope", &mut self.path.rope, 0.0, 0.5, 0.0);
        f("path.jitter", &mut self.path.jitter, 0.0, 2.0, 0.0);
        f("path.every_ticks", &mut self.path.every_ticks, 1.0, 1000.0, d.path.every_ticks);
    }
}
