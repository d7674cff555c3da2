//! The window without a window: the renderer on whatever adapter there is, the panels through
//! AccessKit, and the law that a viewer that stalls costs the sculpture nothing.

mod beside;
mod brush_panel;
mod check;
mod check_maps;
mod check_repairs;
mod cut;
mod files;
mod four_views;
mod kiosk;
mod kiosk_screens;
mod languages;
mod layers;
mod layout;
mod learning;
mod led;
mod lights;
mod panels;
mod people;
mod pictures;
mod preferences;
mod regions;
mod scene;
mod stall;
mod stall_order;
mod versions;
mod walls;
mod workbench;

use std::sync::OnceLock;

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::Published;
use sculptd_daemon::published::PublishedFigures;
use sculptd_engine::camera::Camera;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;
use sculptd_window::language::Translations;

/// The languages of the window; tests speak English, whatever the environment says.
pub(crate) fn translations() -> &'static Translations {
    static ALL: OnceLock<Translations> = OnceLock::new();
    ALL.get_or_init(|| Translations::new(sculptd::settings::WINDOW_TEXTS, None, "en"))
}

pub(crate) fn world(vertices: usize) -> World {
    let mesh =
        Clay::build(&shapes::sphere_of_about(vertices), &Job::default()).expect("a ball builds");
    let options =
        WorldOptions { dab_budget: 1 << 30, undo_bytes: 1 << 30, hands: HandSettings::default() };
    World::new(mesh, Camera::default(), BrushSettings::default(), Workers::new(1), options)
}

pub(crate) fn published(world: &mut World) -> Published {
    Published::of(world, PublishedFigures::default())
}
