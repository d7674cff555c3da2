//! `sculptd demo`: the main job with no hardware.

use super::Outcome;

#[derive(Debug, clap::Args)]
pub struct DemoArgs {}

pub fn run(_: &DemoArgs, _: bool) -> Outcome {
    Ok(())
}
