//! Random requests of the control socket: for each method of the schema, parameters that mean
//! something in the present state, mostly.

use std::path::Path;

use serde_json::{Value, json};

use crate::seeded::Random;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;

/// Asks the daemon; `None`: it refused.
pub type Ask<'a> = &'a dyn Fn(&str, Value) -> Option<Value>;

/// Writes the files that the requests name.
pub fn write_files(dir: &Path) {
    let small = shapes::icosphere(0.3, 8).to_poly();
    write_mesh(&dir.join("ball.ply"), &shapes::icosphere(1.0, 12).to_poly()).expect("a file");
    write_mesh(&dir.join("box.ply"), &small).expect("a file");
    let picture = image::GrayImage::from_fn(16, 16, |x, y| image::Luma([(x * y) as u8]));
    picture.save(dir.join("heights.png")).expect("a picture");
}

fn region(r: &mut Random) -> Value {
    let (x, y) = (0.3 + 0.2 * r.part(), 0.3 + 0.2 * r.part());
    json!({ "box": [x, y, x + 0.2, y + 0.2] })
}

/// Parameters that mean something in the present state, mostly.
pub fn params(method: &str, r: &mut Random, ask: Ask<'_>, dir: &Path) -> Value {
    let mut one_of = |method: &str, list: &str, key: &str| {
        let all = ask(method, Value::Null).map(|reply| reply[list].clone());
        let all = all.as_ref().and_then(Value::as_array).map_or(&[][..], |a| a);
        all.get(r.below(all.len().max(1) as u64) as usize).map_or(json!(0), |o| o[key].clone())
    };
    let any = one_of("scene.list", "objects", "id");
    let other = one_of("scene.list", "objects", "id");
    let layer = one_of("layers.list", "layers", "id");
    // 0 are the vertices in no set.
    let set = one_of("sets.list", "sets", "set").as_u64().unwrap_or(1).max(1);
    let link = one_of("guests.list", "links", "key");
    let file = dir.join(r.of(&["ball.ply", "box.ply"]));
    let operation = r.of(&["union", "intersection", "difference", "reverse-difference"]);
    let node = || ask("history", Value::Null).map(|h| h["places"].clone());
    let turn = [0.0, 0.0, 0.0, 1.0];
    match method {
        "guests.invite" => json!({ "role": "viewer" }),
        "guests.revoke" => json!({ "key": link }),
        "brush" => {
            json!({ "radius": 0.05 + 0.3 * r.part(), "kind": r.of(&["draw", "clay", "smooth"]) })
        }
        "picture" => json!({ "path": dir.join("heights.png") }),
        "mask" => json!({ "action": r.of(&["clear", "fill", "invert", "blur", "grow", "shrink"]) }),
        "mask-measured" => json!({ "by": { "thin": 0.1 + r.part() } }),
        "mask-region" => json!({ "region": region(r), "mask": r.part() }),
        "curve" => json!({ "act": r.of(&["apply", "cancel"]) }),
        "stroke" => {
            let (x, y) = (0.45 + 0.1 * r.part(), 0.45 + 0.1 * r.part());
            let points = json!([[x, y, 1.0, 0], [x + 0.05, y, 1.0, 20], [x + 0.1, y, 1.0, 40]]);
            json!({ "points": points, "space": "view" })
        }
        "camera" => json!({ "yaw": r.part() * 3.0, "pitch": r.part() - 0.5 }),
        "jump" => {
            let places = node().unwrap_or_default();
            let count = places.as_array().map_or(0, Vec::len).max(1) as u64;
            json!({ "node": places[r.below(count) as usize]["node"] })
        }
        "load" | "take-up" => json!({ "path": file }),
        "export" => json!({ "path": dir.join("out.ply") }),
        "thickness" => json!({ "rays": 1 }),
        "join" => json!({ "operation": operation }),
        "trim" => json!({ "part": { "box": [0.0, 0.0, 0.45, 1.0] } }),
        "repair" => match r.below(6) {
            0 => json!({ "repair": { "base": 0.05 + 0.3 * r.part() } }),
            1 => json!({ "repair": { "draft": 1.0 + r.part() } }),
            2 => json!({ "repair": { "drain": { "diameter": 0.1 } }, "plate": r.below(2) == 0 }),
            3 => {
                let at = [r.part() - 0.5, r.part() - 0.5, r.part() - 0.5];
                let text = json!({ "text": "No. 8", "at": at, "height": 0.1, "relief": 0.05 });
                json!({ "repair": { "text": text } })
            }
            4 => json!({ "repair": { "thicken": 0.05 + 0.2 * r.part() } }),
            _ => {
                let point = [0.0, r.part() - 0.5, 0.0];
                let plane = json!({ "point": point, "normal": [0, 1, 0], "radius": 0.1 });
                json!({ "repair": { "split": plane } })
            }
        },
        "level" => json!({ "to": r.of(&["up", "down"]) }),
        "remesh" => json!({ "voxel": 0.08 + 0.1 * r.part() }),
        "remesh.quads" => json!({ "quads": 200 + r.below(200) }),
        "remesh.local" => json!({ "stretched_only": false, "edge": null }),
        "symmetrise" => {
            json!({ "axis": r.of(&["x", "y", "z"]), "negative": r.below(2) == 0 })
        }
        "decimate" => json!({ "triangles": 400 + r.below(400) }),
        "boolean" => {
            let at = [r.part() - 0.5, 0.9, r.part() - 0.5];
            json!({ "operation": operation, "path": dir.join("box.ply"), "at": at })
        }
        "scene.add" => match r.below(3) {
            0 => json!({ "path": file }),
            1 => json!({ "held": true }),
            _ => json!({ "primitive": { "ball": 0.4 }, "edge": 0.1 }),
        },
        "scene.rename" => json!({ "id": any, "name": format!("object {}", r.below(100)) }),
        "scene.transform" => {
            let shift = [r.part() - 0.5, 0.0, 0.0];
            json!({ "id": any, "transform": { "shift": shift, "turn": turn, "scale": 1.0 } })
        }
        "scene.show" => json!({ "id": any, "visible": r.below(4) > 0 }),
        "scene.lock" => json!({ "id": any, "locked": r.below(4) == 0 }),
        "scene.reshape" => json!({ "id": any, "primitive": { "ball": 0.3 }, "edge": 0.1 }),
        "scene.snap" => {
            json!({ "id": any, "at": [0.0, 0.0, 1.0], "to": other, "to_at": [0.0, 1.0, 0.0] })
        }
        "scene.boolean" => {
            let live = r.below(4) == 0;
            json!({ "operation": operation, "a": any, "b": other, "live": live })
        }
        "scene.apply" => json!({ "id": following(ask).unwrap_or(any) }),
        "scene.mirror" => json!({ "id": any, "axis": r.of(&["x", "y", "z"]) }),
        "scene.move" => json!({ "id": any, "to": r.below(3) }),
        "scene.group" => json!({ "ids": [any], "name": "group" }),
        "scene.merge" => json!({ "ids": [any, other] }),
        "layers.add" => json!({ "name": format!("layer {}", r.below(100)) }),
        "layers.rename" => json!({ "layer": layer, "name": "renamed" }),
        "layers.move" => json!({ "layer": layer, "to": r.below(3) }),
        "layers.set" => {
            json!({ "layer": layer, "intensity": r.part() * 2.0, "live": r.below(2) == 0 })
        }
        "layers.activate" => {
            json!({ "layer": if r.below(2) == 0 { json!(layer) } else { Value::Null } })
        }
        m if m.starts_with("layers.") && !["layers.list", "layers.bake"].contains(&m) => {
            json!({ "layer": layer })
        }
        "sets.rename" => json!({ "set": set, "name": "a set" }),
        "sets.make" => {
            json!({ "from": r.of(&["mask", "visible", "loose", "normals", "crease", "walls"]) })
        }
        "sets.hide" | "sets.isolate" => json!({ "set": set }),
        "sets.region" => {
            json!({ "region": region(r), "action": r.of(&["make", "hide", "isolate"]) })
        }
        "sets.extract" => json!({ "thickness": 0.05, "set": set }),
        "reach" => json!({ "middle_mm": [0.0, 250.0, 0.0], "half_mm": 100.0 + 100.0 * r.part() }),
        m if m.starts_with("scene.") && m != "scene.list" => json!({ "id": any }),
        _ => Value::Null,
    }
}

