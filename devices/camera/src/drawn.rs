//! Drawn hands: pictures of hands whose joints are known, for tests, demos and the guide.
//!
//! A hand is a set of tapered capsules with a lambertian skin before a plain or cluttered
//! background. The hand models recognise it, so no test needs a photograph of a person.

use glam::{Vec2, Vec3};

use crate::drawn_hand::DrawnHand;
use crate::lens::Lens;
use crate::picture::Picture;

/// Look of a drawn picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnScene {
    /// Columns and rows.
    pub size: (usize, usize),
    /// The camera's lens.
    pub lens: Lens,
    /// Colour of the skin in full light.
    pub skin: [u8; 3],
    /// Direction to the lamp in the camera's axes: x right, y down, z away from the camera.
    pub lamp: Vec3,
    /// Brightness of the lamp, 1 for a well-lit room.
    pub light: f32,
    /// Standard deviation of the noise, of 255.
    pub noise: f32,
    /// Rectangles and balls behind the hands.
    pub clutter: usize,
    /// Seed of noise and clutter.
    pub seed: u64,
}

impl Default for DrawnScene {
    fn default() -> Self {
        DrawnScene {
            size: (640, 480),
            lens: Lens::default(),
            skin: [205, 150, 120],
            lamp: Vec3::new(-0.4, -0.5, -0.76),
            light: 1.0,
            noise: 4.0,
            clutter: 0,
            seed: 1,
        }
    }
}

/// A part of a hand between two places, with the radius at each; mm in the camera's axes.
#[derive(Clone, Copy)]
struct Capsule {
    ends: [Vec3; 2],
    radii: [f32; 2],
}

/// Radii of the fingers at their knuckles, mm.
const FINGER_RADII: [f32; 5] = [11.0, 9.5, 9.7, 9.3, 8.0];

fn capsules(points: &[Vec3; 21], lower_arm: Vec3, scale: f32, out: &mut Vec<Capsule>) {
    let mut add = |a: Vec3, b: Vec3, ra: f32, rb: f32| {
        out.push(Capsule { ends: [a, b], radii: [ra * scale, rb * scale] });
    };
    for finger in 0..5 {
        let r = FINGER_RADII[finger];
        for k in 0..3 {
            let at = 1 + 4 * finger + k;
            let taper = 1.05 - 0.1 * k as f32;
            add(points[at], points[at + 1], r * taper, r * (taper - 0.1));
        }
        // The palm: from the wrist, a little apart, to each knuckle.
        let root = points[0].lerp(points[1 + 4 * finger], 0.12);
        add(root, points[1 + 4 * finger], 17.0, 12.0);
    }
    for (a, b) in [(5, 9), (9, 13), (13, 17)] {
        add(points[a], points[b], 12.0, 12.0);
        // Flesh between the bones, and the web of the thumb.
        let between = points[a].lerp(points[b], 0.5);
        add(points[0].lerp(between, 0.2), between, 17.0, 12.5);
    }
    add(points[1], points[5], 14.0, 11.0);
    add(points[2], points[5], 9.0, 10.0);
    add(points[1].lerp(points[2], 0.4), points[0].lerp(points[5], 0.6), 14.0, 12.0);
    // The balls of the thumb and of the little finger.
    add(points[0].lerp(points[1], 0.4), points[2], 19.0, 13.0);
    add(points[0].lerp(points[17], 0.2), points[17], 17.0, 12.0);
    add(points[0], lower_arm, 20.0, 22.0);
}

/// A small generator of repeatable noise (PCG, O'Neill 2014).
#[derive(Debug, Clone)]
struct NoiseSource(u64);

impl NoiseSource {
    fn next(&mut self) -> u32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let word = ((self.0 >> 18) ^ self.0) >> 27;
        (word as u32).rotate_right((self.0 >> 59) as u32)
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / 16_777_216.0
    }

    /// Roughly normal, with deviation 1.
    fn normal(&mut self) -> f32 {
        let word = self.next();
        let sum: u32 = word.to_le_bytes().iter().map(|b| u32::from(*b)).sum();
        (sum as f32 - 510.0) / 147.8
    }
}

/// Draws hands, given in the tracker's axes, as the camera sees them.
pub fn draw(scene: &DrawnScene, hands: &[DrawnHand]) -> Picture {
    draw_exposed(scene, &[hands])
}

