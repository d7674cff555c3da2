//! A new exhibit from a mesh: the mesh is the goal, and the start is a block around it.

use glam::{DVec3, Vec3};

use super::score::Goal;
use super::{Exhibit, Manifest, StepManifest, Texts, pack};
use sculptd_geometry::check::{self, MeshReport};
use sculptd_geometry::decimate::{DecimationTarget, quadric};
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::implicit::surface;
use sculptd_geometry::job::Job;
use sculptd_geometry::remesh::{RemeshSettings, remesh};
use sculptd_geometry::{PolyMesh, TriMesh};

/// Samples along the block's longest side: about 60,000 vertices.
const SIDE: usize = 150;
/// Space between the goal and the block's sides, as a share of the goal's longest side.
const MARGIN: f64 = 0.03;
/// Default tolerance, as a share of the goal's longest side.
const TOLERANCE: f64 = 0.02;
/// Radius of the block's edges, as a share of its shortest side.
const ROUND: f64 = 0.08;
/// A goal of more triangles is decimated to this number: it is drawn and measured all the time.
const GOAL_TRIANGLES: usize = 120_000;

/// Settings of a new exhibit.
#[derive(Debug, Clone, Default)]
pub struct NewExhibit {
    pub name: String,
    /// Title on the screen.
    pub title: Texts,
    /// Text that tells visitors what to do; languages left out have a usual one.
    pub text: Texts,
    /// Tools on the screen; none: carve, add and smooth.
    pub tools: Vec<String>,
    /// Longest time for a visit, minutes; 0: no limit.
    pub minutes: f64,
    /// Scale the goal to this length of its longest side; 0: keep its size.
    pub size: f64,
    /// Distance from the goal up to which a place counts as right; 0: a fiftieth of its longest
    /// side.
    pub tolerance: f64,
    /// The file's z axis points up, as in programs for printing; otherwise its y axis does.
    pub z_up: bool,
}

/// Makes an exhibit. The second value says what was done to the goal, one sentence each.
///
/// # Errors
/// Returns a message if the mesh encloses nothing, or a setting is out of its range.
pub fn create(
    goal: &PolyMesh,
    settings: &NewExhibit,
    job: &Job,
) -> Result<(Exhibit, Vec<String>), String> {
    let found = check::report(goal, true, job).map_err(|e| e.to_string())?;
    let mut notes = doubts(&found);
    let mut plain = goal.triangulate().0;
    let solid = DistanceSolid::build(&plain, job).map_err(|e| e.to_string())?;
    if !solid.topology.closed {
        let settings = RemeshSettings { side: 256, sharp: false };
        let remade = remesh(&plain, &solid, settings, job).map_err(|e| e.to_string())?;
        plain = remade.mesh;
        notes.push("the mesh is not closed: its goal is remeshed to a closed surface".to_owned());
        if let Some(lost) = remade.lost {
            let (area, place) = (lost.area, lost.place);
            notes.push(format!(
                "parts thinner than the new mesh's spacing are lost: {area:.3} square units, for \
                 example at {place}"
            ));
        }
    }
    let found = plain.triangles.len();
    if found > GOAL_TRIANGLES {
        let target =
            DecimationTarget { triangles: GOAL_TRIANGLES, error: f64::INFINITY, single: true };
        let fewer = quadric(&plain.to_poly(), target, job).map_err(|e| e.to_string())?;
        plain = fewer.triangulate().0;
        notes.push(format!("the goal has {} triangles of {found}", plain.triangles.len()));
    }
    if settings.z_up {
        plain.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
    }
    place(&mut plain, settings.size);
    let (lo, hi) = plain.bounds();
    let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
    let longest = (hi - lo).max_element();
    let start = block((lo - longest * MARGIN, hi + longest * MARGIN), SIDE, job)?;
    let tolerance = match settings.tolerance > 0.0 {
        true => settings.tolerance,
        // Two figures, so that the file is easy to read.
        false => two_figures(longest * TOLERANCE),
    };
    let mut text = usual_text();
    if settings.text.0.contains_key("en") {
        // A usual text beside one of the museum's own would contradict it.
        text = Texts::default();
    }
    text.0.extend(settings.text.0.clone());
    let mut tools = settings.tools.clone();
    if tools.is_empty() {
        tools = ["carve", "add", "smooth"].map(str::to_owned).to_vec();
    }
    let step = StepManifest { goal: "goal.ply".into(), tolerance, tools, ghost: true, text };
    let manifest = Manifest {
        start: "start.ply".into(),
        minutes: settings.minutes,
        radius: 0.18,
        strength: 1.0,
        symmetry: 1,
        title: settings.title.clone(),
        step: vec![step],
    };
    let meshes = [("start.ply", &start), ("goal.ply", &plain)];
    Ok((pack::of_meshes(&settings.name, &manifest, &meshes, job)?, notes))
}

