//! Resolves the configuration from its layers, once, and records the origin of every value.
//!
//! Layers, weakest first: the defaults of the code, the system's file, the user's file, `--config`,
//! the command line. Each layer is checked strictly before it is merged over the others. An error
//! (unknown key, value out of range, wrong type) names file and line.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::toml_text::to_toml;
use sculptd_camera::hand_camera::HandCameraSettings;
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};
use sculptd_devices::calibration::Calibrations;
use sculptd_devices::pad_actions::ActionTable;
use sculptd_engine::camera::Camera;
use sculptd_engine::hand::HandSettings;

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    pub r#loop: LoopConfig,
    pub channel: ChannelConfig,
    pub brush: BrushSettings,
    /// Presets of each brush; not written to configuration files.
    #[serde(skip)]
    pub presets: Presets,
    pub camera: CameraConfig,
    pub undo: UndoConfig,
    pub hand: HandSettings,
    pub devices: DevicesConfig,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LoopConfig {
    pub rate_hz: u32,
    pub workers: usize,
    pub dab_budget: u64,
}

impl Default for LoopConfig {
    fn default() -> Self {
        LoopConfig { rate_hz: 120, workers: 0, dab_budget: 400_000 }
    }
}

impl LoopConfig {
    /// Helping threads, the tick thread counted in.
    pub fn worker_count(&self) -> usize {
        match self.workers {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()).min(16),
            n => n.min(16),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelConfig {
    pub capacity: usize,
    pub drain_per_tick: usize,
}

impl Default for ChannelConfig {
    fn default() -> Self {
        ChannelConfig { capacity: 4096, drain_per_tick: 4096 }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    pub fov_degrees: f32,
    pub aspect: f32,
    pub orthographic: bool,
    pub yaw_degrees: f32,
    pub pitch_degrees: f32,
}

impl Default for CameraConfig {
    fn default() -> Self {
        CameraConfig {
            fov_degrees: 40.0,
            aspect: 1.6,
            orthographic: false,
            yaw_degrees: 28.0,
            pitch_degrees: 20.0,
        }
    }
}

impl CameraConfig {
    pub fn camera(&self) -> Camera {
        Camera {
            fov_y: self.fov_degrees.to_radians(),
            aspect: self.aspect,
            orthographic: self.orthographic,
            yaw: self.yaw_degrees.to_radians(),
            pitch: self.pitch_degrees.to_radians(),
            ..Camera::default()
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UndoConfig {
    pub bytes: u64,
    pub history_bytes: u64,
}

impl Default for UndoConfig {
    fn default() -> Self {
        UndoConfig { bytes: 1 << 30, history_bytes: 4 << 30 }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DevicesConfig {
    pub hid: bool,
    pub serial: Vec<PathBuf>,
    pub leap: String,
    /// The camera that watches hands: empty for none, a number, a device node, or a file.
    pub camera: String,
    pub camera_settings: HandCameraSettings,
    pub tablets: Vec<PathBuf>,
    pub models: BTreeMap<String, String>,
    pub ignore: Vec<String>,
    pub calibration: Calibrations,
    pub actions: ActionTable,
    pub model_actions: BTreeMap<String, ActionTable>,
}

impl Default for DevicesConfig {
    fn default() -> Self {
        DevicesConfig {
            hid: true,
            serial: vec![],
            leap: String::new(),
            camera: String::new(),
            camera_settings: HandCameraSettings::default(),
            tablets: vec![],
            models: BTreeMap::new(),
            ignore: vec![],
            calibration: Calibrations::new(),
            actions: ActionTable::default(),
            model_actions: BTreeMap::new(),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    /// The text names line, column, key and what was expected.
    #[error("{origin}: {text}")]
    Invalid { origin: String, text: String },
}

/// A configuration and where each of its values was written.
#[derive(Debug, Clone)]
pub struct Resolved {
    pub config: Config,
    /// `section.key` -> the layer that had the last word.
    pub origins: BTreeMap<String, String>,
}

impl Resolved {
    pub fn defaults(presets: &Presets) -> Self {
        Resolver::new(presets).finish()
    }

    /// One text over the defaults, and nothing of what the machine's files say.
    pub fn from_text(text: &str, origin: &str, presets: &Presets) -> Result<Self, ConfigError> {
        let mut resolver = Resolver::new(presets);
        resolver.text(text, origin)?;
        Ok(resolver.finish())
    }

    /// The usual layers, where their files exist, then `extra` (which must exist).
    pub fn load(extra: Option<&Path>, presets: &Presets) -> Result<Self, ConfigError> {
        let mut resolver = Resolver::new(presets);
        for path in usual_files().into_iter().filter(|p| p.is_file()) {
            resolver.file(&path)?;
        }
        if let Some(path) = extra {
            resolver.file(path)?;
        }
        Ok(resolver.finish())
    }
}

/// The system's file and the user's, in that order.
pub fn usual_files() -> Vec<PathBuf> {
    let mut files = vec![PathBuf::from("/etc/sculptd/sculptd.toml")];
    files.extend(
        directories::ProjectDirs::from("", "", "sculptd")
            .map(|d| d.config_dir().join("sculptd.toml")),
    );
    files
}

/// Returns the user's state folder, where sessions named without a folder are stored.
pub fn state_dir() -> PathBuf {
    let dirs = directories::ProjectDirs::from("", "", "sculptd");
    dirs.map_or_else(
        || std::env::temp_dir().join("sculptd"),
        |d| d.state_dir().unwrap_or_else(|| d.data_local_dir()).to_path_buf(),
    )
}

struct Resolver {
    table: toml::Table,
    origins: BTreeMap<String, String>,
    presets: Presets,
}

impl Resolver {
    fn new(presets: &Presets) -> Self {
        let mut resolver = Resolver {
            table: toml::Table::new(),
            origins: BTreeMap::new(),
            presets: presets.clone(),
        };
        resolver.merge(Config::default().table(), "default");
        resolver
    }

    fn file(&mut self, path: &Path) -> Result<(), ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConfigError::Unreadable { path: path.into(), source })?;
        self.text(&text, &path.display().to_string())
    }

    fn text(&mut self, text: &str, origin: &str) -> Result<(), ConfigError> {
        let invalid = |text: String| ConfigError::Invalid { origin: origin.into(), text };
        let mut alone: Config = toml::from_str(text).map_err(|e| invalid(e.to_string()))?;
        let table: toml::Table =
            text.parse().map_err(|e: toml::de::Error| invalid(e.to_string()))?;
        // Brush-specific numbers that the text omits come from the brush's preset.
        if table.get("brush").is_none_or(|b| b.get("extra").is_none()) {
            alone.brush.extra = self.presets.of(alone.brush.kind).extra;
        }
        alone.check().map_err(invalid)?;
        self.merge(table, origin);
        Ok(())
    }

    fn merge(&mut self, over: toml::Table, origin: &str) {
        for (section, value) in over {
            let toml::Value::Table(keys) = value else { continue };
            let under =
                self.table.entry(section.clone()).or_insert_with(|| toml::Table::new().into());
            for (key, value) in keys {
                self.origins.insert(format!("{section}.{key}"), origin.into());
                if let toml::Value::Table(under) = under {
                    under.insert(key, value);
                }
            }
        }
    }

    /// Merges the brush's preset under the user's values and over the defaults.
    fn lay_brush(&mut self) {
        let kind = self.table.get("brush").and_then(|b| b.get("kind")).and_then(|k| k.as_str());
        let Some(kind) = kind.and_then(|k| k.parse::<BrushKind>().ok()) else { return };
        let Some(toml::Value::Table(brush)) = self.table.get_mut("brush") else { return };
        for (key, value) in self.presets.get(kind).table() {
            let origin =
                self.origins.entry(format!("brush.{key}")).or_insert_with(|| "default".into());
            if origin == "default" {
                *origin = format!("brush {kind}");
                brush.insert(key.clone(), value.clone());
            }
        }
    }

    fn finish(mut self) -> Resolved {
        self.lay_brush();
        // Every layer was read alone before it was laid; keys do not depend on each other.
        let text = to_toml(&self.table).unwrap_or_default();
        let mut config: Config = toml::from_str(&text).unwrap_or_default();
        // The brush and its specific numbers may come from different layers.
        config.brush = config.brush.clamped();
        config.presets = self.presets;
        Resolved { config, origins: self.origins }
    }
}

impl Config {
    /// The same as tables of keys. By way of text, so that a number of 32 bits has the digits that
    /// a person would write.
    pub fn table(&self) -> toml::Table {
        to_toml(self).ok().and_then(|text| text.parse().ok()).unwrap_or_default()
    }

    /// Every number within its stated range; the message names the key, the value and the range.
    fn check(&self) -> Result<(), String> {
        fn within<T: PartialOrd + std::fmt::Display + Copy>(
            key: &str,
            v: T,
            lo: T,
            hi: T,
        ) -> Result<(), String> {
            if v >= lo && v <= hi {
                return Ok(());
            }
            Err(format!("{key} = {v}: expected a number from {lo} to {hi}"))
        }
        within("loop.rate_hz", self.r#loop.rate_hz, 30, 1000)?;
        within("loop.workers", self.r#loop.workers, 0, 16)?;
        within("loop.dab_budget", self.r#loop.dab_budget, 1000, 1_000_000_000)?;
        within("channel.capacity", self.channel.capacity, 16, 1 << 20)?;
        within("channel.drain_per_tick", self.channel.drain_per_tick, 1, 1 << 20)?;
        self.brush.check()?;
        within("camera.fov_degrees", self.camera.fov_degrees, 5.0, 120.0)?;
        within("camera.aspect", self.camera.aspect, 0.1, 10.0)?;
        within("camera.yaw_degrees", self.camera.yaw_degrees, -360.0, 360.0)?;
        within("camera.pitch_degrees", self.camera.pitch_degrees, -89.0, 89.0)?;
        let camera = &self.devices.camera_settings;
        within("devices.camera_settings.fov_degrees", camera.fov_degrees, 20.0, 150.0)?;
        within("devices.camera_settings.hand_scale", camera.hand_scale, 0.4, 2.0)?;
        within("devices.camera_settings.depth_offset_mm", camera.depth_offset_mm, -300.0, 300.0)?;
        for (name, calibration) in &self.devices.calibration {
            calibration.check().map_err(|e| format!("devices.calibration.\"{name}\".{e}"))?;
        }
        crate::tablet_vocabulary::check(&self.devices.actions)
            .map_err(|e| format!("devices.{e}"))?;
        for (model, table) in &self.devices.model_actions {
            crate::tablet_vocabulary::check(table)
                .map_err(|e| format!("devices.model_actions.\"{model}\": {e}"))?;
        }
        let h = &self.hand;
        within("hand.steady.min_cutoff", h.steady.min_cutoff, 0.05, 50.0)?;
        within("hand.steady.beta", h.steady.beta, 0.0, 10.0)?;
        within("hand.steady.speed_cutoff", h.steady.speed_cutoff, 0.05, 50.0)?;
        within("hand.pinch_on_mm", h.pinch_on_mm, 5.0, 100.0)?;
        within("hand.pinch_off_mm", h.pinch_off_mm, h.pinch_on_mm, 150.0)?;
        within("hand.grab_on", h.grab_on, 0.1, 1.0)?;
        within("hand.grab_off", h.grab_off, 0.0, h.grab_on)?;
        within("hand.pinch_max_grab", h.pinch_max_grab, 0.0, 1.0)?;
        within("hand.spread", h.spread, 0.3, 3.0)?;
        for (key, ms) in [
            ("hold_ms", h.hold_ms),
            ("pose_ramp_ms", h.pose_ramp_ms),
            ("appear_ramp_ms", h.appear_ramp_ms),
            ("bridge_ms", h.bridge_ms),
            ("view_rest_ms", h.view_rest_ms),
            ("dwell_ms", h.dwell_ms),
            ("ring_ms", h.ring_ms),
        ] {
            within(&format!("hand.{key}"), ms, 0.0, 5000.0)?;
        }
        for (key, mm) in [
            ("tip_radius_mm", h.tip_radius_mm),
            ("pinch_radius_mm", h.pinch_radius_mm),
            ("palm_radius_mm", h.palm_radius_mm),
        ] {
            within(&format!("hand.{key}"), mm, 1.0, 200.0)?;
        }
        within("hand.reach.half_mm", h.reach.half_mm, 30.0, 1000.0)?;
        within("hand.reach.middle_mm", h.reach.middle_mm.abs().max_element(), 0.0, 1999.0)?;
        within("hand.dead_zone_mm", h.dead_zone_mm, 0.0, 50.0)?;
        within("hand.dwell_zone_mm", h.dwell_zone_mm, 0.0, 50.0)?;
        within("undo.bytes", self.undo.bytes, 1 << 20, 1 << 40)?;
        within("undo.history_bytes", self.undo.history_bytes, 1 << 20, 1 << 50)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_have_an_origin_and_the_values_of_the_code() {
        let resolved = Resolved::defaults(&Presets::default());
        let in_code = Config::default().table();
        for (section, keys) in &in_code {
            for key in keys.as_table().expect("sections").keys() {
                let origin = &resolved.origins[&format!("{section}.{key}")];
                assert!(origin == "default" || section == "brush", "{section}.{key}: {origin}");
            }
        }
        assert_eq!(resolved.config.hand, Config::default().hand);
        assert_eq!(resolved.config.undo, Config::default().undo);
    }

    #[test]
    fn an_unknown_key_names_its_line_and_a_value_out_of_range_its_range() {
        let mut resolver = Resolver::new(&Presets::default());
        let e = resolver
            .text("[loop]\nrate_hz = 60\nrate = 3\n", "mine.toml")
            .expect_err("unknown")
            .to_string();
        assert!(e.contains("mine.toml") && e.contains("line 3") && e.contains("`rate`"), "{e}");
        let e = resolver.text("[loop]\nrate_hz = 7\n", "mine.toml").expect_err("range").to_string();
        assert!(e.contains("loop.rate_hz = 7") && e.contains("30 to 1000"), "{e}");
    }

    #[test]
    fn a_brush_alone_is_valid_and_brings_its_own_numbers() {
        for kind in BrushKind::ALL {
            let text = format!("[brush]\nkind = \"{kind}\"\n");
            let presets = Presets::default();
            let resolved = Resolved::from_text(&text, "mine.toml", &presets).expect("valid");
            assert_eq!(resolved.config.brush, presets.of(*kind), "{kind}");
        }
    }

    #[test]
    fn the_last_layer_wins_and_its_name_is_kept() {
        let mut resolver = Resolver::new(&Presets::default());
        resolver.text("[loop]\nrate_hz = 60\n", "system").expect("fine");
        resolver.text("[loop]\nworkers = 2\n[brush]\nstrength = 0.5\n", "user").expect("fine");
        let r = resolver.finish();
        assert_eq!(
            (r.config.r#loop.rate_hz, r.config.r#loop.workers, r.config.brush.strength),
            (60, 2, 0.5)
        );
        assert_eq!(r.origins["loop.rate_hz"], "system");
        assert_eq!(r.origins["brush.strength"], "user");
        assert_eq!(r.origins["camera.aspect"], "default");
    }
}
