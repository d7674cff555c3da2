//! Alphas: pictures of heights, 0 to 1, that a brush presses along its stroke. Eight are made here;
//! one is loaded.
//!
//! `s` runs along the stroke and repeats after 1, `t` across it from edge to edge, 0 to 1 with the
//! axis at 1/2.

use std::f32::consts::{PI, TAU};

use sculptd_geometry::io::height_picture::{
    HeightPicture, read_height_picture, write_height_picture,
};
use sculptd_geometry::portable::PortableMath;
use serde::{Deserialize, Serialize};

/// A picture of heights that the program makes, or the one that was loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alpha {
    /// Round studs in a row.
    Studs,
    /// Overlapping scales in three rows, each set off by half.
    #[default]
    Scales,
    /// Two strands wound about each other.
    Rope,
    /// Oblique stitches along a seam.
    Stitches,
    /// Ripples across the stroke.
    Waves,
    /// Courses of bricks with joints.
    Bricks,
    /// Rough stone: three octaves of smooth noise.
    Stone,
    /// A cracked skin: the borders of random cells.
    Cracks,
    /// The picture that was loaded; flat while there is none.
    Picture,
}

/// A loaded picture of heights, rows from the top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// `width * height` values from 0 (lowest) to 65535 (highest): brightness times the alpha
    /// channel, so transparent pixels are low.
    pub heights: Vec<u16>,
    /// The alpha channel, of the same length; empty for a picture that is opaque everywhere.
    #[serde(default)]
    pub cover: Vec<u16>,
}

/// Pixels of a picture at most: a square of 4096.
const MOST: u64 = 1 << 24;

impl Picture {
    /// Returns true if the sizes and the heights agree.
    pub fn is_sane(&self) -> bool {
        let pixels = u64::from(self.width) * u64::from(self.height);
        let fits = |rows: &[u16]| rows.len() as u64 == pixels;
        let covered = self.cover.is_empty() || fits(&self.cover);
        pixels > 0 && pixels <= MOST && fits(&self.heights) && covered
    }

    /// Reads PNG, and with the feature `pictures` JPEG, WebP, TIFF and OpenEXR; 8 or 16 bits or
    /// float. Colours become their brightness, and what is transparent is low: the height is
    /// brightness times the alpha channel.
    ///
    /// # Errors
    /// Says what is wrong: not a picture, too large, empty.
    pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
        let HeightPicture { width, height: rows, pixels } = read_height_picture(bytes, MOST)?;
        // Transparent pixels are low.
        let height = |[luma, alpha]: [u16; 2]| {
            ((u32::from(luma) * u32::from(alpha) + 32_767) / 65_535) as u16
        };
        let heights = pixels.iter().map(|&p| height(p)).collect();
        let opaque = pixels.iter().all(|p| p[1] == u16::MAX);
        let cover = if opaque { Vec::new() } else { pixels.iter().map(|p| p[1]).collect() };
        let picture = Picture { width, height: rows, heights, cover };
        if picture.is_sane() { Ok(picture) } else { Err("an empty picture".into()) }
    }

    /// The bytes of a PNG of 16 bits; [`Picture::decode`] reads the same picture from them.
    ///
    /// # Errors
    /// A picture whose sizes and heights disagree.
    pub fn encode(&self) -> Result<Vec<u8>, String> {
        // The brightness that is as high as this through so much of it.
        let luma = |height: u16, alpha: u16| {
            let (height, alpha) = (u32::from(height), u32::from(alpha));
            ((height * 65_535 + alpha / 2).checked_div(alpha).unwrap_or(0)).min(65_535) as u16
        };
        let covers = self.cover.iter().copied().chain(std::iter::repeat(u16::MAX));
        let pixels = self.heights.iter().zip(covers).map(|(&h, a)| [luma(h, a), a]).collect();
        write_height_picture(&HeightPicture { width: self.width, height: self.height, pixels })
    }

    /// Height at `s`, `t`, between four pixels; repeats along `s`, ends at the edges of `t`.
    pub fn at(&self, s: f32, t: f32) -> f32 {
        self.between(&self.heights, s, t)
    }

    /// Returns the opacity of the picture at `s`, `t`, from 0 to 1.
    pub fn cover(&self, s: f32, t: f32) -> f32 {
        if self.cover.is_empty() { 1.0 } else { self.between(&self.cover, s, t) }
    }

    fn between(&self, rows: &[u16], s: f32, t: f32) -> f32 {
        let (w, h) = (self.width as usize, self.height as usize);
        let x = (s - s.floor()) * w as f32 - 0.5;
        let y = (1.0 - t.clamp(0.0, 1.0)) * h as f32 - 0.5;
        let (i, j) = (x.floor(), y.floor());
        let (fx, fy) = (x - i, y - j);
        let pixel = |i: f32, j: f32| {
            let column = (i as i64).rem_euclid(w as i64) as usize;
            let row = (j as i64).clamp(0, h as i64 - 1) as usize;
            f32::from(rows[row * w + column]) / 65535.0
        };
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        mix(
            mix(pixel(i, j), pixel(i + 1.0, j), fx),
            mix(pixel(i, j + 1.0), pixel(i + 1.0, j + 1.0), fx),
            fy,
        )
    }
}

