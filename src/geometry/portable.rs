//! Sines, powers and turns with the same bits on every machine.
//!
//! The standard library's `sin`, `exp`, `powf` and their kin are the operating system's, which
//! picks another implementation by the processor: the same stroke then makes another clay, and two
//! machines that replay one session part ways. [`PortableMath`] is the crate `libm` (a port of
//! musl's functions), whose arithmetic is IEEE 754 addition, multiplication and square root alone.
//! Errors are below one unit in the last place; the ranges are those of the functions themselves.
//!
//! Law kept here: whatever becomes a bit of the clay is computed by these functions; the lints of
//! the crates that make clay refuse the others.

use glam::{Mat3, Quat, Vec3};

/// The functions of one float type. Angles are in radians.
pub trait PortableMath: Sized {
    /// The sine.
    fn portable_sin(self) -> Self;
    /// The cosine.
    fn portable_cos(self) -> Self;
    /// The tangent.
    fn portable_tan(self) -> Self;
    /// The angle, 0 to pi, of a cosine of -1 to 1; else not a number.
    fn portable_acos(self) -> Self;
    /// The angle, -pi to pi, of the point (`x`, `self`).
    fn portable_atan2(self, x: Self) -> Self;
    /// `e` to this power.
    fn portable_exp(self) -> Self;
    /// The natural logarithm of this number, which is above 0.
    fn portable_ln(self) -> Self;
    /// This number, which is not negative, to a power.
    fn portable_powf(self, power: Self) -> Self;
    /// The length of (`self`, `y`), without overflow.
    fn portable_hypot(self, y: Self) -> Self;
    /// The sine and the cosine.
    fn portable_sin_cos(self) -> (Self, Self);
}

impl PortableMath for f32 {
    fn portable_sin(self) -> f32 {
        libm::sinf(self)
    }
    fn portable_cos(self) -> f32 {
        libm::cosf(self)
    }
    fn portable_tan(self) -> f32 {
        libm::tanf(self)
    }
    fn portable_acos(self) -> f32 {
        libm::acosf(self)
    }
    fn portable_atan2(self, x: f32) -> f32 {
        libm::atan2f(self, x)
    }
    fn portable_exp(self) -> f32 {
        libm::expf(self)
    }
    fn portable_ln(self) -> f32 {
        libm::logf(self)
    }
    fn portable_powf(self, power: f32) -> f32 {
        libm::powf(self, power)
    }
    fn portable_hypot(self, y: f32) -> f32 {
        libm::hypotf(self, y)
    }
    fn portable_sin_cos(self) -> (f32, f32) {
        libm::sincosf(self)
    }
}

impl PortableMath for f64 {
    fn portable_sin(self) -> f64 {
        libm::sin(self)
    }
    fn portable_cos(self) -> f64 {
        libm::cos(self)
    }
    fn portable_tan(self) -> f64 {
        libm::tan(self)
    }
    fn portable_acos(self) -> f64 {
        libm::acos(self)
    }
    fn portable_atan2(self, x: f64) -> f64 {
        libm::atan2(self, x)
    }
    fn portable_exp(self) -> f64 {
        libm::exp(self)
    }
    fn portable_ln(self) -> f64 {
        libm::log(self)
    }
    fn portable_powf(self, power: f64) -> f64 {
        libm::pow(self, power)
    }
    fn portable_hypot(self, y: f64) -> f64 {
        libm::hypot(self, y)
    }
    fn portable_sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
    }
}

/// The turn by `angle` radians about `axis`, which has unit length, right-handed.
pub fn turn_about(axis: Vec3, angle: f32) -> Quat {
    let (s, c) = (angle * 0.5).portable_sin_cos();
    let v = axis * s;
    Quat::from_xyzw(v.x, v.y, v.z, c)
}

/// The same turn as a matrix.
pub fn turn_matrix(axis: Vec3, angle: f32) -> Mat3 {
    Mat3::from_quat(turn_about(axis, angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_the_functions_they_are_named_after() {
        for i in -200..=200 {
            let x = i as f32 * 0.037;
            let near =
                |a: f32, b: f32| assert!((a - b).abs() <= 3e-7 * b.abs().max(1.0), "{a} {b}");
            near(x.portable_sin(), x.sin());
            near(x.portable_cos(), x.cos());
            near(x.portable_exp().min(1e3), x.exp().min(1e3));
            near((x * x + 0.1).portable_ln(), (x * x + 0.1).ln());
            near(x.abs().portable_powf(0.618), x.abs().powf(0.618));
            near(x.portable_atan2(0.3), x.atan2(0.3));
            near(x.portable_hypot(1.5), x.hypot(1.5));
            near((x / 7.5).portable_acos(), (x / 7.5).acos());
            let turn = turn_about(Vec3::Y, x);
            assert!(turn.dot(Quat::from_rotation_y(x)).abs() > 1.0 - 1e-6);
        }
        assert!(0.3f64.portable_sin_cos() == (0.3f64.portable_sin(), 0.3f64.portable_cos()));
    }

    /// These are the bits on every machine; a new version of `libm` that changes one changes
    /// every sculpture's hash, and must be told as such.
    #[test]
    fn the_bits_are_known() {
        let mut all = 0xcbf2_9ce4_8422_2325u64;
        let mut put = |v: f32| all = (all ^ u64::from(v.to_bits())).wrapping_mul(0x100_0000_01b3);
        for i in -500..=500 {
            let x = i as f32 * 0.013_7;
            put(x.portable_sin());
            put(x.portable_cos());
            put(x.portable_tan());
            put(x.portable_exp());
            put(x.abs().portable_powf(1.7));
            put(x.portable_atan2(0.7));
            put(x.portable_hypot(0.9));
            put((x / 7.0).portable_acos());
        }
        assert_eq!(format!("{all:016x}"), "4f7697ad313eed6c");
    }
}
