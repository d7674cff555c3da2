//! Raised and engraved text: the outlines of a font, drawn out into solids.
//!
//! The text is in the plane that touches the surface at its middle. Where the surface bends under
//! it, raised letters begin below the lowest place of the surface and end above the highest, so
//! that each is at least as high as asked; engraved ones likewise are at least as deep.

use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use ttf_parser::{Face, OutlineBuilder};

use super::tool::append;
use super::{RepairError, combined, direction};
use crate::part::PreparedPart;

/// The font that the program brings: Hack, which has Latin, Greek and Cyrillic letters.
const FONT: &[u8] = epaint_default_fonts::HACK_REGULAR;
/// Lines that stand for a curve of an outline.
const CURVE: usize = 8;
/// The height of a capital letter as a share of the em, where the font does not say.
const CAPITAL: f64 = 0.7;
/// From one line to the next, in capital heights.
const LINE: f64 = 1.6;
/// Most characters of a text.
pub const MOST_LETTERS: usize = 200;
/// Places along a text, and across it, at which the surface is felt.
const FELT: (usize, usize) = (33, 9);
/// The sine of the least angle between a face's normal and the upright direction of its letters.
const UPRIGHT: f64 = 0.05;
/// Length of a solid on the other side of the surface, as a share of the letters' height.
const BEYOND: f64 = 0.1;

/// A text to be raised from a part, or engraved into it. Lengths are in the mesh's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Lettering {
    /// The text; lines are separated by line breaks.
    pub text: String,
    /// Its middle, on the surface or near it.
    pub at: DVec3,
    /// The surface is looked for from `at` in this direction, and not nearest to it.
    pub along: Option<DVec3>,
    /// The direction in which the letters stand upright, as far as the surface allows.
    pub upright: DVec3,
    /// The height of a capital letter.
    pub height: f64,
    /// Height of the letters above the surface; below 0 they are engraved to this depth.
    pub relief: f64,
}

/// The solid of a text, and where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct LetteringPlan {
    /// To be united with the part, or subtracted.
    pub tool: PolyMesh,
    /// Union for raised letters, difference for engraved ones.
    pub operation: Operation,
    /// The middle of the text on the surface.
    pub place: DVec3,
    /// Out of the surface there.
    pub normal: DVec3,
    /// The area of the letters, in square units.
    pub area: f64,
    /// Sentences on how it was carried out.
    pub notes: Vec<String>,
}

/// Plans a text on a part.
///
/// # Errors
/// Returns an error if the text is empty or too long, if the font lacks one of its characters, if
/// a part of the text is beside the surface, and if the job was cancelled.
pub fn plan_lettering(
    solid: &PolyMesh,
    asked: &Lettering,
    job: &Job,
) -> Result<LetteringPlan, RepairError> {
    let height = RepairError::expect_length("text height", asked.height)?;
    let upright = direction("upright direction", asked.upright)?;
    let relief = RepairError::expect_length("relief", asked.relief.abs())?;
    let TextOutlines { shapes, size } = outlines(&asked.text, height)?;
    let part = PreparedPart::new(solid, 1.0, job)?;
    let along = asked.along.map(|d| direction("direction of the text", d)).transpose()?;
    let from = Some(asked.at - part.centred.centre).filter(|p| p.is_finite());
    let found = from.and_then(|p| match along {
        Some(along) => part.distance_along(p, along, 0.0).map(|(d, t)| (p + along * d, t)),
        None => part.tree().nearest(p, f64::INFINITY).map(|n| (n.point, n.triangle)),
    });
    let Some((middle, face)) = found else {
        return Err(RepairError::Text("no face is at its place".into()));
    };
    let normal = part.normals[face as usize];
    let place = part.to_file(middle);
    // On a level face the letters stand towards y, as on a drawing.
    let across = [upright, DVec3::Y, DVec3::X].map(|d| d - normal * normal.dot(d));
    let v = across.iter().find(|d| d.length() > UPRIGHT).map_or(across[0], |d| d.normalize());
    let u = v.cross(normal);
    let (low, high) = felt(&part, middle, [u, v, normal], size, relief)?;
    let mut notes = Vec::new();
    if high - low > 0.5 * relief {
        let (least, most) = (relief, relief + (high - low));
        notes.push(format!(
            "the surface bends under the text, so that the relief is {least:.3} to {most:.3}"
        ));
    }
    let raised = asked.relief > 0.0;
    let beyond = BEYOND * height;
    let (from, to) =
        if raised { (low - beyond, high + relief) } else { (low - relief, high + beyond) };
    let put = |p: DVec2, z: f64| place + u * p.x + v * p.y + normal * z;
    let (mut tool, mut area) = (PolyMesh::new(), 0.0);
    for shape in &shapes {
        job.check()?;
        let Some((outer, holes)) = shape.split_first() else { continue };
        area += shape.iter().map(|ring| ring_area(ring)).sum::<f64>();
        let mut letter = drawn_out(outer, |p, upper| put(p, if upper { to } else { from }));
        for hole in holes {
            let hole: Vec<DVec2> = hole.iter().rev().copied().collect();
            let past = relief + beyond;
            let tube = drawn_out(&hole, |p, up| put(p, if up { to + past } else { from - past }));
            letter = combined(&letter, &tube, Operation::Difference, job)?.0;
        }
        append(&mut tool, &letter);
    }
    let operation = if raised { Operation::Union } else { Operation::Difference };
    Ok(LetteringPlan { tool, operation, place, normal, area, notes })
}

