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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};
    use sculptd_clay::brush::GaussianBrush;
    use sculptd_clay::{Clay, Reach, Workers};
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    #[test]
    fn the_plate_follows_a_dab_and_stands_where_the_object_stands() {
        let mut clay =
            Clay::build(&shapes::sphere_of_about(20_000), &Job::default()).expect("a ball builds");
        let turn = DQuat::from_rotation_x(0.9);
        let transform = ObjectTransform { shift: DVec3::new(5.0, 40.0, -3.0), turn, scale: 4.0 };
        let up = Vec3::new(0.6, 0.8, 0.0);
        let mut kept = PlateHeight::default();
        let mut height =
            |clay: &mut Clay| kept.height(&clay.snapshot(), &transform, up, 0.2).expect("vertices");
        let known = |clay: &mut Clay| {
            let clay = clay.snapshot();
            let all = clay.pages().flat_map(|p| (0..p.own()).map(|v| p.point(v)));
            let least = all.map(|p| transform.point(p).dot(up)).fold(f32::INFINITY, f32::min);
            least + 0.01
        };
        let before = height(&mut clay);
        assert!((before - known(&mut clay)).abs() < 1e-4, "{before}");
        // Raised where the ball meets the plate.
        let below = transform.inverse().direction(-up);
        let reach = Reach::Sphere { centre: below, radius: 0.3 };
        let kernel = GaussianBrush::new(below, 0.3, below, 0.2);
        clay.dab(&reach, &kernel, &Workers::new(1));
        let after = height(&mut clay);
        assert!(after < before - 0.3, "{before} {after}");
        assert!((after - known(&mut clay)).abs() < 1e-4, "{after}");
    }
}
