//! What the methods of the history do: undo and redo, where memory holds no more of them too, and
//! jumps. Each returns once the published state shows where the sculpture is.

use std::time::Duration;

use super::host::{Host, failed};
use super::status_reply::convert;
use crate::session::history::{Handle, Want, listing};
use sculptd_control::RpcError;
use sculptd_control::edit::HistoryReply;
use sculptd_devices::Clock;
use sculptd_engine::answer::Answer;
use sculptd_engine::command::Command;

/// For the history to fetch what an undo or a jump needs.
const PATIENCE: Duration = Duration::from_secs(60);

fn history(host: &Host) -> Result<&Handle, RpcError> {
    let none = || RpcError::failed("no history is kept: the daemon runs without --session");
    host.history.as_ref().ok_or_else(none)
}

/// Every place that the sculpture was at.
pub(super) fn list(host: &Host) -> Result<HistoryReply, RpcError> {
    let history = history(host)?;
    settle(host, history)?;
    let tree = history.tree();
    Ok(HistoryReply { here: tree.cursor, places: convert(listing::places(&tree))? })
}

/// Goes to a place of the history.
pub(super) fn jump(host: &Host, node: u64) -> Result<(), RpcError> {
    let history = history(host)?;
    settle(host, history)?;
    if history.tree().way(node).is_none() {
        return Err(failed(format!("no way leads to {node}; 'history' lists the places")));
    }
    history.want(Want::Node(node));
    settle(host, history)?;
    let here = history.tree().cursor;
    if here != node {
        let text = format!("the sculpture changed meanwhile: it is at {here}, not at {node}");
        return Err(RpcError::failed(text + ". Try again"));
    }
    Ok(())
}

/// Undoes or redoes a step; where memory holds none, the history in the session file does it.
pub(super) fn go(host: &Host, command: Command) -> Result<(), RpcError> {
    let answer = host.carry_out(command)?;
    match (answer, &host.history) {
        (Answer::NothingInMemory, Some(history)) => settle(host, history),
        _ => Ok(()),
    }
}

/// Waits until the history has done what it was asked for, and the published state shows it.
fn settle(host: &Host, history: &Handle) -> Result<(), RpcError> {
    let (clock, quiet) = (Clock::monotonic(), crossbeam_channel::never::<()>());
    let give_up = clock.now_us() + PATIENCE.as_micros() as u64;
    while history.is_going() {
        if let Some(why) = history.trouble() {
            return Err(failed(format!("the history cannot be written: {why}")));
        }
        if host.link().stopped() || clock.now_us() > give_up {
            return Err(RpcError::failed("the history in the session file gave no answer"));
        }
        let _ = quiet.recv_timeout(Duration::from_millis(1));
    }
    host.commands.had_effect(host.published.load().tick);
    Ok(())
}