impl Alpha {
    /// Those that the program makes.
    pub const MADE: [Alpha; 8] = [
        Alpha::Studs,
        Alpha::Scales,
        Alpha::Rope,
        Alpha::Stitches,
        Alpha::Waves,
        Alpha::Bricks,
        Alpha::Stone,
        Alpha::Cracks,
    ];

    /// The height at `s`, `t`: 0 to 1.
    pub fn at(self, s: f32, t: f32, picture: Option<&Picture>) -> f32 {
        let s = s - s.floor();
        let h = match self {
            Alpha::Studs => {
                let d2 = (s - 0.5) * (s - 0.5) + (t - 0.5) * (t - 0.5);
                (1.0 - d2 * 9.0).max(0.0).sqrt()
            }
            Alpha::Scales => scales(s, t),
            Alpha::Rope => {
                // Each strand is a half round that goes from one side to the other in half a turn.
                let strand = |phase: f32| {
                    let c = 0.5 + 0.22 * ((s + phase) * TAU).portable_cos();
                    let d = (t - c) / 0.2;
                    (1.0 - d * d).max(0.0).sqrt()
                        * (0.75 + 0.25 * ((s + phase) * TAU).portable_sin())
                };
                strand(0.0).max(strand(0.5))
            }
            Alpha::Stitches => {
                let (x, y) = ((s - 0.5) - (t - 0.5) * 0.6, t - 0.5);
                let (a, b) = (x / 0.16, y / 0.28);
                let seam = 0.25 * (1.0 - (y / 0.06) * (y / 0.06)).max(0.0);
                (1.0 - a * a - b * b * b * b).max(0.0).sqrt().max(seam)
            }
            Alpha::Waves => 0.5 - 0.5 * (s * TAU * 2.0).portable_cos(),
            Alpha::Bricks => {
                let row = (t * 4.0).floor();
                let x = (s * 2.0 + row * 0.5).rem_euclid(1.0);
                let y = t * 4.0 - row;
                let joint = |v: f32, w: f32| ((0.5 - (v - 0.5).abs()) / w).clamp(0.0, 1.0);
                joint(x, 0.08).min(joint(y, 0.14))
            }
            Alpha::Stone => {
                (noise(s, t, 4, 1) * 4.0 + noise(s, t, 8, 2) * 2.0 + noise(s, t, 16, 3)) / 7.0
            }
            Alpha::Cracks => cracks(s, t),
            Alpha::Picture => picture.map_or(0.0, |p| p.at(s, t)),
        };
        h.clamp(0.0, 1.0)
    }
}

