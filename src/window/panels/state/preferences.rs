//! The preferences that the window keeps between runs.

use std::path::PathBuf;

use super::brush_preferences::BrushPreferences;
use super::key_map::KeySettings;
use super::light::Reference;
use crate::look::Look;
use sculptd_engine::camera::Camera;

/// The first lesson, a hint at a time. Each was followed, in any order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct HintsFollowed {
    pub touched: bool,
    pub turned: bool,
    pub smoothed: bool,
    pub carved: bool,
    pub undone: bool,
    pub mirrored: bool,
}

/// One hint of the first lesson.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hint {
    Sculpt,
    Turn,
    Smooth,
    Carve,
    Undo,
    Mirror,
}

impl HintsFollowed {
    /// Nothing is left to show.
    pub const ALL: HintsFollowed = HintsFollowed {
        touched: true,
        turned: true,
        smoothed: true,
        carved: true,
        undone: true,
        mirrored: true,
    };

    fn hints(&self) -> [(bool, Hint); 6] {
        [
            (self.touched, Hint::Sculpt),
            (self.turned, Hint::Turn),
            (self.smoothed, Hint::Smooth),
            (self.carved, Hint::Carve),
            (self.undone, Hint::Undo),
            (self.mirrored, Hint::Mirror),
        ]
    }

    /// The hint for now, if one is left, with its number and how many there are.
    pub fn hint(&self) -> Option<(Hint, usize, usize)> {
        let hints = self.hints();
        let at = hints.iter().position(|h| !h.0)?;
        Some((hints[at].1, at + 1, hints.len()))
    }
}

/// Effect of two fingers that move together; three fingers have the other one. A pinch of two
/// zooms.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TwoFingers {
    /// They turn the view, and three slide it.
    #[default]
    Turn,
    /// They slide the view, and three turn it.
    Slide,
}

/// Smallest and largest scale of the panels.
pub const SCALE: (f32, f32) = (0.7, 3.0);

/// Recent files kept.
const RECENT: usize = 8;
/// Views that are kept, at most.
pub const VIEWS: usize = 9;

#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// The code of the language (`it`); empty: that of the system.
    pub language: String,
    /// Of the panels, times what the screen asks for.
    pub scale: f32,
    pub light: bool,
    /// Four samples a pixel, where no graphics card draws: a card always does.
    pub smooth_edges: bool,
    /// True if a pointer without pressure derives it from its speed.
    pub speed_is_pressure: bool,
    /// A stroke of a tablet's pen is shown where the pen will be when the frame is seen.
    pub lead_strokes: bool,
    /// Effect of two fingers that move together on a touch screen.
    pub two_fingers: TwoFingers,
    #[serde(alias = "done")]
    pub hints: HintsFollowed,
    pub look: Look,
    /// The person's own picture of a lit ball and of surroundings, by their files' names.
    pub matcap: String,
    pub environment: String,
    pub reference: Reference,
    pub brushes: BrushPreferences,
    pub keys: KeySettings,
    pub recent: Vec<PathBuf>,
    /// Views to come back to.
    pub kept_views: Vec<Camera>,
}

impl Default for Preferences {
    fn default() -> Self {
        Preferences {
            language: String::new(),
            scale: 1.0,
            light: false,
            smooth_edges: false,
            speed_is_pressure: true,
            lead_strokes: true,
            two_fingers: TwoFingers::default(),
            hints: HintsFollowed::default(),
            look: Look::default(),
            matcap: String::new(),
            environment: String::new(),
            reference: Reference::default(),
            brushes: BrushPreferences::default(),
            keys: KeySettings::default(),
            recent: Vec::new(),
            kept_views: Vec::new(),
        }
    }
}

impl Preferences {
    /// From the text of the file. A key that is not there takes its default, and a number outside
    /// of its range the nearest one in it.
    ///
    /// # Errors
    /// Names the line, where the text is not TOML or a value has the wrong type.
    pub fn read(text: &str) -> Result<Preferences, String> {
        let mut p: Preferences = toml::from_str(text).map_err(|e| e.to_string())?;
        p.scale = if p.scale.is_finite() { p.scale.clamp(SCALE.0, SCALE.1) } else { 1.0 };
        p.brushes.bound();
        p.recent.truncate(RECENT);
        p.kept_views.retain(Camera::is_sane);
        p.kept_views.truncate(VIEWS);
        Ok(p)
    }

    pub fn used(&mut self, path: PathBuf) {
        self.recent.retain(|p| *p != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_comes_back_and_nonsense_is_as_at_first() {
        let mut p = Preferences { scale: 1.4, light: true, ..Default::default() };
        p.hints.turned = true;
        p.brushes.mark("clay");
        p.brushes.keep([250, 120, 30, 255]);
        p.brushes.radius_in_pixels = true;
        for i in 0..12 {
            p.used(format!("/a/{i}.stl").into());
        }
        p.used("/a/9.stl".into());
        p.kept_views = vec![Camera::default(), Camera { distance: -1.0, ..Camera::default() }];
        let bad = p.clone();
        p.kept_views.pop();
        assert_eq!(Preferences::read(&toml::to_string(&bad).expect("plain data")), Ok(p.clone()));
        let back = Preferences::read(&toml::to_string(&p).expect("plain data")).expect("read");
        assert_eq!(back, p);
        assert_eq!(back.recent.len(), RECENT);
        assert_eq!(back.recent[0], PathBuf::from("/a/9.stl"));
        assert!(
            Preferences::read("light = true\nscale = \"x\"").is_err_and(|e| e.contains("line 2"))
        );
        assert_eq!(Preferences::read("scale = 90.0").map(|p| p.scale), Ok(SCALE.1));
        assert_eq!(Preferences::read(""), Ok(Preferences::default()));
    }
}
