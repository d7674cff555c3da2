//! One stroke of each brush and of each option on the same form: readable facts, and a hash that
//! does not depend on the number of workers. `SCULPTD_BLESS=1` rewrites the facts.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use sculptd_clay::LayerEdit;
use sculptd_clay::brush::{
    Alpha, BrushKind, BrushSettings, Falloff, MaskAction, Measure, Method, Picture, PressureCurve,
    StampBy,
};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::{TriMesh, shapes};
use serde::{Deserialize, Serialize};

use super::{Studio, form, s_curve};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Facts {
    about: String,
    dabs: u64,
    /// Vertices that are not where they were.
    displaced: u64,
    /// The longest way in thousandths of the form's radius, and the mean way outwards of those
    /// displaced.
    longest: f64,
    outwards: f64,
    /// Change of volume, per cent.
    volume: f64,
    /// Sum of the mask, and vertices with another colour.
    masked: f64,
    coloured: u64,
    /// Vertices in a face set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    grouped: Option<u64>,
    /// Vertices, where triangles were cut.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vertices: Option<u64>,
    /// Told, and not held across machines.
    hash: String,
}

fn volume(mesh: &TriMesh) -> f64 {
    let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum::<f64>()
        / 6.0
}

/// Draws with this number of workers.
fn draw(
    start: &TriMesh,
    brush: &BrushSettings,
    act: &dyn Fn(&mut Studio) -> u64,
    workers: usize,
) -> (u64, Studio) {
    let mut studio = Studio::new(start, *brush, workers);
    let dabs = act(&mut studio);
    (dabs, studio)
}

fn facts(about: &str, brush: &BrushSettings, act: &(dyn Fn(&mut Studio) -> u64 + Sync)) -> Facts {
    facts_on(&form(60_000), about, brush, act)
}

fn facts_on(
    start: &TriMesh,
    about: &str,
    brush: &BrushSettings,
    act: &(dyn Fn(&mut Studio) -> u64 + Sync),
) -> Facts {
    let (dabs, studio) = draw(start, brush, act, 1);
    studio.world.verify_invariants().unwrap_or_else(|e| panic!("{about}: {e}"));
    let hash = studio.world.hash();
    for workers in [2, 3, 7, 16] {
        // In a separate thread, which takes part in the work of its pool.
        let other = std::thread::scope(|s| {
            s.spawn(|| draw(start, brush, act, workers).1.world.hash()).join()
        });
        assert_eq!(other.expect("no panic"), hash, "{about}: with {workers} workers");
    }
    let end = studio.world.mesh().to_tri();
    let ways = start.positions.iter().zip(&end.positions).filter(|(a, b)| a != b);
    let (mut displaced, mut longest, mut outwards) = (0u64, 0.0f64, 0.0f64);
    for (a, b) in ways {
        displaced += 1;
        let way = (*b - *a).as_dvec3();
        longest = longest.max(way.length());
        outwards += way.dot(a.as_dvec3().normalize());
    }
    let (mut masked, mut grouped) = (0.0, 0);
    for p in 0..studio.world.mesh().page_count() as u32 {
        let page = studio.world.mesh().page(p);
        masked += (0..page.own()).map(|v| f64::from(page.mask(v))).sum::<f64>();
        grouped += (0..page.own()).filter(|v| page.face_set(*v) > 0).count() as u64;
    }
    let round = |v: f64| (v * 1e3).round() / 1e3;
    Facts {
        about: about.into(),
        dabs,
        displaced,
        longest: round(longest * 1e3),
        outwards: round(outwards / displaced.max(1) as f64 * 1e3),
        // A sheet has none.
        volume: if volume(start).abs() < 1e-6 {
            0.0
        } else {
            round((volume(&end) / volume(start) - 1.0) * 100.0)
        },
        masked: round(masked),
        coloured: end.colours.map_or(0, |c| c.iter().filter(|c| **c != [255; 4]).count() as u64),
        grouped: (grouped > 0).then_some(grouped),
        vertices: (end.positions.len() != start.positions.len())
            .then_some(end.positions.len() as u64),
        hash: format!("{hash:016x}"),
    }
}

fn near(name: &str, what: &str, now: f64, then: f64, tolerance: f64) {
    assert!(
        (now - then).abs() <= tolerance,
        "{name}, {what}: {now} now, {then} in the golden facts"
    );
}

