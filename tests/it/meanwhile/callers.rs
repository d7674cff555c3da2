//! What each caller hears of an operation is what the world did.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use serde_json::{Value, json};

use super::studio::{self, Pace, Studio, brush};
use sculptd_daemon::boolean_jobs::at_rest;
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::event_clock::EventClock;
use sculptd_daemon::operations::{self, Target};
use sculptd_daemon::remesh_job::{Wanted, remeshed};
use sculptd_devices::Clock;
use sculptd_engine::command::Command;
use sculptd_engine::hand::{MenuItem, Similarity};
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Caller {
    Socket,
    Window,
    /// The menu of tracked hands, at a desk or in an installation.
    Hands,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Case {
    Done,
    Refused,
    Rebased,
    Cancelled,
}

/// What the caller hears; `Err` with the text.
fn heard(studio: &Studio, caller: Caller, cancelled: bool) -> Result<(), String> {
    let live = &studio.live;
    let job = Job::default();
    if cancelled {
        job.cancel();
    }
    match caller {
        Caller::Socket => {
            let presets = sculptd::presets().clone();
            let host = Host::new(live.commands.clone(), live.published.clone(), presets);
            let done = AtomicBool::new(!cancelled);
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    while !done.load(Relaxed) {
                        let _ = call(&host, "cancel", Value::Null);
                        studio::wait(Duration::from_millis(1));
                    }
                });
                let reply = call(&host, "remesh", json!({ "voxel": 0.03 }));
                done.store(true, Relaxed);
                reply.map(|_| ()).map_err(|e| e.message)
            })
        }
        Caller::Window => {
            let (answers, _heard) = crossbeam_channel::unbounded();
            let clock = EventClock::new(Clock::monotonic());
            let commands = live.commands.of_window(answers, clock);
            let to = Target { published: &live.published, commands: &commands };
            let wanted = Wanted { voxel: Some(0.03), sharp: false };
            let done = operations::carry_out(to, &job, |now| remeshed(now, &wanted, &job));
            done.map(|_| ()).map_err(|e| e.to_string())
        }
        Caller::Hands => {
            at_rest(studio.to(), MenuItem::Add, &job).map(|_| ()).map_err(|e| e.to_string())
        }
    }
}

#[test]
fn a_caller_hears_what_the_world_did() {
    for caller in [Caller::Socket, Caller::Window, Caller::Hands] {
        for case in [Case::Done, Case::Refused, Case::Rebased, Case::Cancelled] {
            let mut studio = Studio::new(shapes::sphere_of_about(20_000), brush(), 2);
            if caller == Caller::Hands {
                // Too large for a local cut.
                studio.tell(Command::TakeUp(Arc::new(shapes::icosphere(0.8, 20))));
                let shift = -studio.under.normalize();
                studio.tell(Command::Place(Similarity { shift, ..Similarity::NONE }));
            }
            let id = studio.shown().scene.active().expect("an object").id;
            if case == Case::Refused {
                studio.tell(Command::Scene(SceneCommand::Lock(id, true)));
            }
            let drawing = (case == Case::Rebased).then(|| studio.draw(Pace::One));
            let heard = heard(&studio, caller, case == Case::Cancelled);
            if let Some(drawing) = drawing {
                studio.end(drawing);
            }
            println!("{caller:?} {case:?}: {heard:?}");
            let run = studio.check();
            let says = |part: &str| heard.as_ref().is_err_and(|text| text.contains(part));
            match case {
                Case::Done | Case::Rebased => assert_eq!(heard, Ok(())),
                Case::Refused => assert!(says("lock"), "{caller:?}: {heard:?}"),
                Case::Cancelled => assert!(says("cancel"), "{caller:?}: {heard:?}"),
            }
            assert_eq!(run.installed, usize::from(heard.is_ok()), "{caller:?} {case:?}");
        }
    }
}
