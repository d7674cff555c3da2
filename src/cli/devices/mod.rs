//! `sculptd devices`: what is plugged in, what it says, and recordings of it.

mod decode;
mod live;
mod table;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::hid::HidConfig;
use sculptd_devices::recording::RecordingError;

use super::{Fail, Outcome};
use sculptd_daemon::adaptors;
use sculptd_daemon::config::DevicesConfig;

#[derive(Debug, Subcommand)]
pub enum DevicesCommand {
    /// List the connected devices, and why a device cannot be used.
    List {
        #[command(flatten)]
        source: Source,
    },
    /// Show a live table of every device: rates, jitter, losses and values.
    Watch {
        #[command(flatten)]
        source: Source,
        /// End after this many seconds.
        #[arg(long = "for", value_name = "SECONDS", value_parser = super::run::seconds)]
        limit_s: Option<f64>,
    },
    /// Write the raw bytes of every tablet that is read, stamped, until Ctrl-C.
    Record {
        /// The recording.
        out: PathBuf,
        #[command(flatten)]
        source: Source,
        /// End after this many seconds.
        #[arg(long = "for", value_name = "SECONDS", value_parser = super::run::seconds)]
        limit_s: Option<f64>,
    },
    /// Play a recording through the live channel and show what comes out.
    Play {
        /// A hid-recorder file, a tracker's frames or a recording of ours.
        recording: PathBuf,
        #[command(flatten)]
        source: Source,
        /// Playback speed, as a factor of the recorded speed; 0: as fast as the machine can.
        #[arg(long, default_value_t = 1.0)]
        speed: f64,
    },
    /// Print the samples of a recording, one row per sample.
    Decode {
        /// A hid-recorder file, a tracker's frames or a recording of ours.
        recording: PathBuf,
        /// Write rows as CSV to this file; with no name, to standard output.
        #[arg(long, num_args = 0..=1, default_missing_value = "-")]
        csv: Option<PathBuf>,
        #[command(flatten)]
        source: Source,
    },
}

/// Additional sources of tablet models.
#[derive(Debug, Clone, Default, Args)]
pub struct Source {
    /// A folder of further tablet files. May be repeated.
    #[arg(long, value_name = "FOLDER")]
    tablets: Vec<PathBuf>,
    /// A settings file, for its `[devices]`.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

pub(crate) fn run(command: &DevicesCommand, json: bool) -> Outcome {
    match command {
        DevicesCommand::List { source } => live::list(&source.config()?, json),
        DevicesCommand::Watch { source, limit_s } => live::watch(&source.config()?, *limit_s, json),
        DevicesCommand::Record { out, source, limit_s } => {
            live::record(out, &source.config()?, *limit_s, json)
        }
        DevicesCommand::Play { recording, source, speed } => {
            live::play(recording, &catalogue(&source.config()?)?, *speed, json)
        }
        DevicesCommand::Decode { recording, csv, source } => {
            decode::decode(recording, csv.as_deref(), &catalogue(&source.config()?)?, json)
        }
    }
}

impl Source {
    /// The devices' part of the settings, with the folders of the command line added.
    fn config(&self) -> Result<DevicesConfig, Fail> {
        let mut devices = super::run::load_config(self.config.as_deref())?.devices;
        devices.tablets.extend(self.tablets.iter().cloned());
        Ok(devices)
    }
}

fn catalogue(config: &DevicesConfig) -> Result<Catalogue, Fail> {
    adaptors::tablets(config).map_err(|e| Fail::Config(e.to_string()))
}

fn hid_config(config: &DevicesConfig) -> HidConfig {
    HidConfig {
        models: config.models.clone(),
        ignore: config.ignore.clone(),
        ..HidConfig::default()
    }
}

/// A recording that cannot be played: an unknown device is 5, a file that is not what it claims is
/// 6.
pub(crate) fn recording_fail(e: RecordingError) -> Fail {
    match e {
        RecordingError::Io { path, error } => Fail::io(&path, &error),
        RecordingError::Broken { .. } => Fail::Input(e.to_string()),
        RecordingError::Unknown { .. } => Fail::Device(e.to_string()),
    }
}

/// Whole or not at all: written beside, then renamed.
fn write_text(path: &Path, text: &str) -> Outcome {
    sculptd_geometry::io::write_beside(path, |out| std::io::Write::write_all(out, text.as_bytes()))
        .map_err(|e| Fail::io(path, &e))
}