fn hold(name: &str, now: &Facts) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(name)
        .join("facts.toml");
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        #[allow(clippy::disallowed_methods)] // Under version control: a torn file is seen.
        std::fs::write(&path, toml::to_string(now).expect("facts are plain")).expect("written");
        return;
    }
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let then: Facts = toml::from_str(&text).expect("golden facts parse");
    println!("{name}: hash {} now, {} when it was written", now.hash, then.hash);
    let share = |v: f64, least: f64| least + v.abs() * 0.02;
    near(name, "dabs", now.dabs as f64, then.dabs as f64, 2.0 + then.dabs as f64 * 0.02);
    near(
        name,
        "displaced",
        now.displaced as f64,
        then.displaced as f64,
        share(then.displaced as f64, 20.0),
    );
    near(name, "longest", now.longest, then.longest, share(then.longest, 0.2));
    near(name, "outwards", now.outwards, then.outwards, share(then.outwards, 0.2));
    near(name, "volume", now.volume, then.volume, share(then.volume, 0.01));
    near(name, "masked", now.masked, then.masked, share(then.masked, 5.0));
    let vertices = |f: &Facts| f.vertices.unwrap_or(0) as f64;
    let grouped = |f: &Facts| f.grouped.unwrap_or(0) as f64;
    near(name, "grouped", grouped(now), grouped(&then), share(grouped(&then), 0.0));
    near(name, "vertices", vertices(now), vertices(&then), share(vertices(&then), 0.0));
    near(
        name,
        "coloured",
        now.coloured as f64,
        then.coloured as f64,
        share(then.coloured as f64, 20.0),
    );
}

#[test]
fn every_brush_draws_as_it_did() {
    for kind in BrushKind::ALL {
        let brush = BrushSettings { radius: 0.2, ..sculptd::presets().of(*kind) };
        let whole = BrushSettings { strength: 1.0, ..brush };
        let mut start = form(60_000);
        if *kind == BrushKind::Boundary {
            // Open to the right of where the stroke begins.
            let right = |t: &[u32; 3]| t.iter().all(|v| start.positions[*v as usize].x > 0.1);
            start.triangles.retain(|t| !right(t));
        }
        let now = facts_on(&start, sculptd::presets().get(*kind).about(), &brush, &|studio| {
            if *kind == BrushKind::MaskBlur {
                // There must be a mask to blur.
                studio.tell(Command::Mask(MaskAction::Cavity(0.1)));
            }
            if *kind == BrushKind::EraseLayer {
                // There must be a layer that does something; half of it is erased.
                let add = SceneCommand::Layers(LayerEdit::Add("layer".into()));
                studio.tell(Command::Scene(add));
                let draw = sculptd::presets().of(BrushKind::Draw);
                studio.tell(Command::Brush(BrushSettings { radius: 0.2, ..draw }));
                studio.stroke(&s_curve());
                studio.tell(Command::Brush(whole));
                let way = s_curve();
                return studio.stroke(&way[way.len() / 2..]);
            }
            studio.stroke(&s_curve())
        });
        let paints = now.masked > 0.0 || now.coloured > 0 || now.grouped.is_some();
        let does = now.displaced > 0 || paints;
        assert!(now.dabs > 0 && does, "{kind} does nothing: {now:?}");
        hold(kind.name(), &now);
    }
}

#[test]
fn every_option_draws_as_it_did() {
    // A dab in a fifth of the radius, whatever the preset has.
    let of = sculptd::presets().of(BrushKind::Gaussian);
    let base = BrushSettings { radius: 0.2, spacing: 0.2, ..of };
    let draw = BrushSettings { radius: 0.2, ..sculptd::presets().of(BrushKind::Draw) };
    let options: Vec<(&str, BrushSettings)> = vec![
        ("negative", BrushSettings { negative: true, ..base }),
        ("symmetric", BrushSettings { symmetry: [true, true, true], ..base }),
        ("saturated", BrushSettings { saturation: 1.5, ..base }),
        ("plane", {
            let mut b = base;
            b.mirror.plane = [1.0, 1.0, 0.2];
            b.mirror.offset = 0.1;
            b
        }),
        ("radial", {
            let mut b = base;
            b.mirror.radial = 5;
            b.mirror.axis = 2;
            b
        }),
        ("continuous", {
            let mut b = base;
            b.path.continuous = true;
            b.path.every_ticks = 1.0;
            b
        }),
        ("dots", with_method(base, Method::Dots)),
        ("airbrush", with_method(base, Method::Airbrush)),
        ("anchored", with_method(base, Method::Anchored)),
        ("drag-dot", with_method(base, Method::DragDot)),
        ("line", with_method(base, Method::Line)),
        ("rope", {
            let mut b = base;
            b.path.rope = 0.05;
            b
        }),
        ("average", {
            let mut b = base;
            b.path.average = 8;
            b
        }),
        ("jitter", {
            let mut b = base;
            b.path.jitter = 0.5;
            b
        }),
        ("compensated", {
            let mut b = base;
            b.path.compensate = true;
            b.spacing = 0.05;
            b
        }),
        ("front-faces", {
            let mut b = base;
            b.auto.front_faces = true;
            b
        }),
        ("auto-topology", {
            let mut b = base;
            b.auto.topology = true;
            b
        }),
        ("auto-normal", {
            let mut b = base;
            b.auto.normal_degrees = 20.0;
            b
        }),
        ("auto-cavity", {
            let mut b = base;
            b.auto.cavity = 1.0;
            b
        }),
    ];
    for (name, brush) in options {
        let now = facts(&format!("the Gaussian brush, {name}"), &brush, &|studio| {
            let points = s_curve();
            let down = studio.stroke(&points);
            let (at, pressure) = points[12];
            let resting = studio.sample(at, pressure, true) + studio.rest(9);
            down + resting + studio.sample(at, 0.0, false) + studio.rest(2)
        });
        assert!(now.displaced > 0, "{name} does nothing");
        hold(&format!("option-{name}"), &now);
    }
    for falloff in Falloff::ALL {
        let name = serde_json::to_value(falloff).expect("a name");
        let name = name.as_str().expect("a name").to_string();
        let now =
            facts(&format!("draw, falloff {name}"), &BrushSettings { falloff, ..draw }, &|s| {
                s.stroke(&s_curve())
            });
        hold(&format!("falloff-{name}"), &now);
    }
}

