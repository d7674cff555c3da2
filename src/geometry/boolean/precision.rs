//! The resolution of an operand's coordinates, and the tolerance that follows from it.
//!
//! A face that two solids share is stored twice, and each copy is rounded separately: to 53 bits,
//! to the 24 bits of single precision (STL, PLY, glTF and the clay itself), or to the digits of a
//! text file. Contact can be recognised only within that rounding. The precision is found from the
//! coordinates themselves, so that it does not depend on the mesh's history.

use glam::DVec3;
use serde::Serialize;

use super::box_tree::Span;
use crate::PolyMesh;

/// The rounding of a mesh's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 53 bits, or values so short that they are taken as exact (a box at whole numbers).
    Double,
    /// 24 bits.
    Single,
    /// A fixed number of decimal digits, coarser than single precision or beside it.
    Decimal,
}

impl Precision {
    /// The precision in words.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Double => "double precision",
            Precision::Single => "single precision",
            Precision::Decimal => "decimal digits",
        }
    }
}

/// The resolution of one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// The rounding of its coordinates.
    pub precision: Precision,
    /// Largest rounding error of one coordinate, in the mesh's unit.
    pub error: f64,
}

/// The tolerance that [`super::compute`] takes where none is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DefaultTolerance {
    /// Length within which places are one, in the operands' unit.
    pub tolerance: f64,
    /// The coarser precision of the two operands.
    pub precision: Precision,
}

/// Coordinates of this share of the size or more are decimals of a drawing, not rounded values.
const COARSEST: f64 = 1e-4;
/// Rounded places can be this many coordinate errors apart: two points at 2 sqrt(3) errors, and as
/// much again where a point was computed from rounded ones.
const ERRORS: f64 = 8.0;
/// Values with fewer digits are not rounded ones.
const LEAST_DIGITS: i32 = 5;
/// Vertices that are looked at.
const SAMPLES: usize = 512;

/// The tolerance for two operands: 8 errors of the coarser one, at least 2^-38 of the largest
/// coordinate (the 17 digits of double precision leave 2^-53 of it), at most 1e-4 of the size of
/// the smaller operand.
pub fn default_tolerance(operands: [&PolyMesh; 2]) -> DefaultTolerance {
    tolerance_of(operands.map(OperandScale::of))
}

/// The size of an operand and the resolution of its coordinates: all that a tolerance depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct OperandScale {
    /// The box around all vertices, or a larger one.
    pub span: Span,
    /// The rounding of the coordinates.
    pub resolution: Resolution,
}

impl OperandScale {
    pub fn of(mesh: &PolyMesh) -> OperandScale {
        let span = Span::of(mesh.positions.iter().copied());
        OperandScale { span, resolution: resolution(mesh) }
    }

    /// The largest coordinate.
    pub fn reach(&self) -> f64 {
        let far = self.span.lo.abs().max(self.span.hi.abs()).max_element();
        // The box of nothing is endless.
        if far.is_finite() { far } else { 0.0 }
    }

    /// The longest side of the box.
    fn extent(&self) -> f64 {
        (self.span.hi - self.span.lo).max_element().max(0.0)
    }
}

/// As [`default_tolerance`].
pub(super) fn tolerance_of(operands: [OperandScale; 2]) -> DefaultTolerance {
    let reach = operands.map(|o| o.reach());
    let largest = reach[0].max(reach[1]);
    let found = operands.map(|o| o.resolution);
    let precision = found[0].precision.max(found[1].precision);
    let mut error = found[0].error.max(found[1].error);
    if found.iter().any(|r| r.precision == Precision::Single) {
        // A tool that was moved in double precision was single precision once.
        error = error.max(single_error(largest));
    }
    let size =
        operands.map(|o| o.extent()).into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let least = largest * 2f64.powi(-38);
    let most = if size.is_finite() { (size * COARSEST).max(least) } else { least };
    let wanted = if precision == Precision::Double { 0.0 } else { ERRORS * error };
    DefaultTolerance { tolerance: wanted.clamp(least, most), precision }
}

/// The tolerance for a mesh in single precision whose coordinates reach as far as `reach`, and an
/// other operand of `size`, which may have been moved in double precision: 8 errors of single
/// precision at that distance, at most 1e-4 of the size. For live clay, which is not looked at as a
/// whole.
pub fn single_tolerance(reach: f64, size: f64) -> f64 {
    let least = reach * 2f64.powi(-38);
    (ERRORS * single_error(reach)).min((size * COARSEST).max(least)).max(least)
}

/// Half of the last place of a number of this size in single precision.
fn single_error(reach: f64) -> f64 {
    if reach > 0.0 { 2f64.powi(reach.log2().floor() as i32 - 24) } else { 0.0 }
}

/// The longest side of the box around a mesh.
fn extent(mesh: &PolyMesh) -> f64 {
    let (lo, hi) = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    if mesh.positions.is_empty() { 0.0 } else { (hi - lo).max_element() }
}

