//! The numbers that a frame is drawn with, as the shader has them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use super::provisional::ProvisionalDabs;
use crate::look::{Look, SCALE};
use sculptd_clay::Page;
use sculptd_engine::scene::ObjectTransform;

/// One for the world, and one for each object in its own frame.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Frame {
    pub(super) view_projection: [[f32; 4]; 4],
    pub(super) right: [f32; 4],
    pub(super) up: [f32; 4],
    pub(super) back: [f32; 4],
    pub(super) brush: [f32; 4],
    pub(super) base: [f32; 4],
    pub(super) finish: [f32; 4],
    pub(super) map: [f32; 4],
    pub(super) scale: [[f32; 4]; SCALE],
    pub(super) low: [f32; 4],
    pub(super) high: [f32; 4],
    pub(super) light: [f32; 4],
    pub(super) backdrop: [f32; 4],
    pub(super) main_light: [f32; 4],
    pub(super) shadow: [[f32; 4]; 4],
    pub(super) angle_up: [f32; 4],
    pub(super) angle_ends: [f32; 4],
    pub(super) cut: [f32; 4],
    pub(super) led: ProvisionalDabs,
}

/// Numbers of a map of angles: the direction, with the sine of the limit that decides; the height
/// of the plate, and where the two halves of the scale end, radians.
pub(super) fn angle_numbers(look: &Look) -> [[f32; 4]; 2] {
    let angles = &look.angles;
    let [x, y, z] = angles.up;
    let decides = angles.slack_limit(look.map).to_radians().sin();
    let plate = angles.plate.unwrap_or(f32::MIN);
    let (limit, end) = (angles.limit.to_radians(), angles.end(look.map).to_radians());
    [[x, y, z, decides], [plate, limit, end, 0.0]]
}

/// The same in the frame of an object.
pub(super) fn own_angles([up, ends]: [[f32; 4]; 2], transform: &ObjectTransform) -> [[f32; 4]; 2] {
    let direction = Vec3::new(up[0], up[1], up[2]);
    let own = transform.inverse().direction(direction).extend(up[3]).to_array();
    let shift = transform.shift.dot(direction.as_dvec3());
    let plate = (f64::from(ends[0]) - shift) / transform.scale;
    let plate = plate.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
    [own, [plate, ends[1], ends[2], ends[3]]]
}

/// A plane of the world in the frame of an object.
pub(super) fn own_plane([x, y, z, at]: [f32; 4], transform: &ObjectTransform) -> [f32; 4] {
    let direction = Vec3::new(x, y, z);
    let own = transform.inverse().direction(direction);
    let shift = transform.shift.dot(direction.as_dvec3());
    own.extend(((f64::from(at) - shift) / transform.scale) as f32).to_array()
}

/// Returns true if a page's box may be visible: not wholly beyond one plane of the view.
pub(super) fn in_view(matrix: &Mat4, page: &Page) -> bool {
    let (lo, hi) = page.bounds();
    let mut beyond = [0u8; 5];
    for corner in 0..8u32 {
        let pick = |axis: u32, lo: f32, hi: f32| if corner >> axis & 1 == 0 { lo } else { hi };
        let p = Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z));
        let c = *matrix * p.extend(1.0);
        for (n, out) in
            beyond.iter_mut().zip([c.x < -c.w, c.x > c.w, c.y < -c.w, c.y > c.w, c.w <= 0.0])
        {
            *n += u8::from(out);
        }
    }
    beyond.iter().all(|&n| n < 8)
}