#[test]
fn every_measure_alpha_and_stamp_draws_as_it_did() {
    let of = |kind: BrushKind, set: &dyn Fn(&mut BrushSettings)| {
        let mut b = BrushSettings { radius: 0.2, ..sculptd::presets().of(kind) };
        if kind == Gaussian {
            b.spacing = 0.2;
        }
        set(&mut b);
        b
    };
    let stamp = |by: StampBy, b: &mut BrushSettings| {
        b.stamp.by = by;
        b.stamp.size = if by == StampBy::Stencil { 0.4 } else { 1.0 };
        b.stamp.turn_degrees = 30.0;
        b.alpha = Alpha::Cracks;
    };
    let cut = |by: Measure, edge: f32, b: &mut BrushSettings| {
        b.topology.by = by;
        b.topology.edge = edge;
    };
    let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
    use BrushKind::{Clay, ClayStrips, Draw, Gaussian, Texture};
    let options = [
        ("tilt", of(Gaussian, &|b| b.tilt = 0.8)),
        ("normal-radius", of(Clay, &|b| b.normal_radius = 1.5)),
        ("plane-trim", of(ClayStrips, &|b| b.plane_trim = 0.05)),
        (
            "pressure-radius",
            of(Gaussian, &|b| b.pressure_radius = PressureCurve { at_zero: 0.1, gamma: 3.0 }),
        ),
        ("pressure-strength", of(Gaussian, &|b| b.pressure_strength = firm)),
        ("curve", with_method(of(Gaussian, &|_| ()), Method::Curve)),
        ("detail-brush", of(Draw, &|b| cut(Measure::Brush, 0.05, b))),
        ("detail-absolute", of(Draw, &|b| cut(Measure::Work, 0.012, b))),
        ("detail-view", of(Draw, &|b| cut(Measure::View, 0.006, b))),
        ("stamp-dab", of(Draw, &|b| stamp(StampBy::Dab, b))),
        ("stamp-view", of(Draw, &|b| stamp(StampBy::View, b))),
        ("stamp-stencil", of(Draw, &|b| stamp(StampBy::Stencil, b))),
        ("stamp-mirrored", {
            let mut b = of(Draw, &|b| stamp(StampBy::Stencil, b));
            b.symmetry = [true, false, false];
            b
        }),
    ];
    for (name, brush) in options {
        let now = facts(&format!("the {} brush, {name}", brush.kind), &brush, &|s| {
            s.tilt = Some(Vec2::new(0.6, -0.3));
            s.stroke(&s_curve())
        });
        assert!(now.displaced > 0, "{name} does nothing");
        hold(&format!("option-{name}"), &now);
    }
    for alpha in Alpha::MADE.into_iter().chain([Alpha::Picture]) {
        let name = serde_json::to_value(alpha).expect("a name");
        let name = name.as_str().expect("a name").to_string();
        let now =
            facts(&format!("texture, alpha {name}"), &of(Texture, &|b| b.alpha = alpha), &|s| {
                // A ramp along and a step across.
                let heights =
                    (0..64u16).map(|i| (i % 8) * 6000 + if i < 32 { 9000 } else { 0 }).collect();
                s.tell(Command::Picture(Arc::new(Picture {
                    width: 8,
                    height: 8,
                    heights,
                    cover: Vec::new(),
                })));
                s.stroke(&s_curve())
            });
        assert!(now.displaced > 0, "{name} does nothing");
        hold(&format!("alpha-{name}"), &now);
    }
    // Over the border of an open sheet.
    let mut brush = of(Gaussian, &|b| b.radius = 0.1);
    brush.auto.boundary = true;
    let sheet = shapes::grid(2.0, 2.0, 120, 120).triangulate().0;
    let now = facts_on(&sheet, "the Gaussian brush over a border that is kept", &brush, &|s| {
        let at: Vec<_> =
            (0..=12).map(|i| (s.view(Vec3::new(0.95, -0.3 + 0.05 * i as f32, 0.0)), 1.0)).collect();
        let dabs = s.stroke(&at);
        let kept = s.positions().iter().filter(|p| p.x == 1.0).all(|p| p.z == 0.0);
        assert!(kept, "the border stays");
        dabs
    });
    hold("option-auto-boundary", &now);
}

fn with_method(mut brush: BrushSettings, method: Method) -> BrushSettings {
    brush.path.method = method;
    brush
}
