//! What hands do to the world: they push clay, carry an object, choose from their menu.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::World;
use crate::answer::{Answer, CommandResult};
use crate::command::Command;
use crate::hand::{Act, HeldObject, MenuItem, Similarity};
use crate::scene::SceneError;
use sculptd_clay::{Garbage, Kernel, Reach};
use sculptd_geometry::portable::turn_about;
use sculptd_geometry::{PolyMesh, TriMesh, shapes};

impl World {
    /// An object appears beside the clay, a third as large as it, for the hands to carry.
    pub(super) fn take_up(&mut self, plain: Arc<TriMesh>) -> CommandResult {
        let (lo, hi) = plain.bounds();
        let size = (hi - lo).length() * 0.5;
        if !(size.is_finite() && size > 0.0) {
            return Err(SceneError::Value("a mesh with an extent"));
        }
        let (middle, extent) = (self.middle(), self.extent());
        let scale = extent / 3.0 / size;
        let turn = turn_about(Vec3::Y, self.camera.yaw);
        let at = middle + turn * Vec3::new(extent * 1.2, extent * 0.4, 0.0);
        let place = Similarity { shift: at - turn * ((lo + hi) * 0.5 * scale), turn, scale };
        if !place.is_sane() {
            return Err(SceneError::Transform);
        }
        self.put_down();
        self.thing = Some(HeldObject { plain, place });
        self.hands.carrying = true;
        Ok(Answer::Done)
    }

    pub(super) fn put_down(&mut self) {
        self.end_picking();
        if let Some(held) = self.thing.take() {
            self.garbage.discard(Garbage::Shared(held.plain));
        }
        self.hands.carrying = false;
    }

    pub(super) fn choose(&mut self, choice: MenuItem) {
        let primitive = |solid: PolyMesh| Arc::new(solid.triangulate().0);
        // Nobody waits for an answer here: what hands did is seen.
        let _ = match choice {
            MenuItem::Undo => self.apply_command(&Command::Undo),
            MenuItem::Redo => self.apply_command(&Command::Redo),
            MenuItem::PickUp => return self.begin_picking(),
            MenuItem::PutAway => return self.put_down(),
            MenuItem::Ball => self.take_up(primitive(shapes::uv_sphere(1.0, 24, 48))),
            MenuItem::Box => self.take_up(primitive(shapes::cuboid(DVec3::NEG_ONE, DVec3::ONE))),
            MenuItem::Cylinder => self.take_up(primitive(shapes::cylinder(1.0, 2.0, 48))),
            MenuItem::Add | MenuItem::Carve | MenuItem::Keep => {
                self.report.join = Some(choice);
                return;
            }
        };
    }

    /// One act of a hand; returns what is left of the budget.
    pub(super) fn by_hand(&mut self, act: &Act, left: u64) -> u64 {
        // Hands are in the world, the clay is in the frame of its object.
        let own = self.scene.active().settings.transform.inverse();
        let camera = &mut self.camera;
        match act {
            Act::Orbit(by) => camera.orbit(*by),
            Act::Zoom(factor) => camera.zoom(*factor),
            Act::Move(by) => camera.target -= *by,
            Act::Hold { before, after } => {
                // The camera keeps its place among the hands.
                let mm = before.turn.inverse() * (camera.target - before.origin) / before.scale;
                camera.target = after.to_world(mm);
                camera.distance = (camera.distance * after.scale / before.scale).clamp(1e-6, 1e9);
            }
            Act::Carry(by) => match &mut self.thing {
                Some(thing) => thing.carry(by),
                None => self.carry_object(by),
            },
            // Hands that carry objects do not sculpt: one that opens beside a part would press it.
            Act::Push(_) | Act::Drag(_) | Act::Palm(_) if self.in_hand.picking => {}
            Act::Push(a) => {
                let a = a.seen_from(&own);
                return self.touch(&a.reach(), &a.kernel(), left);
            }
            Act::Drag(a) => {
                let a = a.seen_from(&own);
                return self.touch(&a.reach(), &a.kernel(), left);
            }
            Act::Palm(a) => {
                let a = a.seen_from(&own);
                return self.touch(&a.reach(), &a.kernel(), left);
            }
        }
        left
    }

    fn touch<K: Kernel>(&mut self, reach: &Reach, kernel: &K, left: u64) -> u64 {
        if !self.scene.active().takes_strokes() {
            return left;
        }
        self.author(Some(self.people.hands));
        let clay = &mut self.scene.active_mut().clay;
        clay.begin_step();
        let report = clay.dab(reach, kernel, &self.workers);
        self.author(None);
        if report.moved > 0 {
            self.report.dabs += 1;
            self.hands.sculpted();
        }
        self.report.vertices_moved += report.moved as u64;
        left.saturating_sub(report.affected as u64 + 1)
    }
}
