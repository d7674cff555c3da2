//! The bytes of one page of clay, for a web page.
//!
//! | bytes | field |
//! |---|---|
//! | 1 | 1 whole, 2 rows that changed, 3 values of a map |
//! | 1 | bits: 1 the rows have colours |
//! | 2 | rows of the page |
//! | 4, 4, 4 | number of the message; of the object; of the page |
//!
//! A whole page goes on with its box (lower and upper corner, six f32), the step of its lattice
//! (f32), the number of its triangles (u32), the rows, and three u16 a triangle. Changed rows come
//! in runs: first row, count (u16 each), the rows.
//!
//! Values of a map go on with their step (f32), and a u16 a row: the value in steps, 65535
//! where it is not known.
//!
//! A row: three u16, the place as steps from the box's lower corner; two i8, the normal as a point
//! of an octahedron (Meyer et al. 2010); with colours also red, green, blue (sRGB) and the mask.
//! The box is larger than the page by an eighth, so that a page which swells keeps it. The step is
//! a power of two and the corner a multiple of it: pages of about the same size share one lattice,
//! and no crack opens between them. A place is off by at most a 50,000th of the page's largest side
//! on each axis.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use sculptd_clay::page::Page;

/// Bytes before the content.
pub const HEAD: usize = 16;
const WHOLE: u8 = 1;
const ROWS: u8 = 2;
const VALUES: u8 = 3;
const COLOURED: u8 = 1;
/// Unchanged rows that are sent along rather than to begin another run.
const BRIDGE: usize = 2;
/// Share by which the box exceeds the page on each side.
const ROOM: f64 = 0.125;
/// Most steps on an axis.
const MOST: f64 = 65_535.0;

/// Names of a message.
#[derive(Debug, Clone, Copy)]
pub struct Names {
    pub message: u32,
    pub object: u32,
    pub page: u32,
}

/// A page as it was sent.
#[derive(Debug, Clone)]
pub struct SentPage {
    page: Arc<Page>,
    /// Lower corner of the box, in steps.
    low: DVec3,
    step: f64,
    coloured: bool,
}

/// Appends a whole page to `out`.
pub fn write_page(page: &Arc<Page>, names: Names, out: &mut Vec<u8>) -> SentPage {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let all = page.point_rows().iter().map(|r| r.truncate());
    let (low, high) = all.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (low, high) = if low.is_finite() { (low, high) } else { (Vec3::ZERO, Vec3::ZERO) };
    let side = f64::from((high - low).max_element()).max(1e-30);
    let room = DVec3::splat(side * ROOM);
    let step = ((side * (1.0 + 2.0 * ROOM) / MOST).log2().ceil()).exp2();
    let (low, high) = (low.as_dvec3() - room, high.as_dvec3() + room);
    let low = (low / step).floor();
    let sent = SentPage { page: page.clone(), low, step, coloured: is_coloured(page) };
    head(WHOLE, &sent, names, out);
    let corners = [low * step, high].map(|c| c.as_vec3().to_array());
    for value in corners.into_iter().flatten().chain([step as f32]) {
        out.extend(value.to_le_bytes());
    }
    let shown = |t: &usize| !page.is_triangle_hidden(*t);
    let triangles = (0..page.triangles().len()).filter(shown);
    let at = out.len();
    out.extend([0; 4]);
    for row in 0..page.point_rows().len() {
        put_row(&sent, page, row, out);
    }
    let mut count = 0u32;
    for t in triangles {
        count += 1;
        page.triangles()[t].iter().for_each(|v| out.extend(v.to_le_bytes()));
    }
    out[at..at + 4].copy_from_slice(&count.to_le_bytes());
    sent
}

/// Appends the rows of `page` that differ from those sent, and keeps it as sent. Returns false, and
/// appends nothing, where the page must be sent whole: other triangles are shown, or a vertex left
/// the box.
pub fn changed(sent: &mut SentPage, page: &Arc<Page>, names: Names, out: &mut Vec<u8>) -> bool {
    let old = &sent.page;
    if !page.shows_triangles_of(old) || is_coloured(page) != sent.coloured {
        return false;
    }
    let differs = |row: usize| {
        let bits = |p: &Page| {
            let (a, b) = (p.point_rows()[row], p.normal_rows()[row]);
            [a.to_array(), b.to_array()].map(|r| r.map(f32::to_bits))
        };
        bits(old) != bits(page)
    };
    let start = out.len();
    head(ROWS, sent, names, out);
    let mut row = 0;
    let rows = page.point_rows().len();
    while row < rows {
        if !differs(row) {
            row += 1;
            continue;
        }
        let (first, mut last) = (row, row);
        while row < rows && row - last <= BRIDGE {
            if differs(row) {
                last = row;
            }
            row += 1;
        }
        out.extend((first as u16).to_le_bytes());
        out.extend(((last - first + 1) as u16).to_le_bytes());
        for row in first..=last {
            if !put_row(sent, page, row, out) {
                out.truncate(start);
                return false;
            }
        }
    }
    sent.page = page.clone();
    true
}

