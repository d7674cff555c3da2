//! Files that are valid or common and not what most programs write.

use std::path::Path;

use glam::DVec3;

use super::problem::ParseError;
use super::write_gltf::base64;
use super::{LoadedMesh, encode, lost, parse, rounding};
use crate::job::Job;

fn read(name: &str, bytes: &[u8]) -> LoadedMesh {
    parse(bytes, Path::new(name), &Job::default()).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

fn refused(name: &str, bytes: &[u8]) -> String {
    match parse(bytes, Path::new(name), &Job::default()) {
        Err(ParseError::Problem(problem)) => problem.to_string(),
        other => panic!("{name}: {other:?}"),
    }
}

const STL: &str = "solid a part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
    vertex 0 1 0\nendloop\nendfacet\nendsolid a part\n";
const OBJ: &str = "# a triangle\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const OFF: &str = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn ends_of_lines_and_of_files_of_old_systems_are_read() {
    for (name, text) in [("a.stl", STL), ("a.obj", OBJ), ("a.off", OFF), ("a.ply", PLY)] {
        let marked = format!("\u{feff}{text}");
        assert_eq!(read(name, marked.as_bytes()).mesh.face_count(), 1, "{name} with a mark");
        if name == "a.ply" {
            continue;
        }
        for variant in [
            text.replace('\n', "\r"),
            text.replace('\n', "\r\n"),
            format!("{text}\u{1a}"),
            format!("{text}\0\0\0"),
        ] {
            assert_eq!(read(name, variant.as_bytes()).mesh.face_count(), 1, "{name}: {variant:?}");
        }
    }
    for long in [80, 4090, 100_000] {
        for end in ["", "\0\0"] {
            let name = "x".repeat(long) + end;
            let text = STL.replacen("a part", &name, 1);
            assert_eq!(read("a.stl", text.as_bytes()).mesh.face_count(), 1, "{long} {end:?}");
        }
    }
}

/// A triangle with corners at 0 and `size` times the numbers of `corners`.
fn gltf(kind: u32, normalized: bool, corners: &[u8], sparse: &str, view: &str) -> Vec<u8> {
    let data = base64(corners);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"scale":[10,10,10]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{{view}"componentType":{kind},"normalized":{normalized},"count":3,
            "type":"VEC3"{sparse}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}},
            {{"buffer":0,"byteLength":2}},{{"buffer":0,"byteOffset":4,"byteLength":24}}],
        "buffers":[{{"byteLength":{length},
            "uri":"data:application/octet-stream;base64,{data}"}}]}}"#,
        length = corners.len()
    )
    .into_bytes()
}

#[test]
fn normalized_whole_numbers_stand_for_parts_of_one() {
    let view = r#""bufferView":0,"#;
    for (kind, top) in [(5120u32, 127i32), (5121, 255), (5122, 32767), (5123, 65535)] {
        let mut bytes = Vec::new();
        for n in [0, 0, 0, top, 0, 0, 0, top, 0] {
            match kind {
                5120 | 5121 => bytes.push(n as u8),
                _ => bytes.extend_from_slice(&(n as u16).to_le_bytes()),
            }
        }
        bytes.resize(bytes.len().next_multiple_of(32), 0);
        let extent = |normalized: bool| {
            let mesh = read("a.gltf", &gltf(kind, normalized, &bytes, "", view)).mesh;
            mesh.positions.iter().fold(DVec3::ZERO, |most, p| most.max(*p))
        };
        assert_eq!(extent(true), DVec3::new(10.0, 10.0, 0.0), "{kind}");
        let whole = 10.0 * f64::from(top);
        assert_eq!(extent(false), DVec3::new(whole, whole, 0.0), "{kind}");
    }
}

#[test]
fn sparse_positions_take_the_place_of_those_in_the_view_or_of_zeros() {
    // Two indices, and two points.
    let mut bytes = vec![1u8, 2, 0, 0];
    for value in [1.0f32, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes.resize(64, 0);
    let sparse = r#","sparse":{"count":2,"indices":{"bufferView":1,"componentType":5121},
        "values":{"bufferView":2}}"#;
    let mesh = read("a.gltf", &gltf(5126, false, &bytes, sparse, "")).mesh;
    let mut places = mesh.positions;
    places.sort_by(|a, b| b.x.total_cmp(&a.x).then(b.y.total_cmp(&a.y)));
    assert_eq!(places, [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::ZERO]);
    let outside = sparse.replace("5121", "5125");
    let bytes = gltf(5126, false, &bytes, &outside, "");
    assert!(parse(&bytes, Path::new("a.gltf"), &Job::default()).is_err());
}

#[test]
fn what_a_file_holds_and_is_not_read_is_named() {
    let ply = PLY
        .replace("float z\n", "float z\nproperty float s\nproperty float t\n")
        .replace("indices\n", "indices\nproperty uchar red\nelement edge 1\nproperty int a\n")
        .replace(
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2 9\n7\n",
        );
    let loaded = read("a.ply", ply.as_bytes());
    assert_eq!(loaded.mesh.uvs().map(|(values, _)| values.len()), Some(3));
    let told = loaded.warnings.join("; ");
    for part in ["\"face\" left out: red", "1 rows of \"edge\""] {
        assert!(told.contains(part), "{told}");
    }
    let off = OFF.replace("3 0 1 2\n", "3 0 1 2 7\n");
    assert_eq!(read("a.off", off.as_bytes()).warnings, ["the colours of 1 faces left out"]);
    let mut stl = vec![0u8; 84 + 50];
    stl[80] = 1;
    for (corner, axis) in [(1, 0), (2, 1)] {
        let at = 84 + 12 + corner * 12 + axis * 4;
        stl[at..at + 4].copy_from_slice(&1f32.to_le_bytes());
    }
    assert!(read("a.stl", &stl).warnings.is_empty());
    stl[84 + 48] = 31;
    assert!(read("a.stl", &stl).warnings[0].starts_with("attribute bytes of 1 triangles left out"));
    for (name, text) in [("a.ply", PLY), ("a.off", OFF), ("a.stl", STL), ("a.obj", OBJ)] {
        assert!(read(name, text.as_bytes()).warnings.is_empty(), "{name}");
    }
}

