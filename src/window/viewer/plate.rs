//! The height of the plate under the active object, kept up to date at the cost of the pages that
//! changed.

use glam::Vec3;
use sculptd_clay::{Page, Snapshot};
use sculptd_engine::scene::ObjectTransform;

/// A vertex within this share of a layer, and of the object's height, of the plate is on it: as in
/// the checks.
const LAYER_SHARE: f32 = 0.05;
const HEIGHT_SHARE: f32 = 0.01;

/// The least and the greatest height of each page.
#[derive(Debug, Default)]
pub struct PlateHeight {
    seen: Option<(Snapshot, Vec3)>,
    pages: Vec<[f32; 2]>,
}

fn span(page: &Page, up: Vec3) -> [f32; 2] {
    let heights = (0..page.own()).map(|v| page.point(v).dot(up));
    heights.fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], h| [lo.min(h), hi.max(h)])
}

impl PlateHeight {
    /// The height along `up`, in the world, up to which the object is on its plate. `None` for an
    /// object without vertices.
    pub fn height(
        &mut self,
        mesh: &Snapshot,
        transform: &ObjectTransform,
        up: Vec3,
        layer: f32,
    ) -> Option<f32> {
        let own = transform.inverse().direction(up);
        match &self.seen {
            Some((seen, along)) if *along == own && self.pages.len() == mesh.page_count() => {
                let pages = &mut self.pages;
                mesh.each_changed(seen, |i, page| pages[i as usize] = span(page, own));
            }
            _ => self.pages = mesh.pages().map(|page| span(page, own)).collect(),
        }
        self.seen = Some((mesh.clone(), own));
        let none = [f32::INFINITY, f32::NEG_INFINITY];
        let [lo, hi] = self.pages.iter().fold(none, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let scale = transform.scale as f32;
        let shift = transform.shift.dot(up.as_dvec3()) as f32;
        let slack = (LAYER_SHARE * layer).min(HEIGHT_SHARE * (hi - lo) * scale);
        (lo <= hi).then_some(lo * scale + shift + slack)
    }
}
