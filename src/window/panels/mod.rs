//! The egui panels, a file each: functions from plain data ([`state`]) to requests. Nothing here
//! changes the world, and nothing here knows the viewer.
//!
//! Read first: [`state`], then [`layout`], then one panel.

pub mod act;
mod alphas;
pub mod analysis;
pub mod brush;
mod brush_palette;
mod brush_picture;
mod brush_size;
mod camera_preview;
pub mod check;
pub mod check_values;
pub mod chooser;
mod colours;
pub mod cube;
pub mod curve_stroke;
pub mod devices;
pub mod face_sets;
pub mod files;
pub mod fonts;
pub mod hand_menu;
mod header;
pub mod help;
pub mod hints;
mod icons;
pub mod history;
pub mod history_tree;
pub mod kept_views;
pub mod keys;
pub mod kiosk;
pub mod layers;
pub mod layout;
pub mod legend;
mod light;
pub mod look;
pub mod masks;
pub mod measure;
pub mod messages;
pub mod modal;
pub mod outliner;
pub mod people;
pub mod preferences;
pub mod pressure_curve;
pub mod qr_code;
pub mod radial;
pub mod region;
pub mod remesh;
pub mod retopology;
pub mod rows;
pub mod scene;
pub mod search;
pub mod start;
pub mod state;
mod status_bar;
pub mod symmetry;
pub mod tablet_keys;
pub mod theme;
pub mod timing;
pub mod trim;
pub mod views;

pub use act::act;
pub use layout::{PANEL, all};
pub use state::{SnapPicks, Tab, UiRequest, UiState, View};
