//! `devices list|watch|record|play`: devices as they are now, and recordings as if they were.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::hid::bus::HidApiBus;
use sculptd_devices::hid::tap::{TapBus, Tapped};
use sculptd_devices::hid::watch;
use sculptd_devices::queue::{self, Receiver};
use sculptd_devices::recording::Player;
use sculptd_devices::recording::raw::Recorder;
use sculptd_devices::{Clock, DeviceId};
use serde::Serialize;

use super::super::ending::stop_signal;
use super::super::{Fail, Outcome, answer};
use super::table::Table;
use super::{catalogue, hid_config, recording_fail};
use sculptd_daemon::adaptors;
use sculptd_daemon::config::DevicesConfig;

/// Samples between the adaptors and the table.
const CHANNEL: usize = 4096;
/// Interval between two drawings of the table, in microseconds.
const DRAW_US: u64 = 500_000;
/// Reports that wait for the file before they are dropped and counted.
const TAPPED: usize = 65_536;

#[derive(Debug, Serialize)]
struct Listed {
    devices: Vec<watch::NodeStatus>,
    serial: Vec<String>,
    leap: Option<String>,
}

pub(super) fn list(config: &DevicesConfig, json: bool) -> Outcome {
    let models = catalogue(config)?;
    let found =
        HidApiBus::new().and_then(|mut bus| watch::list(&mut bus, &hid_config(config), &models));
    let devices = found.map_err(|e| Fail::Device(format!("pen tablets: {e}")))?;
    let listed = Listed {
        devices,
        serial: config.serial.iter().map(|p| p.display().to_string()).collect(),
        leap: (!config.leap.is_empty()).then(|| config.leap.clone()),
    };
    answer(json, &listed, |out| {
        if listed.devices.is_empty() {
            writeln!(out, "no HID device is plugged in")?;
        }
        for d in &listed.devices {
            let what = if d.usable { "usable" } else { "not usable" };
            let name = d.model.as_ref().unwrap_or(&d.name);
            write!(out, "{} {:04x}:{:04x} {name}: {what}", d.path, d.vid, d.pid)?;
            match &d.reason {
                Some(why) => writeln!(out, ", {why}")?,
                None => writeln!(out)?,
            }
            if !d.candidates.is_empty() {
                writeln!(
                    out,
                    "    which is it? say so in the settings: [devices] models = {{ \
                        \"{:04x}:{:04x}\" = \"NAME\" }}",
                    d.vid, d.pid
                )?;
                writeln!(out, "    {}", d.candidates.join(", "))?;
            }
        }
        for port in &listed.serial {
            writeln!(out, "{port}: serial pen, asked when the daemon runs")?;
        }
        if let Some(url) = &listed.leap {
            writeln!(out, "{url}: hand tracking")?;
        }
        Ok(())
    });
    Ok(())
}

pub(super) fn watch(config: &DevicesConfig, limit_s: Option<f64>, json: bool) -> Outcome {
    let clock = Clock::monotonic();
    let (factory, mut rx) = queue::channel(CHANNEL);
    let running = adaptors::start(config, catalogue(config)?, &clock, &factory);
    for line in running.describe() {
        eprintln!("{line}");
    }
    let mut table = Table::new(factory.stats());
    follow(&clock, &mut rx, &mut table, limit_s, json, |_| true);
    let standing = running.describe();
    drop(running);
    if table.is_empty() {
        eprintln!("nothing was sent");
        match standing[..] {
            [] => eprintln!("no pen tablet is plugged in, and no serial pen or tracker is set up"),
            _ => standing.iter().for_each(|line| eprintln!("{line}")),
        }
    }
    finish(&table, json);
    Ok(())
}

/// Shows what comes until Ctrl-C, the limit, or `go_on` says no.
fn follow(
    clock: &Clock,
    rx: &mut Receiver,
    table: &mut Table,
    limit_s: Option<f64>,
    json: bool,
    mut go_on: impl FnMut(u64) -> bool,
) {
    let stop = stop_signal();
    let until = limit_s.map(|s| clock.now_us() + (s * 1e6) as u64);
    let mut drawn = clock.now_us();
    loop {
        let now = clock.now_us();
        if stop.load(Relaxed) || until.is_some_and(|u| now >= u) || !go_on(now) {
            return;
        }
        if let Some(sample) = rx.next_within(Duration::from_millis(5)) {
            table.take(&sample);
        }
        if !json && now - drawn >= DRAW_US {
            drawn = now;
            let mut out = std::io::stdout().lock();
            let _ = table.draw(&mut out, std::io::stdout().is_terminal());
        }
    }
}

