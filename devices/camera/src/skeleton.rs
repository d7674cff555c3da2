//! The bones between a hand's joints, and a drawing of them over a picture.

use glam::Vec2;

use crate::landmarks::JOINTS;
use crate::picture::Picture;

/// Pairs of joints that a bone connects.
pub const BONES: [(usize, usize); 21] = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 4),
    (0, 5),
    (5, 6),
    (6, 7),
    (7, 8),
    (5, 9),
    (9, 10),
    (10, 11),
    (11, 12),
    (9, 13),
    (13, 14),
    (14, 15),
    (15, 16),
    (13, 17),
    (17, 18),
    (18, 19),
    (19, 20),
    (0, 17),
];

/// Colour of bones and of joints.
const BONE: [u8; 3] = [90, 220, 160];
const JOINT: [u8; 3] = [255, 255, 255];

/// Paints a skeleton; joints in pixels.
pub fn paint(picture: &mut Picture, joints: &[Vec2; JOINTS]) {
    for (a, b) in BONES {
        let (a, b) = (joints[a], joints[b]);
        let steps = (a.distance(b).min(4096.0) as usize).max(1);
        for i in 0..=steps {
            dot(picture, a.lerp(b, i as f32 / steps as f32), 1.2, BONE);
        }
    }
    for joint in joints {
        dot(picture, *joint, 2.5, JOINT);
    }
}

fn dot(picture: &mut Picture, at: Vec2, radius: f32, colour: [u8; 3]) {
    let reach = radius.ceil() as isize;
    let (cx, cy) = (at.x as isize, at.y as isize);
    for y in cy - reach..=cy + reach {
        for x in cx - reach..=cx + reach {
            let off = Vec2::new(x as f32, y as f32).distance(at);
            let inside = x >= 0 && y >= 0 && (x as usize) < picture.width;
            if inside && off <= radius {
                let from = (y as usize * picture.width + x as usize) * 3;
                if let Some(pixel) = picture.rgb.get_mut(from..from + 3) {
                    pixel.copy_from_slice(&colour);
                }
            }
        }
    }
}
