//! Flatten: both hills and hollows to the mean plane; the other way round it deepens them.

use super::level::LevelBrush;

/// One dab of flatten, made ready.
pub type FlattenBrush = LevelBrush<0>;
