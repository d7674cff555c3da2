//! Hours of input at full speed with faults from a seed: a pen on a wire that is unplugged and
//! found again, packets that are torn, lost or come twice, clocks that jump, a loop that falls
//! behind, a renderer that holds old states, a disk that fills. After every tick the world is
//! sound; at the end the session file gives the same clay.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sculptd_clay::{Clay, GarbageSink, Workers};
use sculptd_daemon::config::Resolved;
use sculptd_daemon::published::{Published, PublishedFigures, Publisher};
use sculptd_daemon::session::format::Settings;
use sculptd_daemon::tick::Journal;
use sculptd_daemon::{session, startup};
use sculptd_devices::serial::{Protocol, SerialDecoder};
use sculptd_devices::sim::faults::Rng;
use sculptd_devices::{DeviceId, queue, sim};
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

use crate::allocations::{live_bytes, passed_alone};

/// A pen on a wire that is not a good one.
struct Wire {
    packets: Vec<Vec<u8>>,
    facts: sculptd_devices::serial::SerialFacts,
    decoder: Option<SerialDecoder>,
    next: usize,
    skew_us: u64,
}

impl Wire {
    fn new() -> Self {
        let journal = sim::journal();
        let span = 0..journal.pen.end_us();
        let (facts, packets) = sim::serial::stream(Protocol::Isdv4, &journal.pen, span);
        Wire {
            decoder: Some(SerialDecoder::new(&facts, DeviceId(100))),
            packets,
            facts,
            next: 0,
            skew_us: 0,
        }
    }

    /// The next packet at `t_us`, with whatever befalls it.
    fn step(&mut self, t_us: u64, rng: &mut Rng, to: &mut queue::Sender) -> Option<&'static str> {
        let mut t_us = t_us + self.skew_us;
        self.next = (self.next + 1) % self.packets.len();
        let packet = &self.packets[self.next];
        let fault = match rng.below(2000) {
            0 => "unplug",
            1 => "clock jump",
            2..=6 => "torn",
            7..=9 => "twice",
            10..=12 => "lost",
            13 => "noise",
            _ => "",
        };
        let Some(decoder) = &mut self.decoder else {
            // It is found again sooner or later.
            if rng.below(400) == 0 {
                self.decoder = Some(SerialDecoder::new(&self.facts, DeviceId(100)));
                return Some("replug");
            }
            return None;
        };
        let mut emit = |s| {
            to.push(s);
        };
        match fault {
            "unplug" => {
                decoder.leave(t_us, &mut emit);
                self.decoder = None;
            }
            "clock jump" => {
                let by = rng.below(3_000_000);
                self.skew_us += by;
                t_us += by;
                decoder.feed(packet, t_us, &mut emit);
            }
            "torn" => decoder.feed(
                &packet[..1 + rng.below(packet.len() as u64 - 1) as usize],
                t_us,
                &mut emit,
            ),
            "twice" => (0..2).for_each(|_| decoder.feed(packet, t_us, &mut emit)),
            "lost" => {}
            "noise" => {
                let bytes: [u8; 24] = std::array::from_fn(|_| rng.below(256) as u8);
                decoder.feed(&bytes, t_us, &mut emit);
            }
            _ => decoder.feed(packet, t_us, &mut emit),
        }
        (!fault.is_empty()).then_some(fault)
    }
}

/// A separate small disk, if root may mount one; it is filled and emptied.
struct Disk {
    at: PathBuf,
    mounted: bool,
}

impl Disk {
    fn new(at: &Path) -> Self {
        let done = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=1g", "tmpfs"])
            .arg(at)
            .output();
        Disk { at: at.into(), mounted: done.is_ok_and(|o| o.status.success()) }
    }

    fn fill(&self) {
        if !self.mounted {
            return;
        }
        let Ok(mut file) = std::fs::File::create(self.at.join("filler")) else { return };
        for size in [1 << 20, 4096] {
            let block = vec![1u8; size];
            while std::io::Write::write_all(&mut file, &block).is_ok() {}
        }
    }

    fn empty(&self) {
        let _ = std::fs::remove_file(self.at.join("filler"));
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        if self.mounted {
            let _ = std::process::Command::new("umount").arg("-l").arg(&self.at).output();
        }
    }
}

/// Schedule of the visits.
#[derive(Debug, Clone, Copy)]
struct Calendar {
    /// From one visit's beginning to the next one's, in ticks.
    every: u64,
    /// Duration of a visit, in ticks.
    visit: u64,
    /// Visits of a day; after them it is night.
    a_day: u64,
    /// A day's length.
    day: u64,
}

