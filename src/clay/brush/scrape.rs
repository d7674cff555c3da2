//! Scrape: hills down to the mean plane, hollows stay; the other way round hollows up to it.

use super::level::LevelBrush;

/// One dab of scrape, made ready.
pub type ScrapeBrush = LevelBrush<1>;
