//! The C interface: `include/sculptd.h`, generated from this crate by cbindgen.
//!
//! This crate is the second place of the workspace where `unsafe` is allowed, for one reason: a
//! pointer that comes from C carries no proof of what it points to. So every pointer is read in
//! `boundary.rs` and nowhere else, each function states in its documentation what the caller
//! promises, and everything behind the boundary is safe Rust.
//!
//! Rules: no function unwinds into C (`boundary::guarded`); no function prints; what is handed
//! out is freed by a function of this crate; null is refused, never followed.
#![allow(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod boundary;
#[allow(dead_code)] // The presets of `sculptd check` are in the same file.
#[path = "../../../cli/embedded_presets.rs"]
mod embedded_presets;
mod judgement;
mod mesh;
mod section;
mod sentences;
mod solid;
mod tablet;

pub use boundary::{SculptdStatus, sculptd_error_message, sculptd_version};
pub use judgement::{
    SculptdJudgement, SculptdJudgementFacts, SculptdLimits, SculptdThinPlace, SculptdVerdict,
    sculptd_judge, sculptd_judgement_facts, sculptd_judgement_free, sculptd_judgement_statement,
    sculptd_judgement_warnings, sculptd_judgement_worst,
};
pub use mesh::{
    SculptdMesh, SculptdMeshContents, sculptd_mesh_contents, sculptd_mesh_corners,
    sculptd_mesh_face_starts, sculptd_mesh_format, sculptd_mesh_free, sculptd_mesh_new,
    sculptd_mesh_read, sculptd_mesh_unread, sculptd_mesh_unwritten, sculptd_mesh_vertices,
    sculptd_mesh_write,
};
pub use section::{
    SculptdContour, SculptdSectionFacts, SculptdSections, sculptd_section_contour,
    sculptd_section_facts, sculptd_sections, sculptd_sections_count, sculptd_sections_free,
};
pub use sentences::{
    SculptdSentences, sculptd_sentences_count, sculptd_sentences_free, sculptd_sentences_get,
};
pub use solid::{
    SculptdBooleanFacts, SculptdOperation, SculptdThickness, sculptd_boolean, sculptd_thickness,
};
pub use tablet::{
    SculptdPenSample, SculptdTablet, SculptdTool, sculptd_tablet_area, sculptd_tablet_free,
    sculptd_tablet_name, sculptd_tablet_open, sculptd_tablet_report, sculptd_tablet_tick,
};
