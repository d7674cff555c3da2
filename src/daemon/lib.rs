//! The daemon: the tick loop, its clock, what it publishes, where input comes from, and what
//! outlives it.
//!
//! Read first: [`live_run`] (a live run put together), [`live`] (its loop, with real devices),
//! [`simulated_loop`] (the loop in simulated time), [`published`] (what others see), [`session`]
//! (what is kept).
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod adaptors;
pub mod boolean_jobs;
pub mod brush_folder;
mod brush_pictures;
pub mod camera_hands;
pub mod carry_over;
pub mod command_queue;
pub mod config;
#[cfg(unix)]
pub mod control;
pub mod decimate_job;
pub mod demo_devices;
pub mod disk_space;
pub mod doctor;
pub mod event_clock;
pub mod face_set_jobs;
pub mod garbage_thread;
pub mod hand_jobs;
#[cfg(unix)]
pub mod http;
pub mod input_hold;
pub mod kiosk;
pub mod live;
pub mod live_booleans;
pub mod live_run;
pub mod local_time;
pub mod mask_jobs;
#[cfg(unix)]
pub mod metric_table;
#[cfg(unix)]
pub mod metrics;
pub mod operations;
pub mod pacer;
pub mod page_thread;
pub mod pen_trail;
pub mod people;
pub mod polygons;
pub mod present_latency;
pub mod priority;
pub mod published;
pub mod qr_code;
pub mod quad_job;
#[cfg(unix)]
pub mod random_token;
pub mod remesh_job;
pub mod repair_jobs;
pub mod scene_jobs;
#[cfg(unix)]
pub mod service;
pub mod session;
pub mod shared_input;
pub mod simulated_loop;
pub mod snap_jobs;
pub mod startup;
pub mod symmetrise_job;
#[cfg(unix)]
pub mod systemd;
pub mod tablet_actions;
pub mod tablet_controls;
pub mod tablet_models;
pub mod tablet_vocabulary;
#[cfg(unix)]
pub mod telemetry;
pub mod tick;
pub mod tick_statistics;
pub mod toml_text;
pub mod trim;
#[cfg(unix)]
pub mod web;
pub mod window_link;

pub use published::{Published, Publisher};
pub use tick_statistics::{Summary, TickStatistics};
