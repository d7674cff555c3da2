//! One stroke of each brush and of each option on the same form: readable facts, and a hash that does not depend on the
//! number of workers. `SCULPTD_BLESS=1` writes the facts anew.

use std::path::PathBuf;

use sculptd::brush::{BrushKind, BrushSettings, Falloff, MaskAction, Method};
use sculptd::command::Command;
use sculptd::mesh::TriMesh;
use serde::{Deserialize, Serialize};

use super::{Studio, form, s_curve};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Facts {
    about: String,
    dabs: u64,
    /// Vertices that are not where they were.
    displaced: u64,
    /// The longest way in thousandths of the form's radius, and the mean way outwards of those displaced.
    longest: f64,
    outwards: f64,
    /// Change of volume, per cent.
    volume: f64,
    /// Sum of the mask, and vertices with another colour.
    masked: f64,
    coloured: u64,
    /// Told, and not held across machines.
    hash: String,
}

fn volume(mesh: &TriMesh) -> f64 {
    let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum::<f64>() / 6.0
}

/// What is drawn, with so many workers.
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
    let start = form(60_000);
    let (dabs, studio) = draw(&start, brush, act, 1);
    studio.world.verify_invariants().unwrap_or_else(|e| panic!("{about}: {e}"));
    let hash = studio.world.hash();
    for workers in [2, 3, 7, 16] {
        // A thread of its own: it takes part in the work of its pool.
        let other =
            std::thread::scope(|s| s.spawn(|| draw(&start, brush, act, workers).1.world.hash()).join());
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
    let mut masked = 0.0;
    for p in 0..studio.world.mesh().page_count() as u32 {
        let page = studio.world.mesh().page(p);
        masked += (0..page.own()).map(|v| f64::from(page.mask(v))).sum::<f64>();
    }
    let round = |v: f64| (v * 1e3).round() / 1e3;
    Facts {
        about: about.into(),
        dabs,
        displaced,
        longest: round(longest * 1e3),
        outwards: round(outwards / displaced.max(1) as f64 * 1e3),
        volume: round((volume(&end) / volume(&start) - 1.0) * 100.0),
        masked: round(masked),
        coloured: end.colours.map_or(0, |c| c.iter().filter(|c| **c != [255; 4]).count() as u64),
        hash: format!("{hash:016x}"),
    }
}

fn near(name: &str, what: &str, now: f64, then: f64, tolerance: f64) {
    assert!((now - then).abs() <= tolerance, "{name}, {what}: {now} now, {then} in the golden facts");
}

fn hold(name: &str, now: &Facts) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name).join("facts.toml");
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
    near(name, "displaced", now.displaced as f64, then.displaced as f64, share(then.displaced as f64, 20.0));
    near(name, "longest", now.longest, then.longest, share(then.longest, 0.2));
    near(name, "outwards", now.outwards, then.outwards, share(then.outwards, 0.2));
    near(name, "volume", now.volume, then.volume, share(then.volume, 0.01));
    near(name, "masked", now.masked, then.masked, share(then.masked, 5.0));
    near(name, "coloured", now.coloured as f64, then.coloured as f64, share(then.coloured as f64, 20.0));
}

#[test]
fn every_brush_draws_as_it_did() {
    for kind in BrushKind::ALL {
        let brush = BrushSettings { radius: 0.2, ..BrushSettings::of(*kind) };
        let now = facts(kind.preset().about(), &brush, &|studio| {
            if *kind == BrushKind::MaskBlur {
                // There must be a mask to blur.
                studio.tell(Command::Mask(MaskAction::Cavity(0.1)));
            }
            studio.stroke(&s_curve())
        });
        let does = now.displaced > 0 || now.masked > 0.0 || now.coloured > 0;
        assert!(now.dabs > 0 && does, "{kind} does nothing: {now:?}");
        hold(kind.name(), &now);
    }
}

#[test]
fn every_option_draws_as_it_did() {
    let base = BrushSettings { radius: 0.2, ..BrushSettings::of(BrushKind::Gaussian) };
    let draw = BrushSettings { radius: 0.2, ..BrushSettings::of(BrushKind::Draw) };
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
        let now = facts(&format!("draw, falloff {name}"), &BrushSettings { falloff, ..draw }, &|s| {
            s.stroke(&s_curve())
        });
        hold(&format!("falloff-{name}"), &now);
    }
}

fn with_method(mut brush: BrushSettings, method: Method) -> BrushSettings {
    brush.path.method = method;
    brush
}
