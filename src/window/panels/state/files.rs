//! What the files page holds: names, the scale and unit of an export, the frames of a turntable.

use std::path::{Path, PathBuf};

use sculptd_geometry::io::states_unit;

/// Units of a number in a file, each with the message of its name: the object itself is in
/// millimetres.
pub const UNITS: [(&str, f64); 4] =
    [("unit-mm", 1.0), ("unit-cm", 0.1), ("unit-m", 0.001), ("unit-inch", 1.0 / 25.4)];

#[derive(Debug)]
pub struct FilesPage {
    pub open: String,
    pub export: String,
    /// A file that exists: whether it is to be replaced is being asked.
    pub replace: Option<PathBuf>,
    /// Sizes are multiplied by this before the unit.
    pub scale: f64,
    /// Index into [`UNITS`].
    pub unit: usize,
    /// Frames of a turntable.
    pub frames: u32,
}

impl Default for FilesPage {
    fn default() -> Self {
        FilesPage {
            open: String::new(),
            export: "sculpture.stl".into(),
            replace: None,
            scale: 1.0,
            unit: 0,
            frames: 36,
        }
    }
}

impl FilesPage {
    /// Returns the factor of the coordinates, and the message of the unit's name.
    pub fn factor(&self, file: &Path) -> (f64, &'static str) {
        if states_unit(file) {
            return (self.scale, UNITS[0].0);
        }
        let (name, factor) = UNITS[self.unit.min(UNITS.len() - 1)];
        (self.scale * factor, name)
    }
}