fn finish(table: &Table, json: bool) {
    answer(json, &table.summary(), |out| table.draw(out, false));
}

pub(super) fn record(
    path: &Path,
    config: &DevicesConfig,
    limit_s: Option<f64>,
    json: bool,
) -> Outcome {
    let models = catalogue(config)?;
    let clock = Clock::monotonic();
    let (factory, mut rx) = queue::channel(CHANNEL);
    let (out, tapped) = crossbeam_channel::bounded(TAPPED);
    let bus = HidApiBus::new().map_err(|e| Fail::Device(format!("pen tablets: {e}")))?;
    let bus = Box::new(TapBus::new(bus, clock.clone(), out));
    // Created now, so that a path that cannot be written is known before anything is drawn.
    let file = std::fs::OpenOptions::new().write(true).create_new(true).open(path);
    let file = file.map_err(|e| Fail::io(path, &e))?;
    let mut recorder =
        Recorder::new(std::io::BufWriter::new(file)).map_err(|e| Fail::io(path, &e))?;
    let stats = factory.stats();
    let running = watch::start_on(bus, hid_config(config), models, clock.clone(), factory)
        .map_err(|e| Fail::Device(format!("pen tablets: {e}")))?;
    let mut table = Table::new(stats);
    let mut failed = None;
    eprintln!("recording into {}; end with Ctrl-C", path.display());
    follow(&clock, &mut rx, &mut table, limit_s, json, |_| {
        failed = write_all(&mut recorder, &tapped).err();
        failed.is_none()
    });
    drop(running);
    let written = write_all(&mut recorder, &tapped).and_then(|()| recorder.finish().map(|_| ()));
    if let Some(e) = failed.or(written.err()) {
        return Err(Fail::io(path, &e));
    }
    finish(&table, json);
    Ok(())
}

fn write_all<W: Write>(
    recorder: &mut Recorder<W>,
    tapped: &crossbeam_channel::Receiver<Tapped>,
) -> std::io::Result<()> {
    for one in tapped.try_iter() {
        match one {
            // Interfaces are numbered here and in the file alike: in the order in which they were
            // opened.
            Tapped::Opened { who, serial, .. } => {
                recorder.interface(&who, &serial)?;
            }
            Tapped::Report { number, t_us, bytes } => recorder.report(number, t_us, &bytes)?,
        }
    }
    Ok(())
}

pub(super) fn play(path: &Path, models: &Catalogue, speed: f64, json: bool) -> Outcome {
    if !(speed.is_finite() && speed >= 0.0) {
        return Err(Fail::Usage(format!("--speed {speed}: expected 0 or more")));
    }
    let mut player = Player::open(path, DeviceId(0), models).map_err(recording_fail)?;
    eprintln!("{}", player.device().name);
    for note in &player.device().notes {
        eprintln!("{note}");
    }
    let (factory, mut rx) = queue::channel(CHANNEL);
    let mut sender = factory.sender();
    let mut table = Table::new(factory.stats());
    let clock = Clock::monotonic();
    let start = clock.now_us();
    follow(&clock, &mut rx, &mut table, None, json, |now| {
        // As fast as the machine can, still in steps that the channel holds.
        let due = match speed {
            0.0 => player.next_due_us().unwrap_or(0),
            _ => ((now - start) as f64 * speed) as u64,
        };
        player.advance(due, &mut |s| sender.push(s));
        sender.flush();
        !player.finished()
    });
    sender.flush();
    let mut rest = Vec::new();
    while rx.drain(CHANNEL, &mut rest) > 0 {
        rest.drain(..).for_each(|s| table.take(&s));
        sender.flush();
    }
    finish(&table, json);
    Ok(())
}
