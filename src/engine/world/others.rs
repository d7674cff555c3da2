//! Where the pens of the others are who share a world, for whoever shows it.

use glam::Vec3;

use super::local_camera::LocalCamera;
use super::{MAX_PENS, World};
use crate::scene::ObjectId;
use sculptd_devices::DeviceId;

/// Pens of others that are shown at most.
pub const MAX_OTHERS: usize = MAX_PENS;

/// A pen of another person over the active object, as that person sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OthersPen {
    /// Whose it is.
    pub person: u8,
    /// Id of the device, unique among all devices.
    pub device: DeviceId,
    /// The object under it.
    pub object: ObjectId,
    /// Position on the clay, in world units.
    pub position: Vec3,
    /// The surface's normal there, unit length.
    pub normal: Vec3,
    /// The radius of the person's brush as it presses now, world units.
    pub radius: f32,
    /// The tip touches.
    pub down: bool,
    /// The person's brush takes clay away.
    pub carves: bool,
}

impl World {
    /// The pens in range of all but the person that the world is shown to, where each meets the
    /// active object. One that points beside it is left out. Costs a ray for each pen; nothing is
    /// kept and nothing of what is stepped depends on it.
    pub fn pens_of_others(&self) -> impl Iterator<Item = OthersPen> + '_ {
        let object = self.scene.active();
        let to_world = object.settings.transform;
        let shared = self.has_people();
        let others = self.pens.iter().filter(move |s| shared && !self.is_shown(s.device));
        others.filter_map(move |seat| {
            let seen = seat.track.seen?;
            let person = self.people.of_device(seat.device);
            let settings = self.people.other(person);
            let camera = settings.map_or(&self.camera, |o| &o.camera);
            let brush = settings.map_or(&self.brush, |o| &o.brush);
            let hit = object.clay.pick(LocalCamera::new(camera, &to_world).ray(seen.view))?;
            let pressed = if seat.track.is_open() { seen.pressure } else { 1.0 };
            Some(OthersPen {
                person,
                device: seat.device,
                object: object.id,
                position: to_world.point(hit.position),
                normal: to_world.direction(hit.normal),
                radius: brush.radius * self.extent() * brush.pressure_radius.factor(pressed),
                down: seat.track.is_open(),
                carves: brush.negative,
            })
        })
    }

    /// Whose hands are followed: the number of the person whose tracker spoke last. `None` in a
    /// world of one person.
    pub fn person_of_hands(&self) -> Option<u8> {
        self.has_people().then_some(self.people.hands)
    }
}
