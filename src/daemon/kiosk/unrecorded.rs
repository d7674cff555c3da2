//! The session of an installation without its attract films: nobody sculpts them, and each begins
//! with the whole start mesh.
//!
//! A visit begins with a reset, so nothing that a film did outlives it, except that each reset
//! gives the clay a new number. The resets of the films are recorded as resets to a tiny mesh,
//! right before that of the visit: a replay then gives the same numbers and the same bits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::tick::Journal;
use sculptd_devices::Sample;
use sculptd_engine::command::{Beginning, Command, NewClay};
use sculptd_engine::world::World;
use sculptd_geometry::shapes;

/// A journal that leaves out attract films.
#[derive(Debug)]
pub struct WithoutFilms<J> {
    journal: J,
    /// Set while a reset begins a film, and not a visit.
    film: Arc<AtomicBool>,
    left_out: Option<LeftOut>,
}

/// What a replay needs of the films that were left out.
#[derive(Debug, Default)]
struct LeftOut {
    resets: usize,
    /// The newest layout of the desktop, which a reset keeps.
    desktop: Option<Command>,
}

impl LeftOut {
    fn take(&mut self, commands: &[Command]) {
        for command in commands {
            match command {
                Command::Begin(_) => self.resets += 1,
                Command::DesktopLayout(_) => self.desktop = Some(command.clone()),
                _ => {}
            }
        }
    }

    /// Returns the commands that take the place of the films: those resets, without their meshes.
    fn instead(self, visit: &Beginning) -> impl Iterator<Item = Command> {
        let tiny = Arc::new(shapes::icosphere(1.0, 1));
        let (camera, brush) = (visit.camera, visit.brush);
        let reset = move |_| {
            let clay = NewClay::new(tiny.clone(), false);
            Command::Begin(Box::new(Beginning { clay, camera, brush }))
        };
        (0..self.resets).map(reset).chain(self.desktop)
    }
}

impl<J> WithoutFilms<J> {
    /// Wraps the journal of an installation. `film`: see [`super::start::Start::film`].
    pub fn new(journal: J, film: Arc<AtomicBool>) -> Self {
        WithoutFilms { journal, film, left_out: None }
    }
}

impl<J: Journal> Journal for WithoutFilms<J> {
    fn tick(&mut self, tick: u64, samples: &[Sample], commands: &[Command], world: &mut World) {
        let visit = commands.iter().find_map(|c| match c {
            Command::Begin(beginning) if !self.film.load(Relaxed) => Some(beginning),
            _ => None,
        });
        let film = visit.is_none() && commands.iter().any(|c| matches!(c, Command::Begin(_)));
        if film || self.left_out.is_some() && visit.is_none() {
            self.left_out.get_or_insert_default().take(commands);
            return;
        }
        match (visit, self.left_out.take()) {
            (Some(visit), Some(left_out)) => {
                let all: Vec<Command> =
                    left_out.instead(visit).chain(commands.iter().cloned()).collect();
                self.journal.tick(tick, samples, &all, world);
            }
            _ => self.journal.tick(tick, samples, commands, world),
        }
    }

    fn has_waiting(&self) -> bool {
        self.left_out.is_none() && self.journal.has_waiting()
    }
}
