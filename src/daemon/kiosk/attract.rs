//! What plays while nobody is here: films and works of the gallery in turn.

use super::KioskConfig;
use super::film::AttractRecording;
use super::wall::Wall;
use crate::adaptors::ATTRACT_IDS;
use crate::command_queue::QueuedCommand;
use sculptd_clay::brush::BrushSettings;
use sculptd_devices::DeviceId;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue::Sender;
use sculptd_engine::camera::Camera;

/// Works of the wall between two films.
const WORKS: usize = 3;

/// The state of the attract loop.
#[derive(Debug, Clone, Copy)]
enum AttractState {
    Nothing,
    Film,
    /// A work of the wall, with its number.
    Work {
        number: u64,
        camera: Camera,
    },
}

/// A request to the sculpt loop.
#[derive(Debug)]
pub(super) enum AttractAct {
    /// Reset everything: a film begins.
    Film,
    /// Show a work of the wall, as a reset that no session records.
    Work(Box<QueuedCommand>),
    /// Turn the work that is shown.
    Turn(Camera),
}

/// The attract loop.
#[derive(Debug)]
pub(super) struct AttractLoop {
    /// Recordings to play while no visitor is present; never empty.
    films: Vec<AttractRecording>,
    film: usize,
    wall: Option<Wall>,
    /// Time that a work of the wall is shown, in which it turns once, microseconds.
    each_us: u64,
    playing: AttractState,
    began_us: u64,
    /// Works shown since the last film.
    works: usize,
    camera: Camera,
    brush: BrushSettings,
}

impl AttractLoop {
    /// Opens the recordings and starts the wall. A recording that cannot be played is an error here
    /// and not in front of visitors.
    ///
    /// # Errors
    /// Names the recording, or the thread that could not be started.
    pub fn new(
        config: &KioskConfig,
        camera: Camera,
        brush: BrushSettings,
    ) -> Result<AttractLoop, String> {
        let catalogue = Catalogue::builtin().map_err(|e| e.to_string())?;
        let mut films = Vec::new();
        for (path, id) in config.attract.iter().zip(ATTRACT_IDS.cycle()) {
            let film = AttractRecording::open(path, DeviceId(id), camera.aspect, &catalogue)
                .map_err(|e| e.to_string())?;
            if film.is_empty() {
                return Err(format!("{}: nothing in it touches the work", path.display()));
            }
            films.push(film);
        }
        if films.is_empty() {
            films.push(AttractRecording::own(DeviceId(ATTRACT_IDS.start)));
        }
        let wall = Wall::start(config).map_err(|e| format!("the gallery wall: {e}"))?;
        let (playing, each_us) = (AttractState::Nothing, (config.wall_s * 1e6) as u64);
        let (film, began_us, works) = (0, 0, WORKS);
        Ok(AttractLoop { films, film, wall, each_us, playing, began_us, works, camera, brush })
    }

    /// The number of the work on the wall, 0 for a curated one; `None`: a film plays, or nothing.
    pub fn work(&self) -> Option<u64> {
        match self.playing {
            AttractState::Work { number, .. } => Some(number),
            _ => None,
        }
    }

    /// Goes on. `aspect`: width over height of the view. `midnight`: the last one, in seconds since
    /// 1970; works kept since then are shown.
    pub fn step(
        &mut self,
        now_us: u64,
        to: &mut Sender,
        (aspect, midnight): (f32, impl FnOnce() -> u64),
    ) -> Option<AttractAct> {
        let since = now_us.saturating_sub(self.began_us);
        match self.playing {
            AttractState::Film => {
                if !self.films[self.film].play(self.began_us, since, to) {
                    self.film = (self.film + 1) % self.films.len();
                    self.playing = AttractState::Nothing;
                }
                return None;
            }
            // The visitor may have deleted it.
            AttractState::Work { camera, .. }
                if since < self.each_us && self.wall.as_ref().is_some_and(Wall::shown_exists) =>
            {
                let turned = since as f32 / self.each_us as f32 * std::f32::consts::TAU;
                return Some(AttractAct::Turn(Camera { yaw: camera.yaw + turned, ..camera }));
            }
            AttractState::Work { .. } | AttractState::Nothing => {}
        }
        self.began_us = now_us;
        let work = match &mut self.wall {
            Some(wall) if self.works < WORKS => wall.take(),
            _ => None,
        };
        if let Some(wall) = &mut self.wall {
            wall.ask(midnight());
        }
        let Some(work) = work else {
            self.works = 0;
            self.films[self.film].rewind();
            self.playing = AttractState::Film;
            return Some(AttractAct::Film);
        };
        self.works += 1;
        let number = work.number();
        let (command, camera) = work.show(Camera { aspect, ..self.camera }, self.brush);
        self.playing = AttractState::Work { number, camera };
        Some(AttractAct::Work(Box::new(command)))
    }

    /// Stops what plays. Next is a film, which shows the next exhibit. Returns true if a film was
    /// stopped, by a last sample of the time `now_us`.
    pub fn stop(&mut self, now_us: u64, to: &mut Sender) -> bool {
        self.works = WORKS;
        let before = std::mem::replace(&mut self.playing, AttractState::Nothing);
        let was_film = matches!(before, AttractState::Film);
        if was_film {
            self.films[self.film].stop(now_us, to);
        }
        was_film
    }
}
