//! Measures what each format keeps, by writing a mesh that has everything and reading it again, and
//! compares the result with `formats.json`, from which the guide's page on files is made.

use std::io::{Cursor, Write};
use std::path::Path;
use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};
use serde_json::{Value, json};

use super::write::ENDINGS;
use super::{
    LoadedMesh, MorphTarget, MorphedMesh, SceneMesh, encode, left_out, parse, write_scene,
};
use crate::job::Job;
use crate::{FaceAttributes, GroupName, PolyMesh};

const KEPT: &str = "kept";
const DROPPED: &str = "dropped";

/// Two squares of different groups, a triangle and a vertex of no face. The two squares do not
/// share the vertices of their common edge.
fn everything() -> PolyMesh {
    let mut mesh = PolyMesh::new();
    // A tenth has no end in binary: single precision rounds it.
    for p in [
        [0.1, 0.0, 0.0],
        [1.1, 0.0, 0.0],
        [1.1, 1.0, 0.0],
        [0.1, 1.0, 0.0],
        [1.1, 0.0, 0.0],
        [2.1, 0.0, 0.0],
        [2.1, 1.0, 0.0],
        [1.1, 1.0, 0.0],
        [1.5, 2.0, 0.3],
        [9.0, 9.0, 9.0],
    ] {
        mesh.positions.push(DVec3::from(p));
    }
    for f in [&[0, 1, 2, 3][..], &[4, 5, 6, 7], &[7, 6, 8]] {
        mesh.push_face(f);
    }
    mesh.groups = Some(vec![0, 1, 1]);
    mesh.colours = Some((0..10).map(|i| [i * 20, 255 - i, 7, 200 + i]).collect());
    let name = |object: &str, group: &str, material: &str| GroupName {
        object: object.into(),
        group: group.into(),
        material: material.into(),
    };
    mesh.attributes = Some(Arc::new(FaceAttributes {
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.75]],
        uv_corners: vec![0, 1, 2, 1, 0, 1, 2, 0, 2, 1, 0],
        groups: vec![name("part", "floor", "clay"), name("part", "roof", "wood")],
        libraries: vec!["part.mtl".into()],
    }));
    mesh
}

