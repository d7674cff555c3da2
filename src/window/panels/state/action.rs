//! Everything that can be asked for by name: one table serves the keys, the search, the radial
//! menu, the help and the tooltips.

use std::borrow::Cow;
use std::sync::LazyLock;

use egui::Key;

use super::key::KeyCombination;
use super::tab::Tab;
use crate::language::{text_or, tr};
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_engine::command::Command;

/// Something to do, without parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Takes a brush, as it was last used.
    Brush(BrushKind),
    /// Opens a page of the right panel.
    Page(Tab),
    Undo,
    Redo,
    Carve,
    Larger,
    Smaller,
    Stronger,
    Weaker,
    DragRadius,
    DragStrength,
    SampleColour,
    MirrorX,
    MirrorY,
    MirrorZ,
    Frame,
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
    Perspective,
    FourViews,
    NextMaterial,
    Facets,
    Ssao,
    Shadows,
    Wireframe,
    Grid,
    Thickness,
    Mask,
    Distance,
    Overhang,
    Gap,
    DraftAngle,
    TrimBox,
    TrimLine,
    RegionLasso,
    RegionBox,
    RegionLine,
    RegionPolyline,
    RegionMask,
    RegionUnmask,
    RegionHide,
    RegionIsolate,
    RegionFaceSet,
    Finer,
    Coarser,
    Remesh,
    TryAdd,
    TryCut,
    TryKeep,
    New,
    OpenMesh,
    Export,
    Screenshot,
    Turntable,
    Search,
    Panels,
    LightOrDark,
    LargerText,
    SmallerText,
    Help,
    Keys,
    Lesson,
}

/// English name of an action, its keys, and its search terms.
#[derive(Debug, Clone)]
pub struct ActionEntry {
    pub action: Action,
    pub name: Cow<'static, str>,
    /// Default keys ([`super::key_map::KeyMap`] has those in force).
    pub keys: Option<KeyCombination>,
    also: Cow<'static, str>,
}

const fn entry(
    action: Action,
    name: &'static str,
    keys: Option<KeyCombination>,
    also: &'static str,
) -> ActionEntry {
    ActionEntry { action, name: Cow::Borrowed(name), keys, also: Cow::Borrowed(also) }
}

const fn key(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key))
}
const fn shift(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key).shift())
}
const fn ctrl(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key).ctrl())
}
const fn ctrl_shift(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination::of(key).ctrl().shift())
}

/// Words that find a brush and are not in its name.
fn also_of(kind: BrushKind) -> &'static str {
    match kind {
        BrushKind::Draw => "standard raise sculpt",
        BrushKind::Smooth | BrushKind::Relax | BrushKind::SlideRelax => "even soften",
        BrushKind::SurfaceSmooth => "even soften volume",
        BrushKind::Grab => "move drag",
        BrushKind::SnakeHook => "pull tentacle horn",
        BrushKind::Crease => "groove line cut",
        BrushKind::Flatten | BrushKind::Plane | BrushKind::Scrape => "level planar",
        BrushKind::Paint => "colour color",
        BrushKind::Mask => "protect freeze",
        BrushKind::Texture => "alpha picture stamp",
        BrushKind::EraseLayer => "remove back morph",
        BrushKind::DrawFaceSets => "polygroup group part",
        BrushKind::Density | BrushKind::Simplify => "topology triangles detail",
        _ => "",
    }
}

/// Words that find a page and are not in what is said of it.
fn also_of_page(tab: Tab) -> &'static str {
    match tab {
        Tab::More => "language preferences settings options",
        Tab::Scene => "objects layers boolean outliner face sets",
        Tab::Devices => "tablets hands pressure",
        _ => "",
    }
}

/// Returns the label of a brush's button, in the language of this thread.
pub fn brush_title(kind: BrushKind) -> String {
    text_or(&format!("kind-{}", kind.name()), &english_title(kind))
}

/// `clay-strips` becomes `Clay strips`.
fn english_title(kind: BrushKind) -> String {
    let name = kind.name().replace('-', " ");
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}

