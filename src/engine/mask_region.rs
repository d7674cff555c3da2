//! Masking what is seen within a region of the view.

use serde::{Deserialize, Serialize};

use crate::region_seen::RegionSeen;
use crate::view_region::ViewRegion;
use sculptd_clay::{Kernel, PageIn, PageOut};

/// Sets the mask of what is seen in a region, all the way through the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MaskRegion {
    /// Where.
    pub region: ViewRegion,
    /// The mask there: 1 protects, 0 frees. 0 to 1.
    pub mask: f32,
    /// Only what faces the eye.
    pub front_faces: bool,
}

impl MaskRegion {
    /// Returns true if every number is finite and in range.
    pub fn is_sane(&self) -> bool {
        self.region.is_sane() && (0.0..=1.0).contains(&self.mask)
    }
}

/// A region before a camera, as a kernel over the clay.
pub(crate) struct MaskSeen<'a> {
    pub(crate) seen: &'a RegionSeen,
    /// The mask there, 0 to 1.
    pub(crate) mask: f32,
}

impl Kernel for MaskSeen<'_> {
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for v in 0..page.own() {
            if self.seen.holds(page.positions.get(v), page.normals.get(v)) {
                out.visit();
                out.set_mask(v, self.mask);
            }
        }
    }
}
