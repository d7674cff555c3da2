//! The numbers of repairs on the Check page.

use glam::{DVec3, Vec2};
use sculptd_check::repair::holes::SealedKind;
use sculptd_check::repair::lettering::Lettering;
use sculptd_check::repair::split::{PegSettings, SplitPlane};
use sculptd_daemon::Published;
use sculptd_daemon::repair_jobs::WantedRepair;
use sculptd_engine::camera::Camera;

/// The numbers of repairs that a person has chosen. Lengths are in millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairChoice {
    /// Of drain holes and vents.
    pub diameter: f64,
    /// A second hole at the highest point of a cavity.
    pub inlet: bool,
    /// Of walls, degrees.
    pub draft: f64,
    /// The least thickness of walls.
    pub wall: f64,
    /// The height of a flat base above the lowest point.
    pub base: f64,
    /// The height of a split as a share of the object's, 0 to 1, along the build direction.
    pub split: f64,
    /// Of a split.
    pub pegs: PegSettings,
    /// A text, the height of its capital letters, and how far it rises (below 0: is engraved).
    pub text: String,
    pub letter_height: f64,
    pub relief: f64,
}

impl Default for RepairChoice {
    fn default() -> Self {
        RepairChoice {
            diameter: 3.0,
            inlet: false,
            draft: 1.5,
            wall: 1.2,
            base: 0.5,
            split: 0.5,
            pegs: PegSettings::default(),
            text: String::new(),
            letter_height: 5.0,
            relief: 0.6,
        }
    }
}

impl RepairChoice {
    /// A hole for the cavity or the cup at a place of the world. A void of at most `least` mm3 gets
    /// none.
    pub fn hole(&self, kind: SealedKind, near: DVec3, least: f64) -> WantedRepair {
        let RepairChoice { diameter, inlet, .. } = *self;
        let inlet = inlet && kind == SealedKind::Trapped;
        WantedRepair::Holes { kind, diameter, inlet, least, near: Some(near) }
    }

    /// The text on the surface in the middle of the view, upright in it.
    pub fn text(&self, camera: &Camera) -> WantedRepair {
        let ray = camera.ray(Vec2::splat(0.5));
        WantedRepair::Text(Lettering {
            text: self.text.clone(),
            at: ray.origin.as_dvec3(),
            along: Some(ray.dir.as_dvec3()),
            upright: camera.axes().1.as_dvec3(),
            height: self.letter_height,
            relief: self.relief,
        })
    }

    /// The split of the active object across a direction.
    pub fn split(&self, state: &Published, up: DVec3) -> WantedRepair {
        let (lo, hi) = state.transform().bounds(state.mesh.bounds());
        let (middle, half) = ((lo + hi).as_dvec3() * 0.5, (hi - lo).as_dvec3() * 0.5);
        let reach = half.dot(up.abs());
        let point = middle + up * (reach * (2.0 * self.split - 1.0));
        WantedRepair::Split(SplitPlane { point, normal: up }, self.pegs)
    }
}
