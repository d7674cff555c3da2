//! Surface smooth: evens the surface and keeps its volume: Taubin 1995, "A signal processing
//! approach to fair surface design". Each dab evens by `lambda` and then goes back by `mu`, where
//! `1 / lambda + 1 / mu` is the pass band `k_PB`: what is wider than that keeps its form.
//!
//! The bound: a wave of frequency `k` (an eigenvalue of the Laplacian, 0 to 2) comes out of a dab
//! `(1 - lambda k) (1 - mu k) = 1 + lambda |mu| k (k_PB - k)` times as high. Up to the pass band
//! that is never less than before, and never more than by a share of `lambda |mu| k_PB^2 / 4`,
//! below 0.1 % at full strength; above it, waves shrink. So the volume, which the widest waves make
//! up, stays: 100 dabs all over a rough ball change it by less than half a percent (a test holds
//! it), where [`super::smooth`] takes several times as much.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::smooth::around;
use crate::brush::surface_query::SurfaceQuery;

/// The pass band, as a share of the highest frequency (Taubin's `k_PB`).
const PASS_BAND: f32 = 0.1;
/// The greatest share of the way to the mean of the ring in one pass, so that the way back stays
/// stable.
const MOST: f32 = 0.6;

/// One dab of surface smooth.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceSmoothBrush {
    factor: f32,
}

impl Brush for SurfaceSmoothBrush {
    const PASSES: usize = 2;

    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        // The effect of a dab grows with the square of lambda, so the square is divided along the
        // path.
        let lambda = (dab.strength * MOST * dab.span.max(0.0).sqrt()).min(MOST);
        let back = -lambda / (1.0 - PASS_BAND * lambda);
        SurfaceSmoothBrush { factor: if dab.pass == 0 { lambda } else { back } }
    }

    #[inline]
    fn change(&self, _: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let (sum, weights) = around(spot.page, spot.v, spot.p);
        if weights > 0.0 && !spot.page.is_border(spot.v) {
            VertexChange::by(sum * (self.factor * spot.weight / weights))
        } else {
            VertexChange::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::{MOST, PASS_BAND};
    use crate::brush::{BrushKind, BrushSettings, Dab, Scratch, Tool};
    use crate::{Clay, DabReport, Workers};
    use sculptd_geometry::flat::TriMesh;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    fn volume(mesh: &TriMesh) -> f64 {
        let of = |t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        (0..mesh.triangles.len()).map(of).sum()
    }

    /// Root mean square distance from the mean of the ring, about a ball of radius one.
    fn roughness(mesh: &TriMesh) -> f64 {
        let mut around = vec![(Vec3::ZERO, 0.0f32); mesh.positions.len()];
        for t in &mesh.triangles {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let at = &mut around[t[a] as usize];
                *at = (at.0 + mesh.positions[t[b] as usize], at.1 + 1.0);
            }
        }
        let off = mesh.positions.iter().zip(&around).map(|(p, (sum, n))| {
            let off = (*p - *sum / *n).dot(p.normalize());
            f64::from(off * off)
        });
        (off.sum::<f64>() / mesh.positions.len() as f64).sqrt()
    }

    #[test]
    fn twice_as_many_dabs_that_each_stand_for_half_the_way_do_as_much() {
        let mut rough = shapes::icosphere(1.0, 40);
        for (i, p) in rough.positions.iter_mut().enumerate() {
            *p *= 1.0 + 0.01 * ((i * 7919) % 101) as f32 / 101.0;
        }
        let left = |count: u32| {
            let settings = BrushSettings::new(BrushKind::SurfaceSmooth);
            let mut clay = Clay::build(&rough, &Job::default()).expect("clay");
            let (workers, mut scratch) = (Workers::new(1), Scratch::default());
            clay.begin_step();
            for _ in 0..count {
                let dab = Dab::resting(&settings, Vec3::Z, 0.8, 0.5);
                let dab = Dab { span: 12.0 / count as f32, ..dab };
                let report = DabReport::default();
                let mut tool =
                    Tool { mesh: &mut clay, workers: &workers, scratch: &mut scratch, report };
                BrushKind::SurfaceSmooth.apply(&[dab], &mut tool);
            }
            roughness(&clay.to_tri()) / roughness(&rough)
        };
        let (once, often) = (left(12), left(48));
        println!("{once} and {often} of the roughness are left");
        assert!(once < 0.985 && (often - once).abs() < 0.1 * (1.0 - once), "{once}, {often}");
    }

    #[test]
    fn the_volume_stays_within_its_bound() {
        let lambda = MOST;
        let back = lambda / (1.0 - PASS_BAND * lambda);
        assert!(lambda * back * PASS_BAND * PASS_BAND / 4.0 < 0.001, "what the bound says");
        let mut rough = shapes::icosphere(1.0, 40);
        for (i, p) in rough.positions.iter_mut().enumerate() {
            *p *= 1.0 + 0.01 * ((i * 7919) % 101) as f32 / 101.0;
        }
        let after = |kind: BrushKind| {
            let settings = BrushSettings::new(kind);
            let mut clay = Clay::build(&rough, &Job::default()).expect("clay");
            let (workers, mut scratch) = (Workers::new(1), Scratch::default());
            clay.begin_step();
            for i in 0..100 {
                // Evenly over the ball: points of a spherical spiral by the golden angle.
                let z = (2.0 * i as f32 + 1.0) / 100.0 - 1.0;
                let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                let centre = Vec3::new(flat * cos, flat * sin, z);
                let report = DabReport::default();
                let mut tool =
                    Tool { mesh: &mut clay, workers: &workers, scratch: &mut scratch, report };
                kind.apply(&[Dab::resting(&settings, centre, 0.5, 1.0)], &mut tool);
            }
            clay.to_tri()
        };
        let before = (volume(&rough), roughness(&rough));
        let change = |mesh: &TriMesh| (volume(mesh) / before.0 - 1.0, roughness(mesh) / before.1);
        let kept = change(&after(BrushKind::SurfaceSmooth));
        let plain = change(&after(BrushKind::Smooth));
        println!("volume and roughness: {kept:?}, by smooth {plain:?}");
        assert!(kept.0.abs() < 0.005, "the volume changed by {}", kept.0);
        assert!(kept.1 < 0.6, "{} of the roughness is left", kept.1);
        assert!(plain.0.abs() > 2.0 * kept.0.abs(), "smooth changed it by {}", plain.0);
    }
}
