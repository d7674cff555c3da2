//! What the thickness page shows: the live map's summary, the limit and where it comes from.

use glam::Vec3;
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::thickness::preset::Preset;

/// A place where the wall is thin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinSpot {
    pub place: Vec3,
    pub thickness: f32,
}

/// Summary of the thickness map of the whole object; lengths in the mesh's unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ThicknessSummary {
    pub min: f32,
    pub max: f32,
    pub median: f32,
    /// The 98th percentile: where the scale and the histogram end.
    pub high: f32,
    pub measured: usize,
    pub vertices: usize,
    /// Share of the measured area below the limit, 0 to 1.
    pub below: f32,
    /// Areas of the classes from `min` to `high`.
    pub histogram: Vec<f32>,
    pub spots: Vec<ThinSpot>,
}

impl ThicknessSummary {
    pub const CLASSES: usize = 48;

    /// The middle of the class with the largest area.
    pub fn usual(&self) -> f32 {
        let classes = 0..self.histogram.len();
        let most = classes.rev().max_by(|&a, &b| self.histogram[a].total_cmp(&self.histogram[b]));
        let width = (self.high - self.min) / self.histogram.len().max(1) as f32;
        most.map_or(self.median, |i| self.min + (i as f32 + 0.5) * width)
    }
}

/// Summary of the change of walls of the whole object; lengths in the mesh's unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WallChangeSummary {
    /// The difference by which a wall became thinnest, negative or 0.
    pub thinned: f32,
    /// The difference by which a wall became thickest, positive or 0.
    pub thickened: f32,
    /// Share of the vertices that could be compared, 0 to 1.
    pub compared: f32,
    /// The places with thinner walls, the most thinned first; `thickness` is the difference.
    pub spots: Vec<ThinSpot>,
}

#[derive(Debug)]
pub struct WallsPage {
    pub found: Option<Box<ThicknessSummary>>,
    pub changes: Option<WallChangeSummary>,
    pub presets: Vec<Preset>,
    /// Index into `presets`; `None`: the person's own limit.
    pub preset: Option<usize>,
    pub limit: f32,
    /// The width below which a gap is too narrow.
    pub gap_limit: f32,
    /// The ends of the scale, set by hand; `None`: they follow the map.
    pub scale: Option<(f32, f32)>,
    /// The wall under the pointer, along the normal.
    pub here: Option<f32>,
    /// The diameter of the largest ball in that wall.
    pub ball: Option<f32>,
}

impl WallsPage {
    /// Returns the limit of walls or of gaps.
    pub fn limit_of(&self, side: MeasuredSide) -> f32 {
        if side == MeasuredSide::Wall { self.limit } else { self.gap_limit }
    }
}

impl Default for WallsPage {
    fn default() -> Self {
        WallsPage {
            found: None,
            changes: None,
            presets: Vec::new(),
            preset: None,
            limit: 1.0,
            gap_limit: 0.4,
            scale: None,
            here: None,
            ball: None,
        }
    }
}