/// Returns the resolution of a mesh's coordinates, from up to 512 vertices. A value counts as
/// rounded only if its digits are used up, so that whole numbers and short decimals are exact.
pub fn resolution(mesh: &PolyMesh) -> Resolution {
    let reach = mesh.positions.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    let double = Resolution { precision: Precision::Double, error: reach * 2f64.powi(-53) };
    let step = mesh.positions.len().div_ceil(SAMPLES).max(1);
    let values: Vec<f64> = mesh
        .positions
        .iter()
        .step_by(step)
        .flat_map(|p| p.to_array())
        .filter(|v| *v != 0.0)
        .collect();
    let single = Resolution { precision: Precision::Single, error: single_error(reach) };
    if values.iter().all(|&v| f64::from(v as f32) == v) {
        let bits = |v: f64| 53 - (v.to_bits() | 1 << 52).trailing_zeros().min(52);
        let full = values.iter().any(|&v| bits(v) > 20);
        return if full { single } else { double };
    }
    // Single precision in a text file: the number nearest to it that the digits allow.
    let (mut near_single, mut long) = (true, 0);
    let mut short: Vec<(i32, i32, i32)> = Vec::new();
    for &v in &values {
        let (digits, decimals) = decimal(v);
        if digits > 12 {
            // A few long values among short ones are computed ones in a mesh that was rounded.
            long += 1;
            if long > 8 || long * 4 > values.len() {
                return double;
            }
            continue;
        }
        near_single &= (v - f64::from(v as f32)).abs() <= 0.5 * 10f64.powi(-decimals);
        short.push((digits - decimals, digits, decimals));
    }
    // The digits of the longest value after the point of the largest one: exact where digits are
    // counted, and where decimals are counted and a largest value uses all of them.
    let Some(&(largest, ..)) = short.iter().max_by_key(|d| d.0) else { return double };
    let longest = short.iter().map(|d| d.1).max().unwrap_or(0);
    let most = longest - largest;
    let error = 0.5 * 10f64.powi(-most);
    let full = short.iter().filter(|d| d.1 >= LEAST_DIGITS && d.2 >= most).count();
    let used = short.len() >= 6 && full * 2 >= short.len();
    let rounded = used && 2.0 * error <= COARSEST * extent(mesh);
    match (rounded, near_single) {
        (true, true) if error < single.error => single,
        (true, _) => Resolution { precision: Precision::Decimal, error },
        _ => double,
    }
}

/// Significant digits of the shortest decimal that is this number, and how many of them stand
/// behind the point.
fn decimal(v: f64) -> (i32, i32) {
    let text = format!("{v:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = mantissa.bytes().filter(u8::is_ascii_digit).count() as i32;
    let exponent: i32 = exponent.parse().unwrap_or(0);
    (digits, digits - 1 - exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;
    use glam::DMat3;

    fn turned() -> PolyMesh {
        let mut m = cuboid(DVec3::new(-1.0, -2.0, 0.0), DVec3::new(3.0, 1.0, 2.5));
        let turn = DMat3::from_axis_angle(DVec3::new(0.3, -0.7, 0.55).normalize(), 0.7);
        m.positions.iter_mut().for_each(|p| *p = turn * *p);
        m
    }

    fn mapped(m: &PolyMesh, round: impl Fn(f64) -> f64) -> PolyMesh {
        let mut m = m.clone();
        m.positions.iter_mut().for_each(|p| *p = p.to_array().map(&round).into());
        m
    }

    fn text(v: f64, precision: usize) -> f64 {
        format!("{v:.precision$}").parse().expect("a number")
    }

    #[test]
    fn each_precision_is_found_from_the_coordinates() {
        let m = turned();
        let nine = |v: f64| format!("{v:.8e}").parse::<f64>().expect("a number");
        assert_eq!(resolution(&m).precision, Precision::Double);
        let single = resolution(&mapped(&m, |v| f64::from(v as f32)));
        assert_eq!(single.precision, Precision::Single);
        assert_eq!(single.error, 2f64.powi(-23));
        let six = resolution(&mapped(&m, |v| text(v, 6)));
        assert_eq!((six.precision, six.error), (Precision::Decimal, 0.5e-6));
        let digits = resolution(&mapped(&m, nine));
        assert_eq!((digits.precision, digits.error), (Precision::Decimal, 0.5e-8));
        let written = resolution(&mapped(&m, |v| nine(f64::from(v as f32))));
        assert_eq!(written.precision, Precision::Single);
    }

    #[test]
    fn digits_are_counted_from_the_largest_value() {
        let nine = |v: f64| format!("{v:.8e}").parse::<f64>().expect("a number");
        let mut m = turned();
        m.positions.iter_mut().for_each(|p| *p += DVec3::new(10.3, -7.7, 0.01));
        assert_eq!(resolution(&mapped(&m, nine)).error, 0.5e-7);
        // A corner at the shift itself has few digits.
        m.positions[0] = DVec3::new(10.3, -7.7, 0.01);
        assert_eq!(resolution(&mapped(&m, nine)).error, 0.5e-7);
    }

    #[test]
    fn drawings_are_exact() {
        let m = cuboid(DVec3::ZERO, DVec3::new(2.0, 12.25, 0.1));
        assert_eq!(resolution(&m).precision, Precision::Double);
        let found = default_tolerance([&m, &m]);
        assert_eq!(found.tolerance, 12.25 * 2f64.powi(-38));
    }

    #[test]
    fn the_tolerance_grows_with_the_distance_from_the_origin_and_is_bounded() {
        let near = mapped(&turned(), |v| f64::from(v as f32));
        let far = mapped(&turned(), |v| f64::from((v + 1000.0) as f32));
        let gone = mapped(&turned(), |v| f64::from((v + 1e7) as f32));
        let [n, f, g] = [&near, &far, &gone].map(|m| default_tolerance([m, m]).tolerance);
        assert_eq!(n, 8.0 * 2f64.powi(-23));
        assert_eq!(f, 8.0 * 2f64.powi(-15));
        assert!(g <= 1e-4 * extent(&gone));
    }
}
