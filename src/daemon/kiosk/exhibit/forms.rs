//! The exhibits that come with the program, made by formula: a figurine in its block, a pot on the
//! wheel, a broken relief. Lengths in millimetres.

use glam::{DVec2, DVec3, dvec2, dvec3};

use super::create::block;
use super::{Exhibit, Manifest, StepManifest, Texts, pack};
use sculptd_geometry::TriMesh;
use sculptd_geometry::implicit::surface;
use sculptd_geometry::job::Job;
use sculptd_geometry::offset::smooth_min;

/// Names of the exhibits that come with the program.
pub const NAMES: [&str; 3] = ["figurine", "pot", "relief"];
/// Samples along the longest side of a form: about 60,000 vertices.
const SIDE: usize = 150;

/// Returns the exhibit `name`; `None`: there is none of this name.
///
/// # Errors
/// Returns a message if the job was cancelled.
pub fn make(name: &str, job: &Job) -> Option<Result<Exhibit, String>> {
    Some(match name {
        "figurine" => figurine_exhibit(job),
        "pot" => pot_exhibit(job),
        "relief" => relief_exhibit(job),
        _ => return None,
    })
}

fn texts(all: [&str; 8]) -> Texts {
    let codes = ["en", "de", "el", "es", "fr", "it", "ja", "zh"];
    let each = codes.iter().zip(all);
    Texts(each.map(|(code, text)| ((*code).to_owned(), text.to_owned())).collect())
}

fn step(tolerance: f64, tools: &[&str], text: Texts) -> StepManifest {
    let tools = tools.iter().map(|&tool| tool.to_owned()).collect();
    StepManifest { goal: GOAL.into(), tolerance, tools, ghost: true, text }
}

const START: &str = "start.ply";
const GOAL: &str = "goal.ply";

fn manifest(
    (radius, strength, symmetry): (f32, f32, u8),
    title: Texts,
    step: Vec<StepManifest>,
) -> Manifest {
    Manifest { start: START.into(), minutes: 8.0, radius, strength, symmetry, title, step }
}

fn exhibit(
    (name, manifest): (&str, Manifest),
    (start, goal): (TriMesh, TriMesh),
    job: &Job,
) -> Result<Exhibit, String> {
    pack::of_meshes(name, &manifest, &[(START, &start), (GOAL, &goal)], job)
}

/// A scaled ball: its sign is right everywhere and its slope near the surface at most 1.
fn ellipsoid(p: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    (((p - centre) / radii).length() - 1.0) * radii.min_element()
}

/// A limb: a segment with a radius.
fn capsule(p: DVec3, a: DVec3, b: DVec3, radius: f64) -> f64 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * along) - radius
}

/// A sitting bear, 96 high, on the plane y = 0.
fn bear(p: DVec3) -> f64 {
    let both = dvec3(p.x.abs(), p.y, p.z);
    let body = ellipsoid(p, dvec3(0.0, 32.0, 0.0), dvec3(25.0, 31.0, 22.0));
    let head = ellipsoid(p, dvec3(0.0, 70.0, 2.0), dvec3(20.0, 18.0, 18.0));
    let snout = ellipsoid(p, dvec3(0.0, 66.0, 19.0), dvec3(9.0, 7.0, 8.0));
    let ear = ellipsoid(both, dvec3(15.0, 87.0, 0.0), dvec3(8.0, 9.0, 5.5));
    let arm = capsule(both, dvec3(22.0, 46.0, 6.0), dvec3(19.0, 28.0, 22.0), 7.5);
    let leg = capsule(both, dvec3(16.0, 10.0, 8.0), dvec3(19.0, 9.5, 30.0), 9.5);
    let limbs = smooth_min(arm, leg, 2.0);
    let face = smooth_min(smooth_min(head, snout, 4.0), ear, 3.0);
    // It sits flat.
    smooth_min(smooth_min(body, limbs, 4.0), face, 6.0).max(-p.y)
}

