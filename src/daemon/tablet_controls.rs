//! What a person binds to the controls of tablets while the program runs, and which control was
//! worked last.
//!
//! Laws kept here:
//! * The tick thread waits for nobody: it loads the table, and tells the last control by one atomic
//!   number.
//! * While somebody listens for a control, what it is bound to is not done. The first one ends it,
//!   so that a window which is lost meanwhile leaves no tablet without its keys.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use arc_swap::ArcSwap;

use sculptd_devices::DeviceId;
use sculptd_devices::pad_actions::{ActionTable, Binding, Control};
use sculptd_geometry::io::write_beside;

use crate::tablet_vocabulary::check;

/// The controls of a kind are numbered from 1; the kinds in the order of these.
const KINDS: [fn(u8) -> Control; 5] =
    [Control::Key, Control::Barrel, Control::Wheel, Control::Ring, Control::Strip];

/// A control that was pressed or turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WorkedControl {
    /// Counts from 1, so that the same control worked twice is seen twice.
    pub count: u32,
    pub device: DeviceId,
    pub control: Control,
}

/// The handle of the tick thread, the window and the control socket on the same.
#[derive(Clone)]
pub struct TabletControls(Arc<Shared>);

struct Shared {
    own: ArcSwap<ActionTable>,
    /// Count, device, kind and number of the last control; 0 before there was one.
    last: AtomicU64,
    listening: AtomicBool,
    file: Option<PathBuf>,
}

impl fmt::Debug for TabletControls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TabletControls").finish_non_exhaustive()
    }
}

impl Default for TabletControls {
    /// Nothing bound, and nothing kept.
    fn default() -> Self {
        TabletControls::new(ActionTable::default(), None)
    }
}

impl TabletControls {
    /// With a person's own bindings, which are kept in `file`.
    pub fn new(own: ActionTable, file: Option<PathBuf>) -> Self {
        let own = ArcSwap::from_pointee(own);
        let (last, listening) = (AtomicU64::new(0), AtomicBool::new(false));
        TabletControls(Arc::new(Shared { own, last, listening, file }))
    }

    /// As the file has them. A file that is not there binds nothing; one that cannot be read binds
    /// nothing either, is left as it is and told.
    pub fn of_file(file: &Path) -> (Self, Option<String>) {
        let text = match std::fs::read_to_string(file) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(e) => {
                let told = format!("{}: {e}", file.display());
                return (TabletControls::default(), Some(told));
            }
        };
        let table: Result<ActionTable, String> = toml::from_str(&text).map_err(|e| e.to_string());
        match table.and_then(|t| check(&t).map(|()| t)) {
            Ok(own) => (TabletControls::new(own, Some(file.into())), None),
            // Without the file's name nothing is written over it.
            Err(e) => (TabletControls::default(), Some(format!("{}: {e}", file.display()))),
        }
    }

    /// The user's own file: `tablet-actions.toml` in the folder of settings.
    pub fn default_file() -> Option<PathBuf> {
        let folders = directories::ProjectDirs::from("", "", "sculptd")?;
        Some(folders.config_dir().join("tablet-actions.toml"))
    }

    /// Returns the user's bindings.
    pub fn own(&self) -> Arc<ActionTable> {
        self.0.own.load_full()
    }

    /// Binds a control, or leaves it to the settings and the defaults (`None`), from the next tick
    /// on, and writes the file.
    ///
    /// # Errors
    /// Names the file where it cannot be written: the binding holds until the program ends.
    pub fn bind(&self, control: Control, binding: Option<Binding>) -> Result<(), String> {
        let mut own = ActionTable::clone(&self.own());
        match binding {
            Some(binding) => drop(own.controls.insert(control, binding)),
            None => drop(own.controls.remove(&control)),
        }
        let text = toml::to_string(&own).map_err(|e| e.to_string())?;
        self.0.own.store(Arc::new(own));
        let Some(file) = &self.0.file else {
            return Err("the keys of the tablet are not kept: their file could not be read".into());
        };
        let write = || {
            if let Some(folder) = file.parent() {
                std::fs::create_dir_all(folder)?;
            }
            write_beside(file, |out| out.write_all(text.as_bytes()))
        };
        write().map_err(|e| format!("{}: {e}", file.display()))
    }

    /// Somebody waits for the next control to be worked, or no longer does.
    pub fn listen(&self, listens: bool) {
        self.0.listening.store(listens, Relaxed);
    }

    pub fn is_listening(&self) -> bool {
        self.0.listening.load(Relaxed)
    }

    /// A control was pressed or turned: nobody listens any longer.
    pub(crate) fn note(&self, device: DeviceId, control: Control) {
        let (kind, number) = match control {
            Control::Key(n) => (0, n),
            Control::Barrel(n) => (1, n),
            Control::Wheel(n) => (2, n),
            Control::Ring(n) => (3, n),
            Control::Strip(n) => (4, n),
            Control::Eraser => (5, 0),
        };
        let count = (self.0.last.load(Relaxed) >> 32) as u32;
        let count = u64::from(count.wrapping_add(1).max(1));
        let low = u64::from(device.0) << 16 | u64::from(kind as u8) << 8 | u64::from(number);
        self.0.last.store(count << 32 | low, Relaxed);
        self.listen(false);
    }

    /// The control that was worked last.
    pub fn last(&self) -> Option<WorkedControl> {
        let last = self.0.last.load(Relaxed);
        let count = (last >> 32) as u32;
        let (kind, number) = ((last >> 8) as u8, last as u8);
        let of = |kind: &fn(u8) -> Control| kind(number);
        let control = KINDS.get(usize::from(kind)).map_or(Control::Eraser, of);
        (count > 0).then_some(WorkedControl {
            count,
            device: DeviceId((last >> 16) as u16),
            control,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_control_is_told_as_it_was_worked() {
        let controls = TabletControls::default();
        assert_eq!(controls.last(), None);
        let all = KINDS.iter().flat_map(|k| [k(1), k(32)]).chain([Control::Eraser]);
        for (i, control) in all.enumerate() {
            let device = DeviceId(300 + i as u16);
            controls.note(device, control);
            let count = i as u32 + 1;
            assert_eq!(controls.last(), Some(WorkedControl { count, device, control }));
        }
    }

    #[test]
    fn what_is_bound_is_kept_and_a_file_that_cannot_be_read_is_left_alone() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("settings/tablet-actions.toml");
        let (controls, told) = TabletControls::of_file(&file);
        assert_eq!(told, None);
        let press = Binding::Press("brush.clay".into());
        assert_eq!(controls.bind(Control::Key(2), Some(press.clone())), Ok(()));
        assert_eq!(controls.bind(Control::Barrel(1), Some(Binding::Nothing)), Ok(()));
        assert_eq!(controls.bind(Control::Barrel(1), None), Ok(()));
        let (again, told) = TabletControls::of_file(&file);
        assert_eq!((told, again.own().controls.len()), (None, 1));
        assert_eq!(again.own().controls.get(&Control::Key(2)), Some(&press));

        for wrong in ["[controls]\nkey-1 = { press = \"fly\" }\n", "controls = 3"] {
            write_beside(&file, |out| out.write_all(wrong.as_bytes())).expect("written");
            let (controls, told) = TabletControls::of_file(&file);
            assert!(told.is_some_and(|t| t.contains("tablet-actions.toml")));
            assert!(controls.bind(Control::Key(1), None).is_err());
            assert_eq!(std::fs::read_to_string(&file).expect("there"), wrong);
        }
    }
}