/// An object that is the result of a live Boolean.
fn following(ask: Ask<'_>) -> Option<Value> {
    let scene = ask("scene.list", Value::Null)?;
    let objects = scene["objects"].as_array()?;
    objects.iter().find(|o| !o["follows"].is_null()).map(|o| o["id"].clone())
}

/// Brings the sculpture into a state in which the method can be carried out, mostly.
pub fn prepare(method: &str, ask: Ask<'_>, dir: &Path) {
    let triangles = ask("status", Value::Null).and_then(|s| s["triangles"].as_u64());
    let ask = |method: &str, params: Value| ask(method, params);
    if triangles.is_some_and(|n| n < 100) {
        ask("load", json!({ "path": dir.join("ball.ply") }));
    }
    if let Some(scene) = ask("scene.list", Value::Null) {
        ask("scene.lock", json!({ "id": scene["active"], "locked": false }));
        ask("scene.show", json!({ "id": scene["active"], "visible": true }));
    }
    match method {
        "join" => {
            ask("take-up", json!({ "path": dir.join("box.ply") }));
        }
        "scene.apply" if following(&ask).is_none() => {
            let add = || ask("scene.add", json!({ "path": dir.join("ball.ply") }));
            if let (Some(a), Some(b)) = (add(), add()) {
                let (a, b) = (&a["id"], &b["id"]);
                let shift = json!({ "shift": [0.7, 0.1, 0.2], "turn": [0, 0, 0, 1], "scale": 1.0 });
                ask("scene.transform", json!({ "id": b, "transform": shift }));
                ask("scene.boolean", json!({ "operation": "union", "a": a, "b": b, "live": true }));
            }
        }
        "scene.reshape" => {
            ask("scene.add", json!({ "primitive": { "ball": 0.4 }, "edge": 0.1 }));
        }
        "scene.split" => {
            let add = || ask("scene.add", json!({ "path": dir.join("ball.ply") }));
            if let (Some(a), Some(b)) = (add(), add()) {
                let far = json!({ "shift": [5.0, 0.1, 0.2], "turn": [0, 0, 0, 1], "scale": 1.0 });
                ask("scene.transform", json!({ "id": b["id"], "transform": far }));
                ask("scene.merge", json!({ "ids": [a["id"], b["id"]] }));
            }
        }
        "guests.revoke" => {
            ask("guests.invite", json!({ "role": "viewer" }));
        }
        m if m.starts_with("layers.") => {
            for k in 0..2 {
                ask("layers.add", json!({ "name": format!("layer {k}") }));
            }
        }
        m if m.starts_with("sets.") && m != "sets.make" => {
            ask("sets.show", json!({}));
            ask("mask", json!({ "action": "clear" }));
            ask("mask-region", json!({ "region": { "box": [0.3, 0.3, 0.5, 0.5] }, "mask": 1.0 }));
            let made = ask("sets.make", json!({ "from": "mask" }));
            if let (Some(made), "sets.show") = (made, m) {
                ask("sets.hide", json!({ "set": made["set"] }));
            }
        }
        "level" if triangles.is_some_and(|n| n < 5000) => {
            ask("level", json!({ "to": "up" }));
        }
        _ => {}
    }
}
