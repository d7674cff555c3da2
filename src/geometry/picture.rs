//! A picture of a mesh, rasterised with a depth buffer on the CPU: for reports, for `--png`, for
//! machines without a GPU. The same mesh and camera give the same bytes everywhere: no threads
//! share a pixel, no time, no library's mathematics but `sqrt`.

use glam::{Mat3, Vec3};

use crate::TriMesh;

/// An orthographic camera.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    /// The point in the middle of the picture.
    pub target: Vec3,
    /// From the target towards the eye; any length but zero.
    pub towards_eye: Vec3,
    /// Points up in the picture as far as possible.
    pub up: Vec3,
    /// Length that half the picture's height shows.
    pub half_height: f32,
}

impl Camera {
    /// Shows the whole mesh from a corner above, whatever its proportions.
    pub fn from_corner(mesh: &TriMesh, aspect: f32) -> Camera {
        Camera::from_side(mesh, Vec3::new(0.55, -0.75, 0.5), aspect)
    }

    /// Shows the whole mesh from a side.
    pub fn from_side(mesh: &TriMesh, towards_eye: Vec3, aspect: f32) -> Camera {
        let (lo, hi) = mesh.bounds();
        let (lo, hi) =
            if lo.is_finite() && hi.is_finite() { (lo, hi) } else { (Vec3::ZERO, Vec3::ONE) };
        let mut camera =
            Camera { target: (lo + hi) * 0.5, towards_eye, up: Vec3::Z, half_height: 1.0 };
        let axes = camera.axes();
        let mut reach = 1e-12f32;
        for i in 0..8u32 {
            let corner = Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), hi, lo);
            let p = axes.transpose() * (corner - camera.target);
            reach = reach.max(p.y.abs()).max(p.x.abs() / aspect.max(1e-3));
        }
        camera.half_height = reach * 1.08;
        camera
    }

    /// Columns: right, up, towards the eye.
    fn axes(&self) -> Mat3 {
        let z = self.towards_eye.normalize_or(Vec3::Z);
        let x = self.up.cross(z);
        let x = if x.length_squared() > 1e-6 { x.normalize() } else { z.any_orthonormal_vector() };
        Mat3::from_cols(x, z.cross(x), z)
    }
}

/// Eight bits a channel, rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// sRGB, `width * height` pixels, row by row from the top, each from the left.
    pub rgb: Vec<[u8; 3]>,
}

/// Samples a pixel's side.
const OVER: usize = 2;

/// Draws `mesh` with one sRGB colour a vertex (grey without), lit from the eye's upper left, over
/// white. The colours are interpolated over the triangles; both sides are drawn, so that an
/// inverted face is not a hole.
pub fn draw(
    mesh: &TriMesh,
    colours: Option<&[[u8; 3]]>,
    camera: &Camera,
    width: usize,
    height: usize,
) -> Picture {
    let (w, h) = (width * OVER, height * OVER);
    let axes = camera.axes().transpose();
    let scale = h as f32 * 0.5 / camera.half_height;
    let screen: Vec<Vec3> = mesh
        .positions
        .iter()
        .map(|&p| {
            let q = axes * (p - camera.target) * scale;
            Vec3::new(q.x + w as f32 * 0.5, h as f32 * 0.5 - q.y, q.z)
        })
        .collect();
    let mut depth = vec![f32::NEG_INFINITY; w * h];
    let mut pixels = vec![[255u8; 3]; w * h];
    let light = Vec3::new(-0.35, 0.45, 0.82).normalize();
    for t in &mesh.triangles {
        if t.iter().any(|&v| v as usize >= screen.len()) {
            continue;
        }
        let [a, b, c] = t.map(|v| screen[v as usize]);
        let [pa, pb, pc] = t.map(|v| axes * mesh.positions[v as usize]);
        let normal = (pb - pa).cross(pc - pa).normalize_or_zero();
        let shade = 0.35 + 0.65 * (normal * normal.z.signum()).dot(light).max(0.0);
        let tint = t.map(|v| match colours {
            Some(all) => {
                all.get(v as usize).map_or(Vec3::splat(190.0), |c| Vec3::from(c.map(f32::from)))
            }
            None => Vec3::splat(190.0),
        });
        fill([a, b, c], w, h, |at, z, weights| {
            if z > depth[at] {
                depth[at] = z;
                let colour = tint[0] * weights.x + tint[1] * weights.y + tint[2] * weights.z;
                pixels[at] = (colour * shade).to_array().map(|x| x.clamp(0.0, 255.0) as u8);
            }
        });
    }
    let rgb = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width * OVER, i / width * OVER);
            let mut sum = [0u32; 3];
            for s in 0..OVER * OVER {
                let p = pixels[(y + s / OVER) * w + x + s % OVER];
                (0..3).for_each(|k| sum[k] += p[k] as u32);
            }
            sum.map(|s| (s / (OVER * OVER) as u32) as u8)
        })
        .collect();
    Picture { width, height, rgb }
}

