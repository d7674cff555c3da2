//! The viewer: draws what was published, sends commands and pointer samples, and owns nothing of
//! the world. A viewer that stalls or dies costs the sculpture nothing.
//!
//! Read first: `app` (events), `poll` (what changed), `frame` (one frame), `clay_frame` (its clay),
//! `input` (the pointer).

mod app;
mod brush_requests;
mod camera_animation;
mod check_follow;
pub mod check_task;
mod clay_frame;
mod clay_picture;
mod coarse_pages;
pub mod distance_field;
pub mod distance_reference;
mod earlier_pictures;
pub mod environment;
mod event_times;
mod exhibit_goal;
mod fingers;
mod folder_listing;
mod folder_tasks;
mod follow;
mod four_views;
mod frame;
mod frame_uniform;
pub mod gizmo;
mod goal_ghost;
pub mod gpu;
mod input;
mod latest_wins;
mod look_choice;
pub mod look_files;
mod look_follow;
mod map_fit;
mod mirrors;
pub mod objects;
mod over_clay;
pub mod overlay;
pub mod overlay_mesh;
mod pacing;
mod page_place;
pub mod pages;
pub mod picture;
mod plate;
mod pointer;
mod poll;
pub mod preferences_file;
pub mod preview;
pub mod provisional;
pub mod renderer;
mod requests;
mod scene_pointer;
pub mod section_figures;
mod shadow;
mod shots;
mod snapshot_workers;
mod ssao;
mod state;
mod step_picture_jobs;
mod step_pictures;
mod surroundings;
mod tablet_map;
mod tablets;
mod task_texts;
pub mod tasks;
mod thickness_task;
pub mod timelapse;
mod turntable;
mod version_pictures;
mod wall_follow;
pub mod wall_probe;
mod wiring;

pub use app::run;
pub use gpu::{Gpu, NoViewer};
pub use wiring::Wiring;