/// Appends the values of a map for the rows of a page, in order; not finite: not known.
pub fn values(all: &[f32], names: Names, out: &mut Vec<u8>) {
    let most = all.iter().copied().filter(|v| v.is_finite()).fold(0.0, f32::max);
    let step = (most / (MOST as f32 - 1.0)).max(f32::MIN_POSITIVE);
    put_head(VALUES, 0, all.len(), names, out);
    out.extend(step.to_le_bytes());
    for value in all {
        let steps = if value.is_finite() { (value / step).round() } else { MOST as f32 };
        out.extend((steps as u16).to_le_bytes());
    }
}

impl SentPage {
    /// Returns its number of rows.
    pub fn rows(&self) -> usize {
        self.page.point_rows().len()
    }

    /// Returns true if this page is what was sent.
    pub fn is(&self, page: &Arc<Page>) -> bool {
        Arc::ptr_eq(&self.page, page)
    }
}

fn head(kind: u8, sent: &SentPage, names: Names, out: &mut Vec<u8>) {
    put_head(kind, if sent.coloured { COLOURED } else { 0 }, sent.rows(), names, out);
}

fn put_head(kind: u8, bits: u8, rows: usize, names: Names, out: &mut Vec<u8>) {
    out.extend([kind, bits]);
    out.extend((rows as u16).to_le_bytes());
    for name in [names.message, names.object, names.page] {
        out.extend(name.to_le_bytes());
    }
}

/// A vertex is painted or masked.
fn is_coloured(page: &Page) -> bool {
    (0..page.point_rows().len()).any(|v| page.colour(v) != [255; 4] || page.mask(v) > 0.0)
}

/// Appends a row. False: its place is outside the box.
fn put_row(sent: &SentPage, page: &Page, row: usize, out: &mut Vec<u8>) -> bool {
    // The nearest point of the lattice, whichever page asks.
    let place = (page.point(row).as_dvec3() / sent.step).round() - sent.low;
    for value in place.to_array() {
        out.extend((value.clamp(0.0, MOST) as u16).to_le_bytes());
    }
    out.extend(octahedral(page.normal(row)).map(|n| n as u8));
    if sent.coloured {
        let [r, g, b, _] = page.colour(row);
        out.extend([r, g, b, (page.mask(row).clamp(0.0, 1.0) * 255.0).round() as u8]);
    }
    place.cmpge(DVec3::ZERO).all() && place.cmple(DVec3::splat(MOST)).all()
}

