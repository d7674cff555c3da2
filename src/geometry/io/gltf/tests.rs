//! Files as other programs write them, made here.

use std::path::Path;

use glam::DVec3;
use meshopt_rs::index::IndexEncodingVersion;
use meshopt_rs::index::buffer::{encode_index_buffer, encode_index_buffer_bound};
use meshopt_rs::vertex::VertexEncodingVersion;
use meshopt_rs::vertex::buffer::{encode_vertex_buffer, encode_vertex_buffer_bound};
use serde_json::{Value, json};

use crate::io::write_gltf::base64;
use crate::io::{LoadedMesh, encode, parse, parse_in_millimetres};
use crate::job::Job;
use crate::{PolyMesh, shapes};

/// A buffer as it grows, with its views.
#[derive(Default)]
struct Packed {
    bytes: Vec<u8>,
    views: Vec<Value>,
}

impl Packed {
    fn view(&mut self, bytes: &[u8]) -> usize {
        let at = self.bytes.len();
        self.views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": bytes.len()}));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn floats(&mut self, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.view(&bytes)
    }

    fn file(self, mut rest: Value) -> Value {
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.bytes));
        rest["asset"] = json!({"version": "2.0", "generator": "another program"});
        rest["buffers"] = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        rest["bufferViews"] = json!(self.views);
        rest
    }
}

fn read(file: &Value) -> LoadedMesh {
    let bytes = file.to_string().into_bytes();
    parse(&bytes, Path::new("a.gltf"), &Job::default()).expect("readable")
}

/// Two triangles of a square with texture coordinates, one of them flat, in two primitives.
fn square() -> Value {
    let mut to = Packed::default();
    let places = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    to.floats(&places);
    to.floats(&[0.0, 1.0, 1.0, 1.0, 1.0, 0.25, 0.0, 0.0]);
    to.view(&[0, 1, 2, 0, 2, 3, 0, 1, 1]);
    to.file(json!({
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "lid \"A\""}],
        "materials": [{"name": "oak"}, {"name": "brass"}],
        "meshes": [{"name": "unused", "primitives": [
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 1}, "indices": 2,
             "material": 0},
            {"attributes": {"POSITION": 0}, "indices": 3, "material": 1},
        ]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR"},
            {"bufferView": 2, "byteOffset": 3, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
    }))
}

#[test]
fn names_and_texture_coordinates_are_read_and_what_is_not_read_is_named() {
    let loaded = read(&square());
    let mesh = &loaded.mesh;
    assert_eq!(mesh.groups, Some(vec![0, 1]));
    let name = |g| mesh.group_name(g).map(|n| (n.object.as_str(), n.material.as_str()));
    assert_eq!((name(0), name(1)), (Some(("lid \"A\"", "oak")), Some(("lid \"A\"", "brass"))));
    let (values, corners) = mesh.uvs().expect("texture coordinates");
    let first: Vec<[f64; 2]> = corners[..3].iter().map(|c| values[*c as usize]).collect();
    assert_eq!(first, [[0.0, 0.0], [1.0, 0.0], [1.0, 0.75]], "v goes up here, down in glTF");
    assert!(corners[3..].iter().all(|c| *c == crate::face_attributes::NO_UV));
    for what in ["1 further sets", "1 triangles with two corners", "2 looks of materials"] {
        assert!(loaded.warnings.iter().any(|w| w.contains(what)), "{what}: {:?}", loaded.warnings);
    }
}

#[test]
fn what_this_program_writes_comes_back_with_groups_names_and_texture_coordinates() {
    let first = read(&square()).mesh;
    for kind in ["glb", "gltf", "ply"] {
        let mut bytes = Vec::new();
        encode(kind, &first, &mut bytes).expect("written");
        let back = parse(&bytes, Path::new("a"), &Job::default()).expect("readable").mesh;
        assert_eq!(back.positions, first.positions, "{kind}");
        let drawn = |mesh: &PolyMesh| -> Vec<Option<[f64; 2]>> {
            let (values, corners) = mesh.uvs().expect("texture coordinates");
            corners.iter().map(|c| values.get(*c as usize).copied()).collect()
        };
        assert_eq!(drawn(&back), drawn(&first), "{kind}");
        if kind != "ply" {
            assert_eq!(back.groups, first.groups);
            assert_eq!(back.group_name(1), first.group_name(1));
        }
    }
}

