//! `sculptd camera`: bare hands by webcam. `setup` installs the hand models, `test` shows what the
//! camera sees and what to change.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::camera_errors::failed;
use super::{Fail, Outcome, answer};
use sculptd_camera::camera_thread::{CameraChoice, CameraStatus};
use sculptd_camera::models::{self, MODEL_FILES, ModelsError, PACKAGE};
use sculptd_daemon::camera_hands;
use sculptd_daemon::config::DevicesConfig;
use sculptd_devices::{Clock, queue};

#[derive(Debug, Subcommand)]
pub enum CameraCommand {
    /// Install the hand models: pip downloads the package, its models are checked and stored.
    Setup(SetupArgs),
    /// Show the camera's frame rate, light and hands for a few seconds, and what to change.
    Test(TestArgs),
}

#[derive(Debug, Args)]
pub struct SetupArgs {
    /// Take the models out of this package file instead of downloading one.
    #[arg(long, value_name = "FILE")]
    pub package: Option<PathBuf>,
    /// Store them in this folder instead of the user's data folder.
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct TestArgs {
    /// The camera's number, a device node, or a recorded file; without it, the configured one.
    #[arg(value_name = "INDEX|FILE")]
    pub camera: Option<String>,
    /// Duration of the test.
    #[arg(long = "for", value_name = "SECONDS", default_value_t = 5.0,
        value_parser = super::run::seconds)]
    pub limit_s: f64,
    /// Calibrate: hold your open hand this far from the camera, in millimetres, for the first half
    /// of the test, and at the second distance for the rest. Two sheets of A4 paper, then one, are
    /// 594 and 297 mm.
    #[arg(long, value_name = "MM", num_args = 1..=2,
        value_parser = clap::value_parser!(u32).range(100..=1500))]
    pub distance: Vec<u32>,
    /// Lay this file over the usual settings.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

pub fn run(command: &CameraCommand, json: bool) -> Outcome {
    match command {
        CameraCommand::Setup(args) => setup(args, json),
        CameraCommand::Test(args) => test(args, json),
    }
}

#[derive(Debug, Serialize)]
struct SetupAnswer {
    folder: String,
    models: Vec<&'static str>,
}

fn setup(args: &SetupArgs, json: bool) -> Outcome {
    let folder = args.folder.clone().or_else(camera_hands::own_models_folder);
    let folder = folder.ok_or_else(|| {
        Fail::Config("there is no data folder: HOME is not set. Name one with --folder".into())
    })?;
    let failed = |e: ModelsError| match e {
        ModelsError::Io { path, source } => Fail::io(&path, &source),
        e => Fail::Input(e.to_string()),
    };
    match &args.package {
        Some(package) => models::install(package, &folder).map_err(failed)?,
        None => {
            let place = std::env::temp_dir().join(format!("sculptd_setup_{}", std::process::id()));
            let downloaded = download(&place);
            let installed =
                downloaded.and_then(|package| models::install(&package, &folder).map_err(failed));
            let _ = std::fs::remove_dir_all(&place);
            installed?;
        }
    }
    models::load(&folder).map_err(failed)?;
    let shown = folder.display().to_string();
    let names = MODEL_FILES.iter().map(|m| m.name).collect();
    answer(json, &SetupAnswer { folder: shown.clone(), models: names }, |out| {
        writeln!(out, "The hand models are in {shown}. Try them: sculptd camera test")
    });
    Ok(())
}

/// Downloads the package with the person's own pip. Returns its file.
fn download(place: &Path) -> Result<PathBuf, Fail> {
    std::fs::create_dir_all(place).map_err(|e| Fail::io(place, &e))?;
    // The models are the same for every platform; this package exists for this one.
    let fixed = ["--only-binary=:all:", "--platform", "manylinux_2_17_x86_64", "--python-version"];
    let mut tried = Vec::new();
    for python in ["python3", "python"] {
        let mut pip = Command::new(python);
        pip.args(["-m", "pip", "download", "--quiet", "--no-deps", "--disable-pip-version-check"]);
        pip.args(fixed).args(["3.11", "--dest"]).arg(place).arg(PACKAGE);
        match pip.output() {
            Ok(done) if done.status.success() => {
                let found = std::fs::read_dir(place).map_err(|e| Fail::io(place, &e))?;
                let wheel =
                    |p: &PathBuf| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("whl"));
                return found.flatten().map(|e| e.path()).find(wheel).ok_or_else(|| {
                    Fail::Check(format!("pip downloaded no package into {}", place.display()))
                });
            }
            Ok(done) => {
                let text = String::from_utf8_lossy(&done.stderr);
                let last = text.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("");
                tried.push(format!("{python} -m pip: {}", last.trim()));
            }
            Err(e) => tried.push(format!("{python}: {e}")),
        }
    }
    Err(Fail::Check(format!(
        "the hand models could not be downloaded ({}). Install Python and pip, or download \
         {PACKAGE} elsewhere and type: sculptd camera setup --package FILE.whl",
        tried.join("; ")
    )))
}

#[derive(Debug, Serialize)]
struct TestAnswer {
    camera: String,
    pictures: u64,
    rate: f32,
    delay_ms: f64,
    damaged: u64,
    skipped: u64,
    light: f32,
    exposure_ms: Option<f32>,
    palm_score: f32,
    hands_percent: f32,
    distance_mm: Option<f32>,
    hand_scale: Option<f32>,
    depth_offset_mm: Option<f32>,
    advice: &'static str,
}