#[test]
fn colours_of_faces_become_colours_of_vertices() {
    let reds = |name: &str, bytes: &[u8]| {
        let loaded = read(name, bytes);
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        loaded.mesh.colours.unwrap_or_else(|| panic!("{name}: no colours"))
    };
    let off = OFF.replace("3 0 1 2\n", "3 0 1 2 1.0 0.0 0.2\n");
    assert_eq!(reds("a.off", off.as_bytes()), [[255, 0, 51, 255]; 3]);
    let ply = PLY
        .replace(
            "indices\n",
            "indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
        )
        .replace("3 0 1 2\n", "3 0 1 2 255 0 51\n");
    assert_eq!(reds("a.ply", ply.as_bytes()), [[255, 0, 51, 255]; 3]);
    let mut stl = vec![0u8; 84 + 50];
    stl[80] = 1;
    for (corner, axis) in [(1, 0), (2, 1)] {
        let at = 84 + 12 + corner * 12 + axis * 4;
        stl[at..at + 4].copy_from_slice(&1f32.to_le_bytes());
    }
    // Blue in the lowest bits; the highest marks a colour.
    stl[84 + 48..84 + 50].copy_from_slice(&(1u16 << 15 | 31 << 10 | 6).to_le_bytes());
    assert_eq!(reds("a.stl", &stl), [[255, 0, 49, 255]; 3]);
    stl[..10].copy_from_slice(b"COLOR=\xff\x00\x33\xff");
    assert_eq!(reds("a.stl", &stl), [[255, 0, 51, 255]; 3], "the colour of the whole");
    stl[84 + 48..84 + 50].copy_from_slice(&31u16.to_le_bytes());
    assert_eq!(reds("a.stl", &stl), [[255, 0, 0, 255]; 3], "red in the lowest bits");
    let two = OFF
        .replace("3 1 0", "4 2 0")
        .replace("3 0 1 2\n", "1 1 0\n3 0 1 2 255 0 0\n3 1 3 2 0 255 0\n");
    let loaded = read("a.off", two.as_bytes());
    assert_eq!(loaded.mesh.colours.expect("colours")[3], [0, 255, 0, 255]);
    assert!(loaded.warnings[0].starts_with("2 vertices lie between"), "{:?}", loaded.warnings);
}

#[test]
fn a_number_that_is_missing_or_too_many_in_text_ply_is_an_error_with_its_line() {
    for (row, line) in [("1 0 0\n", 11), ("3 0 1 2\n", 13)] {
        for other in [row.replacen("0 ", "", 1), row.replacen("0 ", "0 5 ", 1)] {
            let text = PLY.replace(row, &other);
            let told = refused("a.ply", text.as_bytes());
            assert!(told.contains(&format!("line {line}")), "{other}: {told}");
        }
    }
    // Rows over several lines, as some programs write them.
    let wrapped = PLY.replace("1 0 0\n", "1\n0 0\n");
    assert_eq!(read("a.ply", wrapped.as_bytes()).mesh.face_count(), 1);
}

#[test]
fn a_gltf_of_another_version_is_refused() {
    let text =
        String::from_utf8(gltf(5126, false, &[0; 36], "", "\"bufferView\":0,")).expect("text");
    for (version, least) in [("3.0", ""), ("2.9", ",\"minVersion\":\"3.0\"")] {
        let other = text.replace("\"2.0\"", &format!("\"{version}\"{least}"));
        let told = refused("a.gltf", other.as_bytes());
        assert!(told.contains("glTF version 2"), "{version}: {told}");
    }
}

#[test]
fn every_byte_of_a_colour_comes_back() {
    let mut mesh = crate::shapes::icosphere(1.0, 6).to_poly();
    let byte = |v: usize, by: usize| (v * by % 256) as u8;
    let colours = (0..mesh.positions.len()).map(|v| [1, 7, 13, 3].map(|by| byte(v, by)));
    mesh.colours = Some(colours.collect());
    for kind in ["glb", "gltf", "ply", "off", "3mf"] {
        let mut bytes = Vec::new();
        encode(kind, &mesh, &mut bytes).expect("written");
        let name = format!("ball.{kind}");
        let again = parse(&bytes, Path::new(&name), &Job::default()).expect("read").mesh;
        assert_eq!(again.colours, mesh.colours, "{kind}");
        assert_eq!(lost(kind, &mesh), Vec::<String>::new(), "{kind}");
    }
    assert!(lost("obj", &mesh)[0].contains("opacity"));
    assert!(lost("stl", &mesh)[0].contains("colours"));
    let mut far = mesh.clone();
    far.positions[0].x = 1e7 + 0.25;
    for kind in ["stl", "glb", "gltf"] {
        assert_eq!((rounding(kind, &mesh), rounding(kind, &far)), (0.0, 0.25), "{kind}");
    }
    for kind in ["obj", "ply", "off", "3mf"] {
        assert_eq!(rounding(kind, &far), 0.0, "{kind}");
    }
}
