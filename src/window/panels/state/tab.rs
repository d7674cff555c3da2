//! The pages of the right panel.

use crate::language::tr;

/// Open page of the right panel.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize,
)]
pub enum Tab {
    #[default]
    Look,
    Scene,
    Walls,
    Check,
    Measure,
    Files,
    Devices,
    Loop,
    More,
}

impl Tab {
    /// Every page with its English name and what it is about.
    pub const ALL: [(Tab, &str, &str); 9] = [
        (Tab::Look, "Look", "How the clay is shown"),
        (Tab::Scene, "Scene", "A second object, Booleans, levels of detail, trimming"),
        (Tab::Walls, "Walls", "Wall thickness and thin spots"),
        (Tab::Check, "Check", "Ready to print or to mould: findings, overhang and draft"),
        (Tab::Measure, "Size", "Measures, the shadow along a direction, distances to another form"),
        (Tab::Files, "Files", "Open, export, pictures"),
        (Tab::Devices, "Pens", "Devices and their live values"),
        (Tab::Loop, "Loop", "Timing of the tick loop and of this window"),
        (Tab::More, "More", "Language, preferences and messages"),
    ];

    /// The name in files and messages: `page-look`.
    pub fn id(self) -> &'static str {
        match self {
            Tab::Look => "page-look",
            Tab::Scene => "page-scene",
            Tab::Walls => "page-walls",
            Tab::Check => "page-check",
            Tab::Measure => "page-measure",
            Tab::Files => "page-files",
            Tab::Devices => "page-devices",
            Tab::Loop => "page-loop",
            Tab::More => "page-more",
        }
    }

    /// Returns the label of its button.
    pub fn title(self) -> String {
        tr!(self.id())
    }

    /// Returns its description.
    pub fn about(self) -> String {
        tr!(&format!("{}.about", self.id()))
    }
}