fn read(name: &str, bytes: &[u8]) -> LoadedMesh {
    parse(bytes, Path::new(name), &Job::default()).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

fn written(kind: &str, mesh: &PolyMesh) -> LoadedMesh {
    let mut bytes = Vec::new();
    encode(kind, mesh, &mut bytes).expect("written");
    read(&format!("a.{kind}"), &bytes)
}

/// The fate of each part of a mesh in a file of the ending `kind`.
fn survives(kind: &str) -> Value {
    let mesh = everything();
    let back = written(kind, &mesh).mesh;
    let used = |v: usize| mesh.corners.contains(&(v as u32));
    let places = |mesh: &PolyMesh, single: bool| -> Vec<[u64; 3]> {
        let bits = |p: &DVec3| {
            let p = if single { p.as_vec3().as_dvec3() } else { *p };
            p.to_array().map(f64::to_bits)
        };
        let mut all: Vec<_> = (0..mesh.corners.len())
            .map(|c| bits(&mesh.positions[mesh.corners[c] as usize]))
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let coordinates = match () {
        () if places(&mesh, false) == places(&back, false) => "double",
        () if places(&mesh, true) == places(&back, true) => "single",
        () => panic!("{kind}: the places of the vertices changed"),
    };
    let sizes = |m: &PolyMesh| m.faces().map(<[u32]>::len).collect::<Vec<_>>();
    let polygons = if sizes(&mesh) == sizes(&back) { KEPT } else { "cut into triangles" };
    let apart = (0..mesh.positions.len()).filter(|&v| used(v)).count();
    let vertices = match back.positions.len() {
        n if n == mesh.positions.len() => "as they are",
        n if n == apart => "without unused ones",
        n if n < apart => "equal places become one",
        n => panic!("{kind}: {n} vertices"),
    };
    // Of the vertices that faces use. Where several vertices became one, it has the colour of one
    // of them.
    let seen: Vec<[u8; 4]> = match &back.colours {
        Some(all) => {
            (0..all.len()).filter(|v| back.corners.contains(&(*v as u32))).map(|v| all[v]).collect()
        }
        None => Vec::new(),
    };
    let had = |c: &[u8; 4]| mesh.colours.iter().flatten().any(|d| c == d);
    let clear = |[r, g, b, a]: &[u8; 4]| {
        *a == 255 && mesh.colours.iter().flatten().any(|d| d[..3] == [*r, *g, *b])
    };
    let colours = match &seen[..] {
        [] => DROPPED,
        all if all.iter().all(had) => KEPT,
        all if all.iter().all(clear) => "without opacity",
        all => panic!("{kind}: colours {all:?}"),
    };
    let word = |kept: bool| if kept { KEPT } else { DROPPED };
    let partition = |m: &PolyMesh| -> usize {
        let mut all = m.groups.clone().unwrap_or_default();
        all.sort_unstable();
        all.dedup();
        all.len()
    };
    let names = |m: &PolyMesh| -> Vec<GroupName> {
        (0..2).filter_map(|g| m.group_name(g).cloned()).collect()
    };
    let named = |of: fn(&GroupName) -> &String| {
        let all = |m: &PolyMesh| names(m).iter().map(|n| of(n).clone()).collect::<Vec<_>>();
        word(all(&mesh) == all(&back))
    };
    let libraries = back.attributes.as_ref().is_some_and(|a| !a.libraries.is_empty());
    let fates = json!({
        "coordinates": coordinates,
        "vertices": vertices,
        "polygons": polygons,
        "colours of vertices": colours,
        "groups of faces": word(partition(&back) == 2),
        "names of groups": named(|n| &n.group),
        "names of materials": named(|n| &n.material),
        "texture coordinates": word(back.uvs().is_some()),
        "names of material files": word(libraries),
    });
    // Each loss that was measured is one that the program states, and the other way round.
    let says = left_out(kind, &mesh).join("\n");
    for (fate, words) in [
        ("polygons", "the polygons are cut"),
        ("groups of faces", "the groups of faces are left out"),
        ("names of materials", "the names of materials are left out"),
        ("texture coordinates", "the texture coordinates are left out"),
        ("colours of vertices", "the vertices' colours"),
    ] {
        assert_eq!(fates[fate] != KEPT, says.contains(words), "{kind}: {fate}: {says}");
    }
    fates
}

/// The fate of what a scene of several objects has beside their meshes.
fn scene_survives(kind: &str) -> Value {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join(format!("a.{kind}"));
    let mesh = crate::shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let target = MorphTarget {
        name: "wrinkles".into(),
        weight: 0.5,
        visible: true,
        offsets: vec![(1, Vec3::X)],
    };
    let morphed = MorphedMesh { base: mesh.positions.clone(), targets: vec![target] };
    let object = |name: &str, x: f64, morphed| SceneMesh {
        name: name.into(),
        mesh: mesh.clone(),
        shift: DVec3::X * x,
        turn: DQuat::IDENTITY,
        scale: 1.0,
        morphed,
    };
    let all = [object("lid", 0.0, Some(morphed)), object("pot", 5.0, None)];
    let says = write_scene(&file, &all, &Job::default()).expect("written");
    #[allow(clippy::disallowed_methods)] // Nobody writes it meanwhile.
    let bytes = std::fs::read(&file).expect("there");
    let back = read(&format!("a.{kind}"), &bytes);
    let name = |g: u32| back.mesh.group_name(g).map(|n| n.object.as_str());
    let apart = back.mesh.groups.as_ref().is_some_and(|g| g.first() != g.last());
    let word = |kept: bool| if kept { KEPT } else { DROPPED };
    let text = match kind {
        "3mf" => model_text(&bytes),
        _ => String::from_utf8_lossy(&bytes).into_owned(),
    };
    let in_file = text.contains("lid") && text.contains("pot");
    let read_back = name(0) == Some("lid") && name(1) == Some("pot");
    let fate = |kept: bool| match (in_file, kept) {
        (true, true) => KEPT,
        (true, false) => "kept, not read back",
        _ => DROPPED,
    };
    let fates = json!({
        "objects": if in_file || !apart { fate(apart) } else { "groups without names" },
        "names of objects": fate(read_back),
        "layers": word(!back.targets.is_empty()),
    });
    let says = says.join("\n");
    assert_eq!(fates["layers"] != KEPT, says.contains("the layers are part"), "{kind}: {says}");
    assert_eq!(!in_file, says.contains("the objects are one mesh"), "{kind}: {says}");
    fates
}

/// Files with parts that no mesh here has, by format, and the reader's sentences about them.
fn unread() -> Value {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0 0\nvt 1 0 0\nvt 0 1 0\n\
               s 1\nl 1 2\ncurv 0 1 1 2\nf 1/1/1 2/2/1 3/3/1\n";
    let mut stl = Vec::new();
    encode("stl", &triangle(), &mut stl).expect("written");
    stl[84 + 48] = 7;
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
               property float z\nproperty float nx\nproperty float confidence\nelement face 1\n\
               property list uchar int vertex_indices\nproperty uchar red\nelement edge 1\n\
               property int vertex1\nend_header\n0 0 0 0 1\n1 0 0 0 1\n0 1 0 0 1\n3 0 1 2 9\n1\n";
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n";
    let mut gltf = Vec::new();
    encode("gltf", &triangle(), &mut gltf).expect("written");
    let mut gltf: Value = serde_json::from_slice(&gltf).expect("JSON");
    gltf["materials"] = json!([{ "name": "clay" }]);
    let gltf = gltf.to_string();
    let says = |name: &str, bytes: &[u8]| read(name, bytes).warnings;
    json!({
        "OBJ": says("a.obj", obj.as_bytes()),
        "STL (binary)": says("a.stl", &stl),
        "PLY": says("a.ply", ply.as_bytes()),
        "OFF": says("a.off", off.as_bytes()),
        "glTF": says("a.gltf", gltf.as_bytes()),
    })
}

fn triangle() -> PolyMesh {
    let mut mesh = PolyMesh::new();
    mesh.positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    mesh.push_face(&[0, 1, 2]);
    mesh
}

/// The text of the model in a 3MF file.
fn model_text(bytes: &[u8]) -> String {
    let parts = threemf_parts(bytes);
    parts.into_iter().map(|(_, text)| text).collect()
}

/// The names and the texts of the parts of a 3MF file.
fn threemf_parts(bytes: &[u8]) -> Vec<(String, String)> {
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).expect("a zip");
    let mut parts = Vec::new();
    for i in 0..zip.len() {
        let mut part = zip.by_index(i).expect("a part");
        let mut text = String::new();
        std::io::Read::read_to_string(&mut part, &mut text).expect("text");
        let name = part.name().expect("a name").into_owned();
        parts.push((name, text));
    }
    parts
}

/// The largest coordinate of a triangle of size 1 in each unit that a 3MF file can state.
fn threemf_units() -> Value {
    let mut bytes = Vec::new();
    encode("3mf", &triangle(), &mut bytes).expect("written");
    let parts = threemf_parts(&bytes);
    let size = |unit: &str| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default();
        for (name, text) in &parts {
            zip.start_file(name.as_str(), options).expect("a part");
            let text = text.replace("unit=\"millimeter\"", &format!("unit=\"{unit}\""));
            zip.write_all(text.as_bytes()).expect("written");
        }
        let bytes = zip.finish().expect("a zip").into_inner();
        read("a.3mf", &bytes).mesh.positions.iter().fold(0f64, |m, p| m.max(p.max_element()))
    };
    let units = ["micron", "millimeter", "centimeter", "inch", "foot", "meter"];
    units
        .into_iter()
        .map(|u| (u.to_owned(), json!(size(u))))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// A point that is written and read again in each format: no unit and no axis changes.
fn axes() -> Value {
    let mut mesh = triangle();
    mesh.positions[1] = DVec3::new(1.0, 2.0, 3.0);
    let point = |kind: &str| {
        written(kind, &mesh)
            .mesh
            .positions
            .iter()
            .copied()
            .fold(DVec3::ZERO, |far, p| if p.length() > far.length() { p } else { far })
    };
    ENDINGS
        .into_iter()
        .map(|kind| (kind.to_owned(), json!(point(kind).to_array())))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// With `SCULPTD_BLESS=1` the file is written instead.
#[allow(clippy::disallowed_methods)] // The file is under version control.
#[test]
fn the_table_of_formats_is_what_the_code_does() {
    let each = |of: fn(&str) -> Value| -> Value {
        ENDINGS.into_iter().map(|k| (k.to_owned(), of(k))).collect::<serde_json::Map<_, _>>().into()
    };
    let says = each(|kind| json!(left_out(kind, &everything())));
    let now = json!({
        "written": each(survives),
        "scenes": each(scene_survives),
        "warnings when writing": says,
        "warnings when reading": unread(),
        "3MF units": threemf_units(),
        "axes": axes(),
    });
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/io/formats.json");
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        let text = serde_json::to_string_pretty(&now).expect("JSON") + "\n";
        std::fs::write(path, text).expect("written");
        return;
    }
    let then = std::fs::read_to_string(path).expect("src/geometry/io/formats.json");
    let then: Value = serde_json::from_str(&then).expect("JSON");
    assert!(
        now == then,
        "src/geometry/io/formats.json is not what the code does; write it with SCULPTD_BLESS=1, \
         then run config/guide/guide.py generate: {now:#}"
    );
}
