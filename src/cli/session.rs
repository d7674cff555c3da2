//! `sculptd session list|show|prune|save`: the session files.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{Fail, Outcome, answer};
use sculptd_daemon::config::state_dir;

use sculptd_daemon::session::catalog;
use sculptd_daemon::session::catalog::SessionEntry;
use sculptd_daemon::session::history::retention::Freed;
use sculptd_daemon::session::history::{Store, StoreError, listing};
use sculptd_daemon::session::in_use;
use sculptd_daemon::session::salvage::{SalvageError, salvage};
use sculptd_geometry::io::write_beside;

#[derive(Debug, clap::Subcommand)]
pub enum SessionCommand {
    /// Every session in a folder, the newest first.
    List {
        /// The user's own state folder if left out.
        folder: Option<PathBuf>,
    },
    /// Show the contents and the condition of a session. Exits with 1 if it is damaged.
    Show { session: PathBuf },
    /// List every place in the history, including branches; `sculptd ctl jump` goes to a place of a
    /// running daemon's.
    History {
        session: PathBuf,
        /// Write a thumbnail of each place into this folder, as place-00000.png and on.
        #[arg(long, value_name = "FOLDER")]
        pictures: Option<PathBuf>,
    },
    /// Remove the oldest sessions, or shorten the histories of the others. Lists them, and changes
    /// them only with --yes.
    Prune {
        folder: Option<PathBuf>,
        /// Number of newest sessions to keep.
        #[arg(long, value_name = "N", default_value_t = 20)]
        keep: usize,
        /// Remove the oldest places of each remaining session until its history is at most this
        /// many MiB.
        #[arg(long, value_name = "MIB")]
        history: Option<u64>,
        #[arg(long)]
        yes: bool,
    },
    /// Salvage a damaged session into a new file beside it.
    Save { session: PathBuf },
}

fn list(folder: &Path) -> Result<Vec<SessionEntry>, Fail> {
    catalog::list(folder).map_err(|e| Fail::io(folder, &e))
}

fn line(out: &mut dyn std::io::Write, e: &SessionEntry) -> std::io::Result<()> {
    let facts = e.facts.as_ref().map_or_else(
        || "unreadable".into(),
        |f| {
            let seconds = f.last_tick / u64::from(f.rate_hz.max(1));
            format!("{:>3} min {:02} s  {:>9} samples", seconds / 60, seconds % 60, f.samples)
        },
    );
    writeln!(out, "{:>8} KiB  {facts}  {}", e.bytes.div_ceil(1024), e.path.display())?;
    e.damage.as_ref().map_or(Ok(()), |d| writeln!(out, "              damaged: {d}"))
}

fn history(session: &Path, pictures: Option<&Path>, json: bool) -> Outcome {
    std::fs::metadata(session).map_err(|e| Fail::io(session, &e))?;
    let input = |e: StoreError| Fail::Input(format!("{}: {e}", session.display()));
    let found = listing::read(session).map_err(input)?;
    let mut written = 0;
    if let Some(folder) = pictures {
        std::fs::create_dir_all(folder).map_err(|e| Fail::io(folder, &e))?;
        let store = Store::read(session).map_err(input)?;
        for place in &found.places {
            if let Some(png) = store.thumbnail(place.node).map_err(input)? {
                let path = folder.join(format!("place-{:05}.png", place.node));
                write_beside(&path, |out| out.write_all(&png)).map_err(|e| Fail::io(&path, &e))?;
                written += 1;
            }
        }
    }
    answer(json, &json!({ "history": found, "pictures": written }), |out| {
        for p in &found.places {
            let from = p.parent.map_or("-".into(), |n| n.to_string());
            let mark = if p.here { "*" } else { " " };
            let branch = if p.branch { "  branch" } else { "" };
            let deed = format!("{:?}", p.deed).to_lowercase();
            writeln!(
                out,
                "{mark}{:>6}  after {from:>6}  tick {:>9}  {deed:<8} {:>6} of {} pages{branch}",
                p.node, p.tick, p.changed, p.pages
            )?;
        }
        writeln!(out, "{} places, {} KiB of pages", found.places.len(), found.bytes.div_ceil(1024))
    });
    Ok(())
}

/// A session whose history is shortened.
#[derive(Debug, serde::Serialize)]
struct Shorter {
    path: PathBuf,
    /// Bytes of its history before.
    bytes: u64,
    /// The removed places and freed bytes; absent if nothing was done yet.
    freed: Option<Freed>,
}