/// The key of a brush; those of Blender's sculpt mode where no other action has them.
const fn key_of_brush(kind: BrushKind) -> Option<KeyCombination> {
    match kind {
        BrushKind::Draw => key(Key::V),
        BrushKind::Clay => key(Key::A),
        BrushKind::ClayStrips => shift(Key::A),
        BrushKind::Smooth => key(Key::S),
        BrushKind::Crease => shift(Key::C),
        BrushKind::Inflate => key(Key::I),
        BrushKind::Grab => key(Key::D),
        BrushKind::SnakeHook => key(Key::K),
        BrushKind::Pinch => key(Key::P),
        BrushKind::Flatten => shift(Key::T),
        BrushKind::Paint => key(Key::Q),
        _ => None,
    }
}

fn brush(kind: BrushKind) -> ActionEntry {
    let name = format!("{} brush", english_title(kind));
    ActionEntry {
        action: Action::Brush(kind),
        name: name.into(),
        keys: key_of_brush(kind),
        also: also_of(kind).into(),
    }
}

/// Every action: those of the table, the brushes, the pages.
pub fn all() -> &'static [ActionEntry] {
    static ALL: LazyLock<Vec<ActionEntry>> = LazyLock::new(|| {
        let brushes = BrushKind::ALL.iter().map(|k| brush(*k));
        let pages = Tab::ALL.into_iter().map(|(tab, name, about)| {
            let name = format!("Page: {name}");
            ActionEntry {
                action: Action::Page(tab),
                name: name.into(),
                keys: None,
                also: format!("{} {}", about.to_lowercase(), also_of_page(tab)).into(),
            }
        });
        FIXED.iter().cloned().chain(brushes).chain(pages).collect()
    });
    &ALL
}

