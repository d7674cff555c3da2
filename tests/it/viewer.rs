//! The window without a window: the renderer on whatever adapter there is, the panels through AccessKit, and the law
//! that a viewer that stalls costs the sculpture nothing.

mod beside;
mod kiosk;
mod layout;
mod panels;
mod pictures;
mod places;
mod stall;
#[cfg(unix)]
mod window;

use sculptd::analysis::cancel::Job;
use sculptd::brush::BrushSettings;
use sculptd::daemon::Published;
use sculptd::daemon::published::PublishedFigures;
use sculptd::hand::HandSettings;
use sculptd::mesh::{Mesh, Workers, shapes};
use sculptd::stroke::Camera;
use sculptd::world::{World, WorldOptions};

pub(crate) fn world(vertices: usize) -> World {
    let mesh = Mesh::build(&shapes::sphere_of_about(vertices), &Job::default()).expect("a ball builds");
    let options = WorldOptions { dab_budget: 1 << 30, undo_bytes: 1 << 30, hands: HandSettings::default() };
    World::new(mesh, Camera::default(), BrushSettings::default(), Workers::new(1), options)
}

pub(crate) fn published(world: &mut World) -> Published {
    Published::of(world, PublishedFigures::default())
}
