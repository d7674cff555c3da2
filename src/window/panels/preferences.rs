//! What a person likes, kept from day to day.

use std::path::PathBuf;

use super::action::Action;
use super::{UiState, View, hints::Done, theme};
use crate::viewer::look::Look;

/// Smallest and largest scale of the panels.
pub const SCALE: (f32, f32) = (0.7, 3.0);
/// Recent files kept.
const RECENT: usize = 8;

#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Of the panels, times what the screen asks for.
    pub scale: f32,
    pub light: bool,
    /// Four samples a pixel, where no graphics card draws: a card always does.
    pub smooth_edges: bool,
    /// The speed of a pointer without pressure stands in for it.
    pub speed_is_pressure: bool,
    pub done: Done,
    pub look: Look,
    pub recent: Vec<PathBuf>,
}

impl Default for Preferences {
    fn default() -> Self {
        Preferences {
            scale: 1.0,
            light: false,
            smooth_edges: false,
            speed_is_pressure: true,
            done: Done::default(),
            look: Look::default(),
            recent: Vec::new(),
        }
    }
}

impl Preferences {
    /// From what was kept; whatever cannot be read is as at first.
    pub fn parse(text: &str) -> Preferences {
        let mut p: Preferences = toml::from_str(text).unwrap_or_default();
        p.scale = if p.scale.is_finite() { p.scale.clamp(SCALE.0, SCALE.1) } else { 1.0 };
        p.recent.truncate(RECENT);
        p
    }

    pub fn used(&mut self, path: PathBuf) {
        self.recent.retain(|p| *p != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT);
    }
}

pub fn ui(ui: &mut egui::Ui, desk: &mut UiState, view: &View<'_>) {
    ui.strong("Preferences");
    let p = &mut desk.prefs;
    ui.horizontal(|ui| {
        ui.label("Text size");
        let less = ui.button("-").on_hover_text(Action::SmallerText.tip()).clicked();
        ui.label(format!("{:.0} %", p.scale * 100.0));
        let more = ui.button("+").on_hover_text(Action::LargerText.tip()).clicked();
        p.scale = (p.scale + 0.1 * (f32::from(more) - f32::from(less))).clamp(SCALE.0, SCALE.1);
    });
    ui.checkbox(&mut p.light, "Light panels");
    ui.checkbox(&mut p.speed_is_pressure, "Speed is pressure")
        .on_hover_text("For a mouse: slow strokes press harder than quick ones");
    if ui.button("Show the hints again").clicked() {
        p.done = Done::default();
    }
    if ui.button("Search actions").on_hover_text(Action::Search.tip()).clicked() {
        desk.search = Some(Default::default());
    }
    if view.session.is_none() {
        ui.colored_label(theme::quiet(ui), "No session file: the work is kept when you export it.");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_comes_back_and_nonsense_is_as_at_first() {
        let mut p = Preferences { scale: 1.4, light: true, ..Default::default() };
        p.done.turned = true;
        for i in 0..12 {
            p.used(format!("/a/{i}.stl").into());
        }
        p.used("/a/9.stl".into());
        let back = Preferences::parse(&toml::to_string(&p).expect("plain data"));
        assert_eq!(back, p);
        assert_eq!(back.recent.len(), RECENT);
        assert_eq!(back.recent[0], PathBuf::from("/a/9.stl"));
        assert_eq!(Preferences::parse("scale = \"x\""), Preferences::default());
        assert_eq!(Preferences::parse("scale = 90.0").scale, SCALE.1);
    }
}
