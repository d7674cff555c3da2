//! Brush preferences kept between runs: favourites, colours, the unit of the radius.

use serde::{Deserialize, Serialize};

/// Favourites, and colours, that are kept at most.
const MOST: usize = 24;

/// Brush preferences of a person.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct BrushPreferences {
    /// Names of favourite brushes, built-in and custom, in the order in which they were marked.
    pub favourites: Vec<String>,
    /// Colours to come back to, RGBA, sRGB, as they were kept one after another.
    pub colours: Vec<[u8; 4]>,
    /// True if the radius is in pixels: the brush keeps its size on the screen while the view is
    /// zoomed. Off: the radius is in the scene's unit, and keeps its size on the object.
    pub radius_in_pixels: bool,
}

impl BrushPreferences {
    /// Returns true if a brush is a favourite.
    pub fn is_favourite(&self, name: &str) -> bool {
        self.favourites.iter().any(|f| f == name)
    }

    /// Makes a brush a favourite, the last one, or one no longer.
    pub fn mark(&mut self, name: &str) {
        match self.favourites.iter().position(|f| f == name) {
            Some(at) => drop(self.favourites.remove(at)),
            None => self.favourites.push(name.to_owned()),
        }
        self.bound();
    }

    /// Keeps a colour as the last one.
    pub fn keep(&mut self, colour: [u8; 4]) {
        self.colours.retain(|c| *c != colour);
        self.colours.push(colour);
        self.bound();
    }

    /// The first ones make room.
    pub fn bound(&mut self) {
        self.favourites.drain(..self.favourites.len().saturating_sub(MOST));
        self.colours.drain(..self.colours.len().saturating_sub(MOST));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_favourite_is_marked_and_unmarked_and_colours_are_kept_once() {
        let mut likes = BrushPreferences::default();
        likes.mark("clay");
        likes.mark("bark of oak");
        assert!(likes.is_favourite("clay") && likes.is_favourite("bark of oak"));
        likes.mark("clay");
        assert_eq!(likes.favourites, ["bark of oak"]);
        for i in 0..40u8 {
            likes.keep([i, 0, 0, 255]);
            likes.mark(&i.to_string());
        }
        likes.keep([30, 0, 0, 255]);
        assert_eq!((likes.colours.len(), likes.favourites.len()), (MOST, MOST));
        assert_eq!(likes.colours.last(), Some(&[30, 0, 0, 255]));
        assert_eq!(likes.colours[0], [16, 0, 0, 255]);
    }
}