/// The least and the greatest height of the surface under a text over the plane at its middle.
fn felt(
    part: &PreparedPart,
    middle: DVec3,
    [u, v, normal]: [DVec3; 3],
    size: DVec2,
    relief: f64,
) -> Result<(f64, f64), RepairError> {
    let above = size.length() + relief;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (columns, rows) = FELT;
    for i in 0..columns * rows {
        let x = (i % columns) as f64 / (columns - 1) as f64 - 0.5;
        let y = (i / columns) as f64 / (rows - 1) as f64 - 0.5;
        let from = middle + u * (x * size.x) + v * (y * size.y) + normal * above;
        let found = part.distance_along(from, -normal, 0.0).map(|(d, _)| above - d);
        let Some(z) = found.filter(|z| z.abs() <= size.y.max(relief)) else {
            let (wide, tall) = (size.x, size.y);
            return Err(RepairError::NoRoom { wide, tall });
        };
        (low, high) = (low.min(z), high.max(z));
    }
    Ok((low, high))
}

/// A ring of places, drawn out. `put` gives a place of the lower or the upper end.
fn drawn_out(ring: &[DVec2], put: impl Fn(DVec2, bool) -> DVec3) -> PolyMesh {
    let n = ring.len() as u32;
    let ends = [false, true].into_iter().flat_map(|end| ring.iter().map(move |&p| (p, end)));
    let positions = ends.map(|(p, end)| put(p, end)).collect();
    let mut mesh = PolyMesh { positions, ..PolyMesh::new() };
    mesh.push_face(&(0..n).rev().collect::<Vec<_>>());
    mesh.push_face(&(n..2 * n).collect::<Vec<_>>());
    for i in 0..n {
        let j = (i + 1) % n;
        mesh.push_face(&[i, j, j + n, i + n]);
    }
    mesh
}

/// Above 0 for a ring that goes around against the clock.
fn ring_area(ring: &[DVec2]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b) * 0.5).sum()
}

/// The outlines of a text about its middle.
#[derive(Debug)]
struct TextOutlines {
    shapes: Vec<TextShape>,
    /// Width and height.
    size: DVec2,
}

/// A connected shape: its outline against the clock, and its holes with it.
type TextShape = Vec<Vec<DVec2>>;