impl Alpha {
    /// Returns the opacity of the alpha at `s`, `t`, from 0 to 1. Built-in alphas are opaque.
    pub fn cover(self, s: f32, t: f32, picture: Option<&Picture>) -> f32 {
        match (self, picture) {
            (Alpha::Picture, Some(picture)) => picture.cover(s, t),
            _ => 1.0,
        }
    }
}

/// The highest of the scales that lie over a point, each a leaf whose tip points back along the
/// stroke.
fn scales(s: f32, t: f32) -> f32 {
    let mut best = 0.0f32;
    for row in 0..4 {
        let mid = row as f32 / 3.0;
        let shift = if row % 2 == 0 { 0.0 } else { 0.25 };
        for k in -1..3 {
            let x = (s - shift - k as f32 * 0.5) / 0.55;
            let y = (t - mid) / 0.24;
            if (0.0..1.0).contains(&x) && y.abs() < 1.0 {
                let edge = 1.0 - y * y - (1.0 - x).powi(4);
                let rise = 0.35 + 0.65 * (1.0 - x);
                best = best.max(rise * (edge * 6.0).clamp(0.0, 1.0));
            }
        }
    }
    best
}

/// A number from 0 to 1 for a cell.
fn hash(i: i32, j: i32, seed: u32) -> f32 {
    let mut x = (i as u32).wrapping_mul(0x85eb_ca6b)
        ^ (j as u32).wrapping_mul(0xc2b2_ae35)
        ^ seed.wrapping_mul(0x27d4_eb2f);
    x = (x ^ x >> 15).wrapping_mul(0x2c1b_3c6d);
    x = (x ^ x >> 12).wrapping_mul(0x297a_2d39);
    ((x ^ x >> 15) >> 8) as f32 / (1u32 << 24) as f32
}

/// Smooth noise of this many cells, repeating along `s`.
fn noise(s: f32, t: f32, cells: i32, seed: u32) -> f32 {
    let (x, y) = (s * cells as f32, t * cells as f32);
    let (i, j) = (x.floor(), y.floor());
    let ease = |f: f32| f * f * (3.0 - 2.0 * f);
    let (fx, fy) = (ease(x - i), ease(y - j));
    let at = |di: i32, dj: i32| hash((i as i32 + di).rem_euclid(cells), j as i32 + dj, seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fy)
}

