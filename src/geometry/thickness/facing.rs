//! When two sides face each other, as the sides of a wall do, and when they meet at an edge.

/// cos 40 degrees: sides that meet at a larger angle make an edge, not a thin wall.
pub(super) const OPPOSED: f64 = 0.766_044_443;
/// Cosine below which rounding may have turned a right angle: 89.99 degrees. A side that is turned
/// so far is beside a ray and not ahead.
pub(super) const GRAZING: f64 = 2e-4;

/// The cosine of the angle between two facets, one of them turned round, that rounding may make of
/// a right angle.
pub(super) fn grazing(tilts: &[f32], s: u32, t: u32) -> f64 {
    GRAZING + f64::from(tilts[s as usize]) + f64::from(tilts[t as usize])
}
