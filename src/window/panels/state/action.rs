//! Everything that can be asked for by name: one table serves the keys, the search, the radial menu
//! and the tooltips.

use egui::Key;

use sculptd_clay::brush::BrushSettings;
use sculptd_engine::command::Command;

/// Something to do, without parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Action {
    Undo,
    Redo,
    Carve,
    Larger,
    Smaller,
    Stronger,
    Weaker,
    DragRadius,
    DragStrength,
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
    NextMaterial,
    Facets,
    Ssao,
    Wireframe,
    Grid,
    Thickness,
    Mask,
    Distance,
    TrimBox,
    TrimLine,
    Finer,
    Coarser,
    Remesh,
    TryAdd,
    TryCut,
    TryKeep,
    OpenMesh,
    Export,
    Screenshot,
    Turntable,
    Search,
    Panels,
    LightOrDark,
    LargerText,
    SmallerText,
    Hints,
}

/// A key with its modifiers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyCombination {
    pub key: Key,
    pub ctrl: bool,
    pub shift: bool,
}

const fn key(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination { key, ctrl: false, shift: false })
}
const fn shift(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination { key, ctrl: false, shift: true })
}
const fn ctrl(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination { key, ctrl: true, shift: false })
}
const fn ctrl_shift(key: Key) -> Option<KeyCombination> {
    Some(KeyCombination { key, ctrl: true, shift: true })
}

impl std::fmt::Display for KeyCombination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ctrl = if self.ctrl { "Ctrl+" } else { "" };
        let shift = if self.shift { "Shift+" } else { "" };
        write!(f, "{ctrl}{shift}{}", self.key.symbol_or_name())
    }
}

/// What an action is called, its keys, and words that find it.
#[derive(Debug, Clone, Copy)]
pub struct ActionEntry {
    pub action: Action,
    pub name: &'static str,
    pub keys: Option<KeyCombination>,
    pub also: &'static str,
}

const fn entry(
    action: Action,
    name: &'static str,
    keys: Option<KeyCombination>,
    also: &'static str,
) -> ActionEntry {
    ActionEntry { action, name, keys, also }
}

pub const ALL: &[ActionEntry] = &[
    entry(Action::Undo, "Undo", ctrl(Key::Z), "back"),
    entry(Action::Redo, "Redo", ctrl_shift(Key::Z), "again"),
    entry(Action::Carve, "Carve or raise", key(Key::X), "invert negative dig subtract"),
    entry(Action::Larger, "Larger brush", key(Key::CloseBracket), "radius size"),
    entry(Action::Smaller, "Smaller brush", key(Key::OpenBracket), "radius size"),
    entry(Action::Stronger, "Stronger brush", shift(Key::CloseBracket), "strength intensity"),
    entry(Action::Weaker, "Weaker brush", shift(Key::OpenBracket), "strength intensity"),
    entry(Action::DragRadius, "Drag the radius", key(Key::F), "brush size modal"),
    entry(Action::DragStrength, "Drag the strength", shift(Key::F), "brush intensity modal"),
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
    entry(Action::NextMaterial, "Next material", key(Key::M), "matcap colour"),
    entry(Action::Facets, "Smooth or flat shading", ctrl(Key::F), "facets"),
    entry(Action::Ssao, "Ambient occlusion", shift(Key::H), "shade hollows cavity depth"),
    entry(Action::Wireframe, "Wireframe", key(Key::W), "edges triangles"),
    entry(Action::Grid, "Grid", key(Key::G), "floor"),
    entry(Action::Thickness, "Thickness map", key(Key::T), "wall analysis"),
    entry(Action::Mask, "Mask map", shift(Key::M), "protect"),
    entry(Action::Distance, "Distance map", shift(Key::D), "deviation compare reference analysis"),
    entry(Action::TrimBox, "Trim by a box", None, "cut off plane lasso"),
    entry(Action::TrimLine, "Trim by a line", None, "cut off plane"),
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
    entry(Action::OpenMesh, "Open a mesh", ctrl(Key::O), "file load import"),
    entry(Action::Export, "Export the mesh", ctrl(Key::E), "file save stl obj ply"),
    entry(Action::Screenshot, "Screenshot", key(Key::F12), "picture png"),
    entry(Action::Turntable, "Turntable frames", ctrl(Key::F12), "animation film pictures png"),
    entry(Action::Search, "Search actions", ctrl(Key::K), "find command palette"),
    entry(Action::Panels, "Panels", key(Key::N), "hide show full view"),
    entry(Action::LightOrDark, "Light or dark", None, "theme preferences"),
    entry(Action::LargerText, "Larger text", ctrl(Key::Plus), "scale zoom"),
    entry(Action::SmallerText, "Smaller text", ctrl(Key::Minus), "scale zoom"),
    entry(Action::Hints, "Show the hints again", None, "help first"),
];

impl Action {
    pub fn entry(self) -> &'static ActionEntry {
        ALL.iter().find(|e| e.action == self).unwrap_or(&ALL[0])
    }

    /// The name, and the keys in brackets: for a tooltip.
    pub fn tip(self) -> String {
        let e = self.entry();
        e.keys.map_or(e.name.to_owned(), |k| format!("{} ({k})", e.name))
    }
}

/// Actions whose keys went down this frame, while nobody types.
pub fn pressed(ctx: &egui::Context) -> Vec<Action> {
    let typing = ctx.text_edit_focused();
    ctx.input(|i| {
        let mut out = Vec::new();
        for event in &i.events {
            let egui::Event::Key { key, physical_key, pressed: true, modifiers, .. } = event else {
                continue;
            };
            let (ctrl, shift) = (modifiers.command || modifiers.ctrl, modifiers.shift);
            let is = |k: Key| *key == k || *physical_key == Some(k);
            // Some keyboards say "=" where "+" is meant.
            let plus = ctrl && *key == Key::Equals;
            out.extend(ALL.iter().filter_map(|e| {
                let k = e.keys?;
                let found = (is(k.key) || (plus && k.key == Key::Plus))
                    && k.ctrl == ctrl
                    && (k.shift == shift || k.key == Key::Plus)
                    && !modifiers.alt;
                (found && (!typing || k.ctrl)).then_some(e.action)
            }));
            if is(Key::Y) && ctrl && !typing {
                out.push(Action::Redo);
            }
        }
        out
    })
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
/// then other words.
pub fn search(text: &str) -> Vec<&'static ActionEntry> {
    let text = text.to_lowercase();
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut found: Vec<(u8, &ActionEntry)> = ALL
        .iter()
        .filter_map(|e| {
            let name = e.name.to_lowercase();
            let holds = |w: &&str| name.contains(*w) || e.also.contains(*w);
            let rank = if name.starts_with(text.trim()) {
                0
            } else if words.iter().all(|w| name.contains(w)) {
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

    #[test]
    fn every_action_stands_once_and_no_two_share_keys() {
        for (i, a) in ALL.iter().enumerate() {
            for b in &ALL[i + 1..] {
                assert_ne!(a.action, b.action);
                assert!(a.keys.is_none() || a.keys != b.keys, "{} and {}", a.name, b.name);
            }
        }
    }

    #[test]
    fn a_search_finds_by_name_and_by_other_words() {
        assert_eq!(search("thick")[0].action, Action::Thickness);
        assert_eq!(search("stl")[0].action, Action::Export);
        assert_eq!(search("").len(), ALL.len());
        assert!(search("quux").is_empty());
    }
}