fn figurine_exhibit(job: &Job) -> Result<Exhibit, String> {
    let (lo, hi) = (dvec3(-34.0, 0.0, -24.0), dvec3(34.0, 98.0, 42.0));
    let goal = surface(bear, (lo, hi), SIDE, job).map_err(|e| e.to_string())?;
    let (lo, hi) = goal.bounds();
    let start = block((lo.as_dvec3() - 3.0, hi.as_dvec3() + 3.0), SIDE, job)?;
    let text = texts([
        "A bear sits in this block. Carve away what is too much.",
        "In diesem Block sitzt ein Bär. Trage ab, was zu viel ist.",
        "Μια αρκούδα κάθεται σε αυτόν τον όγκο. Αφαίρεσε ό,τι περισσεύει.",
        "Hay un oso en este bloque. Quita lo que sobra.",
        "Un ours est assis dans ce bloc. Enlève ce qui est en trop.",
        "C'è un orso in questo blocco. Togli quello che è di troppo.",
        "このブロックの中に熊がいます。余分なところを削ってください。",
        "这块料里坐着一只熊。把多余的部分削掉。",
    ]);
    let title = texts([
        "The bear in the block",
        "Der Bär im Block",
        "Η αρκούδα στον όγκο",
        "El oso en el bloque",
        "L'ours dans le bloc",
        "L'orso nel blocco",
        "ブロックの中の熊",
        "石块里的熊",
    ]);
    let step = vec![step(2.0, &["carve", "add", "smooth"], text)];
    let manifest = manifest((0.18, 1.0, 1), title, step);
    exhibit(("figurine", manifest), (start, goal), job)
}

/// The outside of the pot at a height: its radius.
fn pot_radius(y: f64) -> f64 {
    let x = (y / 84.0).clamp(0.0, 1.0);
    22.0 + 20.0 * (x * std::f64::consts::PI * 0.95).sin().powi(2) - 4.0 * x
}

/// A pot, 84 high, with walls of 6 to 7 and a rounded rim; hollow from above.
fn pot(p: DVec3) -> f64 {
    let across = dvec2(p.x, p.z).length();
    let outside = (across - pot_radius(p.y)).max(p.y - 84.0).max(-p.y);
    let inside = (across - (pot_radius(p.y) - 7.0)).max(8.0 - p.y);
    -smooth_min(-outside, inside, 4.0)
}

/// A lump of clay on the wheel with the beginning of a hollow.
fn lump(p: DVec3) -> f64 {
    let across = dvec2(p.x, p.z).length();
    let outside = -smooth_min(-(across - 34.0), -(p.y - 66.0).max(-p.y), 12.0);
    let hollow = ellipsoid(p, dvec3(0.0, 66.0, 0.0), dvec3(20.0, 26.0, 20.0));
    -smooth_min(-outside, hollow, 6.0)
}

fn pot_exhibit(job: &Job) -> Result<Exhibit, String> {
    let bounds = (dvec3(-44.0, 0.0, -44.0), dvec3(44.0, 86.0, 44.0));
    let goal = surface(pot, bounds, SIDE, job).map_err(|e| e.to_string())?;
    let start = surface(lump, bounds, SIDE, job).map_err(|e| e.to_string())?;
    let text = texts([
        "The wheel turns: each stroke goes all the way round. Pull up the pot.",
        "Die Scheibe dreht sich: jeder Strich geht ganz herum. Zieh den Topf hoch.",
        "Ο τροχός γυρίζει: κάθε κίνηση κάνει όλο τον κύκλο. Σήκωσε το αγγείο.",
        "El torno gira: cada trazo da la vuelta entera. Levanta la vasija.",
        "Le tour tourne : chaque trait fait le tour. Monte le pot.",
        "Il tornio gira: ogni tratto fa il giro completo. Alza il vaso.",
        "ろくろが回り、一筆が一周します。壺を引き上げてください。",
        "转盘在转：每一笔都绕一整圈。把罐子拉起来。",
    ]);
    let title = texts([
        "A pot on the wheel",
        "Ein Topf auf der Scheibe",
        "Ένα αγγείο στον τροχό",
        "Una vasija en el torno",
        "Un pot sur le tour",
        "Un vaso al tornio",
        "ろくろの壺",
        "转盘上的罐子",
    ]);
    let step = vec![step(2.5, &["grab", "add", "carve", "smooth"], text)];
    let manifest = manifest((0.3, 0.0, 16), title, step);
    exhibit(("pot", manifest), (start, goal), job)
}

/// Size of the relief's plate, and where its picture begins.
const PLATE: DVec3 = dvec3(120.0, 90.0, 8.0);

