//! Where the palm is, and how it is turned: a rigid palm of known size is fitted to the pixels of
//! its six joints (perspective-n-point by Gauss-Newton, Lepetit and Fua 2005, 4.2), held near the
//! turn that the landmark model sees.
//!
//! A rigid palm is what makes depth hold while the hand turns: the model stretches its shape by a
//! tenth to explain a turned palm, and the fit does not.

use glam::{DMat3, DQuat, DVec3, Vec2, Vec3};

use crate::landmarks::{JOINTS, PALM_JOINTS};

/// Palm of an average adult as the landmark model sees it: a right hand before the camera, fingers
/// up; mm from the wrist, x right in the picture, y down, z away from the camera. In the order of
/// [`PALM_JOINTS`].
const AVERAGE_PALM: [DVec3; 6] = [
    DVec3::new(0.0, 0.0, 0.0),
    DVec3::new(28.0, -25.0, -8.0),
    DVec3::new(21.0, -88.0, 0.0),
    DVec3::new(0.0, -89.0, 2.0),
    DVec3::new(-19.0, -85.0, -2.0),
    DVec3::new(-33.0, -73.0, -6.0),
];
/// Length of that palm from wrist to middle knuckle, mm.
const PALM_MM: f64 = 89.0;
/// Expected error of a joint's pixel as a share of the palm's length.
const PIXEL_SIGMA: f64 = 0.05;
/// Expected error of the model's turn, radians.
const TURN_SIGMA: f64 = 0.15;
/// Steps of the fit; it converges in three or four.
const STEPS: usize = 6;

/// A palm in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PalmPose {
    /// Place of the wrist in the camera's axes, mm.
    pub wrist: DVec3,
    /// From the turn that the model saw to the fitted one.
    pub correction: DQuat,
    /// Palm joints in the camera's axes, mm, in the order of [`PALM_JOINTS`].
    pub joints: [DVec3; 6],
    /// Size of the palm as a share of the shape's.
    pub growth: f64,
    /// Root mean square of the missed pixels, as a share of the palm's length.
    pub misfit: f64,
}

/// Axes of a palm: along it, out of it, and across.
fn axes(wrist: DVec3, index: DVec3, middle: DVec3, little: DVec3) -> Option<DMat3> {
    let along = (middle - wrist).try_normalize()?;
    let across = index - little;
    let across = (across - along * across.dot(along)).try_normalize()?;
    Some(DMat3::from_cols(across, along, across.cross(along)))
}

/// Fits the palm to rays (pixels over focal length, from the picture's middle).
pub(crate) fn fit_palm(
    rays: &[Vec2; JOINTS],
    shape: &[Vec3; JOINTS],
    left: bool,
    scale: f32,
) -> Option<PalmPose> {
    let side = if left { -1.0 } else { 1.0 };
    let palm = AVERAGE_PALM.map(|p| DVec3::new(side * p.x, p.y, p.z) * f64::from(scale));
    let seen = PALM_JOINTS.map(|i| shape[i].as_dvec3());
    let frame = |p: &[DVec3; 6]| axes(p[0], p[2], p[3], p[5]);
    let turn = frame(&seen)? * frame(&palm)?.transpose();
    let model_turn = DQuat::from_mat3(&turn).normalize();
    let rays = PALM_JOINTS.map(|i| rays[i].as_dvec2());
    let mut turn = model_turn;
    let mut at = linear_place(&rays, &palm.map(|p| turn * p))?;
    for _ in 0..STEPS {
        let sigma = PIXEL_SIGMA * PALM_MM * f64::from(scale) / at.z;
        let mut normal = [[0.0; 6]; 6];
        let mut right = [0.0; 6];
        let mut add = |row: [f64; 6], off: f64| {
            for i in 0..6 {
                for j in 0..6 {
                    normal[i][j] += row[i] * row[j];
                }
                right[i] -= row[i] * off;
            }
        };
        for (ray, p) in rays.iter().zip(&palm) {
            let arm = turn * *p;
            let place = arm + at;
            if place.z < 10.0 {
                return None;
            }
            for (axis, seen) in [(0, ray.x), (1, ray.y)] {
                let shown = place[axis] / place.z;
                // How the pixel moves with the place, and with the turn by way of the place.
                let mut slope = DVec3::ZERO;
                slope[axis] = 1.0;
                let slope = (slope - DVec3::Z * shown) / (place.z * sigma);
                let swing = arm.cross(slope);
                let row = [swing.x, swing.y, swing.z, slope.x, slope.y, slope.z];
                add(row, (shown - seen) / sigma);
            }
        }
        let off = (turn * model_turn.inverse()).normalize();
        let off = if off.w < 0.0 { -off } else { off }.to_scaled_axis() / TURN_SIGMA;
        for axis in 0..3 {
            let mut row = [0.0; 6];
            row[axis] = 1.0 / TURN_SIGMA;
            add(row, off[axis]);
        }
        let step = solve(normal, right)?;
        let by = DVec3::new(step[0], step[1], step[2]).clamp_length_max(0.5);
        turn = (DQuat::from_scaled_axis(by) * turn).normalize();
        at += DVec3::new(step[3], step[4], step[5]).clamp_length_max(0.5 * at.z);
        if !at.is_finite() || at.z < 40.0 {
            return None;
        }
    }
    let joints = palm.map(|p| turn * p + at);
    let missed: f64 =
        joints.iter().zip(&rays).map(|(p, ray)| (p.truncate() / p.z).distance_squared(*ray)).sum();
    let size = PALM_MM * f64::from(scale) / at.z;
    let spread = |p: &[DVec3; 6]| {
        let middle = p.iter().sum::<DVec3>() / 6.0;
        p.iter().map(|p| p.distance_squared(middle)).sum::<f64>().sqrt()
    };
    Some(PalmPose {
        wrist: joints[0],
        correction: (turn * model_turn.inverse()).normalize(),
        joints,
        growth: spread(&palm) / spread(&seen).max(1.0),
        misfit: (missed / 6.0).sqrt() / size,
    })
}

