//! How a brush fades from its middle to its rim.

use serde::{Deserialize, Serialize};

use super::weights::exp;

/// A profile over `x`, the distance to the brush's middle as a share of its radius. All are 1 at
/// the middle (to 4e-6) and 0 from the rim on, [`Falloff::Constant`] excepted, which is 1 up to the
/// rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Falloff {
    /// `exp(-(3.5 x)^2 / (2 * 0.7^2))`: the bell of Cipollini 2020.
    Gaussian,
    /// `3 t^2 - 2 t^3` with `t = 1 - x`: flat at both ends.
    #[default]
    Smooth,
    /// `sqrt(1 - x^2)`: a ball.
    Sphere,
    /// `sqrt(1 - x)`: broad, steep at the rim.
    Root,
    /// `(1 - x)^2`: pointed.
    Sharp,
    /// `1 - x`: a cone.
    Linear,
    /// 1 everywhere: a punch.
    Constant,
    /// Through nine values at x = 0, 1/8, ... 1: see [`CURVE`].
    Custom,
}

/// Values of a custom falloff, evenly spaced from the middle to the rim.
pub const CURVE: usize = 9;

impl Falloff {
    /// Every profile.
    pub const ALL: [Falloff; 8] = [
        Falloff::Gaussian,
        Falloff::Smooth,
        Falloff::Sphere,
        Falloff::Root,
        Falloff::Sharp,
        Falloff::Linear,
        Falloff::Constant,
        Falloff::Custom,
    ];

    /// The profile at `x` >= 0; `curve` matters to [`Falloff::Custom`] only.
    #[inline]
    pub fn at(self, x: f32, curve: &[f32; CURVE]) -> f32 {
        if x < 1.0 { self.within(x, curve) } else { 0.0 }
    }

    /// The profile at `x` from 0 to 1; beyond that any number, or none.
    #[inline(always)]
    pub(super) fn within(self, x: f32, curve: &[f32; CURVE]) -> f32 {
        let t = 1.0 - x;
        match self {
            Falloff::Gaussian => exp(x * x * -12.5),
            Falloff::Smooth => t * t * (3.0 - 2.0 * t),
            Falloff::Sphere => (t * (1.0 + x)).sqrt(),
            Falloff::Root => t.sqrt(),
            Falloff::Sharp => t * t,
            Falloff::Linear => t,
            Falloff::Constant => 1.0,
            Falloff::Custom => custom(x, curve),
        }
    }
}

/// Catmull-Rom through the values, held within 0 to 1.
fn custom(x: f32, curve: &[f32; CURVE]) -> f32 {
    let at = x.max(0.0) * (CURVE - 1) as f32;
    let i = (at as usize).min(CURVE - 2);
    let t = at - i as f32;
    let (b, c) = (curve[i], curve[i + 1]);
    let a = if i == 0 { b } else { curve[i - 1] };
    let d = if i + 2 < CURVE { curve[i + 2] } else { c };
    let bend = ((d - a + (b - c) * 3.0) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d)) * t + (c - a);
    (b + 0.5 * t * bend).max(0.0).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_is_one_in_the_middle_never_rises_and_ends_at_the_rim() {
        let curve = std::array::from_fn(|i| 1.0 - i as f32 / 8.0);
        for f in Falloff::ALL {
            assert!((f.at(0.0, &curve) - 1.0).abs() < 4e-6, "{f:?}");
            let mut last = f32::INFINITY;
            for i in 0..=1000 {
                let y = f.at(i as f32 / 1000.0, &curve);
                assert!((0.0..=1.0).contains(&y) && y <= last, "{f:?} at {i}: {y} after {last}");
                last = y;
            }
            assert_eq!(f.at(1.0, &curve), 0.0);
            assert_eq!(f.at(f32::NAN, &curve), 0.0);
        }
    }

    #[test]
    fn the_profiles_are_the_formulas() {
        let c = [1.0, 0.9, 0.8, 0.2, 0.5, 0.5, 0.5, 0.1, 0.0];
        let at = |f: Falloff| f.at(0.25, &c);
        for (got, want) in [
            (at(Falloff::Smooth), 0.84375),
            (at(Falloff::Sphere), 0.9375f32.sqrt()),
            (at(Falloff::Root), 0.75f32.sqrt()),
            (at(Falloff::Sharp), 0.5625),
            (at(Falloff::Linear), 0.75),
            (at(Falloff::Constant), 1.0),
            (at(Falloff::Custom), 0.8),
            // x = 3.5 / 4 of the profile's reach over sigma 0.7: exp(-0.78125).
            (at(Falloff::Gaussian), (-0.78125f32).exp()),
        ] {
            assert!((got - want).abs() < 1e-6, "{got} for {want}");
        }
    }
}
