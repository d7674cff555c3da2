//! Masks by what is measured over the whole surface: where a part is thin, and where it is
//! sheltered from light.
//!
//! A mask is measured on a snapshot, away from the tick, and then applied page by page. Like the
//! cavity mask, it adds to the existing mask.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::live_thickness::LiveMap;
use crate::{Clay, Kernel, Page, PageIn, PageOut, Snapshot};
use sculptd_geometry::bvh::{Bvh8, Ray};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::thickness::cone::frame;

/// Directions in which a vertex looks for light, spread by the cosine to its normal.
const DIRECTIONS: usize = 64;
/// Vertices measured between two looks at the progress.
const BLOCK: usize = 1 << 16;
/// The border is soft: over this share of the measure the mask goes from free to protected.
const SOFT: f32 = 0.25;

/// The measure that a mask is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaskMeasure {
    /// Masks parts of at most this thickness (clay units), by one ray along each vertex's normal.
    Thin(f32),
    /// Masks where the object blocks at least this share of the light of an even sky, 0 to 1:
    /// ambient occlusion.
    Occlusion(f32),
}

/// The reason why no mask was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeasuredMaskError {
    /// Nothing would be protected by half or more.
    #[error("nothing of the object is so thin, or so sheltered")]
    Nothing,
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A mask that was measured on one revision of a clay, and fits no other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredMask {
    /// Of the clay that it was measured on.
    pub revision: u64,
    /// The mask of the owned vertices, 0 to 255, for each page with something to protect;
    /// ascending.
    pub pages: Arc<Vec<(u32, Vec<u8>)>>,
}

impl MeasuredMask {
    /// Measures a snapshot on the current rayon pool.
    ///
    /// # Errors
    /// Returns an error if nothing would be protected, or the job was cancelled.
    pub fn new(
        snapshot: &Snapshot,
        by: MaskMeasure,
        job: &Job,
    ) -> Result<MeasuredMask, MeasuredMaskError> {
        let pages = match by {
            MaskMeasure::Thin(below) => thin(snapshot, below, job)?,
            MaskMeasure::Occlusion(share) => sheltered(snapshot, share, job)?,
        };
        let mask = MeasuredMask { revision: snapshot.revision(), pages: Arc::new(pages) };
        if mask.protected() == 0 { Err(MeasuredMaskError::Nothing) } else { Ok(mask) }
    }

    /// Vertices that it protects by half or more.
    pub fn protected(&self) -> u64 {
        self.pages.iter().flat_map(|p| &p.1).filter(|m| **m >= 128).count() as u64
    }

    /// Returns true if it was measured on the clay's current state. Visits each page.
    pub fn fits(&self, clay: &Clay) -> bool {
        let fits = |(page, mask): &(u32, Vec<u8>)| {
            (*page as usize) < clay.page_count() && clay.page(*page).own() == mask.len()
        };
        self.revision == clay.revision()
            && self.pages.windows(2).all(|two| two[0].0 < two[1].0)
            && self.pages.iter().all(fits)
    }
}

impl Kernel for MeasuredMask {
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let Ok(at) = self.pages.binary_search_by_key(&page.number(), |p| p.0) else { return };
        for (v, &mask) in self.pages[at].1.iter().enumerate().take(page.own()) {
            out.visit();
            out.set_mask(v, page.mask(v).max(f32::from(mask) / 255.0));
        }
    }
}

