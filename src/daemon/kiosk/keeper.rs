//! The cycle at work: a thread looks at what the loop publishes, plays the attract recordings, and sends what the cycle asks for.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::{Act, Cycle, KioskConfig, Stage, View, gallery};
use crate::analysis::cancel::Job;
use crate::brush::BrushSettings;
use crate::command::{Beginning, Command, NewClay};
use crate::daemon::Published;
use crate::daemon::adaptors::RECORDING_IDS;
use crate::daemon::rig::{Area, RecordingFeed, used_area};
use crate::daemon::stepped::Feed;
use crate::devices::catalogue::Catalogue;
use crate::devices::queue::SenderFactory;
use crate::devices::recording::Player;
use crate::devices::{Clock, DeviceId};
use crate::mesh::{Mesh, TriMesh};
use crate::stroke::Camera;

/// Looks a second.
const RATE_HZ: f64 = 50.0;
/// Ids of attract recordings: what they draw is nobody's touch.
const ATTRACT_IDS: std::ops::Range<u16> = RECORDING_IDS + 50..RECORDING_IDS + 66;

/// What every visitor begins with.
#[derive(Debug, Clone)]
pub struct Start {
    pub plain: Arc<TriMesh>,
    pub camera: Camera,
    pub brush: BrushSettings,
}

impl Start {
    /// The command that puts everything back. Building the pages takes as long as the start is large: not on the tick thread.
    pub fn command(&self) -> Option<Command> {
        let mesh = Mesh::build(&self.plain, &Job::default()).ok()?;
        let clay = NewClay::new(self.plain.clone(), mesh, false);
        Some(Command::Begin(Box::new(Beginning { clay, camera: self.camera, brush: self.brush })))
    }
}

/// What a screen reads and presses.
#[derive(Debug, Default)]
pub struct Desk {
    pub view: Mutex<Option<View>>,
    /// The visitor pressed "finished".
    pub finished: AtomicBool,
    /// What staff typed.
    pub typed: Mutex<Option<String>>,
}

/// A running keeper; it ends when `stop` is raised.
#[derive(Debug)]
pub struct Keeper {
    pub desk: Arc<Desk>,
    pub thread: JoinHandle<()>,
}

struct Keeping {
    config: KioskConfig,
    start: Start,
    published: Arc<ArcSwap<Published>>,
    commands: cc::Sender<Command>,
    factory: SenderFactory,
    clock: Clock,
    stop: Arc<AtomicBool>,
    desk: Arc<Desk>,
    /// Recordings of the attract loop, each with the part of the tablet that it uses.
    films: Vec<(PathBuf, Option<Area>)>,
    playing: Option<RecordingFeed>,
    next_film: usize,
    began_us: u64,
    dabs_before: u64,
}

/// Starts keeping. A recording that cannot be played is an error here and not in front of visitors.
pub fn start(
    config: KioskConfig,
    start: Start,
    published: Arc<ArcSwap<Published>>,
    commands: cc::Sender<Command>,
    factory: SenderFactory,
    clock: Clock,
    stop: Arc<AtomicBool>,
) -> Result<Keeper, String> {
    let catalogue = Catalogue::builtin().map_err(|e| e.to_string())?;
    let mut films = Vec::new();
    for path in &config.attract {
        let player =
            Player::open(path, DeviceId(ATTRACT_IDS.start), &catalogue).map_err(|e| e.to_string())?;
        films.push((path.clone(), used_area(player, start.camera.aspect)));
    }
    let desk = Arc::new(Desk::default());
    let mut keeping = Keeping {
        config,
        start,
        published,
        commands,
        factory,
        clock,
        stop,
        desk: desk.clone(),
        films,
        playing: None,
        next_film: 0,
        began_us: 0,
        dabs_before: 0,
    };
    let run = move || keeping.run(&catalogue);
    let thread =
        std::thread::Builder::new().name("sculptd-kiosk".into()).spawn(run).map_err(|e| e.to_string())?;
    Ok(Keeper { desk, thread })
}