const FIXED: &[ActionEntry] = &[
    entry(Action::Undo, "Undo", ctrl(Key::Z), "back"),
    entry(Action::Redo, "Redo", ctrl_shift(Key::Z), "again"),
    entry(Action::Carve, "Carve or raise", key(Key::X), "invert negative dig subtract"),
    entry(Action::Larger, "Larger brush", key(Key::CloseBracket), "radius size"),
    entry(Action::Smaller, "Smaller brush", key(Key::OpenBracket), "radius size"),
    entry(Action::Stronger, "Stronger brush", shift(Key::CloseBracket), "strength intensity"),
    entry(Action::Weaker, "Weaker brush", shift(Key::OpenBracket), "strength intensity"),
    entry(Action::DragRadius, "Drag the radius", key(Key::F), "brush size modal"),
    entry(Action::DragStrength, "Drag the strength", shift(Key::F), "brush intensity modal"),
    entry(Action::SampleColour, "Sample the colour", key(Key::C), "eyedropper paint pick"),
    entry(Action::MirrorX, "Mirror over x", ctrl(Key::Num1), "symmetry"),
    entry(Action::MirrorY, "Mirror over y", ctrl(Key::Num2), "symmetry"),
    entry(Action::MirrorZ, "Mirror over z", ctrl(Key::Num3), "symmetry"),
    entry(Action::Frame, "Frame the sculpture", key(Key::Home), "view all fit camera"),
    entry(Action::Front, "View from the front", key(Key::Num7), "camera"),
    entry(Action::Back, "View from behind", shift(Key::Num7), "camera back"),
    entry(Action::Right, "View from the right", key(Key::Num8), "camera"),
    entry(Action::Left, "View from the left", shift(Key::Num8), "camera"),
    entry(Action::Top, "View from above", key(Key::Num9), "camera top"),
    entry(Action::Bottom, "View from below", shift(Key::Num9), "camera bottom"),
    entry(Action::Perspective, "Perspective or orthographic", key(Key::Num5), "camera parallel"),
    entry(
        Action::FourViews,
        "Four views or one",
        key(Key::Num4),
        "camera split quad front right top orthographic",
    ),
    entry(Action::NextMaterial, "Next material", key(Key::M), "matcap colour"),
    entry(Action::Facets, "Smooth or flat shading", ctrl(Key::F), "facets"),
    entry(Action::Ssao, "Ambient occlusion", shift(Key::H), "shade hollows cavity depth"),
    entry(Action::Shadows, "Shadows", None, "cast light sun dark"),
    entry(Action::Wireframe, "Wireframe", key(Key::W), "edges triangles"),
    entry(Action::Grid, "Grid", key(Key::G), "floor"),
    entry(Action::Thickness, "Thickness map", key(Key::T), "wall analysis"),
    entry(Action::Gap, "Gap map", None, "clearance wall check analysis"),
    entry(Action::Mask, "Mask map", shift(Key::M), "protect"),
    entry(Action::Distance, "Distance map", shift(Key::D), "deviation compare reference analysis"),
    entry(Action::Overhang, "Overhang map", None, "print support check analysis angle"),
    entry(Action::DraftAngle, "Draft map", None, "mould check analysis angle undercut"),
    entry(Action::TrimBox, "Trim by a box", None, "cut off plane lasso"),
    entry(Action::TrimLine, "Trim by a line", None, "cut off plane"),
    entry(Action::RegionLasso, "Region by a lasso", key(Key::L), "mask hide select freehand"),
    entry(Action::RegionBox, "Region by a box", key(Key::B), "mask hide select rectangle border"),
    entry(Action::RegionLine, "Region by a line", shift(Key::L), "mask hide select side"),
    entry(Action::RegionPolyline, "Region by a polyline", shift(Key::B), "mask hide polygon"),
    entry(Action::RegionMask, "Mask a region", None, "lasso box protect"),
    entry(Action::RegionUnmask, "Unmask a region", None, "lasso box free"),
    entry(Action::RegionHide, "Hide a region", None, "lasso box invisible"),
    entry(Action::RegionIsolate, "Show only a region", None, "lasso box isolate hide"),
    entry(Action::RegionFaceSet, "Face set of a region", None, "lasso box group polygroup"),
    entry(Action::Finer, "Finer level", ctrl(Key::PageUp), "subdivide multires detail"),
    entry(Action::Coarser, "Coarser level", ctrl(Key::PageDown), "multires shape"),
    entry(Action::Remesh, "Remesh", ctrl(Key::R), "voxel even triangles dynamesh retopology"),
    entry(Action::TryAdd, "Preview: add the held object", None, "boolean union try join"),
    entry(
        Action::TryCut,
        "Preview: cut with the held object",
        None,
        "boolean difference try join carve",
    ),
    entry(Action::TryKeep, "Preview: keep what both share", None, "boolean intersection try join"),
    entry(Action::New, "New sculpture", ctrl(Key::N), "begin start fresh ball file"),
    entry(Action::OpenMesh, "Open a mesh", ctrl(Key::O), "file load import"),
    entry(Action::Export, "Export the mesh", ctrl(Key::E), "file save stl obj ply"),
    entry(Action::Screenshot, "Screenshot", key(Key::F12), "picture png"),
    entry(Action::Turntable, "Turntable frames", ctrl(Key::F12), "animation film pictures png"),
    entry(Action::Search, "Search actions", ctrl(Key::K), "find command palette"),
    entry(Action::Panels, "Panels", key(Key::N), "hide show full view"),
    entry(Action::LightOrDark, "Light or dark", None, "theme preferences"),
    entry(Action::LargerText, "Larger text", ctrl(Key::Plus), "scale zoom"),
    entry(Action::SmallerText, "Smaller text", ctrl(Key::Minus), "scale zoom"),
    entry(Action::Lesson, "First lesson", None, "tutorial learn help begin hints"),
    entry(Action::Help, "Help", key(Key::F1), "manual what how"),
    entry(Action::Keys, "Change the keys", None, "shortcuts hotkeys keyboard blender zbrush"),
];

impl Action {
    pub fn entry(self) -> &'static ActionEntry {
        let all = all();
        all.iter().find(|e| e.action == self).unwrap_or(&all[0])
    }

    /// Returns its name, in the language of this thread.
    pub fn title(self) -> String {
        match self {
            Action::Brush(kind) => tr!("action-brush", brush = brush_title(kind)),
            Action::Page(tab) => tr!("action-page", page = tab.title()),
            _ => text_or(&format!("action-{}", self.id()), &self.entry().name),
        }
    }

    /// The name in the file of preferences: `mirror-x`, `brush-clay-strips`, `page-look`.
    pub fn id(self) -> String {
        match self {
            Action::Brush(kind) => format!("brush-{}", kind.name()),
            Action::Page(tab) => tab.id().to_owned(),
            _ => kebab(&format!("{self:?}")),
        }
    }
}