fn test(args: &TestArgs, json: bool) -> Outcome {
    let config = super::run::load_config(args.config.as_deref())?.devices;
    let named = args.camera.clone().unwrap_or_else(|| config.camera.clone());
    let choice = CameraChoice::from_text(&named);
    list(json);
    // A camera that cannot be opened is an error at once; the thread would go on trying.
    let opened = choice.open(&Clock::monotonic()).map_err(|e| failed(&e.into()))?;
    let camera = opened.describe();
    drop(opened);
    let mut pairs = Vec::new();
    let halves: Vec<Option<u32>> = match args.distance.as_slice() {
        [] => vec![None],
        some => some.iter().copied().map(Some).collect(),
    };
    let limit_s = args.limit_s / halves.len() as f64;
    let (mut last, mut depth) = (None, None);
    for half in halves {
        if let Some(mm) = half {
            eprintln!("sculptd: hold your open hand {mm} mm from the camera");
        }
        let (status, seen, depths) = watch(&config, choice.clone(), limit_s)?;
        depth = median(depths);
        if let Some(mm) = half {
            let Some(found) = depth else {
                let why = status.advice();
                return Err(Fail::Check(format!("calibration failed: no hand was seen. {why}")));
            };
            pairs.push((mm as f32, found));
        }
        last = Some((status, seen));
    }
    let Some((status, seen)) = last else { return Ok(()) };
    let found = (!pairs.is_empty()).then(|| config.camera_settings.calibration().corrected(&pairs));
    if found == Some(None) {
        return Err(Fail::Check(format!(
            "calibration failed: the measured distances contradict each other ({pairs:?} mm). \
             Repeat it with the palm to the camera"
        )));
    }
    let found = found.flatten();
    let view = status.view.as_ref();
    let answer_ = TestAnswer {
        camera,
        pictures: status.pictures,
        rate: status.rate,
        delay_ms: status.delay_us as f64 / 1e3,
        damaged: status.damaged,
        skipped: status.skipped,
        light: view.map_or(0.0, |v| v.light),
        exposure_ms: exposure(&choice),
        palm_score: view.map_or(0.0, |v| v.palm_score),
        hands_percent: 100.0 * seen,
        distance_mm: depth,
        hand_scale: found.map(|c| c.scale),
        depth_offset_mm: found.map(|c| c.offset_mm),
        advice: status.advice(),
    };
    answer(json, &answer_, |out| {
        let a = &answer_;
        writeln!(out, "camera          {}", a.camera)?;
        writeln!(
            out,
            "pictures        {} ({:.1} a second), {} skipped, {} damaged",
            a.pictures, a.rate, a.skipped, a.damaged
        )?;
        writeln!(out, "picture to hand {:.1} ms", a.delay_ms)?;
        writeln!(out, "light           {:.0} % (good: 15 to 80 %)", 100.0 * a.light)?;
        if let Some(ms) = a.exposure_ms {
            writeln!(out, "exposure        {ms:.1} ms")?;
        }
        writeln!(out, "palm score      {:.2}", a.palm_score)?;
        writeln!(out, "hands           seen in {:.0} % of the pictures", a.hands_percent)?;
        if let Some(mm) = a.distance_mm {
            writeln!(out, "distance        {mm:.0} mm")?;
        }
        if let Some((scale, offset)) = a.hand_scale.zip(a.depth_offset_mm) {
            writeln!(out, "Write this into your settings, under [devices]:")?;
            writeln!(
                out,
                "    camera_settings = {{ hand_scale = {scale:.3}, depth_offset_mm = {offset:.1} }}"
            )?;
        }
        writeln!(out, "{}", a.advice)
    });
    if let Some(why) = status.last_error.filter(|_| status.pictures == 0) {
        return Err(Fail::Device(why));
    }
    Ok(())
}

/// Lists the cameras of this machine.
fn list(json: bool) {
    #[cfg(target_os = "linux")]
    if !json {
        for found in sculptd_camera::source::device::list() {
            eprintln!("sculptd: camera {}: {} ({})", found.index, found.name, found.path);
        }
    }
    let _ = json;
}

/// Runs the camera. Returns its state, the share of pictures with a hand, and the distances of the
/// first hand.
fn watch(
    config: &DevicesConfig,
    choice: CameraChoice,
    limit_s: f64,
) -> Result<(CameraStatus, f32, Vec<f32>), Fail> {
    let clock = Clock::monotonic();
    let (factory, mut receiver) = queue::channel(1024);
    let handle =
        camera_hands::start_choice(choice, config.camera_settings, &clock, factory.sender())
            .map_err(|e| failed(&e))?;
    let ends = clock.now_us() + (limit_s * 1e6) as u64;
    let (mut pictures, mut with_hands, mut depths) = (0_u32, 0_u32, Vec::new());
    while clock.now_us() < ends {
        if let Some(sample) = receiver.next_within(Duration::from_millis(100)) {
            pictures += 1;
            if let sculptd_devices::Body::Hands(hands) = sample.body {
                with_hands += u32::from(hands.count > 0);
            }
            let depth = handle.status().view.map_or(0.0, |v| v.depth[0]);
            depths.extend((depth > 0.0).then_some(depth));
        } else if handle.status().ended {
            break;
        }
    }
    Ok((handle.status(), with_hands as f32 / pictures.max(1) as f32, depths))
}

fn median(mut all: Vec<f32>) -> Option<f32> {
    all.sort_by(f32::total_cmp);
    all.get(all.len() / 2).copied()
}

/// Exposure in ms, where the camera states it.
fn exposure(choice: &CameraChoice) -> Option<f32> {
    #[cfg(target_os = "linux")]
    if let CameraChoice::Device(which) = choice {
        let camera = sculptd_camera::source::device::CameraDevice::open(which, Clock::monotonic());
        return camera.ok()?.exposure().map(|units| units as f32 * 0.1);
    }
    let _ = choice;
    None
}
