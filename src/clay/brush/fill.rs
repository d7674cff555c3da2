//! Fill: hollows up to the mean plane, hills stay; the other way round hills down to it.

use super::level::LevelBrush;

/// One dab of fill, made ready.
pub type FillBrush = LevelBrush<{ -1 }>;
