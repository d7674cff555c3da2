//! The cone of rays: directions, weights, and how the values of its rays become one.

use glam::Vec3;

/// The rule for outliers of a cone, which do not count. At least one value is kept: the median
/// always stays.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outliers {
    /// All count.
    Keep,
    /// Out: farther from the median than this share (0.1 to 0.9) of the range of the values.
    Range(f32),
    /// Out: below the first or above the second share of the way from the least value to the
    /// largest; `Within(0.1, 0.9)` keeps from 10 to 90 % of the cone's range. 0 to 1, rising.
    Within(f32, f32),
    /// Out: farther from the mean than one standard deviation.
    SigmaMean,
    /// Out: farther from the median than one standard deviation.
    SigmaMedian,
}

/// The weight of a value in the mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weights {
    /// Every ray counts the same.
    Plain,
    /// The inverse of the ray's angle to the axis (Shapira, Shamir, Cohen-Or 2008); the axis itself
    /// counts as one degree.
    InverseAngle,
}

/// The rays around the axis +z, the axis first, evenly over the solid angle (a golden-angle
/// spiral).
#[derive(Debug, Clone)]
pub struct Cone {
    /// Of unit length, the axis first.
    pub dirs: Vec<Vec3>,
    /// The weight of each ray in the mean, one per direction.
    pub weights: Vec<f32>,
}

impl Cone {
    /// `rays` from 1 to 1000; `opening` is the full angle in radians.
    pub fn new(rays: usize, opening: f32, weights: Weights) -> Cone {
        let lowest = (opening * 0.5).cos();
        let golden = std::f32::consts::PI * (3.0 - 5.0f32.sqrt());
        let dirs: Vec<Vec3> = (0..rays)
            .map(|i| {
                let z = 1.0 - (1.0 - lowest) * i as f32 / (rays - 1).max(1) as f32;
                let r = (1.0 - z * z).max(0.0).sqrt();
                let (s, c) = (golden * i as f32).sin_cos();
                Vec3::new(r * c, r * s, z)
            })
            .collect();
        let weight = |d: &Vec3| match weights {
            Weights::Plain => 1.0,
            Weights::InverseAngle => 1.0 / d.z.min(1.0).acos().max(1f32.to_radians()),
        };
        let weights = dirs.iter().map(weight).collect();
        Cone { dirs, weights }
    }
}

/// Two directions at right angles to `n` and to each other (Duff et al., "Building an orthonormal
/// basis, revisited", 2017).
pub fn frame(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

/// The same with the first direction as near to `along` as it can be: so it turns with the part.
pub fn frame_along(n: Vec3, along: Vec3) -> (Vec3, Vec3) {
    let flat = along - n * along.dot(n);
    if !(flat.length_squared() > 1e-8 * along.length_squared()) {
        return frame(n);
    }
    let x = flat.normalize();
    (x, n.cross(x))
}

/// The result of a cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Folded {
    /// The weighted mean of the kept values.
    pub value: f32,
    /// Standard error of the mean of the kept values; 0 of a single one.
    pub error: f32,
}

