//! The contact sheet: the same stroke of each brush on the same form, as a picture; and the same
//! strokes from nearby, which the window shows on the brushes' buttons. `SCULPTD_BLESS=1` redraws
//! both: look at them before you keep them.

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

/// A sheet of pictures, one a brush in the order of [`BrushKind::ALL`].
struct Sheet {
    path: &'static str,
    /// Pixels of a picture.
    cell: (usize, usize),
    camera: Camera,
    /// For buttons: a shorter stroke, and relief where the brush evens, so that a small picture
    /// tells it from others.
    small: bool,
}

const SHEETS: [Sheet; 2] = [
    Sheet {
        path: "tests/golden/sheet/brushes.png",
        cell: (160, 160),
        camera: Camera {
            target: Vec3::ZERO,
            towards_eye: Vec3::new(0.15, 0.25, 1.0),
            up: Vec3::Y,
            half_height: 1.15,
        },
        small: false,
    },
    // The clay fills each picture of the buttons.
    Sheet {
        path: "src/window/panels/brush_pictures.png",
        cell: (132, 84),
        camera: Camera {
            target: Vec3::new(0.0, 0.06, 0.0),
            towards_eye: Vec3::new(0.15, 0.25, 1.0),
            up: Vec3::Y,
            half_height: 0.5,
        },
        small: true,
    },
];

/// The stroke: across the form from the left, down in the middle.
fn stroke(small: bool) -> Vec<(Vec2, f32)> {
    let (wide, high) = if small { (0.14, 0.09) } else { (0.18, 0.12) };
    (0..=30)
        .map(|i| {
            let t = i as f32 / 30.0;
            (Vec2::new(0.5 + wide * (t - 0.5) * 2.0, 0.42 + high * (t * 5.0).sin()), 0.8)
        })
        .collect()
}

/// The form after the stroke, and a colour a vertex.
fn sculpted(kind: BrushKind, small: bool) -> (TriMesh, Vec<[u8; 3]>) {
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
    let rough = small && (evens || matches!(kind, BrushKind::Sharpen | BrushKind::Trim));
    if evens {
        (brush.radius, brush.strength) = (if small { 0.16 } else { 0.2 }, 1.0);
    }
    let coarse = matches!(
        kind,
        BrushKind::Smooth
            | BrushKind::Relax
            | BrushKind::SlideRelax
            | BrushKind::Density
            | BrushKind::SurfaceSmooth
    );
    let sharpens = kind == BrushKind::Sharpen;
    let fine = rough && (coarse || sharpens);
    let mut start = form(match coarse {
        true if fine => 16_000,
        true => 8_000,
        false => 60_000,
    });
    if rough {
        let waves = if fine { 36.0 } else { 21.0 };
        let bump = |p: Vec3| (p * waves).to_array().map(f32::sin).iter().product::<f32>();
        let high = if sharpens { 0.008 } else { 0.03 };
        start.positions.iter_mut().for_each(|p| *p *= 1.0 + high * bump(*p));
    }
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
        studio.stroke(&stroke(small));
        studio.tell(Command::Brush(BrushSettings { radius: 0.3, strength: 1.0, ..brush }));
        for _ in 0..6 {
            studio.stroke(&stroke(small)[15..]);
        }
    } else if kind == BrushKind::EraseLayer {
        // Half of a stroke on a layer is erased.
        let add = SceneCommand::Layers(LayerEdit::Add("layer".into()));
        studio.tell(Command::Scene(add));
        studio.tell(Command::Brush(sculptd::presets().of(BrushKind::Draw)));
        studio.stroke(&stroke(small));
        studio.tell(Command::Brush(BrushSettings { radius: 0.2, strength: 1.0, ..brush }));
        for _ in 0..2 {
            studio.stroke(&stroke(small)[15..]);
        }
    } else if kind == BrushKind::DrawFaceSets {
        // Two sets, the second over the end of the first.
        studio.stroke(&stroke(small));
        studio.tell(Command::Brush(BrushSettings { radius: 0.25, ..brush }));
        studio.stroke(&stroke(small)[22..]);
    } else if kind.grip() == Grip::Surface {
        for _ in 0..if evens || small && sharpens { 5 } else { 1 } {
            studio.stroke(&stroke(small));
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
    (mesh, tints)
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

fn drawn(sheet: &Sheet, all: &[(TriMesh, Vec<[u8; 3]>)]) -> Picture {
    let (w, h) = sheet.cell;
    let (width, height) = (COLUMNS * w, all.len().div_ceil(COLUMNS) * h);
    let mut out = Picture { width, height, rgb: vec![[255; 3]; width * height] };
    for (i, (mesh, tints)) in all.iter().enumerate() {
        let one = draw(mesh, Some(tints), &sheet.camera, w, h);
        let (x, y) = (i % COLUMNS * w, i / COLUMNS * h);
        for row in 0..h {
            let at = (y + row) * width + x;
            out.rgb[at..at + w].copy_from_slice(&one.rgb[row * w..(row + 1) * w]);
        }
    }
    out
}

#[test]
fn every_brush_looks_as_it_did() {
    for sheet in &SHEETS {
        let all: Vec<_> = BrushKind::ALL.iter().map(|kind| sculpted(*kind, sheet.small)).collect();
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(sheet.path);
        let now = drawn(sheet, &all);
        if std::env::var_os("SCULPTD_BLESS").is_some() {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            #[allow(clippy::disallowed_methods)] // Under version control: a torn file is seen.
            std::fs::write(&path, now.png().expect("a picture")).expect("written");
            continue;
        }
        let then = image::open(&path).expect("the sheet").into_rgb8();
        assert_eq!((then.width() as usize, then.height() as usize), (now.width, now.height));
        let (w, h) = sheet.cell;
        for (i, kind) in BrushKind::ALL.iter().enumerate() {
            let (x, y) = (i % COLUMNS * w, i / COLUMNS * h);
            let mut sum = 0u64;
            for row in y..y + h {
                for column in x..x + w {
                    let then = then.get_pixel(column as u32, row as u32).0;
                    let now = now.rgb[row * now.width + column];
                    sum += (0..3).map(|k| u64::from(then[k].abs_diff(now[k]))).sum::<u64>();
                }
            }
            let mean = sum as f64 / (3 * w * h) as f64;
            assert!(mean < 1.0, "{}: {kind} differs by {mean:.2} of 255 a pixel", sheet.path);
        }
    }
}
