//! The inactive objects on the card, and the transform of each object.
//!
//! Every object is drawn in its frame: its matrix, the view's axes and the brush are transformed
//! into it, so that a transform resends no vertex. The other objects are sent once; a hidden object
//! uses no memory on the card.

use std::collections::BTreeMap;

use glam::{DVec3, Mat4, Vec3};

use super::frame_uniform::{Frame, in_view, own_angles, own_plane};
use super::pages::Pages;
use super::provisional::ProvisionalDabs;
use crate::viewer::gpu::Gpu;
use sculptd_clay::{Ray, Snapshot};
use sculptd_daemon::Published;
use sculptd_engine::scene::{ObjectId, ObjectTransform};

/// Transform of the active object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stance {
    /// Its id.
    pub id: u32,
    pub transform: ObjectTransform,
    pub visible: bool,
}

impl Default for Stance {
    fn default() -> Self {
        Stance { id: 0, transform: ObjectTransform::NONE, visible: true }
    }
}

impl Stance {
    /// That of the active object.
    pub fn of(state: &Published) -> Stance {
        state.scene.active().map_or(Stance::default(), |o| Stance {
            id: o.id.0,
            transform: o.settings.transform,
            visible: o.settings.visible,
        })
    }
}

/// An object beside the active one, to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct OtherObject<'a> {
    /// Its id.
    pub id: u32,
    pub clay: &'a Snapshot,
    pub transform: ObjectTransform,
}

/// The visible objects beside the active one.
pub fn others(state: &Published) -> Vec<OtherObject<'_>> {
    let all = state.scene.objects.iter().filter(|o| o.settings.visible);
    all.filter_map(|o| {
        let (id, transform) = (o.id.0, o.settings.transform);
        o.clay.as_ref().map(|clay| OtherObject { id, clay, transform })
    })
    .collect()
}

/// The nearest visible object on a ray of the world.
pub fn under(state: &Published, ray: Ray) -> Option<ObjectId> {
    hit_under(state, ray).map(|(id, _)| id)
}

/// The nearest visible object on a ray of the world, and where the ray meets it, in the world.
pub fn hit_under(state: &Published, ray: Ray) -> Option<(ObjectId, DVec3)> {
    let seen = state.scene.each(&state.mesh).filter(|(o, _)| o.settings.visible);
    let hits = seen.filter_map(|(o, clay)| {
        let transform = o.settings.transform;
        let hit = clay.pick(transform.inverse().ray(ray))?;
        let at = transform.apply(hit.position.as_dvec3());
        Some((f64::from(hit.t) * transform.scale, o.id, at))
    });
    hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id, at)| (id, at))
}

impl Frame {
    /// The same in the frame of an object.
    pub(super) fn seen_from(&self, matrix: &Mat4, transform: &ObjectTransform) -> Frame {
        if transform.is_none() {
            return *self;
        }
        let own = transform.inverse();
        let direction =
            |v: [f32; 4]| own.direction(Vec3::new(v[0], v[1], v[2])).extend(v[3]).to_array();
        let [x, y, z, radius] = self.brush;
        let place = own.point(Vec3::new(x, y, z));
        let [angle_up, angle_ends] = own_angles([self.angle_up, self.angle_ends], transform);
        let shadow = Mat4::from_cols_array_2d(&self.shadow) * model(transform);
        Frame {
            view_projection: (*matrix * model(transform)).to_cols_array_2d(),
            shadow: shadow.to_cols_array_2d(),
            right: direction(self.right),
            up: direction(self.up),
            back: direction(self.back),
            angle_up,
            angle_ends,
            cut: own_plane(self.cut, transform),
            brush: place.extend(radius * own.scale as f32).to_array(),
            led: self.led.seen_from(transform),
            ..*self
        }
    }
}

/// From an object to the world.
pub fn model(transform: &ObjectTransform) -> Mat4 {
    Mat4::from_scale_rotation_translation(
        Vec3::splat(transform.scale as f32),
        transform.turn.as_quat(),
        transform.shift.as_vec3(),
    )
}