/// The point of a normal on the unfolded octahedron, 127ths.
fn octahedral(normal: Vec3) -> [i8; 2] {
    let sum = normal.abs().element_sum();
    if !(sum.is_finite() && sum > 0.0) {
        return [0, 0];
    }
    let (x, y, z) = (normal.x / sum, normal.y / sum, normal.z / sum);
    let fold = |a: f32, b: f32| (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 };
    let at = if z < 0.0 { Vec2::new(fold(x, y), fold(y, x)) } else { Vec2::new(x, y) };
    [at.x, at.y].map(|c| (c * 127.0).round() as i8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_clay::Clay;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    const NAMES: Names = Names { message: 7, object: 3, page: 0 };

    fn u16_at(bytes: &[u8], at: usize) -> u16 {
        u16::from_le_bytes([bytes[at], bytes[at + 1]])
    }

    fn f32_at(bytes: &[u8], at: usize) -> f32 {
        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    }

    #[test]
    fn a_page_arrives_as_it_is_within_the_stated_error() {
        let mut clay = Clay::build(&shapes::icosphere(1.0, 32), &Job::default()).expect("clay");
        let snapshot = clay.snapshot();
        let mut bytes = Vec::new();
        let page = snapshot.page(0);
        write_page(page, NAMES, &mut bytes);
        let rows = page.point_rows().len();
        assert_eq!((bytes[0], bytes[1], usize::from(u16_at(&bytes, 2))), (WHOLE, 0, rows));
        let (step, none) = (f32_at(&bytes, HEAD + 24), (Vec3::INFINITY, Vec3::NEG_INFINITY));
        let all = page.point_rows().iter().map(|r| r.truncate());
        let (lo, hi) = all.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)));
        let side = (hi - lo).max_element();
        for row in 0..rows {
            let at = HEAD + 32 + row * 8;
            for axis in 0..3 {
                let low = f32_at(&bytes, HEAD + 4 * axis);
                let value = low + f32::from(u16_at(&bytes, at + 2 * axis)) * step;
                let error = (value - page.point(row)[axis]).abs();
                assert!(error <= side / 50_000.0 + 1e-7, "{error}");
            }
            let (x, y) = (bytes[at + 6] as i8, bytes[at + 7] as i8);
            let (x, y) = (f32::from(x) / 127.0, f32::from(y) / 127.0);
            let z = 1.0 - x.abs() - y.abs();
            let t = (-z).max(0.0);
            let normal = Vec3::new(x - t * x.signum(), y - t * y.signum(), z).normalize();
            assert!(normal.dot(page.normal(row)) > 0.9995, "within two degrees");
        }
        assert_eq!(bytes.len(), HEAD + 32 + rows * 8 + page.triangles().len() * 6);
    }

    #[test]
    fn pages_have_a_common_vertex_at_one_place() {
        let mut clay = Clay::build(&shapes::icosphere(1.0, 64), &Job::default()).expect("clay");
        let snapshot = clay.snapshot();
        let mut places = std::collections::BTreeMap::new();
        for page in snapshot.pages() {
            let mut bytes = Vec::new();
            write_page(page, NAMES, &mut bytes);
            let step = f32_at(&bytes, HEAD + 24);
            for row in 0..page.point_rows().len() {
                let axis = |i: usize| {
                    let steps = f32::from(u16_at(&bytes, HEAD + 32 + row * 8 + 2 * i));
                    (f32_at(&bytes, HEAD + 4 * i) + steps * step).to_bits()
                };
                let key = (page.point(row).to_array().map(f32::to_bits), step.to_bits());
                let place = [axis(0), axis(1), axis(2)];
                assert_eq!(*places.entry(key).or_insert(place), place);
            }
        }
    }

    #[test]
    fn values_of_a_map_arrive_within_a_step() {
        let mut bytes = Vec::new();
        values(&[0.0, 1.5, f32::NAN, 3.0, f32::INFINITY], NAMES, &mut bytes);
        assert_eq!((bytes[0], u16_at(&bytes, 2), bytes.len()), (VALUES, 5, HEAD + 4 + 10));
        let step = f32_at(&bytes, HEAD);
        let at = |row: usize| u16_at(&bytes, HEAD + 4 + 2 * row);
        assert_eq!([at(0), at(2), at(4)], [0, 65_535, 65_535]);
        assert!((f32::from(at(1)) * step - 1.5).abs() <= step);
        assert!((f32::from(at(3)) * step - 3.0).abs() <= step && at(3) < 65_535);
    }

    #[test]
    fn only_rows_that_changed_are_sent_until_one_leaves_the_box() {
        let mut clay = Clay::build(&shapes::icosphere(1.0, 32), &Job::default()).expect("clay");
        let before = clay.snapshot().page(0).clone();
        let mut bytes = Vec::new();
        let mut sent = write_page(&before, NAMES, &mut bytes);
        let full = bytes.len();
        bytes.clear();
        assert!(changed(&mut sent, &before, NAMES, &mut bytes));
        assert_eq!(bytes.len(), HEAD, "nothing changed");
        let ids = clay.snapshot().page(0).topology().ids.clone();
        let mut mesh = clay.snapshot().to_tri();
        mesh.positions[ids[5] as usize] *= 1.001;
        let mut moved = Clay::build(&mesh, &Job::default()).expect("clay");
        let after = moved.snapshot().page(0).clone();
        bytes.clear();
        // Another clay has other triangles, equal or not.
        assert!(!changed(&mut sent, &after, NAMES, &mut bytes) && bytes.is_empty());
        assert!(full > HEAD);
    }
}