impl Calendar {
    /// All the time.
    const ALWAYS: Calendar = Calendar { every: 1, visit: 1, a_day: u64::MAX, day: u64::MAX };
    /// An installation at 120 ticks a second: 20 visits of half a minute, one every half hour.
    const MUSEUM: Calendar =
        Calendar { every: 216_000, visit: 3_600, a_day: 20, day: 86_400 * 120 };

    fn is_visited(&self, slot: u64) -> bool {
        let of_day = slot % self.day;
        of_day % self.every < self.visit && of_day / self.every < self.a_day
    }
}

/// Open descriptors and threads of this process; zero where the system does not say.
fn handles() -> [usize; 2] {
    ["/proc/self/fd", "/proc/self/task"].map(|d| std::fs::read_dir(d).map_or(0, Iterator::count))
}

fn soak(seed: u64, ticks: u64, calendar: Calendar) -> Result<(), String> {
    let mut config = Resolved::defaults(sculptd::presets()).config;
    config.undo.bytes = 8 << 20;
    let dir = tempfile::tempdir().map_err(|e| e.to_string())?;
    let disk = Disk::new(dir.path());
    let plain = shapes::sphere_of_about(400);
    let mesh = Clay::build(&plain, &Job::default()).map_err(|e| e.to_string())?;
    let mut world = startup::world(mesh, &config);
    let settings = Settings {
        rate_hz: 120,
        dab_budget: config.r#loop.dab_budget,
        undo_bytes: config.undo.bytes,
        camera: config.camera.camera(),
        brush: config.brush,
        hands: config.hand,
    };
    let path = dir.path().join("soak.sculpt");
    let (mut writer, thread) =
        session::create(&path, &plain, &settings).map_err(|e| e.to_string())?;
    let (factory, mut receiver) = queue::channel(256);
    let mut sender = factory.sender();
    let mut rng = Rng::new(seed);
    let mut wire = Wire::new();
    let mut faults = std::collections::BTreeMap::<&str, u64>::new();
    let mut publisher = Publisher::new(Published::of(&mut world, PublishedFigures::default()));
    // The state that a slow renderer still holds, with the ticks when it took it and when it
    // releases it.
    let mut held: Option<(Arc<Published>, u64, u64)> = None;
    let (mut samples, mut slow, mut full_until) = (Vec::new(), 0u64, 0u64);
    let (mut dabs, mut taken) = (0u64, 0u64);
    let mut heap = [0i64; 2];
    let mut held_open = [[0usize; 2]; 2];
    // Slots with somebody at the pen: faults and figures follow these.
    let visited_of = |slots: u64| match calendar.day {
        u64::MAX => slots,
        day => slots / day * calendar.a_day * calendar.visit,
    };
    let (busy_ticks, mut busy) = (visited_of(ticks), 0u64);
    let mut tick = 0;
    // Time goes on whether or not the loop does.
    for slot in 1..=ticks {
        let t_us = slot * 8333;
        if !calendar.is_visited(slot) {
            // The loop goes on with nobody there. The pen's lift is taken by the first of these.
            tick += 1;
            samples.clear();
            receiver.drain(4096, &mut samples);
            world.step(tick, &samples, &[]);
            writer.tick(tick, &samples, &[], &mut world);
            continue;
        }
        busy += 1;
        if let Some(fault) = wire.step(t_us, &mut rng, &mut sender) {
            *faults.entry(fault).or_default() += 1;
        }
        sender.flush();
        if slow == 0 && rng.below(4000) == 0 {
            slow = rng.below(60);
            *faults.entry("slow loop").or_default() += 1;
        }
        // In each half of the time the disk is full once.
        if busy % (busy_ticks / 2) == busy_ticks / 6 {
            disk.fill();
            full_until = busy + (busy_ticks / 20).min(21_600);
            *faults.entry("full disk").or_default() += 1;
        }
        if busy == full_until {
            disk.empty();
        }
        // A slow loop: nothing is taken for a while, the channel fills and motion is coalesced.
        if slow > 0 {
            slow -= 1;
            continue;
        }
        tick += 1;
        samples.clear();
        receiver.drain(4096, &mut samples);
        sculptd_daemon::tick::in_order_of_time(&mut samples);
        let commands = match rng.below(400) {
            0 => vec![Command::Undo],
            1 => vec![Command::Redo],
            2 => vec![Command::LiftAll],
            _ => vec![],
        };
        let report = *world.step(tick, &samples, &commands);
        (dabs, taken) = (dabs + report.dabs, taken + samples.len() as u64);
        writer.tick(tick, &samples, &commands, &mut world);
        let state = Published::of(&mut world, PublishedFigures::default());
        publisher.publish(state, &GarbageSink::default());
        let at = |e: String| format!("tick {tick}: {e}");
        world.verify_invariants().map_err(at)?;
        let lost = receiver.stats().total().lost_transition;
        if lost != 0 {
            return Err(format!("tick {tick}: {lost} transitions lost"));
        }
        match &held {
            // Ten seconds at most; what it looked at has not changed under it.
            Some((state, hash, until)) if tick >= *until => {
                if state.mesh.hash() != *hash {
                    return Err(format!("tick {tick}: a published state has changed"));
                }
                held = None;
            }
            None if rng.below(2000) == 0 => {
                let state = publisher.reader().load_full();
                let hash = state.mesh.hash();
                held = Some((state, hash, tick + rng.below(1200)));
                *faults.entry("slow renderer").or_default() += 1;
            }
            _ => {}
        }
        // The first tenth fills the pools and the undo store.
        if busy > busy_ticks / 10 {
            let half = usize::from(busy > busy_ticks / 2);
            heap[half] = heap[half].max(live_bytes());
            if busy % 256 == 0 {
                let now = handles();
                (0..2).for_each(|i| held_open[half][i] = held_open[half][i].max(now[i]));
            }
        }
    }
    disk.empty();
    drop(writer);
    if let Some(fault) = thread.finish() {
        return Err(format!("the journal: {fault}"));
    }
    // Memory after the first half is memory for good; what the journal kept of a full disk is in
    // both.
    let mb = heap.map(|b| b as f64 / 1e6);
    if mb[1] > mb[0] * 1.05 + 4.0 {
        return Err(format!("{:.1} MB in the second half, {:.1} MB in the first", mb[1], mb[0]));
    }
    let [before, after] = held_open;
    if after[0] > before[0] || after[1] > before[1] {
        return Err(format!("descriptors and threads grew from {before:?} to {after:?}"));
    }
    let bytes = std::fs::metadata(&path).map_or(0, |m| m.len());
    let hash = world.hash();
    let opened = session::open(&path).map_err(|e| e.to_string())?;
    if let Some(loss) = &opened.loss {
        return Err(format!("the session: {loss}"));
    }
    let again = session::replay::replay(&opened, Some(tick), Workers::new(1), &Job::default())
        .map_err(|e| e.to_string())?;
    if again.world.hash() != hash {
        return Err(format!(
            "the session gives {:016x}, the world was {hash:016x}",
            again.world.hash()
        ));
    }
    println!(
        "{ticks} ticks, {busy} of them visited, {taken} samples, {dabs} dabs; heap {:.1} then \
         {:.1} MB; descriptors and threads {before:?} then {after:?}; session {:.1} MB; \
         {faults:?}",
        mb[0],
        mb[1],
        bytes as f64 / 1e6
    );
    Ok(())
}

