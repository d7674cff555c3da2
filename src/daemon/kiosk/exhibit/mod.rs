//! Exhibits: a form that each visitor starts from and, step by step, a goal to sculpt towards.
//!
//! An exhibit is a *pack*: a folder or a `.zip` file with `exhibit.toml` and the meshes that it
//! names ([`pack`]). Three come with the program, made by formula ([`forms`]); others are made from
//! a mesh ([`create`]). How near a work is to its goal is measured by signed distance ([`score`]).

pub mod create;
pub mod forms;
mod open;
pub mod pack;
pub mod score;
pub mod score_thread;

pub use open::open;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use score::Goal;
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};
use sculptd_geometry::TriMesh;
use sculptd_geometry::picture::Picture;

/// Name of the file that describes a pack.
pub const MANIFEST: &str = "exhibit.toml";
/// Most steps of an exhibit.
const MAX_STEPS: usize = 20;
/// Most characters of a text: a line or two on the screen.
const MAX_TEXT: usize = 200;
/// Longest time for a visit, minutes.
const MAX_MINUTES: f64 = 120.0;

/// A text by language code (`en`).
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Texts(pub BTreeMap<String, String>);

impl Texts {
    /// Returns a text that is the same in every language.
    pub fn new(text: &str) -> Texts {
        Texts(BTreeMap::from([("en".to_owned(), text.to_owned())]))
    }

    /// Returns a line of TOML for each text.
    fn lines(&self) -> String {
        self.0.iter().map(|(code, text)| format!("{code} = {}\n", quoted(text))).collect()
    }

    /// Returns the text in the language `code`, or else in English, or else in any.
    pub fn get(&self, code: &str) -> &str {
        let text = self.0.get(code).or_else(|| self.0.get("en"));
        text.or_else(|| self.0.values().next()).map_or("", String::as_str)
    }
}

/// Returns a line of TOML with its remark.
fn remarked((line, remark): (String, &str)) -> String {
    if remark.is_empty() { format!("{line}\n") } else { format!("{line:<20} # {remark}\n") }
}

/// Returns a text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The content of `exhibit.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The mesh file that each visitor starts from.
    pub start: String,
    /// Longest time for a visit, minutes; 0: no limit.
    #[serde(default)]
    pub minutes: f64,
    /// The brush's radius, a share of the object's own; 0: that of the installation.
    #[serde(default)]
    pub radius: f32,
    /// The brush's strength, from 0 to 1; 0: that of the installation.
    #[serde(default)]
    pub strength: f32,
    /// Copies of each stroke around the vertical axis, 1 to 16: more than one for a pot on the
    /// wheel.
    #[serde(default = "one")]
    pub symmetry: u8,
    pub title: Texts,
    pub step: Vec<StepManifest>,
}

/// One `[[step]]` of `exhibit.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepManifest {
    /// The mesh file to sculpt towards; empty: this step has no goal and no score.
    #[serde(default)]
    pub goal: String,
    /// Distance from the goal up to which a place counts as right, in the meshes' unit.
    #[serde(default)]
    pub tolerance: f64,
    /// Tools on the screen, in this order; see [`ExhibitTool`]. Empty: add, carve and smooth.
    #[serde(default)]
    pub tools: Vec<String>,
    /// True to show the goal through the clay.
    #[serde(default = "yes")]
    pub ghost: bool,
    pub text: Texts,
}

fn one() -> u8 {
    1
}

fn yes() -> bool {
    true
}

/// A tool on the screen: `add`, `carve`, `smooth`, or a brush by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExhibitTool {
    pub kind: BrushKind,
    /// True if the brush takes clay away.
    pub negative: bool,
}

impl ExhibitTool {
    pub const ADD: ExhibitTool = ExhibitTool { kind: BrushKind::Clay, negative: false };
    pub const CARVE: ExhibitTool = ExhibitTool { kind: BrushKind::Clay, negative: true };
    pub const SMOOTH: ExhibitTool = ExhibitTool { kind: BrushKind::Smooth, negative: false };
    /// Tools of a visit without an exhibit.
    pub const USUAL: [ExhibitTool; 3] = [ExhibitTool::ADD, ExhibitTool::CARVE, ExhibitTool::SMOOTH];