/// High within random cells, low on their borders: the second nearest seed's distance less the
/// nearest one's.
fn cracks(s: f32, t: f32) -> f32 {
    const CELLS: i32 = 5;
    let (x, y) = (s * CELLS as f32, t * CELLS as f32);
    let (i, j) = (x.floor() as i32, y.floor() as i32);
    let (mut first, mut second) = (f32::INFINITY, f32::INFINITY);
    for dj in -1..=1 {
        for di in -1..=1 {
            let (ci, cj) = (i + di, j + dj);
            let seed = |k| hash(ci.rem_euclid(CELLS), cj, k);
            let (sx, sy) = (ci as f32 + seed(7), cj as f32 + seed(8));
            let d = ((x - sx) * (x - sx) + (y - sy) * (y - sy)).sqrt();
            if d < first {
                (second, first) = (first, d);
            } else if d < second {
                second = d;
            }
        }
    }
    let gap = ((second - first) / 0.18).clamp(0.0, 1.0);
    0.5 - 0.5 * (gap * PI).portable_cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_made_alpha_has_relief_repeats_and_stays_within_bounds() {
        for a in Alpha::MADE {
            let (mut lo, mut hi) = (1.0f32, 0.0f32);
            for i in 0..100 {
                for j in 0..=50 {
                    let (s, t) = (i as f32 / 100.0, j as f32 / 50.0);
                    let h = a.at(s, t, None);
                    assert!((0.0..=1.0).contains(&h), "{a:?}");
                    assert!((h - a.at(s + 3.0, t, None)).abs() < 2e-2, "{a:?} repeats at {s}, {t}");
                    (lo, hi) = (lo.min(h), hi.max(h));
                }
            }
            assert!(hi - lo > 0.5, "{a:?}: {lo} to {hi}");
            let seam = (0..=50).map(|j| j as f32 / 50.0);
            let step = seam
                .map(|t| (a.at(0.0, t, None) - a.at(0.9999, t, None)).abs())
                .fold(0.0, f32::max);
            assert!(step < 0.7, "{a:?}: a step of {step} where it repeats");
        }
    }

    #[test]
    fn a_sixteen_bit_picture_keeps_its_steps() {
        let mut png = Vec::new();
        let pixels: Vec<u16> = (0..16u16).map(|i| i * 4369 / 16 + 30_000).collect();
        let picture = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(4, 4, pixels.clone())
            .expect("fits");
        let formats = [image::ImageFormat::Png, image::ImageFormat::Tiff];
        let known = if cfg!(feature = "pictures") { 2 } else { 1 };
        for format in formats.into_iter().take(known) {
            png.clear();
            picture.write_to(&mut std::io::Cursor::new(&mut png), format).expect("written");
            let read = Picture::decode(&png).expect("read");
            assert_eq!((read.width, read.height, &read.heights), (4, 4, &pixels));
            let corner = read.at(0.125, 0.875);
            assert!((corner - f32::from(pixels[0]) / 65535.0).abs() < 1e-6);
        }
        let see_through =
            image::ImageBuffer::<image::LumaA<u8>, _>::from_raw(2, 1, vec![200u8, 255, 200, 0]);
        png.clear();
        let written = see_through
            .expect("fits")
            .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png);
        written.expect("written");
        let read = Picture::decode(&png).expect("read");
        assert_eq!((read.heights, read.cover), (vec![200 * 257, 0], vec![65_535, 0]));
        assert!(Picture::decode(b"not a picture").is_err());
        assert!(Picture::decode(&png[..png.len() / 2]).is_err());
    }

    #[test]
    fn a_picture_is_the_same_once_it_is_written_and_read_again() {
        let heights: Vec<u16> = (0..64u32).map(|i| (i * i * 16 % 65_536) as u16).collect();
        let opaque = Picture { width: 16, height: 4, heights, cover: Vec::new() };
        let cover: Vec<u16> = (0..64u32).map(|i| (i * 1040 % 65_536) as u16).collect();
        // Transparent pixels are low.
        let heights = opaque.heights.iter().zip(&cover).map(|(&h, &c)| h.min(c)).collect();
        let clear = Picture { heights, cover, ..opaque };
        for picture in [opaque, clear] {
            let read = Picture::decode(&picture.encode().expect("written")).expect("read");
            assert_eq!(read, picture);
        }
        let odd = Picture { width: 3, height: 3, heights: vec![0; 4], cover: Vec::new() };
        assert!(odd.encode().is_err());
    }

    #[cfg(feature = "pictures")]
    #[test]
    fn jpeg_and_webp_are_read_and_their_alpha_counts() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let grey = image::ImageBuffer::<image::Luma<u8>, _>::from_pixel(16, 8, image::Luma([180]));
        grey.write_to(&mut bytes, image::ImageFormat::Jpeg).expect("written");
        let read = Picture::decode(bytes.get_ref()).expect("a JPEG");
        assert_eq!((read.width, read.height, read.cover.len()), (16, 8, 0));
        assert!(read.heights.iter().all(|h| h.abs_diff(180 * 257) < 3 * 257));
        bytes = std::io::Cursor::new(Vec::new());
        let rim = image::ImageBuffer::from_fn(8, 8, |x, y| {
            let inside = (2..6).contains(&x) && (2..6).contains(&y);
            image::Rgba([150u8, 150, 150, if inside { 255 } else { 0 }])
        });
        rim.write_to(&mut bytes, image::ImageFormat::WebP).expect("written");
        let read = Picture::decode(bytes.get_ref()).expect("a WebP");
        assert_eq!((read.heights[0], read.cover[0]), (0, 0));
        assert_eq!((read.heights[27], read.cover[27]), (150 * 257, 65_535));
    }
}