impl Keeping {
    fn run(&mut self, catalogue: &Catalogue) {
        let mut cycle = Cycle::new(RATE_HZ, self.config.idle_s, self.config.countdown_s);
        let mut felt = None;
        let (_keep, quiet) = cc::bounded::<()>(1);
        while !self.stop.load(Relaxed) {
            let now = touch(&self.published.load());
            // Something that lies still on the tablet is nobody.
            let touched = now.is_some() && now != felt;
            felt = now;
            let done = self.desk.finished.swap(false, Relaxed);
            let act = cycle.step(touched, done);
            self.obey(act, &cycle);
            let typed = self.desk.typed.lock().ok().and_then(|mut t| t.take());
            if let Some(number) = typed {
                let act = cycle.staff(&number, &self.config.staff_pin);
                self.obey(act, &cycle);
            }
            if cycle.view().stage == Stage::Attract {
                self.attract(catalogue);
            }
            if let Ok(mut view) = self.desk.view.lock() {
                *view = Some(cycle.view());
            }
            let _ = quiet.recv_timeout(Duration::from_secs_f64(1.0 / RATE_HZ));
        }
    }

    fn obey(&mut self, act: Option<Act>, cycle: &Cycle) {
        match act {
            None => {}
            Some(Act::Quit) => self.stop.store(true, Relaxed),
            Some(Act::Begin) => {
                self.playing = None;
                self.dabs_before = self.published.load().figures.dabs;
                self.put_back();
            }
            Some(Act::End { seconds }) => {
                let state = self.published.load_full();
                let dabs = state.figures.dabs.saturating_sub(self.dabs_before);
                let mut kept = false;
                if dabs > 0 && !self.config.gallery.as_os_str().is_empty() {
                    let mesh = state.mesh.to_tri().to_poly();
                    match gallery::keep(&self.config.gallery, &mesh) {
                        Ok(_) => kept = true,
                        Err(e) => tracing::error!("{}: {e}", self.config.gallery.display()),
                    }
                }
                let file = &self.config.audit;
                if !file.as_os_str().is_empty()
                    && let Err(e) = gallery::audit(file, cycle.view().visits, seconds, dabs, kept)
                {
                    tracing::error!("{}: {e}", file.display());
                }
                self.put_back();
            }
        }
    }

    fn put_back(&self) {
        if let Some(command) = self.start.command() {
            // The loop takes 64 commands a tick: it has room again before long.
            let _ = self.commands.send_timeout(command, Duration::from_secs(2));
        }
    }

    fn attract(&mut self, catalogue: &Catalogue) {
        let over = self.playing.as_ref().is_none_or(|p| p.finished());
        if over {
            let Some((path, area)) = self.films.get(self.next_film) else { return };
            self.next_film = (self.next_film + 1) % self.films.len();
            self.put_back();
            let Ok(mut player) = Player::open(path, DeviceId(ATTRACT_IDS.start), catalogue) else { return };
            self.began_us = self.clock.now_us();
            player.start_at(self.began_us);
            self.playing = Some(RecordingFeed::new(player, self.factory.sender(), *area));
        }
        if let Some(feed) = &mut self.playing {
            feed.advance(self.clock.now_us().saturating_sub(self.began_us));
        }
    }
}

/// What visitors touch now: their pens and hands, the attract loop's left out. `None`: nothing.
fn touch(state: &Published) -> Option<Vec<(u16, [f32; 3])>> {
    let mut felt: Vec<(u16, [f32; 3])> = Vec::new();
    for (id, pen) in state.pens.iter().flatten() {
        if !ATTRACT_IDS.contains(&id.0) {
            felt.push((id.0, [pen.view.x, pen.view.y, pen.pressure]));
        }
    }
    if let Some(hands) = &state.hands {
        felt.extend(hands.as_slice().iter().map(|h| (u16::MAX, h.palm.to_array())));
    }
    (!felt.is_empty()).then_some(felt)
}
