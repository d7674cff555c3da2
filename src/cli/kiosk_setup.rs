//! `sculptd kiosk install` and `sculptd kiosk uninstall`.

use std::path::PathBuf;

use super::{Fail, Outcome, answer};
use crate::settings::{KIOSK, TABLET_RULES};
use sculptd_daemon::kiosk::setup::{self, FileAction, InstallRequest, SetupError, SetupReport};
use sculptd_daemon::random_token::random_token;

#[derive(Debug, clap::Args)]
pub struct InstallArgs {
    /// The user that the installation runs as. It is made if absent, without a password.
    #[arg(long, value_name = "NAME", default_value = "visitor")]
    pub user: String,
    /// Root of the system, for one that is mounted.
    #[arg(long, value_name = "FOLDER", default_value = "/")]
    pub root: PathBuf,
    /// Change nothing, and print what would be done.
    #[arg(long)]
    pub dry_run: bool,
}

#[derive(Debug, clap::Args)]
pub struct UninstallArgs {
    /// Root of the system, for one that is mounted.
    #[arg(long, value_name = "FOLDER", default_value = "/")]
    pub root: PathBuf,
    /// Change nothing, and print what would be done.
    #[arg(long)]
    pub dry_run: bool,
}

pub fn install(args: &InstallArgs, json: bool) -> Outcome {
    let random = random_token().map_err(|e| Fail::Input(format!("no random numbers: {e}")))?;
    let request = InstallRequest {
        root: &args.root,
        user: &args.user,
        dry_run: args.dry_run,
        settings: KIOSK,
        tablet_rules: TABLET_RULES,
        random: &random,
    };
    report(&setup::install(&request).map_err(|e| failed("install", e))?, json)
}

pub fn uninstall(args: &UninstallArgs, json: bool) -> Outcome {
    let done = setup::uninstall(&args.root, args.dry_run);
    report(&done.map_err(|e| failed("uninstall", e))?, json)
}

fn failed(what: &str, e: SetupError) -> Fail {
    let text = format!("kiosk {what}: {e}");
    match e {
        SetupError::NotRoot => Fail::Permission(text),
        SetupError::UserName { .. } | SetupError::UserIsRoot { .. } => Fail::Usage(text),
        SetupError::Missing { .. } | SetupError::NotInstalled(_) => Fail::Check(text),
        SetupError::Io { path, source } => Fail::io(&path, &source),
    }
}

/// Prints what was done. Fails where a command failed.
fn report(done: &SetupReport, json: bool) -> Outcome {
    answer(json, done, |out| {
        for file in &done.files {
            let word = match file.action {
                FileAction::Write => "write",
                FileAction::Update => "update",
                FileAction::Unchanged => "as it was",
                FileAction::LeaveChanged => "LEFT",
                FileAction::Packaged => "packaged",
                FileAction::Remove => "remove",
            };
            writeln!(out, "{word:<10} {}  ({})", file.path, file.about)?;
        }
        for command in &done.commands {
            match &command.failure {
                None => writeln!(out, "{:<10} {}", "run", command.command)?,
                Some(why) => writeln!(out, "{:<10} {}: {why}", "FAILED", command.command)?,
            }
        }
        if done.dry_run {
            writeln!(out, "a dry run: nothing was changed")?;
        }
        done.notes.iter().try_for_each(|note| writeln!(out, "{note}"))
    });
    match done.failures() {
        0 => Ok(()),
        n => Err(Fail::Check(format!("{n} of {} commands failed", done.commands.len()))),
    }
}