    fn parse(name: &str) -> Result<ExhibitTool, String> {
        match name {
            "add" => Ok(ExhibitTool::ADD),
            "carve" => Ok(ExhibitTool::CARVE),
            "smooth" => Ok(ExhibitTool::SMOOTH),
            brush => match brush.parse() {
                Ok(kind) => Ok(ExhibitTool { kind, negative: false }),
                Err(e) => Err(format!("tools: expected add, carve, smooth or a brush: {e}")),
            },
        }
    }
}

/// One step of an exhibit, ready for visitors.
#[derive(Debug, Clone)]
pub struct ExhibitStep {
    pub text: Texts,
    pub tools: Vec<ExhibitTool>,
    /// The form to sculpt towards.
    pub goal: Option<Arc<Goal>>,
    /// True to show the goal through the clay.
    pub ghost: bool,
}

/// An exhibit, ready for visitors.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// Name of its folder, its file or its form.
    pub name: String,
    pub manifest: Manifest,
    /// The mesh that each visitor starts from.
    pub start: Arc<TriMesh>,
    /// One or more.
    pub steps: Vec<ExhibitStep>,
    /// The last goal, or the start if there is none.
    pub picture: Arc<Picture>,
}

/// Size of an exhibit's picture, pixels.
pub const PICTURE: [usize; 2] = [400, 300];

impl Exhibit {
    /// Returns the brush that a visitor starts with: the first step's first tool.
    pub fn first_brush(&self, presets: &Presets, now: &BrushSettings) -> BrushSettings {
        let tool = self.steps.first().and_then(|step| step.tools.first());
        let tool = tool.copied().unwrap_or(ExhibitTool::ADD);
        let mut brush = match tool.kind == now.kind {
            true => *now,
            false => presets.switched(now, tool.kind),
        };
        brush.negative = tool.negative;
        if self.manifest.radius > 0.0 {
            brush.radius = self.manifest.radius;
        }
        if self.manifest.strength > 0.0 {
            brush.strength = self.manifest.strength;
        }
        brush.mirror.radial = self.manifest.symmetry;
        brush.mirror.axis = 1;
        brush.clamped()
    }
}

impl Manifest {
    /// Reads the text of `exhibit.toml`.
    ///
    /// # Errors
    /// Names the line, or the key and its range.
    pub fn parse(text: &str) -> Result<Manifest, String> {
        let manifest: Manifest = toml::from_str(text).map_err(|e| e.to_string())?;
        manifest.check()?;
        Ok(manifest)
    }

    /// Returns the text of `exhibit.toml`, with a remark at each key.
    pub fn text(&self) -> String {
        let Manifest { start, minutes, radius, strength, symmetry, title, step } = self;
        let mut text = [
            (format!("start = {}", quoted(start)), "mesh file that each visitor begins with"),
            (format!("minutes = {minutes:?}"), "longest time for a visit; 0: no limit"),
            (
                format!("radius = {radius:?}"),
                "of the brush, a share of the form's own; 0: as usual",
            ),
            (format!("strength = {strength:?}"), "from 0 to 1; 0: as usual"),
            (format!("symmetry = {symmetry}"), "copies around the axis, 16 for a pot on the wheel"),
            (String::new(), ""),
            ("[title]".into(), "by language; one that is left out has the English text"),
        ]
        .map(remarked)
        .concat();
        text += &title.lines();
        for step in step {
            let StepManifest { goal, tolerance, tools, ghost, text: own } = step;
            let tools: Vec<String> = tools.iter().map(|tool| quoted(tool)).collect();
            text += &[
                (String::new(), ""),
                ("[[step]]".into(), "one or more; a button leads from step to step"),
                (
                    format!("goal = {}", quoted(goal)),
                    "closed mesh in the start's place; \"\": no score",
                ),
                (
                    format!("tolerance = {tolerance:?}"),
                    "a place this near to the goal is right, mm",
                ),
                (
                    format!("tools = [{}]", tools.join(", ")),
                    "add, carve, smooth, or brushes by name: grab, inflate",
                ),
                (format!("ghost = {ghost}"), "show the goal through the clay"),
                (String::new(), ""),
                ("[step.text]".into(), "the task"),
            ]
            .map(remarked)
            .concat();
            text += &own.lines();
        }
        text
    }

