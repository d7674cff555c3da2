//! A region of a plane, and the places in it that are far enough from its boundary.
//!
//! The plane is divided into squares, and a square is divided further only where some place in it
//! may be far enough: its centre's distance to the boundary plus half its diagonal bounds that of
//! every place in it (Garcia-Castellanos and Lombardo, "Poles of inaccessibility", 2007).

use glam::DVec2;

/// Squares along the longest side, at most, where places are collected.
const FINEST: f64 = 96.0;
/// Squares that are looked at, at most, to find the widest place.
const MOST: usize = 20_000;

/// A region of a plane, by the lines of its boundary.
#[derive(Debug, Clone, Default)]
pub(super) struct SectionRegion {
    lines: Vec<[DVec2; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Square {
    centre: DVec2,
    half: f64,
    /// Of the centre.
    clearance: f64,
}

impl Square {
    /// No place in it is further from the boundary.
    fn bound(&self) -> f64 {
        self.clearance + self.half * std::f64::consts::SQRT_2
    }
}

impl SectionRegion {
    /// Each line of the boundary once, in any order.
    pub fn new(lines: Vec<[DVec2; 2]>) -> SectionRegion {
        SectionRegion { lines }
    }

    /// The distance to the boundary; below 0 outside of the region, by the even-odd rule.
    pub fn clearance(&self, p: DVec2) -> f64 {
        let (mut inside, mut nearest) = (false, f64::INFINITY);
        for [a, b] in &self.lines {
            if (a.y > p.y) != (b.y > p.y) {
                let x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
                inside ^= x > p.x;
            }
            let along = *b - *a;
            let t = ((p - *a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let foot = if t.is_finite() { *a + along * t } else { *a };
            nearest = nearest.min(p.distance_squared(foot));
        }
        if inside { nearest.sqrt() } else { -nearest.sqrt() }
    }

    fn square(&self, centre: DVec2, half: f64) -> Square {
        Square { centre, half, clearance: self.clearance(centre) }
    }

    fn bounding_square(&self) -> Option<Square> {
        let all = || self.lines.iter().flatten();
        let lo = all().fold(DVec2::INFINITY, |m, p| m.min(*p));
        let hi = all().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p));
        let half = (hi - lo).max_element() * 0.5;
        (half > 0.0 && half.is_finite()).then(|| self.square((lo + hi) * 0.5, half))
    }

    fn quarters(&self, square: Square) -> [Square; 4] {
        let half = square.half * 0.5;
        let sides = [(-half, -half), (half, -half), (-half, half), (half, half)];
        sides.map(|(x, y)| self.square(square.centre + DVec2::new(x, y), half))
    }

    /// Places that are at least `need` from the boundary, evenly spread, in a fixed order.
    pub fn places(&self, need: f64) -> Vec<DVec2> {
        let mut out = Vec::new();
        let Some(whole) = self.bounding_square() else { return out };
        let finest = (need * 0.25).max(whole.half / FINEST);
        let mut todo = vec![whole];
        while let Some(square) = todo.pop() {
            if square.bound() < need {
                continue;
            }
            if square.half > finest {
                todo.extend(self.quarters(square));
            } else if square.clearance >= need {
                out.push(square.centre);
            }
        }
        out
    }

    /// The place that is furthest from the boundary, and that distance, within a thousandth of the
    /// region's size.
    pub fn widest(&self) -> Option<(DVec2, f64)> {
        let whole = self.bounding_square()?;
        let enough = whole.half * 1e-3;
        let mut best = whole;
        let mut level = vec![whole];
        let mut looked = 0;
        while !level.is_empty() && looked < MOST {
            let next: Vec<Square> = level.iter().flat_map(|s| self.quarters(*s)).collect();
            looked += next.len();
            for square in &next {
                if square.clearance > best.clearance {
                    best = *square;
                }
            }
            level = next.into_iter().filter(|s| s.bound() > best.clearance + enough).collect();
        }
        (best.clearance > 0.0).then_some((best.centre, best.clearance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[[f64; 2]]) -> Vec<[DVec2; 2]> {
        let at = |i: usize| DVec2::from(corners[i % corners.len()]);
        (0..corners.len()).map(|i| [at(i), at(i + 1)]).collect()
    }

    #[test]
    fn the_widest_place_is_far_from_the_outline_and_from_holes() {
        let mut lines = ring(&[[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]]);
        let plain = SectionRegion::new(lines.clone());
        let (_, clearance) = plain.widest().expect("a place");
        assert!((clearance - 5.0).abs() < 0.02, "{clearance}");
        // A hole in the middle leaves the two ends: from x = 0 to 8.
        lines.extend(ring(&[[8.0, 3.0], [8.0, 7.0], [12.0, 7.0], [12.0, 3.0]]));
        let holed = SectionRegion::new(lines);
        let (place, clearance) = holed.widest().expect("a place");
        assert!((clearance - 4.0).abs() < 0.02, "{clearance}");
        assert!((place.x - 10.0).abs() > 5.0, "{place}");
        assert!(holed.clearance(DVec2::new(10.0, 5.0)) < 0.0, "in the hole");
        assert!(holed.places(5.1).is_empty());
        let all = holed.places(2.0);
        assert!(all.len() > 20 && all.iter().all(|p| holed.clearance(*p) >= 2.0), "{}", all.len());
    }
}
