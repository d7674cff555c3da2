//! What the drawn hands of `sculptd demo --camera` do before the camera: push, pinch, smooth, turn
//! and zoom.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec3, vec3};

use sculptd_devices::sim::hand::{HandKey, HandScript, Performer};

/// Middle of the tracked space, mm.
const MIDDLE: Vec3 = vec3(0.0, 200.0, 0.0);

/// An upright hand, palm to the camera, fingers a little apart, `by` from the middle.
fn upright(seconds: f32, by: Vec3) -> HandKey {
    HandKey::flat((seconds * 1e6) as u64, MIDDLE + by).turned(0.0, FRAC_PI_2, 0.0)
}

/// About 18 s: a finger pushes into the clay, a pinch draws it out, a flat palm smooths, an open
/// hand turns the view, and two open hands zoom.
pub fn performance() -> HandScript {
    let point = |s: f32, by: Vec3| upright(s, by).pointing();
    // Less than no spread: the fingers lie together.
    let flat = |s: f32, by: Vec3| upright(s, by).spread(-0.7);
    let open = |s: f32, by: Vec3| upright(s, by).spread(0.9);
    let right = vec![
        // Push: the finger goes through the clay from the right, twice.
        point(0.0, vec3(110.0, -60.0, 0.0)),
        point(1.2, vec3(110.0, -60.0, 0.0)),
        point(2.4, vec3(15.0, -60.0, 0.0)),
        point(3.2, vec3(100.0, -30.0, 0.0)),
        point(4.2, vec3(10.0, -30.0, 0.0)),
        // Pinch: takes hold of the clay and draws it out.
        upright(5.0, vec3(50.0, -10.0, 0.0)),
        upright(5.4, vec3(45.0, -10.0, 0.0)).pinched(1.0),
        upright(5.9, vec3(45.0, -10.0, 0.0)).pinched(1.0),
        upright(7.2, vec3(115.0, 20.0, 0.0)).pinched(1.0),
        upright(7.5, vec3(115.0, 20.0, 0.0)),
        // Smooth: a flat palm over the surface.
        flat(8.3, vec3(60.0, 10.0, 0.0)),
        flat(9.3, vec3(-50.0, 0.0, 0.0)),
        flat(10.3, vec3(60.0, -20.0, 0.0)),
        // Turn: an open hand sweeps across.
        open(11.2, vec3(90.0, 0.0, 40.0)),
        open(11.9, vec3(90.0, 0.0, 40.0)),
        open(13.2, vec3(-60.0, 0.0, 40.0)),
        // Zoom: two open hands part.
        open(14.0, vec3(70.0, 0.0, 60.0)),
        open(15.2, vec3(70.0, 0.0, 60.0)),
        open(16.6, vec3(135.0, 0.0, 60.0)),
        open(17.2, vec3(135.0, 0.0, 60.0)).gone(),
        open(17.6, vec3(135.0, 0.0, 60.0)).gone(),
    ];
    let left = vec![
        open(13.9, vec3(-70.0, 0.0, 60.0)),
        open(15.2, vec3(-70.0, 0.0, 60.0)),
        open(16.6, vec3(-135.0, 0.0, 60.0)),
        open(17.2, vec3(-135.0, 0.0, 60.0)).gone(),
    ];
    HandScript {
        performers: vec![
            Performer { left: false, keys: right },
            Performer { left: true, keys: left },
        ],
    }
}