    fn check(&self) -> Result<(), String> {
        if !(0.0..=MAX_MINUTES).contains(&self.minutes) {
            let minutes = self.minutes;
            return Err(format!("minutes = {minutes}: expected a number from 0 to {MAX_MINUTES}"));
        }
        if !(0.0..=2.0).contains(&self.radius) {
            return Err(format!("radius = {}: expected a number from 0 to 2", self.radius));
        }
        if !(0.0..=1.0).contains(&self.strength) {
            return Err(format!("strength = {}: expected a number from 0 to 1", self.strength));
        }
        if !(1..=16).contains(&self.symmetry) {
            return Err(format!("symmetry = {}: expected 1 to 16", self.symmetry));
        }
        if !(1..=MAX_STEPS).contains(&self.step.len()) {
            let found = self.step.len();
            return Err(format!("expected 1 to {MAX_STEPS} tables [[step]], found {found}"));
        }
        let texts = std::iter::once(&self.title).chain(self.step.iter().map(|s| &s.text));
        for text in texts.flat_map(|t| t.0.values()) {
            let length = text.chars().count();
            if length > MAX_TEXT || text.chars().any(char::is_control) {
                return Err(format!(
                    "\"{text}\": expected one line of at most {MAX_TEXT} characters, found {length}"
                ));
            }
        }
        if self.title.0.is_empty() {
            return Err("title: expected a text, for example title.en = \"A name\"".into());
        }
        for (i, step) in self.step.iter().enumerate() {
            let number = i + 1;
            let tolerance = step.tolerance;
            let is_distance = tolerance > 0.0 && tolerance.is_finite();
            if !step.goal.is_empty() && !is_distance {
                return Err(format!(
                    "step {number}: tolerance = {tolerance}: expected a distance above 0, for the \
                     step has a goal"
                ));
            }
            step.tools().map_err(|e| format!("step {number}: {e}"))?;
        }
        Ok(())
    }
}

impl StepManifest {
    fn tools(&self) -> Result<Vec<ExhibitTool>, String> {
        match self.tools.is_empty() {
            true => Ok(ExhibitTool::USUAL.to_vec()),
            false => self.tools.iter().map(|name| ExhibitTool::parse(name)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
        start = "block.ply"
        minutes = 5
        title = { en = "A bear", de = "Ein Bär" }
        [[step]]
        goal = "goal.ply"
        tolerance = 1.5
        tools = ["carve", "grab"]
        text.en = "Find it"
    "#;

    #[test]
    fn a_manifest_says_what_it_lacks() {
        let manifest = Manifest::parse(TEXT).expect("valid");
        assert_eq!(manifest.title.get("de"), "Ein Bär");
        assert_eq!(manifest.title.get("ja"), "A bear");
        let tools = manifest.step[0].tools().expect("tools");
        assert!(tools[0].negative && tools[1].kind == BrushKind::Grab);
        for (old, new, expected) in [
            ("minutes = 5", "minutes = -1", "minutes = -1"),
            ("minutes = 5", "minutes = nan", "minutes"),
            ("minutes = 5", "strength = 2", "strength = 2"),
            ("tolerance = 1.5", "", "tolerance = 0"),
            ("\"carve\"", "\"chisel\"", "chisel"),
            ("title = {", "titel = {", "titel"),
            ("[[step]]", "symmetry = 99\n[[step]]", "symmetry = 99"),
            ("Find it", &"long ".repeat(50), "at most 200"),
        ] {
            let said = Manifest::parse(&TEXT.replace(old, new)).expect_err(new);
            assert!(said.contains(expected), "{new}: {said}");
        }
        let written = Manifest::parse(&manifest.text()).expect("its own text");
        assert_eq!(written, manifest, "{}", manifest.text());
        // The example of the guide is a file as it is written.
        let guide = include_str!("../../../../config/guide/src/exhibits.md");
        let example = guide.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
        let example = example.expect("an example");
        assert_eq!(Manifest::parse(example).expect("valid").text(), example);
        let none = TEXT.split("[[step]]").next().expect("a text");
        assert!(Manifest::parse(none).is_err_and(|e| e.contains("step")));
    }
}
