//! A world that runs ahead of another: it shares the pages, and its steps are a trial that the
//! other does not see. So a person sees their stroke before those who share the world have ordered
//! it.

use super::World;
use crate::scene::{Object, Scene};
use sculptd_clay::brush::Measure;

impl World {
    /// Copies this world for strokes on the active object, without other objects, undo steps and
    /// hands. The revisions of its clay continue after `revision`. Returns `None` if strokes cannot
    /// be tried now: the object has layers, its triangles change under the brush, or an edit of the
    /// whole surface is under way.
    pub fn fork(&self, revision: u64) -> Option<World> {
        let active = self.scene.active();
        let cuts = self.brush.topology.by != Measure::Off && self.brush.kind.cuts();
        let edited = self.layers.is_edit() || self.surface.is_under_way();
        if cuts || edited || active.clay.layer_count() > 0 {
            return None;
        }
        let object = Object {
            id: active.id,
            settings: active.settings.clone(),
            clay: active.clay.fork(revision),
            middle: active.middle,
            extent: active.extent,
        };
        let scene = Scene::restored(vec![object], 0, active.id.0 + 1)?;
        let workers = self.workers.clone();
        let mut world = World::around(scene, self.camera, self.brush, workers, self.options);
        world.tick = self.tick;
        world.camera = self.camera;
        world.pens.extend(self.pens.iter().cloned());
        world.strokes = self.strokes;
        world.scratch.picture.clone_from(&self.scratch.picture);
        world.desktop = self.desktop;
        world.kept_brushes = self.kept_brushes.clone();
        world.people = self.people.clone();
        world.lineages = self.lineages;
        world.set_garbage_sink(self.garbage.clone());
        world.set_page_supply(self.pages.clone());
        Some(world)
    }

    /// The world is needed no more: what it holds goes the way of its garbage.
    pub fn discard(self: Box<Self>) {
        let sink = self.garbage.clone();
        sink.discard_owned(self);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::camera::Camera;
    use crate::hand::HandSettings;
    use crate::world::WorldOptions;
    use sculptd_clay::brush::{BrushKind, BrushSettings};
    use sculptd_clay::{Clay, Workers};
    use sculptd_devices::{Body, DeviceId, Pen, Sample};
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    fn world(kind: BrushKind) -> World {
        let clay = Clay::build(&shapes::sphere_of_about(3000), &Job::default()).expect("a ball");
        let options = WorldOptions {
            dab_budget: 400_000,
            undo_bytes: 64 << 20,
            hands: HandSettings::default(),
        };
        let brush = BrushSettings { kind, radius: 0.2, ..BrushSettings::default() };
        World::new(clay, Camera::default(), brush, Workers::new(1), options)
    }

    fn pen(k: u64, tip: bool) -> Sample {
        let pen = Pen {
            in_range: true,
            tip,
            pos_mm: Vec2::new(40.0 + 0.4 * k as f32, 52.0),
            area_mm: Vec2::new(100.0, 100.0),
            pressure: Some(0.7),
            ..Pen::default()
        };
        Sample { device: DeviceId(0), t_us: k * 8333, device_t_us: None, body: Body::Pen(pen) }
    }

    #[test]
    fn a_fork_in_the_middle_of_a_stroke_goes_on_to_the_bit_and_changes_nothing_of_the_world() {
        // One that adds to the surface, one that measures on the surface as the stroke found it,
        // one that holds what it took.
        for kind in [BrushKind::Draw, BrushKind::Clay, BrushKind::Grab] {
            let mut world = world(kind);
            let begin = world.hash();
            (1..20).for_each(|k| {
                world.step(k, &[pen(k, true)], &[]);
            });
            let middle = world.hash();
            assert_ne!(middle, begin, "{kind:?}");
            let mut ahead = world.fork(1 << 40).expect("nothing is in the way");
            (20..40).for_each(|k| {
                ahead.step(k, &[pen(k, k < 38)], &[]);
            });
            assert_eq!(world.hash(), middle, "{kind:?}: the world does not know of it");
            assert!(ahead.mesh().revision() > 1 << 40);
            (20..40).for_each(|k| {
                world.step(k, &[pen(k, k < 38)], &[]);
            });
            assert_eq!(world.hash(), ahead.hash(), "{kind:?}");
            assert!(world.mesh().revision() < 1 << 40);
            world.verify_invariants().expect("sound");
            ahead.verify_invariants().expect("sound");
            Box::new(ahead).discard();
        }
    }
}
