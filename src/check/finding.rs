//! A finding: what is wrong, where, by how much, and what to do about it.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The subject of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// A check that the process asks for could not run.
    NotChecked,
    /// Edges with one face, or with more than two.
    Open,
    /// Faces that disagree on the outside, or a solid that is inside out.
    Orientation,
    /// Triangles that cross each other.
    SelfIntersection,
    /// A shell inside another one that faces the same way: the common matter counts twice.
    NestedShell,
    /// A triangle that is nearly a line.
    Sliver,
    /// A wall below the limit.
    ThinWall,
    /// A pin below the limit: thin across in every direction.
    ThinPin,
    /// A clearance below the limit.
    Gap,
    /// A hole below the limit: narrow across in every direction.
    Hole,
    /// A wall above the limit.
    ThickSection,
    /// A wall much thicker than the nominal one, over which the surface sinks.
    Sink,
    /// A contour that begins with nothing below it.
    Island,
    /// Faces that look down more steeply than the limit.
    Overhang,
    /// A flat ceiling between supports with a span beyond the limit.
    Bridge,
    /// An enclosed cavity.
    TrappedVolume,
    /// A volume that is sealed against the film while the part is built.
    SuctionCup,
    /// Faces with less draft than the limit.
    Draft,
    /// Faces that neither half of the mould releases.
    Undercut,
    /// The clamping force beyond the machine's.
    ClampingForce,
    /// The shot beyond the machine's.
    ShotVolume,
    /// The part falls over.
    Tipping,
    /// The part is larger than the machine.
    Size,
    /// The first layer is too small to hold.
    Contact,
}

impl FindingKind {
    /// Every kind, in order.
    pub const ALL: [FindingKind; 24] = [
        FindingKind::NotChecked,
        FindingKind::Open,
        FindingKind::Orientation,
        FindingKind::SelfIntersection,
        FindingKind::NestedShell,
        FindingKind::Sliver,
        FindingKind::ThinWall,
        FindingKind::ThinPin,
        FindingKind::Gap,
        FindingKind::Hole,
        FindingKind::ThickSection,
        FindingKind::Sink,
        FindingKind::Island,
        FindingKind::Overhang,
        FindingKind::Bridge,
        FindingKind::TrappedVolume,
        FindingKind::SuctionCup,
        FindingKind::Draft,
        FindingKind::Undercut,
        FindingKind::ClampingForce,
        FindingKind::ShotVolume,
        FindingKind::Tipping,
        FindingKind::Size,
        FindingKind::Contact,
    ];

    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            FindingKind::NotChecked => "not-checked",
            FindingKind::Open => "open",
            FindingKind::Orientation => "orientation",
            FindingKind::SelfIntersection => "self-intersection",
            FindingKind::NestedShell => "nested-shell",
            FindingKind::Sliver => "sliver",
            FindingKind::ThinWall => "thin-wall",
            FindingKind::ThinPin => "thin-pin",
            FindingKind::Gap => "gap",
            FindingKind::Hole => "hole",
            FindingKind::ThickSection => "thick-section",
            FindingKind::Sink => "sink",
            FindingKind::Island => "island",
            FindingKind::Overhang => "overhang",
            FindingKind::Bridge => "bridge",
            FindingKind::TrappedVolume => "trapped-volume",
            FindingKind::SuctionCup => "suction-cup",
            FindingKind::Draft => "draft",
            FindingKind::Undercut => "undercut",
            FindingKind::ClampingForce => "clamping-force",
            FindingKind::ShotVolume => "shot-volume",
            FindingKind::Tipping => "tipping",
            FindingKind::Size => "size",
            FindingKind::Contact => "contact",
        }
    }
}

/// The weight of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// A limit is broken, or a check could not run.
    Error,
    /// Worth a look: an advised value is not reached.
    Warning,
}

/// A finding. Lengths are in millimetres, positions in the file's coordinates in millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The subject.
    pub kind: FindingKind,
    /// The weight.
    pub severity: Severity,
    /// The place; `None` for a finding of the whole part.
    pub position: Option<[f64; 3]>,
    /// The measured value.
    pub value: Option<f64>,
    /// The limit that it was compared with.
    pub limit: Option<f64>,
    /// The unit of `value` and `limit`.
    pub unit: &'static str,
    /// The area of the region, mm2, where it has one.
    pub area: Option<f64>,
    /// The greatest error of `value`; 0 where it is exact up to rounding.
    pub error: f64,
    /// One sentence: what it is and what to do.
    pub message: String,
}

impl Finding {
    /// Creates an error without value and place.
    pub fn new(kind: FindingKind, message: impl Into<String>) -> Finding {
        Finding {
            kind,
            severity: Severity::Error,
            position: None,
            value: None,
            limit: None,
            unit: "",
            area: None,
            error: 0.0,
            message: message.into(),
        }
    }

    /// Creates the finding that `check` could not run, and why.
    pub fn not_checked(check: &str, why: &str) -> Finding {
        Finding::new(FindingKind::NotChecked, format!("not checked: {check}, because {why}"))
    }

    /// Sets the place.
    pub fn at(mut self, position: DVec3) -> Finding {
        self.position = Some(position.to_array());
        self
    }

    /// Sets the value, its limit and their unit.
    pub fn measured(mut self, value: f64, limit: f64, unit: &'static str) -> Finding {
        (self.value, self.limit, self.unit) = (Some(value), Some(limit), unit);
        self
    }

    /// Sets the area.
    pub fn over(mut self, area: f64) -> Finding {
        self.area = Some(area);
        self
    }

    /// Sets the greatest error of the value.
    pub fn within(mut self, error: f64) -> Finding {
        self.error = error;
        self
    }

    /// Makes it a warning.
    pub fn warning(mut self) -> Finding {
        self.severity = Severity::Warning;
        self
    }
}

/// The greatest number of findings of one kind in an answer; the rest is counted in a warning.
pub const MOST_OF_A_KIND: usize = 100;

/// Sorts findings by severity and kind, the worst of a kind first as they come, and cuts each kind
/// at [`MOST_OF_A_KIND`]. Returns a sentence for each kind that was cut.
pub(crate) fn arrange(findings: &mut Vec<Finding>) -> Vec<String> {
    findings.sort_by_key(|f| (f.severity, f.kind));
    let mut cut = Vec::new();
    let mut kept: Vec<Finding> = Vec::with_capacity(findings.len());
    for group in findings.chunk_by(|a, b| (a.severity, a.kind) == (b.severity, b.kind)) {
        kept.extend_from_slice(&group[..group.len().min(MOST_OF_A_KIND)]);
        if group.len() > MOST_OF_A_KIND {
            let (rest, name) = (group.len() - MOST_OF_A_KIND, group[0].kind.name());
            cut.push(format!("{rest} more findings of kind {name} are not listed"));
        }
    }
    *findings = kept;
    cut
}