fn outlines(text: &str, height: f64) -> Result<TextOutlines, RepairError> {
    let count = text.chars().count();
    if count == 0 || count > MOST_LETTERS || text.trim().is_empty() {
        let why = format!("expected 1 to {MOST_LETTERS} letters, found {count}");
        return Err(RepairError::Text(why));
    }
    let face = Face::parse(FONT, 0).map_err(|e| RepairError::Text(e.to_string()))?;
    let em = f64::from(face.units_per_em());
    let capital = face.capital_height().map_or(CAPITAL * em, f64::from);
    let scale = height / capital;
    let mut lines = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let mut pen = OutlinePen { scale, ..OutlinePen::default() };
        let mut x = 0.0;
        for c in line.chars() {
            let glyph = face.glyph_index(c).ok_or_else(|| {
                RepairError::Text(format!("the font has no letter for {c:?}; write it otherwise"))
            })?;
            pen.origin = DVec2::new(x, -(k as f64) * LINE * height);
            // Nothing to draw: a space.
            let _box = face.outline_glyph(glyph, &mut pen);
            x += f64::from(face.glyph_hor_advance(glyph).unwrap_or(0)) * scale;
        }
        let half = DVec2::new(x * 0.5, 0.0);
        lines.extend(pen.rings.into_iter().map(|ring| {
            ring.into_iter().map(|p| (p - half).to_array()).collect::<Vec<[f64; 2]>>()
        }));
    }
    let all = || lines.iter().flatten().map(|p| DVec2::from(*p));
    let lo = all().fold(DVec2::INFINITY, DVec2::min);
    let hi = all().fold(DVec2::NEG_INFINITY, DVec2::max);
    if !(lo.cmplt(hi).all()) {
        return Err(RepairError::Text("the text has no visible letter".into()));
    }
    let middle = (lo + hi) * 0.5;
    // TrueType outlines may cross themselves and each other.
    let shapes = lines.simplify_shape_as::<i64>(FillRule::NonZero);
    let moved = |ring: Vec<[f64; 2]>| ring.into_iter().map(|p| DVec2::from(p) - middle).collect();
    let shapes = shapes.into_iter().map(|shape| shape.into_iter().map(moved).collect()).collect();
    Ok(TextOutlines { shapes: turned(shapes), size: hi - lo })
}

/// Outlines against the clock, holes with it.
fn turned(mut shapes: Vec<TextShape>) -> Vec<TextShape> {
    for shape in &mut shapes {
        for (k, ring) in shape.iter_mut().enumerate() {
            if (ring_area(ring) > 0.0) != (k == 0) {
                ring.reverse();
            }
        }
    }
    shapes
}

/// Collects the outlines of letters as rings of lines.
#[derive(Debug, Default)]
struct OutlinePen {
    scale: f64,
    origin: DVec2,
    rings: Vec<Vec<DVec2>>,
    ring: Vec<DVec2>,
}

impl OutlinePen {
    fn place(&self, x: f32, y: f32) -> DVec2 {
        self.origin + DVec2::new(f64::from(x), f64::from(y)) * self.scale
    }

    fn curve(&mut self, at: impl Fn(DVec2, f64) -> DVec2) {
        let Some(&from) = self.ring.last() else { return };
        self.ring.extend((1..=CURVE).map(|i| at(from, i as f64 / CURVE as f64)));
    }
}

impl OutlineBuilder for OutlinePen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.close();
        self.ring.push(self.place(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.ring.push(self.place(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (b, c) = (self.place(x1, y1), self.place(x, y));
        self.curve(|a, t| a.lerp(b, t).lerp(b.lerp(c, t), t));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (b, c, d) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.curve(|a, t| {
            let (p, q, r) = (a.lerp(b, t), b.lerp(c, t), c.lerp(d, t));
            p.lerp(q, t).lerp(q.lerp(r, t), t)
        });
    }

    fn close(&mut self) {
        if self.ring.len() > 2 {
            self.rings.push(std::mem::take(&mut self.ring));
        }
        self.ring.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_have_the_height_that_was_asked_and_holes_where_letters_have_them() {
        let TextOutlines { shapes, size } = outlines("H", 5.0).expect("a letter");
        assert!((size.y - 5.0).abs() < 1e-3 && shapes.len() == 1 && shapes[0].len() == 1);
        let shapes = outlines("B8o", 5.0).expect("letters").shapes;
        let holes: Vec<usize> = shapes.iter().map(|s| s.len() - 1).collect();
        assert_eq!(holes.iter().sum::<usize>(), 5, "{holes:?}");
        for shape in &shapes {
            assert!(ring_area(&shape[0]) > 0.0 && shape[1..].iter().all(|h| ring_area(h) < 0.0));
        }
        let (one, two) = (outlines("o", 5.0), outlines("o\no", 5.0));
        assert!(two.expect("two lines").size.y > 1.5 * one.expect("a letter").size.y);
        assert!(outlines(" ", 5.0).is_err() && outlines("\u{4e2d}", 5.0).is_err());
        assert!(outlines(&"x".repeat(MOST_LETTERS + 1), 5.0).is_err());
    }
}
