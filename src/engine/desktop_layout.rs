//! Position of a tablet's pen in the view, and where it may begin a stroke, as a desktop maps it.
//!
//! A desktop moves its pointer with the same pen that the daemon reads. It may map the pen to any
//! part of its screens, where other windows can cover the view. A window learns the map and sends
//! it with [`crate::command::Command::DesktopLayout`]. Laws kept here:
//! * The desktop is plain data and part of the input, so a replay finds every pen where it was.
//! * Without a layout from a window, a pen covers the view with its whole area and may begin a
//!   stroke anywhere: a headless daemon has no desktop.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use sculptd_devices::DeviceId;

/// Tablets that a desktop knows.
pub const MAX_TABLETS: usize = 4;
/// Surfaces over the view that a desktop knows: menus, dialogs, floating panels.
pub const MAX_COVERS: usize = 8;
/// Clamp for view coordinates, one view size beyond each border: nothing is hit there, and nothing
/// overflows.
const FARTHEST: (f32, f32) = (-1.0, 2.0);

/// Mapping of one tablet's pen to the view.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum PenPlace {
    /// The whole area of the tablet lies over the whole view.
    #[default]
    Area,
    /// The desktop moves its pointer by this pen, but by which map is not known yet. The pointer
    /// sculpts in its place, and the pen itself does nothing.
    Unknown,
    /// By an affine map from shares of the tablet's area to shares of the view: `origin` is where
    /// the area's top left corner lies, `across` and `down` its two edges.
    Mapped {
        /// The place of the area's top left corner.
        origin: Vec2,
        /// The area's upper edge, from left to right.
        across: Vec2,
        /// The area's left edge, from top to bottom.
        down: Vec2,
    },
    /// The window shows the form cut, which is only looked at: the pen does nothing.
    Off,
}

/// The places of all tablets, and what is free for them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DesktopLayout {
    /// The tablets that a desktop's pointer follows.
    pub tablets: [Option<(DeviceId, PenPlace)>; MAX_TABLETS],
    /// Areas over the view that take presses: least and greatest corner, in shares of the view.
    pub covers: [Option<[Vec2; 2]>; MAX_COVERS],
    /// The window is behind others, or not the one that is worked in: no stroke begins.
    pub away: bool,
}

impl PenPlace {
    /// Maps a share of the tablet's area to the view, clamped to a range that is safe to compute
    /// with.
    pub fn view(&self, share: Vec2) -> Vec2 {
        let at = match *self {
            PenPlace::Area | PenPlace::Unknown | PenPlace::Off => share,
            PenPlace::Mapped { origin, across, down } => origin + across * share.x + down * share.y,
        };
        at.clamp(Vec2::splat(FARTHEST.0), Vec2::splat(FARTHEST.1))
    }

    /// Returns true if all numbers are finite and within a hundred views.
    fn is_sane(&self) -> bool {
        match *self {
            PenPlace::Area | PenPlace::Unknown | PenPlace::Off => true,
            PenPlace::Mapped { origin, across, down } => {
                // A comparison with a number that is none is false.
                [origin, across, down].iter().all(|v| v.abs().max_element() <= 100.0)
                    && origin.is_finite()
                    && across.is_finite()
                    && down.is_finite()
            }
        }
    }
}

impl DesktopLayout {
    /// Returns the mapping of one pen; `None` if no desktop maps it.
    pub fn place(&self, device: DeviceId) -> Option<PenPlace> {
        self.tablets.iter().flatten().find(|t| t.0 == device).map(|t| t.1)
    }

    /// Returns true if a pen with this mapping may begin a stroke here. Without a mapping it may
    /// begin anywhere.
    pub fn is_free(&self, place: Option<PenPlace>, view: Vec2) -> bool {
        let inside = |[lo, hi]: [Vec2; 2]| view.cmpge(lo).all() && view.cmplt(hi).all();
        match place {
            None => true,
            Some(PenPlace::Unknown | PenPlace::Off) => false,
            Some(_) => {
                !self.away
                    && inside([Vec2::ZERO, Vec2::ONE])
                    && !self.covers.iter().flatten().any(|c| inside(*c))
            }
        }
    }

    /// Refuses what no pen can be placed by.
    pub fn is_sane(&self) -> bool {
        self.tablets.iter().flatten().all(|t| t.1.is_sane())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapped_pen_is_where_the_map_says_and_begins_only_where_it_is_free() {
        // The tablet covers a screen of which the view is the middle half, turned by nothing.
        let place = PenPlace::Mapped {
            origin: Vec2::splat(-0.5),
            across: Vec2::new(2.0, 0.0),
            down: Vec2::new(0.0, 2.0),
        };
        let desktop = DesktopLayout {
            tablets: [Some((DeviceId(3), place)), None, None, None],
            covers: [Some([Vec2::splat(0.4), Vec2::splat(0.6)]); MAX_COVERS],
            away: false,
        };
        assert!(desktop.is_sane());
        assert_eq!(place.view(Vec2::splat(0.5)), Vec2::splat(0.5));
        assert_eq!(place.view(Vec2::ZERO), Vec2::splat(-0.5));
        let known = desktop.place(DeviceId(3));
        assert!(desktop.is_free(known, Vec2::splat(0.2)));
        assert!(!desktop.is_free(known, Vec2::splat(0.5)), "under a menu");
        assert!(!desktop.is_free(known, place.view(Vec2::ZERO)), "on a panel beside the view");
        assert!(!DesktopLayout { away: true, ..desktop }.is_free(known, Vec2::splat(0.2)));
        assert!(
            desktop.is_free(desktop.place(DeviceId(4)), Vec2::splat(0.5)),
            "no desktop follows it"
        );
        for none in [PenPlace::Unknown, PenPlace::Off] {
            assert!(!desktop.is_free(Some(none), Vec2::splat(0.2)), "{none:?}");
        }
        let wild = PenPlace::Mapped { origin: Vec2::NAN, across: Vec2::X, down: Vec2::Y };
        let wild = DesktopLayout { tablets: [Some((DeviceId(3), wild)); MAX_TABLETS], ..desktop };
        assert!(!wild.is_sane());
    }
}