/// Returns notes on features of a goal that make it hard to carve.
fn doubts(goal: &MeshReport) -> Vec<String> {
    let mut notes = Vec::new();
    if goal.components > 1 {
        notes.push(format!(
            "the goal has {} separate parts: from one block visitors carve one part, so the score \
             cannot reach 100 %",
            goal.components
        ));
    }
    if let Some(pairs) = goal.self_intersections.filter(|pairs| *pairs > 0) {
        notes.push(format!(
            "{pairs} pairs of its triangles cross: inside and outside may be wrong there; \
             `sculptd convert --mend` may help"
        ));
    }
    if let Some(holes) = goal.genus.filter(|genus| *genus > 0) {
        notes.push(format!(
            "holes that go through: {holes}; they are hard to carve, and a start with the holes in \
             it helps"
        ));
    }
    notes
}

/// Moves a goal to the origin, its lowest point on the plane y = 0, and scales its longest side to
/// `size`; 0 keeps its size.
fn place(goal: &mut TriMesh, size: f64) {
    let (lo, hi) = goal.bounds();
    let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
    let longest = (hi - lo).max_element();
    let scale = if size > 0.0 && longest > 0.0 { size / longest } else { 1.0 };
    let middle = (lo + hi) * 0.5;
    let foot = DVec3::new(middle.x, lo.y, middle.z);
    goal.positions.iter_mut().for_each(|p| *p = ((p.as_dvec3() - foot) * scale).as_vec3());
}

fn two_figures(x: f64) -> f64 {
    let unit = 10f64.powf(x.log10().floor() - 1.0);
    (x / unit).round() * unit
}

fn usual_text() -> Texts {
    let all = [
        ("en", "It is hidden in this block. Carve away what is too much."),
        ("de", "Es steckt in diesem Block. Trage ab, was zu viel ist."),
        ("el", "Κρύβεται σε αυτόν τον όγκο. Αφαίρεσε ό,τι περισσεύει."),
        ("es", "Está escondido en este bloque. Quita lo que sobra."),
        ("fr", "C'est caché dans ce bloc. Enlève ce qui est en trop."),
        ("it", "È nascosto in questo blocco. Togli quello che è di troppo."),
        ("ja", "このブロックの中に隠れています。余分なところを削ってください。"),
        ("zh", "它藏在这块料里。把多余的部分削掉。"),
    ];
    Texts(all.map(|(code, text)| (code.to_owned(), text.to_owned())).into())
}

