//! Light from all around: a picture of what surrounds the clay, made
//! ready for diffuse and for glossy light.
//!
//! The picture is equirectangular, as Radiance HDR files of surroundings are. For diffuse light it
//! is folded with the cosine (irradiance, Ramamoorthi and Hanrahan 2001, here by direct sums over
//! a small picture); for glossy light it is halved again and again, and a rougher surface reads a
//! smaller one.

use glam::Vec3;

/// Width of the sharpest picture; its height is half of it.
const WIDTH: usize = 256;
/// Pictures for glossy light, each half as wide as the one before.
const LEVELS: usize = 6;
/// Width of the picture that diffuse light is summed up from, and of the result.
const COARSE: usize = 64;
const DIFFUSE: usize = 32;
/// Mean radiance after scaling, because files define no exposure.
const MEAN: f32 = 0.55;

/// Light of every direction, red, green and blue, linear. Row 0 is overhead.
#[derive(Debug, Clone, PartialEq)]
struct Panorama {
    width: usize,
    pixels: Vec<Vec3>,
}

/// An environment as the card has it: `Rgb9e5Ufloat`, rows from overhead to below.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Diffuse light by the surface's normal: its width and texels.
    pub diffuse: (u32, Vec<u32>),
    /// Glossy light, from sharp to blurred: width and texels of each level.
    pub glossy: Vec<(u32, Vec<u32>)>,
}

/// The direction of the middle of a pixel: x right, y up, z towards the eye at the middle.
fn direction(x: usize, y: usize, width: usize) -> Vec3 {
    let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / (width / 2) as f32);
    let (around, down) = ((u - 0.5) * std::f32::consts::TAU, v * std::f32::consts::PI);
    Vec3::new(down.sin() * around.sin(), down.cos(), down.sin() * around.cos())
}

impl Panorama {
    fn new(width: usize, light: impl Fn(usize, usize) -> Vec3) -> Panorama {
        let all = (0..width / 2).flat_map(|y| (0..width).map(move |x| (x, y)));
        Panorama { width, pixels: all.map(|(x, y)| light(x, y)).collect() }
    }

    fn at(&self, x: usize, y: usize) -> Vec3 {
        self.pixels[y * self.width + x]
    }

    fn half(&self) -> Panorama {
        Panorama::new(self.width / 2, |x, y| {
            let (x, y) = (2 * x, 2 * y);
            (self.at(x, y) + self.at(x + 1, y) + self.at(x, y + 1) + self.at(x + 1, y + 1)) * 0.25
        })
    }

    /// The solid angle of a pixel of row `y`.
    fn angle(&self, y: usize) -> f32 {
        let step = std::f32::consts::TAU / self.width as f32;
        let down = (y as f32 + 0.5) * step;
        step * step * down.sin()
    }

    /// Returns the light on a white surface with this `normal`: the cosine-weighted mean.
    fn seen(&self, normal: Vec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for y in 0..self.width / 2 {
            let angle = self.angle(y);
            for x in 0..self.width {
                let cosine = direction(x, y, self.width).dot(normal).max(0.0);
                sum += self.at(x, y) * (cosine * angle);
            }
        }
        sum / std::f32::consts::PI
    }

    fn texels(&self) -> (u32, Vec<u32>) {
        (self.width as u32, self.pixels.iter().map(|p| shared_exponent(*p)).collect())
    }
}