fn prune(folder: &Path, keep: usize, history_mib: Option<u64>, yes: bool, json: bool) -> Outcome {
    let all = if folder.exists() { list(folder)? } else { vec![] };
    let spare = catalog::spare(all.clone(), keep);
    let mut shorter = Vec::new();
    if let Some(mib) = history_mib {
        let most = mib.saturating_mul(1 << 20);
        for e in
            all.iter().filter(|e| e.damage.is_none() && !spare.iter().any(|s| s.path == e.path))
        {
            let bytes = e.history.as_ref().map_or(0, |h| h.total_bytes);
            if bytes <= most || in_use(&e.path) {
                continue;
            }
            let fail = |why: StoreError| Fail::Input(format!("{}: {why}", e.path.display()));
            let freed = if yes { catalog::shorten(&e.path, most).map_err(fail)? } else { None };
            shorter.push(Shorter { path: e.path.clone(), bytes, freed });
        }
    }
    let freed: u64 = spare.iter().map(|e| e.bytes).sum();
    if yes {
        for e in &spare {
            catalog::remove(&e.path).map_err(|why| Fail::io(&e.path, &why))?;
        }
    }
    let paths: Vec<&PathBuf> = spare.iter().map(|e| &e.path).collect();
    let value = json!({ "removed": yes, "bytes": freed, "sessions": paths, "shortened": shorter });
    answer(json, &value, |out| {
        spare.iter().try_for_each(|e| line(out, e))?;
        let word = if yes { "removed" } else { "would go (add --yes)" };
        writeln!(out, "{} {word}, {} KiB", spare.len(), freed.div_ceil(1024))?;
        for s in &shorter {
            match s.freed {
                Some(f) => writeln!(
                    out,
                    "{}: {} oldest places went, {} KiB",
                    s.path.display(),
                    f.places,
                    f.bytes / 1024
                )?,
                None => writeln!(
                    out,
                    "{}: {} KiB of history would be shortened (add --yes)",
                    s.path.display(),
                    s.bytes / 1024
                )?,
            }
        }
        Ok(())
    });
    Ok(())
}

pub fn run(command: &SessionCommand, json: bool) -> Outcome {
    match command {
        SessionCommand::List { folder } => {
            let folder = folder.clone().unwrap_or_else(state_dir);
            let all = if folder.exists() { list(&folder)? } else { vec![] };
            answer(json, &json!({ "folder": folder, "sessions": all }), |out| {
                if all.is_empty() {
                    return writeln!(out, "no sessions in {}", folder.display());
                }
                all.iter().try_for_each(|e| line(out, e))
            });
        }
        SessionCommand::Show { session } => {
            let entry = catalog::look(session).map_err(|e| Fail::io(session, &e))?;
            answer(json, &entry, |out| {
                line(out, &entry)?;
                if let Some(text) = &entry.not_ended {
                    writeln!(out, "{text}")?;
                }
                let Some(f) = &entry.facts else { return Ok(()) };
                writeln!(out, "start           {:>12} vertices", f.start_vertices)?;
                writeln!(out, "last tick       {:>12}   at {} Hz", f.last_tick, f.rate_hz)?;
                writeln!(out, "ticks           {:>12}   that had input", f.ticks)?;
                writeln!(out, "commands        {:>12}", f.commands)?;
                writeln!(out, "layout          {:>12}", f.layout)?;
                if let Some(why) = &f.replay_from {
                    writeln!(out, "opens at a checkpoint, not from its start: {why}")?;
                }
                let Some(h) = &entry.history else { return Ok(()) };
                writeln!(
                    out,
                    "history         {:>12} places, {} on branches",
                    h.places, h.branches
                )?;
                writeln!(
                    out,
                    "                {:>12} checkpoints, {} KiB, of which {} KiB of pages",
                    h.checkpoints,
                    h.total_bytes / 1024,
                    h.bytes / 1024
                )?;
                match h.dropped {
                    0 => Ok(()),
                    n => writeln!(
                        out,
                        "                {n:>12} older places let go (undo.history_bytes)"
                    ),
                }
            });
            match entry {
                SessionEntry { facts: None, damage: Some(why), .. } => {
                    return Err(Fail::Input(why));
                }
                SessionEntry { damage: Some(_), .. } => {
                    let text = format!(
                        "damaged; mend it with: sculptd session save '{}'",
                        session.display()
                    );
                    return Err(Fail::Check(text));
                }
                _ => {}
            }
        }
        SessionCommand::History { session, pictures } => {
            history(session, pictures.as_deref(), json)?
        }
        SessionCommand::Prune { folder, keep, history, yes } => {
            prune(folder.clone().unwrap_or_else(state_dir).as_path(), *keep, *history, *yes, json)?;
        }
        SessionCommand::Save { session } => {
            let saved = salvage(session).map_err(|e| match e {
                SalvageError::Whole { .. } => Fail::Usage(e.to_string()),
                e => Fail::Input(e.to_string()),
            })?;
            let lost = saved.loss.as_ref().and_then(|l| l.ticks());
            let value = json!({
                "path": saved.path, "lost_ticks": lost, "start_changed": saved.start_changed,
                "loss": saved.loss.as_ref().map(|l| l.to_string()),
            });
            answer(json, &value, |out| writeln!(out, "{saved}"));
        }
    }
    Ok(())
}
