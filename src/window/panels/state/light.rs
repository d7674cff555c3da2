//! What a person's own pictures offer for the look of the clay: lit balls, surroundings,
//! references.

/// Files found in the person's folders when the page was last opened.
#[derive(Default)]
pub struct LightPage {
    /// Names of the files of lit balls, with small pictures.
    pub matcaps: Vec<(String, egui::TextureHandle)>,
    /// Names of the files of surroundings.
    pub environments: Vec<String>,
    /// Names of the files of reference pictures.
    pub references: Vec<String>,
    /// The reference picture that is shown.
    pub reference: Option<egui::TextureHandle>,
}

impl std::fmt::Debug for LightPage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Textures have nothing to tell.
        f.debug_struct("LightPage")
            .field("matcaps", &self.matcaps.iter().map(|m| &m.0).collect::<Vec<_>>())
            .field("environments", &self.environments)
            .field("references", &self.references)
            .finish_non_exhaustive()
    }
}

/// A picture that is looked at while one sculpts.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Reference {
    /// The file's name in the folder of references; empty: none is shown.
    pub file: String,
    /// True if it is shown behind the clay; false shows it in a separate window.
    pub behind: bool,
    /// Opacity, 0 none to 1.
    pub opacity: f32,
}

impl Default for Reference {
    fn default() -> Self {
        Reference { file: String::new(), behind: true, opacity: 0.6 }
    }
}
