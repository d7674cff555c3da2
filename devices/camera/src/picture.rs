//! Pictures in memory, and the square crops that the models look at.

use glam::{Vec2, Vec4};
use pulp::{Arch, Scalar128b, Simd, WithSimd};

/// An RGB picture, row by row.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

/// Most pixels of one picture: 8K.
pub const MAX_PIXELS: usize = 7680 * 4320;

/// Turn of the camera, clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Rotation {
    /// Upright.
    #[default]
    #[serde(rename = "0")]
    None,
    /// A quarter turn.
    #[serde(rename = "90")]
    Quarter,
    /// Upside down.
    #[serde(rename = "180")]
    Half,
    /// Three quarter turns.
    #[serde(rename = "270")]
    ThreeQuarters,
}

/// A turned square of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crop {
    /// Middle, pixels.
    pub centre: Vec2,
    /// Side, pixels.
    pub side: f32,
    /// Radians, clockwise as seen in the picture.
    pub angle: f32,
}

/// Colour outside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// Black.
    Black,
    /// The nearest pixel's.
    Nearest,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, colour: [u8; 3]) -> Self {
        let mut rgb = Vec::with_capacity(width * height * 3);
        for _ in 0..width * height {
            rgb.extend(colour);
        }
        Picture { width, height, rgb }
    }

    /// Returns the size in pixels.
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// Returns the colour of a pixel; black outside the picture.
    #[inline(always)]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = (y * self.width + x) * 3;
        let inside = x < self.width;
        self.rgb.get(at..at + 3).filter(|_| inside).map_or([0; 3], |p| [p[0], p[1], p[2]])
    }

    /// Returns the picture as it would be with the camera upright.
    pub fn turned(self, rotation: Rotation) -> Picture {
        let (w, h) = (self.width, self.height);
        let (width, height) = match rotation {
            Rotation::None => return self,
            Rotation::Half => (w, h),
            Rotation::Quarter | Rotation::ThreeQuarters => (h, w),
        };
        let mut rgb = Vec::with_capacity(self.rgb.len());
        for y in 0..height {
            for x in 0..width {
                let (sx, sy) = match rotation {
                    Rotation::Quarter => (y, h - 1 - x),
                    Rotation::ThreeQuarters => (w - 1 - y, x),
                    _ => (w - 1 - x, h - 1 - y),
                };
                rgb.extend(self.pixel(sx, sy));
            }
        }
        Picture { width, height, rgb }
    }

    /// Mean brightness and its spread, 0 to 1, over every eighth pixel.
    pub fn light(&self) -> (f32, f32) {
        let (mut sum, mut squares, mut n) = (0.0_f64, 0.0_f64, 0.0_f64);
        for y in (0..self.height).step_by(8) {
            for x in (0..self.width).step_by(8) {
                let [r, g, b] = self.pixel(x, y).map(f64::from);
                let v = (0.299 * r + 0.587 * g + 0.114 * b) / 255.0;
                (sum, squares, n) = (sum + v, squares + v * v, n + 1.0);
            }
        }
        let mean = sum / n.max(1.0);
        (mean as f32, (squares / n.max(1.0) - mean * mean).max(0.0).sqrt() as f32)
    }
}

impl Crop {
    /// The square around a whole picture.
    pub fn around(picture: &Picture) -> Self {
        let size = picture.size();
        Crop { centre: size * 0.5, side: size.max_element(), angle: 0.0 }
    }

    /// Returns the picture's pixel for a place in the crop, each coordinate 0 to 1.
    pub fn to_picture(&self, at: Vec2) -> Vec2 {
        self.centre + Vec2::from_angle(self.angle).rotate((at - 0.5) * self.side)
    }

    /// Fills `out`, `side` by `side` pixels of three numbers from 0 to 1. Crops that are larger
    /// than the output are averaged, which also takes the noise out.
    pub fn sample(&self, picture: &Picture, border: Border, side: usize, out: &mut [f32]) {
        let work = Sampling { crop: *self, picture, border, side, out };
        match Arch::new() {
            Arch::Scalar => Scalar128b.vectorize(work),
            arch => arch.dispatch(work),
        }
    }
}

/// One sampling, to be compiled for the vectors that the processor has.
struct Sampling<'a> {
    crop: Crop,
    picture: &'a Picture,
    border: Border,
    side: usize,
    out: &'a mut [f32],
}

impl WithSimd for Sampling<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Sampling { crop, picture, border, side, out } = self;
        let step = crop.side / side as f32;
        // One place between four pixels covers a step of up to 1.4 pixels well enough.
        let taps = ((step / 1.4).ceil() as usize).clamp(1, 3);
        let (across, down) = (
            Vec2::from_angle(crop.angle) * step / taps as f32,
            Vec2::from_angle(crop.angle).perp() * step / taps as f32,
        );
        let corner = crop.to_picture(Vec2::ZERO) + (across + down) * 0.5 - 0.5;
        let weight = 1.0 / (255.0 * (taps * taps) as f32);
        for (i, pixel) in out.chunks_exact_mut(3).take(side * side).enumerate() {
            let (x, y) = ((i % side * taps) as f32, (i / side * taps) as f32);
            let mut sum = Vec4::ZERO;
            let mut line = corner + across * x + down * y;
            for _ in 0..taps {
                let mut at = line;
                for _ in 0..taps {
                    if taps == 3 {
                        // Nine of them need no interpolation.
                        picture.add_nearest(at, border, &mut sum);
                    } else {
                        picture.add_bilinear(at, border, &mut sum);
                    }
                    at += across;
                }
                line += down;
            }
            pixel.copy_from_slice(&(sum * weight).to_array()[..3]);
        }
    }
}

