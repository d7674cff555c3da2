//! What a part is checked against: a process, its machine and material, and how the part stands.

use glam::DVec3;
use sculptd_geometry::thickness::preset::Preset;

use crate::preset::{BuildMethod, CheckPreset, MaterialPreset, PrinterPreset, ProcessPreset};

/// The presets that are available by name.
#[derive(Debug, Clone, Default)]
pub struct PresetLibrary {
    /// Processes, printers and materials.
    pub checks: Vec<CheckPreset>,
    /// Limits of walls.
    pub walls: Vec<Preset>,
}

/// Everything that a check compares with.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckSettings {
    /// The limits of the process, with those that the printer overrides.
    pub process: ProcessPreset,
    /// The machine, where one is named.
    pub printer: Option<PrinterPreset>,
    /// The material.
    pub material: MaterialPreset,
    /// The limits of walls.
    pub walls: Option<Preset>,
    /// The build direction, or the pull direction of a mould; of unit length.
    pub up: DVec3,
}

/// A name that no preset has, or presets that do not fit together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct UnknownPreset(pub String);

impl PresetLibrary {
    fn names(&self, of: impl Fn(&CheckPreset) -> bool) -> String {
        let names: Vec<&str> =
            self.checks.iter().filter(|p| of(p)).map(CheckPreset::name).collect();
        names.join(", ")
    }

    /// Returns the process of this name.
    pub fn process(&self, name: &str) -> Result<&ProcessPreset, UnknownPreset> {
        let found = self.checks.iter().find_map(|p| match p {
            CheckPreset::Process(p) if p.name == name => Some(&**p),
            _ => None,
        });
        found.ok_or_else(|| {
            let known = self.names(|p| matches!(p, CheckPreset::Process(_)));
            UnknownPreset(format!("no process is called \"{name}\"; there are {known}"))
        })
    }

    /// Returns the printer of this name.
    pub fn printer(&self, name: &str) -> Result<&PrinterPreset, UnknownPreset> {
        let found = self.checks.iter().find_map(|p| match p {
            CheckPreset::Printer(p) if p.name == name => Some(&**p),
            _ => None,
        });
        found.ok_or_else(|| {
            let known = self.names(|p| matches!(p, CheckPreset::Printer(_)));
            UnknownPreset(format!("no printer is called \"{name}\"; there are {known}"))
        })
    }

    /// Returns the material of this name.
    pub fn material(&self, name: &str) -> Result<&MaterialPreset, UnknownPreset> {
        let found = self.checks.iter().find_map(|p| match p {
            CheckPreset::Material(p) if p.name == name => Some(&**p),
            _ => None,
        });
        found.ok_or_else(|| {
            let known = self.names(|p| matches!(p, CheckPreset::Material(_)));
            UnknownPreset(format!("no material is called \"{name}\"; there are {known}"))
        })
    }

    /// Returns the limits of walls of this name.
    pub fn walls(&self, name: &str) -> Result<&Preset, UnknownPreset> {
        self.walls.iter().find(|p| p.name == name).ok_or_else(|| {
            let known: Vec<&str> = self.walls.iter().map(|p| p.name.as_str()).collect();
            let known = known.join(", ");
            UnknownPreset(format!("no thickness preset is called \"{name}\"; there are {known}"))
        })
    }
}

impl CheckSettings {
    /// Puts a process together with a printer and a material; without a material, the process names
    /// it. `up` has any length but zero.
    ///
    /// # Errors
    /// Returns an error if a named preset is not in the library, or the printer works by another
    /// process.
    pub fn new(
        library: &PresetLibrary,
        process: &ProcessPreset,
        printer: Option<&PrinterPreset>,
        material: Option<&MaterialPreset>,
        up: DVec3,
    ) -> Result<CheckSettings, UnknownPreset> {
        let mut process = process.clone();
        if let Some(p) = printer {
            if p.process != process.name {
                return Err(UnknownPreset(format!(
                    "the printer \"{}\" works by {}, and the part is checked for {}",
                    p.name, p.process, process.name
                )));
            }
            process.resolution = p.resolution.or(process.resolution);
            process.layer_height = p.layer_height.or(process.layer_height);
        }
        let material = match material {
            Some(m) => m,
            None => library.material(&process.material)?,
        };
        let walls = match process.walls.as_ref().or(material.walls.as_ref()) {
            Some(name) => Some(library.walls(name)?.clone()),
            None => None,
        };
        if process.method == BuildMethod::Mould && walls.is_none() {
            return Err(UnknownPreset(format!(
                "the material \"{}\" names no limits of walls: moulding needs one of those that do",
                material.name
            )));
        }
        let up = up
            .try_normalize()
            .ok_or_else(|| UnknownPreset("the build direction has no length".into()))?;
        let (printer, material) = (printer.cloned(), material.clone());
        Ok(CheckSettings { process, printer, material, walls, up })
    }

    /// The height of a layer; without layers a hundredth of a millimetre.
    pub fn layer(&self) -> f64 {
        self.process.layer_height.unwrap_or(0.01)
    }
}