/// Height of the relief's picture over the plate: a sun over waves.
fn sun_over_waves(p: DVec2) -> f64 {
    let smooth = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let from_sun = p - dvec2(0.0, 12.0);
    let away = from_sun.length();
    let disc = 7.0 * smooth((17.0 - away) / 4.0);
    let turn = from_sun.y.atan2(from_sun.x);
    let rays = smooth(((turn * 12.0).cos() - 0.1) * 2.0)
        * smooth((away - 20.0) / 2.0)
        * smooth((33.0 - away) / 4.0);
    let crest = -24.0 + 3.0 * (p.x / 9.0).sin();
    let water = smooth((crest - p.y) / 3.0) * (3.0 + 2.0 * ((p.y + p.x * 0.1) / 2.6).sin());
    disc.max(4.0 * rays).max(water)
}

/// The relief; `broken`: a part of its picture has fallen off.
fn relief(p: DVec3, broken: bool) -> f64 {
    let q = dvec2(p.x, p.y);
    let edge = (PLATE.x * 0.5 - q.x.abs()).min(PLATE.y * 0.5 - q.y.abs());
    // The picture ends before the plate's edge.
    let mut height = sun_over_waves(q) * (edge / 4.0).clamp(0.0, 1.0);
    if broken {
        let from_gap = q - dvec2(20.0, -2.0);
        let ragged = 26.0 + 3.0 * (from_gap.y.atan2(from_gap.x) * 7.0).sin();
        height *= ((from_gap.length() - ragged) / 2.0).clamp(0.0, 1.0);
    }
    // The slope of the picture is up to about 3: the field is flattened by as much.
    let top = (p.z - PLATE.z - height) * 0.5;
    let sides = (q.abs() - dvec2(PLATE.x, PLATE.y) * 0.5).max_element();
    top.max(sides).max(-p.z)
}

fn relief_exhibit(job: &Job) -> Result<Exhibit, String> {
    let half = dvec3(PLATE.x * 0.5, PLATE.y * 0.5, 0.0);
    let bounds = (-half, half + DVec3::Z * (PLATE.z + 8.0));
    let side = SIDE * 3 / 2;
    let [goal, start] =
        [false, true].map(|broken| surface(|p| relief(p, broken), bounds, side, job));
    let (goal, start) = (goal.map_err(|e| e.to_string())?, start.map_err(|e| e.to_string())?);
    let text = texts([
        "A piece of this relief is lost. Model it anew.",
        "Ein Stück dieses Reliefs fehlt. Modelliere es neu.",
        "Ένα κομμάτι του ανάγλυφου λείπει. Πλάσε το ξανά.",
        "Falta un trozo de este relieve. Vuelve a modelarlo.",
        "Un morceau de ce relief manque. Modèle-le à nouveau.",
        "Manca un pezzo di questo rilievo. Modellalo di nuovo.",
        "この浮き彫りは一部が欠けています。作り直してください。",
        "这块浮雕缺了一块。请把它重新塑好。",
    ]);
    let title = texts([
        "The broken relief",
        "Das zerbrochene Relief",
        "Το σπασμένο ανάγλυφο",
        "El relieve roto",
        "Le relief brisé",
        "Il rilievo spezzato",
        "欠けた浮き彫り",
        "残缺的浮雕",
    ]);
    let step = vec![step(1.0, &["add", "carve", "smooth"], text)];
    let manifest = manifest((0.06, 0.0, 1), title, step);
    exhibit(("relief", manifest), (start, goal), job)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::check;

    #[test]
    fn every_form_is_a_closed_solid_and_is_not_solved_at_the_start() {
        let job = Job::default();
        for name in NAMES {
            let made = make(name, &job).expect("known").expect("made");
            let goal = made.steps[0].goal.as_ref().expect("a goal");
            for (what, mesh) in [("start", &made.start), ("goal", &goal.mesh)] {
                let facts = check::report(&mesh.to_poly(), true, &job).expect("not cancelled");
                assert!(
                    facts.closed && facts.manifold && facts.components == 1,
                    "{name} {what}: {facts:?}"
                );
                assert_eq!(facts.self_intersections, Some(0), "{name} {what}");
                let count = mesh.triangles.len();
                assert!((40_000..400_000).contains(&count), "{name} {what}: {count} triangles");
            }
            let begun = goal.score(&made.start, &job).expect("scored");
            let done = goal.score(&goal.mesh, &job).expect("scored");
            println!("{name}: at the start {begun:?}");
            assert!(begun.percent() == 0 && done.percent() == 100, "{name}: {begun:?} {done:?}");
            assert!(begun.too_much > 1.0 || begun.too_little > 1.0, "{name}: {begun:?}");
        }
        assert!(make("a vase", &job).is_none());
    }
}