/// One value from (value, weight) pairs; `None` of none. Sorts the pairs.
pub fn fold(values: &mut [(f32, f32)], outliers: Outliers) -> Option<Folded> {
    let n = values.len();
    if n < 2 {
        return values.first().map(|v| Folded { value: v.0, error: 0.0 });
    }
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let median =
        if n % 2 == 1 { values[n / 2].0 } else { (values[n / 2 - 1].0 + values[n / 2].0) * 0.5 };
    let mean = |v: &[(f32, f32)]| v.iter().map(|v| v.0 as f64).sum::<f64>() / v.len() as f64;
    let deviation = |v: &[(f32, f32)]| {
        let m = mean(v);
        (v.iter().map(|v| (v.0 as f64 - m).powi(2)).sum::<f64>() / v.len() as f64).sqrt()
    };
    let (centre, reach) = match outliers {
        Outliers::Within(low, high) => {
            let (least, range) = (values[0].0, values[n - 1].0 - values[0].0);
            (least + range * (low + high) * 0.5, range * (high - low) * 0.5)
        }
        Outliers::Keep => (median, f32::INFINITY),
        Outliers::Range(share) => (median, (values[n - 1].0 - values[0].0) * share),
        Outliers::SigmaMean => (mean(values) as f32, deviation(values) as f32),
        Outliers::SigmaMedian => (median, deviation(values) as f32),
    };
    // Rounding of the centre must not throw out values that are all the same.
    let reach = reach + centre.abs() * 1e-6;
    let first = values.partition_point(|v| v.0 < centre - reach);
    let last = values.partition_point(|v| v.0 <= centre + reach);
    let kept = &values[first..last.max(first)];
    if kept.is_empty() {
        return Some(Folded { value: median, error: deviation(values) as f32 });
    }
    let (sum, weight) = kept
        .iter()
        .fold((0.0f64, 0.0f64), |(s, w), v| (s + v.0 as f64 * v.1 as f64, w + v.1 as f64));
    let error = deviation(kept) / (kept.len() as f64).sqrt();
    Some(Folded { value: (sum / weight) as f32, error: error as f32 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cone_is_as_wide_as_asked_and_starts_on_the_axis() {
        let cone = Cone::new(1000, 120f32.to_radians(), Weights::InverseAngle);
        assert_eq!(cone.dirs[0], Vec3::Z);
        let widest = cone.dirs.iter().map(|d| d.z.acos().to_degrees()).fold(0.0, f32::max);
        assert!((widest - 60.0).abs() < 1e-3, "{widest}");
        assert!(cone.dirs.iter().all(|d| (d.length() - 1.0).abs() < 1e-6));
        assert!(cone.weights[0] > cone.weights[1] && cone.weights[1] > cone.weights[999]);
        assert_eq!(Cone::new(1, 1.0, Weights::Plain).dirs, [Vec3::Z]);
    }

    #[test]
    fn the_frame_is_orthonormal_everywhere() {
        for n in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Z, Vec3::new(1.0, -2.0, -1e-9).normalize()] {
            let (u, v) = frame(n);
            assert!((u.cross(v) - n).length() < 1e-6 && u.dot(v).abs() < 1e-6, "{n}");
        }
    }

    #[test]
    fn each_rule_throws_out_what_it_says() {
        let values = [1.0f32, 1.1, 1.2, 1.3, 9.0].map(|v| (v, 1.0));
        let by = |o| fold(&mut values.clone(), o).map(|f| f.value).unwrap_or(f32::NAN);
        assert!((by(Outliers::Keep) - 2.72).abs() < 1e-5);
        assert!((by(Outliers::Range(0.1)) - 1.15).abs() < 1e-5);
        assert!(
            (by(Outliers::Range(0.9)) - 1.15).abs() < 1e-5
                || (by(Outliers::Range(0.9)) - 2.72).abs() < 1e-5
        );
        // From 1.8 to 8.2 of the range from 1 to 9 lies nothing: the median stays.
        assert_eq!(by(Outliers::Within(0.1, 0.9)), 1.2);
        let mut even = [1.0f32, 2.0, 3.0, 4.0, 6.0].map(|v| (v, 1.0));
        let kept = fold(&mut even, Outliers::Within(0.1, 0.9)).map(|f| f.value);
        assert_eq!(kept, Some(3.0));
        assert!((by(Outliers::SigmaMean) - 1.15).abs() < 1e-5);
        assert!((by(Outliers::SigmaMedian) - 1.15).abs() < 1e-5);
        assert_eq!(fold(&mut [], Outliers::Keep), None);
        assert_eq!(
            fold(&mut [(2.0, 1.0); 25], Outliers::SigmaMean),
            Some(Folded { value: 2.0, error: 0.0 })
        );
    }
}