/// A frame's numbers on the card.
#[derive(Debug)]
struct FrameSlot {
    buffer: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// The other objects on the card.
#[derive(Debug)]
pub struct ObjectBuffers {
    layout: wgpu::BindGroupLayout,
    pages: BTreeMap<u32, Pages>,
    /// The first is that of the active object; one more for each that is drawn beside it.
    frames: Vec<FrameSlot>,
    /// The object whose pages are those of the renderer itself.
    active: u32,
    /// Bytes sent with the last frame.
    pub uploaded: u64,
    /// Pages that wait to be sent.
    pub waiting: usize,
}

impl ObjectBuffers {
    pub fn new(layout: wgpu::BindGroupLayout) -> ObjectBuffers {
        let (pages, frames) = (BTreeMap::new(), Vec::new());
        ObjectBuffers { layout, pages, frames, active: 0, uploaded: 0, waiting: 0 }
    }

    /// Of the frame that each object is drawn with.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Exchanges the renderer's own pages for those of the object that is active now.
    pub fn activate(&mut self, id: u32, own: &mut Option<Pages>) {
        if id == self.active {
            return;
        }
        if let Some(pages) = own.take() {
            self.pages.insert(self.active, pages);
        }
        *own = self.pages.remove(&id);
        self.active = id;
    }

    fn frame(&mut self, gpu: &Gpu, slot: usize, frame: &Frame) {
        while self.frames.len() <= slot {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("object"),
                size: size_of::<Frame>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("object"),
                layout: &self.layout,
                entries: &[wgpu::BindGroupEntry {
                    binding: 0,
                    resource: buffer.as_entire_binding(),
                }],
            });
            self.frames.push(FrameSlot { buffer, group });
        }
        gpu.queue.write_buffer(&self.frames[slot].buffer, 0, bytemuck::bytes_of(frame));
    }

    /// Sends missing data to the card: the frame of the active object and of each other one, and
    /// the pages that are new or changed. `frame`: that of the world.
    pub(super) fn send(
        &mut self,
        gpu: &Gpu,
        frame: &Frame,
        matrix: &Mat4,
        stance: &Stance,
        others: &[OtherObject<'_>],
    ) {
        self.frame(gpu, 0, &frame.seen_from(matrix, &stance.transform));
        self.pages.retain(|id, _| others.iter().any(|o| o.id == *id));
        (self.uploaded, self.waiting) = (0, 0);
        // A map is of the active object, and so are the brush and what is led.
        let kind = if frame.map[2] >= 2.0 { 0.0 } else { frame.map[2] };
        let [low, high, _, nearer] = frame.map;
        let map = [low, high, kind, nearer];
        let bare = Frame { brush: [0.0; 4], led: ProvisionalDabs::default(), map, ..*frame };
        for (k, other) in others.iter().enumerate() {
            self.frame(gpu, k + 1, &bare.seen_from(matrix, &other.transform));
            let kept = self.pages.remove(&other.id).filter(|p| p.fits(other.clay));
            let mut pages = kept.unwrap_or_else(|| Pages::new(&gpu.device, &gpu.queue, other.clay));
            pages.update(&gpu.queue, other.clay, false);
            self.uploaded += pages.uploaded;
            self.waiting += pages.waiting();
            self.pages.insert(other.id, pages);
        }
    }

    /// Returns the bind group of the active object.
    pub fn active_group(&self) -> Option<&wgpu::BindGroup> {
        self.frames.first().map(|f| &f.group)
    }

    /// Draws the others; how many pages.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        matrix: &Mat4,
        others: &[OtherObject<'_>],
    ) -> usize {
        let mut drawn = 0;
        for (other, slot) in others.iter().zip(self.frames.iter().skip(1)) {
            let Some(pages) = self.pages.get(&other.id) else { continue };
            let matrix = *matrix * model(&other.transform);
            pass.set_bind_group(0, &slot.group, &[]);
            drawn += pages.draw(pass, |_, page| in_view(&matrix, page));
        }
        drawn
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn an_object_is_seen_where_it_stands() {
        let turn = DQuat::from_rotation_z(0.7);
        let transform = ObjectTransform { shift: DVec3::new(3.0, -1.0, 2.0), turn, scale: 2.0 };
        let p = Vec3::new(0.3, 0.4, -0.5);
        assert!((model(&transform).transform_point3(p) - transform.point(p)).length() < 1e-5);
    }
}
