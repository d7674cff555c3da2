//! `sculptd replay`: a session's input once more, from its start; prints the clay's hash.

use std::path::PathBuf;

use serde::Serialize;

use super::run::export;
use super::{Fail, Outcome, answer};
use crate::analysis::cancel::Job;
use crate::config::LoopConfig;
use crate::daemon::session::{self, OpenError};
use crate::mesh::Workers;

#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// The session file.
    pub session: PathBuf,
    /// Stop after this tick.
    #[arg(long, value_name = "TICK")]
    pub until: Option<u64>,
    /// Write the mesh as it then is.
    #[arg(long, value_name = "FILE")]
    pub export: Option<PathBuf>,
    /// Threads that help; the hash is the same with any number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub workers: usize,
}

#[derive(Debug, Serialize)]
struct Answer {
    ticks: u64,
    hash: String,
    vertices: u64,
    export: Option<String>,
    /// What of the file could not be read, if anything.
    loss: Option<String>,
}

pub fn run(args: &ReplayArgs, json: bool) -> Outcome {
    let opened = session::open(&args.session).map_err(|e| match e {
        OpenError::Io { source, .. } => Fail::io(&args.session, &source),
        e => Fail::Input(e.to_string()),
    })?;
    if let Some(loss) = &opened.loss {
        eprintln!("sculptd: warning: {}: {loss}", args.session.display());
    }
    let workers = Workers::new(LoopConfig { workers: args.workers, ..LoopConfig::default() }.worker_count());
    let replayed = session::replay::replay(&opened, args.until, workers, &Job::default())
        .map_err(|e| Fail::Input(format!("{}: {e}", args.session.display())))?;
    let answer_ = Answer {
        ticks: replayed.ticks,
        hash: format!("{:016x}", replayed.world.hash()),
        vertices: replayed.world.mesh().vertex_count() as u64,
        export: export(args.export.as_deref(), &replayed.world)?,
        loss: opened.loss.map(|l| l.to_string()),
    };
    answer(json, &answer_, |out| writeln!(out, "ticks  {}\nhash   {}", answer_.ticks, answer_.hash));
    Ok(())
}