/// Calls `put(pixel, depth, weights)` for each pixel whose centre is in the triangle.
fn fill([a, b, c]: [Vec3; 3], w: usize, h: usize, mut put: impl FnMut(usize, f32, Vec3)) {
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    if !(lo.is_finite() && hi.is_finite())
        || hi.x < 0.0
        || hi.y < 0.0
        || lo.x >= w as f32
        || lo.y >= h as f32
    {
        return;
    }
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if area == 0.0 {
        return;
    }
    let (x0, x1) = (lo.x.max(0.0) as usize, (hi.x.max(0.0) as usize + 1).min(w));
    let (y0, y1) = (lo.y.max(0.0) as usize, (hi.y.max(0.0) as usize + 1).min(h));
    let inverse = 1.0 / area;
    for y in y0..y1 {
        for x in x0..x1 {
            let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
            let u = ((c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x)) * inverse;
            let v = ((a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x)) * inverse;
            let t = 1.0 - u - v;
            if u >= 0.0 && v >= 0.0 && t >= -1e-6 {
                put(y * w + x, a.z * u + b.z * v + c.z * t, Vec3::new(u, v, t));
            }
        }
    }
}

impl Picture {
    /// Returns the projection of a point of the mesh, in pixels from the upper left.
    pub fn place(&self, camera: &Camera, p: Vec3) -> (f32, f32) {
        let q = camera.axes().transpose()
            * (p - camera.target)
            * (self.height as f32 * 0.5 / camera.half_height);
        (self.width as f32 * 0.5 + q.x, self.height as f32 * 0.5 - q.y)
    }

    /// A ring of `radius` pixels, black in white, around a place.
    pub fn ring(&mut self, (cx, cy): (f32, f32), radius: f32) {
        for y in 0..self.height {
            for x in 0..self.width {
                let d = (x as f32 + 0.5 - cx).hypot(y as f32 + 0.5 - cy) - radius;
                if d.abs() < 1.5 {
                    self.rgb[y * self.width + x] = [0; 3];
                } else if d.abs() < 2.5 {
                    self.rgb[y * self.width + x] = [255; 3];
                }
            }
        }
    }

    /// A line two pixels wide between two places.
    pub fn line(&mut self, from: (f32, f32), to: (f32, f32), colour: [u8; 3]) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        // Parts far outside cost no more than visible ones.
        let steps = dx.abs().max(dy.abs()).ceil().clamp(1.0, 1e5) as usize;
        for i in 0..=steps {
            let t = i as f32 / steps as f32;
            let (x, y) = ((from.0 + dx * t).floor(), (from.1 + dy * t).floor());
            for (px, py) in [(x, y), (x - 1.0, y), (x, y - 1.0), (x - 1.0, y - 1.0)] {
                let inside = (0.0..self.width as f32).contains(&px)
                    && (0.0..self.height as f32).contains(&py);
                if inside {
                    self.rgb[py as usize * self.width + px as usize] = colour;
                }
            }
        }
    }

    /// Draws a scale of colours in the lower left corner: a bar from `low` to `high` by `colour`,
    /// and the two numbers beneath it, in black. Pictures of less than 240 by 80 pixels have no
    /// room for it and stay as they are.
    pub fn legend(&mut self, low: f32, high: f32, colour: impl Fn(f32) -> [u8; 3]) {
        let (bar, left, top) = (200, 16, self.height.saturating_sub(48));
        if self.width < 240 || self.height < 80 {
            return;
        }
        for y in top..top + 14 {
            for x in 0..bar {
                let value = low + (high - low) * x as f32 / (bar - 1) as f32;
                self.rgb[y * self.width + left + x] = colour(value);
            }
        }
        let upper = format!("{high:.3}");
        let right = left + bar - (upper.len() * GLYPH_STEP).min(bar);
        self.number(&format!("{low:.3}"), left, top + 18);
        self.number(&upper, right, top + 18);
    }

    /// Writes digits, points and signs with their upper left corner at a pixel; what is beyond the
    /// picture is cut off.
    fn number(&mut self, text: &str, left: usize, top: usize) {
        for (n, c) in text.chars().enumerate() {
            let Some((_, rows)) = GLYPHS.iter().find(|g| g.0 == c) else { continue };
            for (row, bits) in rows.iter().enumerate() {
                for column in 0..3 {
                    for pixel in 0..GLYPH_SCALE * GLYPH_SCALE {
                        let x = left + n * GLYPH_STEP + column * GLYPH_SCALE + pixel % GLYPH_SCALE;
                        let y = top + row * GLYPH_SCALE + pixel / GLYPH_SCALE;
                        if bits >> (2 - column) & 1 == 1 && x < self.width && y < self.height {
                            self.rgb[y * self.width + x] = [0; 3];
                        }
                    }
                }
            }
        }
    }

    /// As a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, image::ImageError> {
        use image::ImageEncoder;
        let mut out = Vec::new();
        image::codecs::png::PngEncoder::new(&mut out).write_image(
            self.rgb.as_flattened(),
            self.width as u32,
            self.height as u32,
            image::ExtendedColorType::Rgb8,
        )?;
        Ok(out)
    }
}