/// The place of a shape that is already turned: linear in its three unknowns.
fn linear_place(rays: &[glam::DVec2; 6], shape: &[DVec3; 6]) -> Option<DVec3> {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (ray, p) in rays.iter().zip(shape) {
        for (row, value) in [
            (DVec3::new(1.0, 0.0, -ray.x), ray.x * p.z - p.x),
            (DVec3::new(0.0, 1.0, -ray.y), ray.y * p.z - p.y),
        ] {
            normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            right += row * value;
        }
    }
    (normal.determinant().abs() > 1e-9).then_some(())?;
    let at = normal.inverse() * right;
    (at.is_finite() && at.z > 40.0 && at.z < 5000.0).then_some(at)
}

/// Solves six equations by Gaussian elimination with pivots.
fn solve(mut a: [[f64; 6]; 6], mut b: [f64; 6]) -> Option<[f64; 6]> {
    for k in 0..6 {
        let pivot = (k..6).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs()))?;
        if !(a[pivot][k].abs() > 1e-12) {
            return None;
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..6 {
            let by = a[i][k] / a[k][k];
            for j in k..6 {
                a[i][j] -= by * a[k][j];
            }
            b[i] -= by * b[k];
        }
    }
    for k in (0..6).rev() {
        for j in k + 1..6 {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels of an average palm, turned and placed.
    fn exact(turn: DQuat, at: DVec3, left: bool) -> ([Vec2; JOINTS], [Vec3; JOINTS]) {
        let (mut rays, mut shape) = ([Vec2::ZERO; JOINTS], [Vec3::ZERO; JOINTS]);
        for (i, p) in PALM_JOINTS.iter().zip(AVERAGE_PALM) {
            let p = turn * DVec3::new(if left { -p.x } else { p.x }, p.y, p.z);
            shape[*i] = p.as_vec3();
            let place = p + at;
            rays[*i] = (place.truncate() / place.z).as_vec2();
        }
        (rays, shape)
    }

    #[test]
    fn an_exact_palm_is_found_and_a_wrong_turn_is_corrected() {
        for (axis, angle, left) in [(DVec3::X, 0.5, false), (DVec3::Y, -0.8, true)] {
            let turn = DQuat::from_axis_angle(axis, angle);
            let at = DVec3::new(30.0, -40.0, 420.0);
            let (rays, mut shape) = exact(turn, at, left);
            let pose = fit_palm(&rays, &shape, left, 1.0).expect("a pose");
            assert!(pose.wrist.distance(at) < 0.01 && pose.misfit < 1e-6, "{pose:?}");
            // The model sees the palm a little less turned, as it does with drawn hands.
            let less = DQuat::from_axis_angle(axis, -0.2 * angle).as_quat();
            shape = shape.map(|p| less * p);
            let pose = fit_palm(&rays, &shape, left, 1.0).expect("a pose");
            assert!((pose.wrist.z - at.z).abs() < 0.02 * at.z, "{pose:?}");
        }
    }
}