/// Rounds down; quicker than `floor` on processors without such an instruction.
#[inline(always)]
fn round_down(x: f32) -> i32 {
    const SHIFT: f32 = 65_536.0;
    (x + SHIFT) as i32 - SHIFT as i32
}

impl Picture {
    #[inline(always)]
    fn add_nearest(&self, at: Vec2, border: Border, sum: &mut Vec4) {
        let (x, y) = (round_down(at.x + 0.5), round_down(at.y + 0.5));
        let (w, h) = (self.width as i32, self.height as i32);
        let inside = x >= 0 && y >= 0 && x < w && y < h;
        if inside || border == Border::Nearest {
            let (x, y) = (x.clamp(0, w - 1), y.clamp(0, h - 1));
            let [r, g, b] = self.pixel(x as usize, y as usize).map(f32::from);
            *sum += Vec4::new(r, g, b, 0.0);
        }
    }

    #[inline(always)]
    fn add_bilinear(&self, at: Vec2, border: Border, sum: &mut Vec4) {
        let (x, y) = (round_down(at.x), round_down(at.y));
        let (ax, ay) = (at.x - x as f32, at.y - y as f32);
        let (w, h) = (self.width as i32, self.height as i32);
        let weights = [(1.0 - ax) * (1.0 - ay), ax * (1.0 - ay), (1.0 - ax) * ay, ax * ay];
        // Away from the border: four bytes a corner, the fourth of which is not used.
        if x >= 0 && y >= 0 && x + 2 < w && y + 1 < h {
            let top = (y * w + x) as usize * 3;
            let bottom = top + w as usize * 3;
            if let (Some(top), Some(bottom)) =
                (self.rgb[top..].first_chunk::<7>(), self.rgb[bottom..].first_chunk::<7>())
            {
                let texel = |row: &[u8; 7], from: usize| {
                    let [r, g, b, over] = [row[from], row[from + 1], row[from + 2], row[from + 3]];
                    Vec4::new(f32::from(r), f32::from(g), f32::from(b), f32::from(over))
                };
                *sum += texel(top, 0) * weights[0]
                    + texel(top, 3) * weights[1]
                    + texel(bottom, 0) * weights[2]
                    + texel(bottom, 3) * weights[3];
            }
            return;
        }
        for (corner, weight) in weights.iter().enumerate() {
            let (cx, cy) = (x + corner as i32 % 2, y + corner as i32 / 2);
            let inside = cx >= 0 && cy >= 0 && cx < w && cy < h;
            if inside || border == Border::Nearest {
                let (cx, cy) = (cx.clamp(0, w - 1), cy.clamp(0, h - 1));
                let pixel = self.pixel(cx as usize, cy as usize);
                let [r, g, b] = pixel.map(f32::from);
                *sum += Vec4::new(r, g, b, 0.0) * *weight;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red grows to the right, green downwards.
    fn gradient() -> Picture {
        let mut picture = Picture::filled(200, 120, [0; 3]);
        for y in 0..120 {
            for x in 0..200 {
                picture.rgb[(y * 200 + x) * 3..][..2].copy_from_slice(&[x as u8, y as u8]);
            }
        }
        picture
    }

    #[test]
    fn a_crop_shows_the_place_that_it_names() {
        let picture = gradient();
        for (angle, side, out) in [(0.0, 40.0, 32), (0.5, 60.0, 16), (-1.2, 20.0, 48)] {
            let crop = Crop { centre: Vec2::new(90.0, 60.0), side, angle };
            let mut pixels = vec![0.0; out * out * 3];
            crop.sample(&picture, Border::Nearest, out, &mut pixels);
            for i in [0, out / 2, out * out / 2, out * out - 1] {
                let at = Vec2::new((i % out) as f32 + 0.5, (i / out) as f32 + 0.5) / out as f32;
                // A pixel's middle lies half a pixel from its corner.
                let want = crop.to_picture(at) - 0.5;
                let got = Vec2::new(pixels[i * 3], pixels[i * 3 + 1]) * 255.0;
                // Nine nearest pixels instead of one place between four.
                let off = if side / out as f32 > 2.0 { 0.4 } else { 0.02 };
                assert!(got.distance(want) < off, "{got} instead of {want}");
            }
        }
    }

    #[test]
    fn four_quarter_turns_are_none() {
        let picture = gradient();
        let turned = picture.clone().turned(Rotation::Quarter);
        assert_eq!((turned.width, turned.height), (120, 200));
        assert_eq!(turned.pixel(119, 0), picture.pixel(0, 0), "the left top comes to the right");
        assert_eq!(turned.turned(Rotation::ThreeQuarters), picture);
        let half = picture.clone().turned(Rotation::Half);
        assert_eq!(half.turned(Rotation::Half), picture);
    }
}