/// 0 to 1 over the soft border, as a file keeps it.
fn stored(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Returns each page's number with `of` its owned vertices; pages with nothing to protect are left
/// out.
fn by_page(
    snapshot: &Snapshot,
    job: &Job,
    of: impl Fn(&Page, usize) -> u8 + Sync,
) -> Result<Vec<(u32, Vec<u8>)>, Cancelled> {
    let numbered: Vec<(u32, &Arc<Page>)> = (0..).zip(snapshot.pages()).collect();
    let masks: Result<Vec<_>, Cancelled> = numbered
        .par_iter()
        .map(|(number, page)| {
            job.check()?;
            Ok((*number, (0..page.own()).map(|v| of(page, v)).collect::<Vec<u8>>()))
        })
        .collect();
    let mut masks = masks?;
    masks.retain(|(_, mask)| mask.iter().any(|m| *m > 0));
    Ok(masks)
}

fn thin(snapshot: &Snapshot, below: f32, job: &Job) -> Result<Vec<(u32, Vec<u8>)>, Cancelled> {
    let mut map = LiveMap::new(snapshot, MeasuredSide::Wall, job)?;
    let all = map.values().len().max(1);
    while map.work(Vec3::ZERO, BLOCK, job)? > 0 {
        job.progress(1.0 - map.stale() as f32 / all as f32);
    }
    let (ranks, values) = (snapshot.ranks(), map.values());
    by_page(snapshot, job, |page, v| {
        let value = ranks.find(page.topology().ids[v]).map_or(f32::NAN, |r| values[r as usize]);
        // Without a wall there is no thickness.
        if value.is_nan() { 0 } else { stored(1.0 - (value / below - 1.0) / SOFT) }
    })
}

fn sheltered(snapshot: &Snapshot, share: f32, job: &Job) -> Result<Vec<(u32, Vec<u8>)>, Cancelled> {
    let tree = Bvh8::build_for_rays(&snapshot.to_tri(), job)?;
    let (lo, hi) = snapshot.bounds();
    let reach = (hi - lo).length();
    // A spiral of the golden angle over the disc, lifted to the hemisphere (Malley's method).
    let directions: Vec<Vec3> = (0..DIRECTIONS)
        .map(|i| {
            let r2 = (i as f32 + 0.5) / DIRECTIONS as f32;
            let turn = i as f32 * 2.399_963_2;
            let (x, y) = (turn.portable_cos(), turn.portable_sin());
            Vec3::new(x * r2.sqrt(), y * r2.sqrt(), (1.0 - r2).sqrt())
        })
        .collect();
    let least = share * (1.0 - SOFT);
    by_page(snapshot, job, |page, v| {
        let (point, normal) = (page.point(v), page.normal(v));
        if normal == Vec3::ZERO {
            return 0;
        }
        let (x, y) = frame(normal);
        let away = |d: &Vec3| x * d.x + y * d.y + normal * d.z;
        let origin = point + normal * (reach * 1e-4);
        let blocked = directions.iter().filter(|d| {
            let ray = Ray { t_max: reach, ..Ray::new(origin, away(d)) };
            tree.any_hit(ray, |_| true)
        });
        let found = blocked.count() as f32 / DIRECTIONS as f32;
        stored((found - least) / (share - least).max(1e-6))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Workers;
    use sculptd_geometry::shapes;

    fn masks(clay: &mut Clay, by: MaskMeasure) -> Vec<(Vec3, f32)> {
        let measured = MeasuredMask::new(&clay.snapshot(), by, &Job::default()).expect("some");
        assert!(measured.fits(clay));
        clay.begin_step();
        let pages: Vec<u32> = (0..clay.page_count() as u32).collect();
        clay.dab_on(&pages, &measured, &Workers::new(2));
        assert!(clay.end_step() && !measured.fits(clay));
        let shown = clay.snapshot();
        let all = shown.pages().flat_map(|p| (0..p.own()).map(|v| (p.point(v), p.mask(v))));
        let found: Vec<_> = all.collect();
        let protected = found.iter().filter(|(_, m)| *m >= 0.5).count() as u64;
        assert_eq!(protected, measured.protected());
        found
    }

    #[test]
    fn what_is_thin_is_protected_and_what_is_thick_is_not() {
        // Two rings, one of a rod of 0.2, one of a rod of 1.
        let mut both = shapes::torus(2.0, 0.1, 60, 12).triangulate().0;
        let thick = shapes::torus(2.0, 0.5, 60, 24).triangulate().0;
        let first = both.positions.len() as u32;
        both.positions.extend(thick.positions.iter().map(|p| *p + Vec3::Z * 3.0));
        both.triangles.extend(thick.triangles.iter().map(|t| t.map(|v| v + first)));
        let mut clay = Clay::build(&both, &Job::default()).expect("clay");
        for (p, mask) in masks(&mut clay, MaskMeasure::Thin(0.4)) {
            assert_eq!(mask, if p.z < 1.0 { 1.0 } else { 0.0 }, "{p}");
        }
        let none = MeasuredMask::new(&clay.snapshot(), MaskMeasure::Thin(1e-4), &Job::default());
        assert_eq!(none, Err(MeasuredMaskError::Nothing));
    }

    #[test]
    fn what_lies_in_a_pit_is_protected_and_what_lies_open_is_not() {
        let mut pit = shapes::grid(2.0, 2.0, 60, 60).triangulate().0;
        for p in &mut pit.positions {
            p.z = -(-p.truncate().length_squared() / 0.05).exp();
        }
        let mut clay = Clay::build(&pit, &Job::default()).expect("clay");
        for (p, mask) in masks(&mut clay, MaskMeasure::Occlusion(0.5)) {
            assert!(p.z < -0.05 || mask == 0.0, "{p}: {mask}");
            assert!(p.z > -0.9 || mask == 1.0, "{p}: {mask}");
        }
        // A ball shelters nothing.
        let ball = Clay::build(&shapes::icosphere(1.0, 12), &Job::default());
        let shown = ball.expect("clay").snapshot();
        let none = MeasuredMask::new(&shown, MaskMeasure::Occlusion(0.2), &Job::default());
        assert_eq!(none, Err(MeasuredMaskError::Nothing));
    }
}
