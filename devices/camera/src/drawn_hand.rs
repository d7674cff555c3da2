//! The skeleton of a drawn hand: an adult's proportions, posed like the simulated hand of a
//! tracker.

use glam::{Quat, Vec3, vec3};

use crate::landmarks::JOINTS;
use sculptd_devices::sim::hand::{HandKey, HandScript};

/// A hand to draw: joints in the tracker's axes, mm, in the order of the landmark model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnHand {
    /// Wrist, then four joints a finger, thumb first.
    pub joints: [Vec3; JOINTS],
    /// Size as a share of an average adult's hand.
    pub scale: f32,
    /// A left hand.
    pub left: bool,
}

/// First joint of each finger of a right hand, mm from the wrist: the palm is in the plane of x
/// and z with its back up, and the fingers point along -z.
const ROOTS: [Vec3; 5] = [
    vec3(-32.0, -6.0, -23.0),
    vec3(-26.0, 0.0, -87.0),
    vec3(-5.0, 2.0, -92.0),
    vec3(16.0, 0.0, -86.0),
    vec3(33.0, -3.0, -74.0),
];
/// Bones of each finger, mm.
const BONES: [[f32; 3]; 5] = [
    [37.0, 32.0, 26.0],
    [41.0, 26.0, 20.0],
    [46.0, 29.0, 22.0],
    [42.0, 28.0, 21.0],
    [32.0, 20.0, 18.0],
];
/// Degrees by which a relaxed finger leans away from the middle one, to the thumb's side.
const LEAN: [f32; 5] = [45.0, 9.0, 1.0, -6.0, -14.0];
/// Most degrees that each joint bends.
const BEND: [f32; 3] = [80.0, 100.0, 65.0];
/// The same of a thumb.
const THUMB_BEND: [f32; 3] = [28.0, 36.0, 42.0];

impl DrawnHand {
    /// Poses a hand. The palm's middle comes to the key's place.
    pub fn new(key: &HandKey, left: bool, scale: f32) -> Self {
        let mut own = [Vec3::ZERO; JOINTS];
        for finger in 0..5 {
            let chain = chain(finger, key.curl[finger], key.spread);
            own[1 + 4 * finger..][..4].copy_from_slice(&chain);
        }
        if key.pinch > 0.0 {
            pinch(&mut own, key.pinch);
        }
        let middle = [0, 5, 9, 13, 17].iter().map(|i| own[*i]).sum::<Vec3>() * 0.2;
        let [yaw, pitch, roll] = key.yaw_pitch_roll;
        let turn =
            Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Quat::from_rotation_z(roll);
        let side = if left { -1.0 } else { 1.0 };
        let joints = own.map(|p| {
            let p = (p - middle) * scale;
            key.palm + turn * vec3(side * p.x, p.y, p.z)
        });
        DrawnHand { joints, scale, left }
    }

    /// Every hand of a script at one instant.
    pub fn of_script(script: &HandScript, t_us: u64) -> Vec<DrawnHand> {
        let hands = script.performers.iter();
        hands.filter_map(|p| Some(DrawnHand::new(&p.at(t_us)?.0, p.left, 1.0))).collect()
    }

    /// Returns the distance between the tips of thumb and index finger, mm.
    pub fn pinch_gap(&self) -> f32 {
        self.joints[4].distance(self.joints[8])
    }
}

fn chain(finger: usize, curl: f32, spread: f32) -> [Vec3; 4] {
    let thumb = finger == 0;
    // Curled fingers lie together; fingers that are spread stand twice as far apart.
    let apart = if thumb { 1.0 - 0.5 * curl } else { (1.0 + spread) * (1.0 - 0.7 * curl) };
    let mut turn = Quat::from_rotation_y(LEAN[finger].to_radians() * apart);
    // A thumb closes across the palm, the fingers into it.
    let axis = if thumb { vec3(0.35, 0.85, 0.0).normalize() } else { Vec3::X };
    let bend = if thumb { THUMB_BEND } else { BEND };
    let mut joints = [ROOTS[finger]; 4];
    for bone in 0..3 {
        turn *= Quat::from_axis_angle(axis, -bend[bone].to_radians() * curl);
        joints[bone + 1] = joints[bone] + turn * vec3(0.0, 0.0, -BONES[finger][bone]);
    }
    joints
}

/// Brings the tips of thumb and index finger together, each joint by its share of the way.
fn pinch(own: &mut [Vec3; JOINTS], by: f32) {
    let meet = (own[4] + own[8]) * 0.5 + vec3(0.0, -14.0, 10.0);
    for (tip, apart) in [(4, vec3(-4.0, -2.0, 0.0)), (8, vec3(4.0, 2.0, 0.0))] {
        let whole = (meet + apart - own[tip]) * by;
        for (joint, share) in [(tip - 2, 0.25), (tip - 1, 0.65), (tip, 1.0)] {
            own[joint] += whole * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_is_where_its_key_says_and_as_large_as_its_scale() {
        let key = HandKey::flat(0, vec3(10.0, 200.0, -30.0)).turned(0.3, 1.2, 0.4);
        for (left, scale) in [(false, 1.0), (true, 0.85)] {
            let hand = DrawnHand::new(&key, left, scale);
            let palm = crate::hand_sample::palm_of(&hand.joints);
            assert!(palm.distance(key.palm) < 1e-3);
            let bone = hand.joints[9].distance(hand.joints[10]);
            assert!((bone - 46.0 * scale).abs() < 1e-3);
        }
        let open = DrawnHand::new(&key, false, 1.0).pinch_gap();
        let closed = DrawnHand::new(&key.pinched(1.0), false, 1.0).pinch_gap();
        assert!(open > 50.0 && closed < 12.0, "{open} {closed}");
    }
}
