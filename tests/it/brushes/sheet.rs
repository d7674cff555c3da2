//! The contact sheet: the same stroke of each brush on the same form, as a picture.
//! `SCULPTD_BLESS=1` redraws it: look at it before you keep it.

use std::path::PathBuf;

use glam::{Vec2, Vec3};
use sculptd_clay::LayerEdit;
use sculptd_clay::brush::{Alpha, BrushKind, BrushSettings, Falloff, Grip};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::TriMesh;
use sculptd_geometry::picture::{Camera, Picture, draw};

use super::super::clay::Dice;
use super::{Studio, form};

const COLUMNS: usize = 6;
const CELL: usize = 160;

/// The stroke: across the form from the left, down in the middle.
fn stroke() -> Vec<(Vec2, f32)> {
    (0..=30)
        .map(|i| {
            let t = i as f32 / 30.0;
            (Vec2::new(0.5 + 0.18 * (t - 0.5) * 2.0, 0.42 + 0.12 * (t * 5.0).sin()), 0.8)
        })
        .collect()
}

fn cell(kind: BrushKind) -> Picture {
    let held = if kind.grip() == Grip::Surface { 0.14 } else { 0.25 };
    let mut brush = BrushSettings { radius: held, ..sculptd::presets().of(kind) };
    if kind == BrushKind::Texture {
        brush.alpha = Alpha::Rope;
        brush.strength = 0.35;
    }
    // Smoothing brushes need more than one stroke to be visible. Brushes that only move or cut
    // triangles are visible by the triangles' size.
    let cuts = matches!(kind, BrushKind::Density | BrushKind::Simplify);
    let sizes = cuts || matches!(kind, BrushKind::Relax | BrushKind::SlideRelax);
    let evens = matches!(
        kind,
        BrushKind::Smooth
            | BrushKind::Flatten
            | BrushKind::Fill
            | BrushKind::Scrape
            | BrushKind::Relax
            | BrushKind::Plane
            | BrushKind::SurfaceSmooth
    );
    if evens {
        (brush.radius, brush.strength) = (0.2, 1.0);
    }
    let coarse = matches!(
        kind,
        BrushKind::Smooth
            | BrushKind::Relax
            | BrushKind::SlideRelax
            | BrushKind::Density
            | BrushKind::SurfaceSmooth
    );
    let mut start = form(if coarse { 8_000 } else { 60_000 });
    if kind == BrushKind::Simplify {
        brush.topology.edge = 0.4;
    }
    if kind == BrushKind::Relax {
        let mut dice = Dice(5);
        start.positions.iter_mut().for_each(|p| *p += dice.unit().cross(*p) * 0.012);
    }
    let mut studio = Studio::new(&start, brush, 2);
    if kind == BrushKind::MaskBlur {
        // Half of a masked stroke is blurred.
        let mask = BrushSettings {
            radius: 0.14,
            falloff: Falloff::Constant,
            ..sculptd::presets().of(BrushKind::Mask)
        };
        studio.tell(Command::Brush(mask));
        studio.stroke(&stroke());
        studio.tell(Command::Brush(BrushSettings { radius: 0.3, strength: 1.0, ..brush }));
        for _ in 0..6 {
            studio.stroke(&stroke()[15..]);
        }
    } else if kind == BrushKind::EraseLayer {
        // Half of a stroke on a layer is erased.
        let add = SceneCommand::Layers(LayerEdit::Add("layer".into()));
        studio.tell(Command::Scene(add));
        studio.tell(Command::Brush(sculptd::presets().of(BrushKind::Draw)));
        studio.stroke(&stroke());
        studio.tell(Command::Brush(BrushSettings { radius: 0.2, strength: 1.0, ..brush }));
        for _ in 0..2 {
            studio.stroke(&stroke()[15..]);
        }
    } else if kind == BrushKind::DrawFaceSets {
        // Two sets, the second over the end of the first.
        studio.stroke(&stroke());
        studio.tell(Command::Brush(BrushSettings { radius: 0.25, ..brush }));
        studio.stroke(&stroke()[22..]);
    } else if kind.grip() == Grip::Surface {
        for _ in 0..if evens { 5 } else { 1 } {
            studio.stroke(&stroke());
        }
    } else {
        // Held: a short pull to the upper right.
        let pull: Vec<_> = (0..=12)
            .map(|i| (Vec2::new(0.53, 0.5) + Vec2::new(0.012, -0.012) * i as f32, 0.8))
            .collect();
        studio.stroke(&pull);
    }
    let mesh = studio.world.mesh().to_tri();
    let mut tints = vec![[190u8, 180, 170]; mesh.positions.len()];
    if let Some(colours) = &mesh.colours {
        for (tint, c) in tints.iter_mut().zip(colours).filter(|(_, c)| **c != [255; 4]) {
            *tint = [c[0], c[1], c[2]].map(|c| (f32::from(c) * 0.75) as u8);
        }
    }
    if sizes {
        tint_by_size(&mesh, &mut tints);
    }
    let clay = studio.world.mesh();
    if !cuts {
        for p in 0..clay.page_count() as u32 {
            let page = clay.page(p);
            for v in 0..page.own() {
                let free = 1.0 - 0.7 * page.mask(v);
                let tint = &mut tints[page.topology().ids[v] as usize];
                *tint = tint.map(|c| (f32::from(c) * free) as u8);
                if let Some(set) = usize::from(page.face_set(v)).checked_sub(1) {
                    *tint = [[205, 110, 95], [90, 140, 200]][set % 2];
                }
            }
        }
    }
    let camera = Camera {
        target: Vec3::ZERO,
        towards_eye: Vec3::new(0.15, 0.25, 1.0),
        up: Vec3::Y,
        half_height: 1.15,
    };
    draw(&mesh, Some(&tints), &camera, CELL, CELL)
}