/// Draws hands that move while the shutter is open: each entry holds them at one moment of the
/// exposure.
pub fn draw_exposed<H: AsRef<[DrawnHand]>>(scene: &DrawnScene, moments: &[H]) -> Picture {
    let (width, height) = scene.size;
    let mut noise = NoiseSource(scene.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let empty = background(scene, &mut noise);
    let mut colours = vec![Vec3::ZERO; if moments.len() > 1 { empty.len() } else { 0 }];
    let mut last = empty.clone();
    for moment in moments {
        last.clone_from(&empty);
        draw_hands(scene, moment.as_ref(), &mut last);
        let share = 1.0 / moments.len() as f32;
        colours.iter_mut().zip(&last).for_each(|(sum, c)| *sum += *c * share);
    }
    let rgb = if colours.is_empty() { &last } else { &colours }
        .iter()
        .flat_map(|c| c.to_array())
        .map(|v| (v + scene.noise * noise.normal()).round().clamp(0.0, 255.0) as u8)
        .collect();
    Picture { width, height, rgb }
}

fn draw_hands(scene: &DrawnScene, hands: &[DrawnHand], colours: &mut [Vec3]) {
    let mut nearest = vec![f32::MAX; colours.len()];
    for hand in hands {
        let points = hand.joints.map(|p| scene.lens.to_camera(p));
        let arm = points[0] + (points[0] - points[9]).normalize_or(Vec3::Y) * 160.0;
        let mut parts = Vec::with_capacity(32);
        capsules(&points, arm, hand.scale, &mut parts);
        for part in &parts {
            draw_capsule(scene, part, colours, &mut nearest);
        }
    }
}

fn background(scene: &DrawnScene, noise: &mut NoiseSource) -> Vec<Vec3> {
    let (width, height) = scene.size;
    let mut colours = Vec::with_capacity(width * height);
    for y in 0..height {
        let down = y as f32 / height as f32;
        let wall = Vec3::new(96.0, 104.0, 112.0).lerp(Vec3::new(66.0, 70.0, 78.0), down);
        colours.extend(std::iter::repeat_n(wall * scene.light, width));
    }
    for _ in 0..scene.clutter {
        let (x, y) = (noise.unit() * width as f32, noise.unit() * height as f32);
        let (w, h) = (20.0 + noise.unit() * 150.0, 20.0 + noise.unit() * 120.0);
        let colour =
            Vec3::new(noise.unit(), noise.unit(), noise.unit()) * 200.0 * scene.light + 20.0;
        let round = noise.unit() < 0.4;
        for py in (y as usize)..((y + h) as usize).min(height) {
            for px in (x as usize)..((x + w) as usize).min(width) {
                let off = Vec2::new(px as f32 - x, py as f32 - y) / Vec2::new(w, h) * 2.0 - 1.0;
                if !round || off.length_squared() < 1.0 {
                    colours[py * width + px] = colour;
                }
            }
        }
    }
    colours
}

fn draw_capsule(scene: &DrawnScene, part: &Capsule, colours: &mut [Vec3], nearest: &mut [f32]) {
    let (width, height) = scene.size;
    let size = Vec2::new(width as f32, height as f32);
    let focal = scene.lens.focal_px(size);
    let [a, b] = part.ends;
    if a.z < 40.0 || b.z < 40.0 {
        return;
    }
    let flat = |p: Vec3| size * 0.5 + Vec2::new(p.x, p.y) * (focal / p.z);
    let (fa, fb) = (flat(a), flat(b));
    let radii = [part.radii[0] * focal / a.z, part.radii[1] * focal / b.z];
    let reach = radii[0].max(radii[1]) + 1.0;
    let low = (fa.min(fb) - reach).max(Vec2::ZERO);
    let high = (fa.max(fb) + reach).min(size - 1.0);
    if low.x > high.x || low.y > high.y {
        return;
    }
    let along = fb - fa;
    let length = along.length_squared().max(1e-6);
    let lamp = scene.lamp.normalize_or(Vec3::NEG_Z);
    let skin = Vec3::from_array(scene.skin.map(f32::from));
    // Along the axis the surface leans as the radii differ and as the part points at the camera.
    for y in low.y as usize..=high.y as usize {
        for x in low.x as usize..=high.x as usize {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let t = ((p - fa).dot(along) / length).clamp(0.0, 1.0);
            let r = radii[0] + (radii[1] - radii[0]) * t;
            let off = p - fa - along * t;
            let inside = r * r - off.length_squared();
            if inside <= 0.0 {
                continue;
            }
            let z = a.z + (b.z - a.z) * t;
            let normal = Vec3::new(off.x, off.y, -inside.sqrt()) / r;
            let depth = z + normal.z * r * z / focal;
            let at = y * width + x;
            if depth < nearest[at] {
                nearest[at] = depth;
                let shade = (normal.dot(lamp).clamp(0.0, 1.0) * 0.75 + 0.3) * scene.light;
                colours[at] = (skin * shade).min(Vec3::splat(255.0));
            }
        }
    }
}
