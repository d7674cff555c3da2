//! A small picture of the work at a node, drawn on the CPU: some ten thousand of its vertices as
//! dots, whatever its size.

use glam::{Quat, Vec3};

use sculptd_clay::Snapshot;

/// Pixels.
const WIDTH: usize = 96;
const HEIGHT: usize = 72;
/// Dots at most.
const DOTS: usize = 40_000;
/// Seen from a little to the right and above.
const YAW: f32 = 0.5;
const PITCH: f32 = -0.35;
/// Greatest extent of the sculpture from its middle, as a share of half the box's diagonal: a ball
/// reaches 0.58, a cube in this view 0.81.
const REACH: f32 = 0.82;
const PAPER: [u8; 3] = [38, 40, 43];

/// Returns a PNG; `None` if nothing is visible.
pub fn png(work: &Snapshot) -> Option<Vec<u8>> {
    let (lo, hi) = work.bounds();
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).length() * 0.5);
    if !(size.is_finite() && size > 0.0 && middle.is_finite()) {
        return None;
    }
    let turn = Quat::from_rotation_x(-PITCH) * Quat::from_rotation_y(-YAW);
    let light = Vec3::new(0.3, 0.5, 0.8).normalize();
    let scale = HEIGHT as f32 * 0.5 / (size * REACH);
    let every = work.vertex_count().div_ceil(DOTS).max(1);
    // Dots so large that they close up: a square of a side that covers each one's share of the
    // surface, twice over.
    let dots = (work.vertex_count() / every).max(1) as f32;
    let reach = ((HEIGHT * HEIGHT) as f32 * 2.0 / dots).sqrt().ceil().clamp(1.0, 6.0) as i32;
    let mut depth = vec![f32::NEG_INFINITY; WIDTH * HEIGHT];
    let mut rgb = vec![PAPER; WIDTH * HEIGHT];
    let mut left = 0;
    for page in work.pages() {
        let mut v = left;
        while v < page.own() {
            let p = turn * (page.point(v) - middle) * scale;
            let shade = 0.35 + 0.65 * (turn * page.normal(v)).dot(light).max(0.0);
            let colour = page.colour(v);
            let x = (p.x + WIDTH as f32 * 0.5) as i32;
            let y = (HEIGHT as f32 * 0.5 - p.y) as i32;
            for yy in (y - reach / 2).max(0)..(y - reach / 2 + reach).min(HEIGHT as i32) {
                for xx in (x - reach / 2).max(0)..(x - reach / 2 + reach).min(WIDTH as i32) {
                    let at = yy as usize * WIDTH + xx as usize;
                    if p.z > depth[at] {
                        depth[at] = p.z;
                        rgb[at] = [0, 1, 2].map(|k| (f32::from(colour[k]) * 0.86 * shade) as u8);
                    }
                }
            }
            v += every;
        }
        left = v - page.own();
    }
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(
        encoder,
        rgb.as_flattened(),
        WIDTH as u32,
        HEIGHT as u32,
        image::ExtendedColorType::Rgb8,
    )
    .ok()?;
    Some(png)
}