/// Dark where triangles are small, light where they are large.
fn tint_by_size(mesh: &TriMesh, tints: &mut [[u8; 3]]) {
    let mut area = vec![(0.0f32, 0.0f32); mesh.positions.len()];
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        for v in mesh.triangles[t] {
            let at = &mut area[v as usize];
            *at = (at.0 + (b - a).cross(c - a).length(), at.1 + 1.0);
        }
    }
    let size = |(sum, n): &(f32, f32)| (sum / n.max(1.0)).sqrt();
    let mut sizes: Vec<f32> = area.iter().map(size).collect();
    sizes.sort_by(f32::total_cmp);
    let usual = sizes[sizes.len() / 2];
    for (tint, at) in tints.iter_mut().zip(&area) {
        let light = (size(at) / usual * 0.8).clamp(0.3, 1.35);
        *tint = tint.map(|c| (f32::from(c) * light).min(255.0) as u8);
    }
}

fn sheet() -> Picture {
    let rows = BrushKind::ALL.len().div_ceil(COLUMNS);
    let (width, height) = (COLUMNS * CELL, rows * CELL);
    let mut all = Picture { width, height, rgb: vec![[255; 3]; width * height] };
    for (i, kind) in BrushKind::ALL.iter().enumerate() {
        let one = cell(*kind);
        let (x, y) = (i % COLUMNS * CELL, i / COLUMNS * CELL);
        for row in 0..CELL {
            let at = (y + row) * width + x;
            all.rgb[at..at + CELL].copy_from_slice(&one.rgb[row * CELL..(row + 1) * CELL]);
        }
    }
    all
}

#[test]
fn every_brush_looks_as_it_did() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sheet/brushes.png");
    let now = sheet();
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        #[allow(clippy::disallowed_methods)] // Under version control: a torn file is seen.
        std::fs::write(&path, now.png().expect("a picture")).expect("written");
        return;
    }
    let then = image::open(&path).expect("the sheet").into_rgb8();
    assert_eq!((then.width() as usize, then.height() as usize), (now.width, now.height));
    for (i, kind) in BrushKind::ALL.iter().enumerate() {
        let (x, y) = (i % COLUMNS * CELL, i / COLUMNS * CELL);
        let mut sum = 0u64;
        for row in y..y + CELL {
            for column in x..x + CELL {
                let then = then.get_pixel(column as u32, row as u32).0;
                let now = now.rgb[row * now.width + column];
                sum += (0..3).map(|k| u64::from(then[k].abs_diff(now[k]))).sum::<u64>();
            }
        }
        let mean = sum as f64 / (3 * CELL * CELL) as f64;
        assert!(mean < 1.0, "{kind}: differs by {mean:.2} of 255 a pixel");
    }
}
