//! The faults, one function each. Each returns what was seen.

use std::fs::File;
use std::path::Path;

use rustix::fs::{FallocateFlags, FsWord, fallocate, statfs};
use rustix::io::Errno;

use super::TrialEnd;
use super::running::{Running, kill, pause};
use crate::disk_space::free_bytes;
use crate::kiosk::visit_journal::VISIT_FILE;

/// Most memory that a full disk in memory may cost, bytes.
const MOST_MEMORY: u64 = 256 << 20;
/// Bytes that count as a full disk: less than a group of input needs.
const FULL: u64 = 4096;
/// The jump of the clock, seconds.
const JUMP_S: i64 = 3600;
/// File system type of `tmpfs` (`linux/magic.h`).
const TMPFS: FsWord = 0x0102_1994;

/// Kills the program. Another process must show the same sculpture.
pub(super) fn kill_program(running: &mut Running) -> Result<String, TrialEnd> {
    let before = running.sculpt()?;
    let (pid, window) = (running.pid, settled_window(running));
    kill(pid)?;
    comes_back(running, &before, &window)
}

/// Kills the X server of the program, which ends with it.
pub(super) fn screen(running: &mut Running) -> Result<String, TrialEnd> {
    let none = |why: &str| TrialEnd::NotTried(why.into());
    let display = running.variable("DISPLAY").ok_or_else(|| none("it runs without an X server"))?;
    let number = display.trim_start_matches(':').split('.').next().unwrap_or_default();
    let lock = format!("/tmp/.X{number}-lock");
    let server = std::fs::read_to_string(&lock).ok().and_then(|text| text.trim().parse().ok());
    // Anybody may write the lock file, and this may be root: only an X server is killed.
    let server = server.filter(|pid| is_x_server(*pid));
    let server = server.ok_or_else(|| none(&format!("{lock} names no X server")))?;
    let before = running.sculpt()?;
    let window = settled_window(running);
    kill(server)?;
    comes_back(running, &before, &window)
}

fn is_x_server(pid: i32) -> bool {
    let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).unwrap_or_default();
    matches!(name.trim(), "X" | "Xorg" | "Xvfb" | "Xwayland" | "Xephyr")
}

fn window(running: &Running) -> String {
    let status = running.status().unwrap_or_default();
    status["window"].as_str().unwrap_or("unknown").to_owned()
}

/// The state of the window once it is no longer opening.
fn settled_window(running: &mut Running) -> String {
    let settled = running.within(|r| Some(window(r)).filter(|state| state != "opening"));
    settled.unwrap_or_else(|| window(running))
}

/// Waits until another process shows the same sculpture, in a window if there was one.
fn comes_back(running: &mut Running, before: &str, shown: &str) -> Result<String, TrialEnd> {
    let (old, begun) = (running.pid, running.clock.now_us());
    let back = running.within(|r| {
        r.pid = r.listener().filter(|pid| *pid != old)?;
        (window(r) == shown).then(|| r.hash()).flatten()
    });
    let seconds = (running.clock.now_us() - begun) as f64 / 1e6;
    match back {
        Some(hash) if hash == before => Ok(format!(
            "another process (window: {shown}) showed the same sculpture after {seconds:.1} s"
        )),
        Some(_) => Err(TrialEnd::Failed(format!(
            "another process came after {seconds:.1} s with another sculpture"
        ))),
        None => Err(TrialEnd::Failed(format!("it was not back after {seconds:.0} s"))),
    }
}

