//! Hands, written as a frame of protocol 6.

use std::fmt::Write;

use glam::{Mat3, Vec3};

use crate::sample::{Finger, Hand, Hands};
use crate::sim::hand::basis;

/// Encodes one frame: every field of protocol 6, for every hand in view. `stamp` is the tracker's
/// clock in µs.
pub fn frame_json(hands: &Hands, stamp: u64, rate: f32) -> String {
    let mut out = String::with_capacity(1024 + 8192 * hands.count as usize);
    let _ = write!(
        out,
        concat!(
            r#"{{"currentFrameRate":{rate},"id":{},"timestamp":{stamp},"#,
            r#""r":[[1,0,0],[0,1,0],[0,0,1]],"s":1,"t":[0,0,0],"gestures":[],"#,
            r#""interactionBox":{{"center":[0,200,0],"size":[235.247,235.247,147.751]}},"#,
            r#""hands":["#
        ),
        hands.frame,
        rate = rate,
        stamp = stamp
    );
    for (i, hand) in hands.as_slice().iter().enumerate() {
        out.push_str(if i > 0 { "," } else { "" });
        write_hand(&mut out, hand);
    }
    out.push_str("],\"pointables\":[");
    let mut first = true;
    for hand in hands.as_slice() {
        for (kind, finger) in hand.fingers.iter().enumerate() {
            if let Some(finger) = finger {
                out.push_str(if first { "" } else { "," });
                first = false;
                write_finger(&mut out, hand, kind, finger);
            }
        }
    }
    out.push_str("]}");
    out
}

fn write_hand(out: &mut String, h: &Hand) {
    let velocity = h.palm_velocity.unwrap_or_default();
    let _ = write!(
        out,
        concat!(
            r#"{{"id":{},"type":"{}","confidence":{},"grabStrength":{},"pinchStrength":{},"#,
            r#""timeVisible":{},"palmWidth":{},"armWidth":60,"sphereRadius":{},"#,
            r#""r":[[1,0,0],[0,1,0],[0,0,1]],"s":1,"t":[0,0,0]"#
        ),
        h.id,
        if h.left == Some(true) { "left" } else { "right" },
        h.confidence.unwrap_or(1.0),
        h.grab.unwrap_or(0.0),
        h.pinch.unwrap_or(0.0),
        h.time_visible.unwrap_or(0.0),
        h.palm_width.unwrap_or(85.0),
        100.0 - 60.0 * h.grab.unwrap_or(0.0),
    );
    let normal = h.palm_normal.unwrap_or(Vec3::NEG_Y);
    vector(out, "palmPosition", h.palm);
    vector(out, "stabilizedPalmPosition", h.palm);
    vector(out, "palmVelocity", velocity);
    vector(out, "palmNormal", normal);
    vector(out, "direction", h.direction.unwrap_or(Vec3::NEG_Z));
    vector(out, "sphereCenter", h.palm + normal * 50.0);
    vector(out, "wrist", h.wrist.unwrap_or(h.palm));
    vector(out, "elbow", h.elbow.unwrap_or(h.palm));
    out.push_str(",\"armBasis\":");
    matrix(out, basis(h));
    out.push('}');
}

fn write_finger(out: &mut String, h: &Hand, kind: usize, f: &Finger) {
    let joints = f.joints.map(|j| j.unwrap_or(f.tip));
    let length: f32 = joints[1..].windows(2).map(|w| w[0].distance(w[1])).sum();
    let _ = write!(
        out,
        concat!(
            r#"{{"id":{},"handId":{},"type":{},"tool":false,"length":{},"width":{},"#,
            r#""extended":{},"touchZone":"none","touchDistance":1,"timeVisible":{}"#
        ),
        10 * h.id + kind as i32,
        h.id,
        kind,
        length,
        f.width.unwrap_or(18.0),
        f.extended.unwrap_or(true),
        h.time_visible.unwrap_or(0.0),
    );
    vector(out, "tipPosition", f.tip);
    vector(out, "stabilizedTipPosition", f.tip);
    vector(out, "tipVelocity", h.palm_velocity.unwrap_or_default());
    vector(out, "direction", f.direction.unwrap_or(Vec3::NEG_Z));
    for (name, place) in ["carp", "mcp", "pip", "dip", "btip"].iter().zip(joints) {
        vector(out, &format!("{name}Position"), place);
    }
    out.push_str(",\"bases\":[");
    for (i, bone) in joints.windows(2).enumerate() {
        out.push_str(if i > 0 { "," } else { "" });
        matrix(out, bone_basis(h, bone[0], bone[1]));
    }
    out.push_str("]}");
}

/// z from the bone's end to its beginning, x across the hand. A bone of no length has the hand's.
fn bone_basis(h: &Hand, from: Vec3, to: Vec3) -> Mat3 {
    let hand = basis(h);
    let z = (from - to).normalize_or(hand.z_axis);
    let y = (hand.y_axis - z * hand.y_axis.dot(z)).normalize_or(hand.y_axis);
    Mat3::from_cols(y.cross(z), y, z)
}

fn vector(out: &mut String, name: &str, v: Vec3) {
    let _ = write!(out, r#","{name}":[{},{},{}]"#, v.x, v.y, v.z);
}

fn matrix(out: &mut String, m: Mat3) {
    let _ = write!(
        out,
        "[[{},{},{}],[{},{},{}],[{},{},{}]]",
        m.x_axis.x,
        m.x_axis.y,
        m.x_axis.z,
        m.y_axis.x,
        m.y_axis.y,
        m.y_axis.z,
        m.z_axis.x,
        m.z_axis.y,
        m.z_axis.z
    );
}
