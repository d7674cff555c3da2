//! Checks of a part before it is printed or moulded: what is wrong, where, by how much, and what to
//! do about it.
//!
//! Read first: [`finding`] (what a check says), [`preset`] (the limits), then [`check_part`], which
//! runs all checks that a process asks for.
//!
//! | question | module |
//! |---|---|
//! | is the mesh one solid? | [`soundness`] |
//! | thin walls, pins, gaps, holes, thick sections | [`walls`] |
//! | islands, enclosed voids, suction cups | [`layers::sweep`] |
//! | overhangs, bridges, support | [`layers::overhangs`], [`layers::bridge`], [`columns`] |
//! | first layer, tipping, size | [`layers::placement`], [`layers::plate`] |
//! | draft, undercuts, parting direction | [`moulding`] |
//! | weight, time, cooling, clamping | [`estimates`] |
//! | in which direction to build | [`orientation`] |
//! | how to repair it: base, split, holes | [`repair`] |
//!
//! No claim without a check: [`CheckAnswer::ok`] is true only if every check that the process
//! asks for ran. A check that could not run is a finding. A tie with a limit passes. Results are
//! the same with any number of threads.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]
#![deny(missing_docs)]
#![warn(rustdoc::broken_intra_doc_links, rustdoc::private_intra_doc_links)]

mod answer;
mod ceilings;
mod checks;
pub mod columns;
pub mod estimates;
pub mod finding;
pub mod layers;
pub mod moulding;
pub mod orientation;
pub mod part;
pub mod preset;
pub mod regions;
pub mod repair;
pub mod report;
mod run;
pub mod settings;
pub mod soundness;
pub mod walls;

pub use answer::{CheckAnswer, CheckProgress, CheckRequest, CheckedSolid, PartFacts, RanCheck};
pub use finding::{Finding, FindingKind, Severity};
pub use run::{check_count, check_part};
pub use settings::{CheckSettings, PresetLibrary};