/// Pixels a side of a dot of a glyph, and from one glyph to the next.
const GLYPH_SCALE: usize = 3;
const GLYPH_STEP: usize = 4 * GLYPH_SCALE;

/// Glyphs of three by five dots, rows from the top, the left dot in the highest bit.
const GLYPHS: [(char, [u8; 5]); 12] = [
    ('0', [7, 5, 5, 5, 7]),
    ('1', [2, 6, 2, 2, 7]),
    ('2', [7, 1, 7, 4, 7]),
    ('3', [7, 1, 7, 1, 7]),
    ('4', [5, 5, 7, 1, 1]),
    ('5', [7, 4, 7, 1, 7]),
    ('6', [7, 4, 7, 5, 7]),
    ('7', [7, 1, 1, 2, 2]),
    ('8', [7, 5, 7, 5, 7]),
    ('9', [7, 5, 7, 1, 7]),
    ('.', [0, 0, 0, 0, 2]),
    ('-', [0, 0, 7, 0, 0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_covers_its_share_and_the_nearer_wins() {
        let quad =
            |z: f32, s: f32| [[-s, -s], [s, -s], [s, s], [-s, s]].map(|[x, y]| Vec3::new(x, y, z));
        let mut positions = quad(0.0, 0.5).to_vec();
        positions.extend(quad(1.0, 0.25));
        let mesh = TriMesh {
            positions,
            triangles: vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]],
            colours: None,
        };
        let colours: Vec<[u8; 3]> =
            (0..8).map(|v| if v < 4 { [200, 0, 0] } else { [0, 200, 0] }).collect();
        let camera =
            Camera { target: Vec3::ZERO, towards_eye: Vec3::Z, up: Vec3::Y, half_height: 1.0 };
        let p = draw(&mesh, Some(&colours), &camera, 64, 64);
        let count = |f: fn(&&[u8; 3]) -> bool| p.rgb.iter().filter(f).count();
        assert_eq!(count(|c| c[1] > 50 && c[0] == 0), 16 * 16);
        assert_eq!(count(|c| c[0] > 50 && c[1] == 0), 32 * 32 - 16 * 16);
        assert_eq!(p.place(&camera, Vec3::new(0.5, 0.5, 3.0)), (48.0, 16.0));
        assert_eq!(&p.png().expect("encodes")[1..4], b"PNG");
    }

    #[test]
    fn a_line_is_drawn_between_its_ends_and_nowhere_else() {
        let mut p = Picture { width: 40, height: 30, rgb: vec![[255; 3]; 1200] };
        p.line((5.0, 5.0), (25.0, 15.0), [9, 0, 0]);
        p.line((30.0, -50.0), (30.0, 500.0), [0, 9, 0]);
        let at = |p: &Picture, x: usize, y: usize| p.rgb[y * 40 + x];
        assert_eq!([at(&p, 5, 5), at(&p, 15, 10), at(&p, 25, 15)], [[9, 0, 0]; 3]);
        assert_eq!([at(&p, 15, 5), at(&p, 36, 15), at(&p, 3, 5)], [[255; 3]; 3]);
        assert!((0..30).all(|y| at(&p, 30, y) == [0, 9, 0] && at(&p, 29, y) == [0, 9, 0]));
    }

    #[test]
    fn the_legend_has_the_colours_and_the_numbers() {
        let blank = |w, h| Picture { width: w, height: h, rgb: vec![[255; 3]; w * h] };
        let mut p = blank(300, 100);
        p.legend(1.0, 2.0, |v| [(v * 100.0) as u8, 0, 1]);
        let bar: Vec<u8> = p.rgb.iter().filter(|c| c[2] == 1).map(|c| c[0]).collect();
        assert_eq!((bar.len(), bar[0], bar[199]), (200 * 14, 100, 200));
        // "1.000" and "2.000": 8 + 1 + 3 * 12 and 11 + 1 + 3 * 12 dots of nine pixels.
        assert_eq!(p.rgb.iter().filter(|c| **c == [0; 3]).count(), (45 + 48) * 9);
        let mut small = blank(100, 60);
        small.legend(1.0, 2.0, |_| [0; 3]);
        assert_eq!(small, blank(100, 60));
    }
}
