//! Three courses through the program for beginners: a sculptor with a tablet, a newcomer with a
//! mouse, an installer. Each step is done in a real window by pen, pointer and keys. It is complete
//! when the daemon or the screen reports it. The list of steps is printed; with
//! `SCULPTD_SHOTS=folder` each step saves a picture, and some are compared with reference pictures.
//!
//! They are long tests: each takes minutes where a processor draws.

mod installer;
mod newcomer;
mod sculptor;

use serde_json::{Value, json};

use super::stage::{Stage, as_kept, long, pause};

/// A course under way.
struct Course {
    s: Stage,
    name: &'static str,
    steps: u32,
}

impl Course {
    /// A window for a course; `None`, and why, where there can be none or nobody asked.
    fn begin(name: &'static str, args: &[&str]) -> Option<Course> {
        if !long() {
            println!("skipped: SCULPTD_LONG=1 runs it");
            return None;
        }
        let mut s = Stage::open(args)?;
        // The window is there before its first frame is.
        s.seen(&format!("course-{name}-00"));
        Some(Course { s, name, steps: 0 })
    }

    /// One step: what the person does, and how it is seen that it was done.
    fn step(
        &mut self,
        what: &str,
        act: impl FnOnce(&mut Stage),
        came: impl FnMut(&mut Stage) -> bool,
    ) {
        self.steps += 1;
        act(&mut self.s);
        self.s.until(what, came);
        // The frame after the one that answered.
        pause(300);
        self.s.look(&format!("course-{}-{:02}", self.name, self.steps));
        println!("{} {:2}: {what}", self.name, self.steps);
    }

    /// The screen as it is after the last step resembles the kept picture.
    fn is_as_kept(&mut self) {
        let name = format!("course-{}-{:02}", self.name, self.steps);
        as_kept(&name, &self.s.look(&name));
    }
}

fn press(s: &Stage, (x, y): (i32, i32)) {
    s.drive(&["mousemove", &x.to_string(), &y.to_string(), "click", "1"]);
}

/// A drag with another button, pixels of the window.
fn drag_with(s: &Stage, button: &str, from: (i32, i32), to: (i32, i32)) {
    let go = |(x, y): (i32, i32)| s.drive(&["mousemove", &x.to_string(), &y.to_string()]);
    go(from);
    s.drive(&["mousedown", button]);
    for i in 1..=8 {
        go((from.0 + (to.0 - from.0) * i / 8, from.1 + (to.1 - from.1) * i / 8));
    }
    s.drive(&["mouseup", button]);
}

fn key(s: &Stage, keys: &str) {
    s.drive(&["key", keys]);
}

fn brush(s: &Stage) -> Value {
    s.ask("brush", &json!({}))
}

fn hash(s: &Stage) -> Value {
    s.ask("hash", &Value::Null)["hash"].clone()
}

fn steps(s: &Stage) -> u64 {
    s.figure("undo_steps")
}