/// `MirrorX` becomes `mirror-x`.
fn kebab(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.char_indices() {
        if i > 0 && c.is_uppercase() {
            out.push('-');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// The brush after an action, where the action is one of the brush.
pub fn on_brush(action: Action, mut brush: BrushSettings) -> Option<Command> {
    match action {
        Action::Carve => brush.negative = !brush.negative,
        Action::Larger => brush.radius *= 1.1,
        Action::Smaller => brush.radius /= 1.1,
        Action::Stronger => brush.strength = (brush.strength * 1.1).max(0.01),
        Action::Weaker => brush.strength /= 1.1,
        Action::MirrorX => brush.symmetry[0] ^= true,
        Action::MirrorY => brush.symmetry[1] ^= true,
        Action::MirrorZ => brush.symmetry[2] ^= true,
        _ => return None,
    }
    Some(Command::Brush(brush.clamped()))
}

/// Actions that hold every word of a search, best first: a name that begins with it, then names,
/// then other words. A name is found in the language of this thread and in English, and a brush
/// also as files write it: `clay-strips`.
pub fn search(text: &str) -> Vec<&'static ActionEntry> {
    let text = text.to_lowercase().replace(['-', '_'], " ");
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut found: Vec<(u8, &ActionEntry)> = all()
        .iter()
        .filter_map(|e| {
            let names = [e.action.title(), e.name.to_string()]
                .map(|n| n.to_lowercase().replace(['-', '_'], " "));
            let in_name = |w: &str| names.iter().any(|name| name.contains(w));
            let about = match e.action {
                Action::Page(tab) => tab.about().to_lowercase(),
                _ => String::new(),
            };
            let holds = |w: &&str| in_name(w) || e.also.contains(*w) || about.contains(*w);
            let rank = if names.iter().any(|name| name.starts_with(text.trim())) {
                0
            } else if words.iter().all(|w| in_name(w)) {
                1
            } else {
                2
            };
            words.iter().all(holds).then_some((rank, e))
        })
        .collect();
    found.sort_by_key(|f| f.0);
    found.into_iter().map(|f| f.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language;

    #[test]
    fn every_action_stands_once_and_has_a_name_of_its_own_in_files() {
        for (i, a) in all().iter().enumerate() {
            for b in &all()[i + 1..] {
                assert_ne!(a.action, b.action);
                assert_ne!(a.action.id(), b.action.id());
                assert_ne!(a.name, b.name);
            }
        }
        assert_eq!(Action::MirrorX.id(), "mirror-x");
        assert_eq!(Action::Brush(BrushKind::ClayStrips).id(), "brush-clay-strips");
        assert_eq!(Action::Page(Tab::Look).id(), "page-look");
    }

    #[test]
    fn a_search_finds_the_words_of_the_language_and_the_english_ones() {
        let languages = language::tests::of_config("it_IT");
        language::set_current(languages.choose(""));
        for text in ["spessore", "thick", "analysis"] {
            let found = search(text);
            assert!(found.iter().any(|e| e.action == Action::Thickness), "{text}");
        }
        assert_eq!(search("annulla")[0].action, Action::Undo);
        assert_eq!(search("lingua")[0].action, Action::Page(Tab::More));
        assert_eq!(search("undo")[0].action, Action::Undo);
        assert_eq!(search("clay-strips")[0].action, Action::Brush(BrushKind::ClayStrips));
        assert_eq!(Action::Brush(BrushKind::Smooth).entry().name, "Smooth brush");
        assert_ne!(Action::Brush(BrushKind::Smooth).title(), "Smooth brush");
    }

    #[test]
    fn a_search_finds_by_name_and_by_other_words() {
        language::set_current(language::tests::of_config("").english());
        assert_eq!(search("thick")[0].action, Action::Thickness);
        assert_eq!(search("stl")[0].action, Action::Export);
        assert_eq!(search("clay")[0].action, Action::Brush(BrushKind::Clay));
        assert_eq!(search("paint")[0].action, Action::Brush(BrushKind::Paint));
        assert_eq!(search("language")[0].action, Action::Page(Tab::More));
        assert_eq!(search("shortcuts")[0].action, Action::Keys);
        assert!(search("timing").iter().any(|e| e.action == Action::Page(Tab::Loop)));
        assert_eq!(search("").len(), all().len());
        assert!(search("quux").is_empty());
    }
}