fn told(seed: u64, ticks: u64, calendar: Calendar, name: &str) {
    let told = std::panic::catch_unwind(|| soak(seed, ticks, calendar))
        .unwrap_or_else(|_| Err("a panic, above".into()));
    if let Err(e) = told {
        panic!(
            "{e}; again: SCULPTD_SEED={seed} SCULPTD_TICKS={ticks} cargo test --release --test it \
                soak::{name}"
        );
    }
}

fn number(key: &str) -> Option<u64> {
    std::env::var(key).ok().and_then(|v| v.parse().ok())
}

#[test]
fn an_hour_of_faults() {
    if passed_alone("soak::an_hour_of_faults") {
        return;
    }
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let seed = number("SCULPTD_SEED").unwrap_or(20);
    let ticks = number("SCULPTD_TICKS").unwrap_or(if long { 432_000 } else { 6_000 });
    told(seed, ticks, Calendar::ALWAYS, "an_hour_of_faults");
}

/// Thirty days of an installation, every tick of them stepped: visits, nights, and the same faults.
#[test]
fn thirty_days_of_visits() {
    let days = number("SCULPTD_DAYS");
    if std::env::var_os("SCULPTD_LONG").is_none() && days.is_none() {
        println!("skipped: SCULPTD_LONG not set");
        return;
    }
    if passed_alone("soak::thirty_days_of_visits") {
        return;
    }
    let seed = number("SCULPTD_SEED").unwrap_or(30);
    let ticks = days.unwrap_or(30) * Calendar::MUSEUM.day;
    told(seed, ticks, Calendar::MUSEUM, "thirty_days_of_visits");
}