/// Three numbers in 32 bits: nine bits each and one exponent of five, as `Rgb9e5Ufloat` has them
/// (OpenGL's extension EXT_texture_shared_exponent).
fn shared_exponent(c: Vec3) -> u32 {
    const MOST: f32 = 65_408.0;
    const BIAS: i32 = 15;
    let c = c.to_array().map(|v| if v > 0.0 { v.min(MOST) } else { 0.0 });
    let most = c[0].max(c[1]).max(c[2]);
    let exponent_of = |v: f32| (v.to_bits() >> 23) as i32 - 127;
    let mut exponent = exponent_of(most).max(-BIAS - 1) + 1 + BIAS;
    let unit = |exponent: i32| ((exponent - BIAS - 9) as f32).exp2();
    if (most / unit(exponent) + 0.5).floor() >= 512.0 {
        exponent += 1;
    }
    let [r, g, b] = c.map(|v| (v / unit(exponent) + 0.5).floor() as u32);
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

impl Environment {
    /// Of an equirectangular picture, red, green and blue in linear light, rows from overhead.
    /// Numbers that are not finite or below 0 count as dark.
    pub fn of_picture(width: usize, height: usize, pixels: &[f32]) -> Option<Environment> {
        if width == 0 || height == 0 || pixels.len() != width * height * 3 {
            return None;
        }
        let sound = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
        // Each pixel is the mean of the pixels that it covers; at least one.
        let span = |i: usize, parts: usize, whole: usize| {
            let from = i * whole / parts;
            from..((i + 1) * whole / parts).max(from + 1)
        };
        let sharp = Panorama::new(WIDTH, |x, y| {
            let (mut sum, mut count) = (Vec3::ZERO, 0.0);
            for row in span(y, WIDTH / 2, height) {
                for column in span(x, WIDTH, width) {
                    let at = 3 * (row * width + column);
                    let [r, g, b] = [pixels[at], pixels[at + 1], pixels[at + 2]].map(sound);
                    sum += Vec3::new(r, g, b);
                    count += 1.0;
                }
            }
            sum / count
        });
        Some(Environment::of(sharp))
    }

    /// A room with two large soft lights and a pale floor, for metal without a picture.
    pub fn room() -> Environment {
        Environment::of(Panorama::new(WIDTH, |x, y| {
            let d = direction(x, y, WIDTH);
            // A soft edge, or the lights would be seen as cut out.
            let lamp =
                |to: Vec3, size: f32| ((d.dot(to.normalize()) - size) * 12.0).clamp(0.0, 1.0);
            let key = lamp(Vec3::new(-0.55, 0.65, 0.5), 0.86) * 5.0;
            let side = lamp(Vec3::new(0.95, 0.15, -0.05), 0.90) * 2.2;
            let sky = Vec3::new(0.30, 0.33, 0.38) * (0.5 + 0.5 * d.y);
            let floor = Vec3::new(0.20, 0.17, 0.15) * (0.5 - 0.5 * d.y);
            sky + floor + Vec3::new(1.0, 0.96, 0.9) * key + Vec3::new(0.75, 0.86, 1.0) * side
        }))
    }

    fn of(mut sharp: Panorama) -> Environment {
        let (mut light, mut angles) = (0.0, 0.0);
        for y in 0..WIDTH / 2 {
            let angle = sharp.angle(y);
            for x in 0..WIDTH {
                light += sharp.at(x, y).element_sum() / 3.0 * angle;
                angles += angle;
            }
        }
        let exposure = if light > 0.0 { MEAN * angles / light } else { 1.0 };
        sharp.pixels.iter_mut().for_each(|p| *p *= exposure);
        let mut levels = vec![sharp];
        while levels.len() < LEVELS {
            levels.push(levels[levels.len() - 1].half());
        }
        let coarse = &levels[(WIDTH / COARSE).ilog2() as usize];
        let diffuse = Panorama::new(DIFFUSE, |x, y| coarse.seen(direction(x, y, DIFFUSE)));
        Environment {
            diffuse: diffuse.texels(),
            glossy: levels.iter().map(Panorama::texels).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(texel: u32) -> Vec3 {
        let unit = ((texel >> 27) as f32 - 24.0).exp2();
        let part = |shift: u32| (texel >> shift & 511) as f32 * unit;
        Vec3::new(part(0), part(9), part(18))
    }

    #[test]
    fn a_texel_keeps_its_light() {
        for c in [
            Vec3::ZERO,
            Vec3::new(0.5, 0.25, 1.0),
            Vec3::new(1e-3, 2.0, 300.0),
            Vec3::splat(0.999_99),
            Vec3::splat(1e9),
        ] {
            let back = decoded(shared_exponent(c));
            let asked = c.min(Vec3::splat(65_408.0));
            assert!(
                (back - asked).abs().max_element() <= asked.max_element() / 510.0,
                "{c} {back}"
            );
        }
        assert_eq!(decoded(shared_exponent(Vec3::new(f32::NAN, -1.0, 1.0))), Vec3::Z);
    }

    #[test]
    fn even_light_is_even_on_every_side() {
        let even = Environment::of_picture(8, 4, &[3.0; 8 * 4 * 3]).expect("a picture");
        for texel in even.diffuse.1.iter().chain(&even.glossy[5].1) {
            assert!((decoded(*texel) - Vec3::splat(MEAN)).abs().max_element() < 0.01, "{texel:x}");
        }
        assert_eq!(even.glossy.iter().map(|l| l.0).collect::<Vec<_>>(), [256, 128, 64, 32, 16, 8]);
        assert!(even.glossy.iter().all(|l| l.1.len() as u32 == l.0 * l.0 / 2));
        assert_eq!(Environment::of_picture(8, 4, &[0.0; 5]), None);
        assert_eq!(Environment::of_picture(0, 4, &[]), None);
    }

    #[test]
    fn light_from_overhead_falls_on_what_looks_up() {
        let mut sky = vec![0.0; 16 * 8 * 3];
        sky[..16 * 4 * 3].fill(1.0);
        let half = Environment::of_picture(16, 8, &sky).expect("a picture");
        let up = decoded(half.diffuse.1[DIFFUSE / 2]);
        let down = decoded(half.diffuse.1[half.diffuse.1.len() - DIFFUSE / 2]);
        // By the formula: 2 * MEAN overhead, none below, a share of (1 + cos) / 2 between.
        assert!((up.x - 2.0 * MEAN).abs() < 0.03 && down.x < 0.02, "{up} {down}");
        // Nothing but darkness stays dark, and does not divide by it.
        let dark = Environment::of_picture(16, 8, &[f32::NAN; 16 * 8 * 3]).expect("a picture");
        assert!(dark.diffuse.1.iter().all(|t| decoded(*t) == Vec3::ZERO));
    }
}