#[test]
fn instances_of_the_extension_stand_where_it_says() {
    let mut to = Packed::default();
    to.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    to.floats(&[0.0, 0.0, 0.0, 10.0, 0.0, 0.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    to.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    to.floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let vectors = |view: usize, count: usize, kind: &str| {
        let float = 5126;
        json!({"bufferView": view, "componentType": float, "count": count, "type": kind})
    };
    let file = to.file(json!({
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "nodes": [{"mesh": 0, "translation": [0, 0, 5], "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": 1, "ROTATION": 2, "SCALE": 3}}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [vectors(0, 3, "VEC3"), vectors(1, 2, "VEC3"), vectors(2, 2, "VEC4"),
                      vectors(3, 2, "VEC3")],
    }));
    let loaded = read(&file);
    assert_eq!(loaded.mesh.face_count(), 2);
    // Twice as large, turned by a quarter about z, shifted.
    let right = DVec3::new(10.0, 2.0, 5.0);
    assert!((loaded.mesh.positions[4] - right).length() < 1e-6, "{:?}", loaded.mesh.positions);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

/// A ball, its places and indices packed.
fn packed_ball() -> (Value, PolyMesh) {
    let ball = shapes::icosphere(1.0, 6);
    let rows: Vec<[f32; 4]> = ball.positions.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect();
    let mut places = vec![0; encode_vertex_buffer_bound(rows.len(), 16)];
    let long = encode_vertex_buffer(&mut places, &rows, VertexEncodingVersion::V0);
    places.truncate(long.expect("packed"));
    let list: Vec<u32> = ball.triangles.iter().flatten().copied().collect();
    let mut indices = vec![0; encode_index_buffer_bound(list.len(), rows.len())];
    let long = encode_index_buffer(&mut indices, &list, IndexEncodingVersion::V1);
    indices.truncate(long.expect("packed"));
    let mut to = Packed::default();
    let ext = |view: &mut Value, count: usize, stride: usize, mode: &str| {
        let inner = json!({
            "buffer": 0, "byteOffset": view["byteOffset"], "byteLength": view["byteLength"],
            "byteStride": stride, "count": count, "mode": mode,
        });
        *view = json!({
            "buffer": 1, "byteOffset": 0, "byteLength": count * stride,
            "extensions": {"EXT_meshopt_compression": inner},
        });
        if mode == "ATTRIBUTES" {
            view["byteStride"] = stride.into();
        }
    };
    to.view(&places);
    to.view(&indices);
    ext(&mut to.views[0], rows.len(), 16, "ATTRIBUTES");
    ext(&mut to.views[1], list.len(), 4, "TRIANGLES");
    let mut file = to.file(json!({
        "extensionsRequired": ["EXT_meshopt_compression"],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": rows.len(), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": list.len(), "type": "SCALAR"},
        ],
    }));
    let fallback = json!({"EXT_meshopt_compression": {"fallback": true}});
    let all = file["buffers"].as_array_mut().expect("buffers");
    all.push(json!({"byteLength": rows.len() * 16, "extensions": fallback}));
    (file, ball.to_poly())
}

#[test]
fn packed_views_are_read() {
    let (file, ball) = packed_ball();
    let loaded = read(&file);
    assert_eq!(loaded.mesh.face_count(), ball.face_count());
    let sum = |mesh: &PolyMesh| mesh.positions.iter().map(|p| p.length()).sum::<f64>();
    assert!((sum(&loaded.mesh) - sum(&ball)).abs() < 1e-9);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

#[test]
fn damaged_packed_views_are_refused_or_read_and_nothing_panics() {
    let (file, _) = packed_ball();
    let uri = file["buffers"][0]["uri"].as_str().expect("text").to_owned();
    let head = uri.find(',').expect("a comma") + 1;
    let mut random = 7u64;
    for round in 0..2_000 {
        let mut file = file.clone();
        let mut text = uri.clone().into_bytes();
        for _ in 0..1 + round % 5 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let at = head + (random >> 33) as usize % (text.len() - head - 4);
            text[at] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdef"[(random >> 20) as usize % 32];
        }
        file["buffers"][0]["uri"] = String::from_utf8(text).expect("text").into();
        if round % 3 == 0 {
            let inner =
                &mut file["bufferViews"][round % 2]["extensions"]["EXT_meshopt_compression"];
            let name = ["count", "byteStride", "byteLength", "byteOffset"][round / 3 % 4];
            inner[name] = ((random >> 40) % 4_000).into();
            inner["mode"] = ["ATTRIBUTES", "TRIANGLES", "INDICES"][round / 7 % 3].into();
            inner["filter"] =
                ["NONE", "EXPONENTIAL", "QUATERNION", "OCTAHEDRAL"][round / 5 % 4].into();
        }
        let bytes = file.to_string().into_bytes();
        let _refused = parse(&bytes, Path::new("a.gltf"), &Job::default()).is_err();
    }
}

#[test]
fn in_millimetres_metres_grow_and_what_this_program_wrote_stays() {
    let metres = |file: &[u8]| {
        let read = parse_in_millimetres(file, Path::new("a.gltf"), &Job::default());
        read.expect("readable").mesh.positions
    };
    let square = square();
    let other = metres(&square.to_string().into_bytes());
    assert_eq!(other[2], DVec3::new(1000.0, 1000.0, 0.0));
    let mesh = read(&square).mesh;
    let mut ours = Vec::new();
    encode("gltf", &mesh, &mut ours).expect("written");
    assert_eq!(metres(&ours), mesh.positions);
}