/// Returns a box with rounded edges, sampled at `side` places along its longest side.
///
/// # Errors
/// Returns a message if the box has no volume.
pub fn block((lo, hi): (DVec3, DVec3), side: usize, job: &Job) -> Result<TriMesh, String> {
    let (middle, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
    let round = half.min_element() * 2.0 * ROUND;
    let field = move |p: DVec3| {
        let q = (p - middle).abs() - half + round;
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - round
    };
    surface(field, (lo, hi), side, job).map_err(|e| e.to_string())
}

/// Returns the goal of a step, counted from 1.
///
/// # Errors
/// Returns a message if the exhibit has no such step, or the step has no goal.
pub fn goal_of(exhibit: &Exhibit, step: usize) -> Result<&Goal, String> {
    let count = exhibit.steps.len();
    let found = step.checked_sub(1).and_then(|i| exhibit.steps.get(i));
    let found = found.ok_or_else(|| format!("expected a step from 1 to {count}, found {step}"))?;
    found.goal.as_deref().ok_or_else(|| format!("step {step} has no goal"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes;

    #[test]
    fn a_goal_stands_on_the_ground_in_a_block_that_holds_it() {
        let job = Job::default();
        let torus = shapes::torus(20.0, 6.0, 96, 48);
        let title = Texts::new("A ring");
        let settings = NewExhibit { size: 100.0, title, ..Default::default() };
        let (made, notes) = create(&torus, &settings, &job).expect("made");
        assert!(notes.len() == 1 && notes[0].contains("through: 1"), "{notes:?}");
        let goal = goal_of(&made, 1).expect("a goal");
        let (lo, hi) = goal.mesh.bounds();
        assert!(lo.y.abs() < 1e-4 && ((hi - lo).max_element() - 100.0).abs() < 1e-3);
        let score = goal.score(&made.start, &job).expect("scored");
        assert!(score.too_little == 0.0 && score.too_much > 2.9, "{score:?}");
        assert_eq!(goal.tolerance, 2.0);
        assert!(goal_of(&made, 2).is_err_and(|e| e.contains("from 1 to 1")));
    }

    #[test]
    fn the_axis_that_points_up_in_the_file_points_up_on_the_screen() {
        let mut post = shapes::uv_sphere(1.0, 16, 32);
        post.positions.iter_mut().for_each(|p| p.z *= 3.0);
        for (z_up, tall) in [(true, 1), (false, 2)] {
            let settings = NewExhibit { title: Texts::new("A post"), z_up, ..Default::default() };
            let (made, _) = create(&post, &settings, &Job::default()).expect("made");
            let goal = goal_of(&made, 1).expect("a goal");
            let (lo, hi) = goal.mesh.bounds();
            assert_eq!((hi - lo).max_position(), tall, "{lo} {hi}");
            assert!(lo.y.abs() < 1e-4);
            // It is turned and not mirrored.
            assert!(goal.score(&goal.mesh, &Job::default()).expect("scored").near > 0.99);
        }
    }

    #[test]
    fn a_goal_in_parts_and_a_goal_that_crosses_itself_are_named() {
        let ball = shapes::icosphere(10.0, 8);
        for (apart, words) in [(30.0, "2 separate parts"), (5.0, "triangles cross")] {
            let mut two = ball.clone();
            two.positions.extend(ball.positions.iter().map(|p| *p + Vec3::X * apart));
            let count = ball.positions.len() as u32;
            two.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + count)));
            let settings = NewExhibit { title: Texts::new("Two"), ..Default::default() };
            let (_, notes) = create(&two.to_poly(), &settings, &Job::default()).expect("made");
            assert!(notes.iter().any(|note| note.contains(words)), "{notes:?}");
        }
    }

    #[test]
    fn an_open_mesh_becomes_a_solid_and_says_so() {
        let mut ball = shapes::uv_sphere(10.0, 32, 64).triangulate().0;
        ball.triangles.truncate(ball.triangles.len() - 20);
        let settings = NewExhibit { title: Texts::new("A ball"), ..Default::default() };
        let made = create(&ball.to_poly(), &settings, &Job::default());
        let (made, notes) = made.expect("made");
        assert!(notes.iter().any(|n| n.contains("not closed")), "{notes:?}");
        assert!(goal_of(&made, 1).is_ok());
    }
}