/// Takes the whole disk of the visit's file. The program must report it, go on, and store again
/// once there is room.
pub(super) fn disk(running: &mut Running) -> Result<String, TrialEnd> {
    let not_tried = |why: String| TrialEnd::NotTried(why);
    running.sculpt()?;
    let visits = running.visits().filter(|folder| folder.join(VISIT_FILE).exists());
    let visits = visits.ok_or_else(|| not_tried("the visit's file was not found".into()))?;
    let filling = fill(&visits).map_err(not_tried)?;
    let begun = running.clock.now_us();
    let seconds = |r: &Running, since: u64| (r.clock.now_us() - since) as f64 / 1e6;
    let reported = running.within(|r| {
        r.sculpt().ok()?;
        r.fault()
    });
    let after = seconds(running, begun);
    let sculpts = running.sculpt();
    drop(filling);
    let (freed, before) = (running.clock.now_us(), ticks_stored(running));
    // First without a visitor's input, then with it.
    let well = |r: &Running| r.status().is_some_and(|s| s["journal"]["fault"].is_null());
    let over = running.within(|r| well(r).then_some(()));
    let again = seconds(running, freed);
    let stores = |r: &mut Running| {
        r.sculpt().ok()?;
        (well(r) && ticks_stored(r) > before).then_some(())
    };
    let stored = over.and_then(|()| running.within(stores));
    let reported = reported.ok_or_else(|| {
        TrialEnd::Failed(format!("no fault was reported within {after:.0} s of a full disk"))
    })?;
    sculpts.map_err(|_| TrialEnd::Failed(format!("sculpting stopped: {reported}")))?;
    match stored {
        Some(()) => Ok(format!(
            "sculpting went on; after {after:.1} s it reported \"{reported}\"; {again:.1} s after \
             there was room again the fault was over, and more was stored"
        )),
        None => Err(TrialEnd::Failed(format!(
            "{again:.1} s after there was room again it did not store: {}",
            running.fault().unwrap_or_else(|| "it reports no fault".into())
        ))),
    }
}

/// Returns the number of ticks that the visit's file has.
fn ticks_stored(running: &Running) -> u64 {
    running.status().and_then(|status| status["journal"]["written"].as_u64()).unwrap_or(0)
}

/// Takes all room on the disk of a folder, in a file without a name: the room comes back with the
/// end of this process at the latest.
fn fill(folder: &Path) -> Result<File, String> {
    let free = free_bytes(folder).ok_or("the free space is not known")?;
    let in_memory = statfs(folder).is_ok_and(|disk| disk.f_type == TMPFS);
    if in_memory && free > MOST_MEMORY {
        return Err(format!("{} is in memory, which would be full", folder.display()));
    }
    let file = tempfile_in(folder)?;
    let (mut at, mut step) = (0, free);
    while step >= FULL {
        match fallocate(&file, FallocateFlags::empty(), at, step) {
            Ok(()) => at += step,
            Err(Errno::NOSPC) => step /= 2,
            Err(e) => return Err(format!("the disk cannot be filled: {e}")),
        }
    }
    Ok(file)
}

fn tempfile_in(folder: &Path) -> Result<File, String> {
    let path = folder.join(".kiosk-try");
    let file = std::fs::OpenOptions::new().write(true).create_new(true).open(&path);
    let file = file.map_err(|e| format!("{}: {e}", path.display()))?;
    std::fs::remove_file(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(file)
}

/// Moves the clock ahead and back. The same process must keep the same sculpture and go on.
pub(super) fn clock(running: &mut Running) -> Result<String, TrialEnd> {
    let before = running.sculpt()?;
    let pid = running.pid;
    let move_clock = running.settings.move_clock;
    move_clock(JUMP_S).map_err(|e| TrialEnd::NotTried(format!("the clock cannot be set: {e}")))?;
    pause(3_000);
    let ahead = running.hash();
    let set_back = move_clock(-JUMP_S);
    pause(1_000);
    set_back.map_err(|e| TrialEnd::Failed(format!("the clock is {JUMP_S} s ahead: {e}")))?;
    let back = running.hash();
    if running.listener() != Some(pid) {
        return Err(TrialEnd::Failed("the program ended".into()));
    }
    if [&ahead, &back].iter().any(|hash| hash.as_ref() != Some(&before)) {
        return Err(TrialEnd::Failed("the sculpture changed".into()));
    }
    running.sculpt()?;
    Ok("an hour ahead and back: the same process kept the sculpture, and sculpting went on".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_that_names_another_process_names_no_x_server() {
        assert!(!is_x_server(i32::try_from(std::process::id()).expect("a process")));
        assert!(!is_x_server(1));
        assert!(!is_x_server(-1));
    }
}
