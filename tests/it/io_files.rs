//! Our own mesh files: what they hold, what they are after a round trip, and what is said when they
//! are broken.

use std::path::Path;
use std::process::{Command, Output};

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::check::{MeshReport, report};
use sculptd_geometry::io;
use sculptd_geometry::io::{MeshFormat, ParseError, encode, read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn model(name: &str) -> io::LoadedMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(name);
    read_mesh(&path, &Job::default()).unwrap()
}

fn facts(mesh: &PolyMesh) -> MeshReport {
    report(mesh, true, &Job::default()).unwrap()
}

fn bytes(kind: &str, mesh: &PolyMesh) -> Vec<u8> {
    let mut out = Vec::new();
    encode(kind, mesh, &mut out).unwrap();
    out
}

fn parse(name: &str, bytes: &[u8]) -> Result<io::LoadedMesh, ParseError> {
    io::parse(bytes, Path::new(name), &Job::default())
}

fn complaint(name: &str, bytes: &[u8]) -> String {
    match parse(name, bytes) {
        Err(ParseError::Problem(p)) => p.to_string(),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn each_format_holds_what_was_written_into_it() {
    let pyramid = model("pyramid.obj");
    assert_eq!(
        (pyramid.format, pyramid.mesh.positions.len(), pyramid.mesh.face_count()),
        (MeshFormat::Obj, 5, 5)
    );
    assert_eq!(pyramid.mesh.face(0), [0, 3, 2, 1]);
    assert_eq!(pyramid.mesh.face(2), [1, 2, 4]);
    assert_eq!(pyramid.mesh.groups, Some(vec![0, 1, 1, 1, 1]));
    assert_eq!(pyramid.mesh.colours.as_ref().unwrap()[..2], [[255, 0, 0, 255], [0, 255, 0, 255]]);
    let f = facts(&pyramid.mesh);
    assert!(f.closed && f.manifold && (f.volume.unwrap() - 2.0).abs() < 1e-14, "{f:?}");

    let wedge = model("wedge.off");
    assert_eq!((wedge.format, wedge.mesh.face_count()), (MeshFormat::Off, 5));
    assert_eq!(wedge.mesh.colours.as_ref().unwrap()[2], [0, 0, 255, 255]);
    assert!(facts(&wedge.mesh).closed && (facts(&wedge.mesh).volume.unwrap() - 3.0).abs() < 1e-14);

    let tetra = model("tetra.stl");
    assert_eq!((tetra.format, tetra.mesh.positions.len()), (MeshFormat::StlAscii, 4));
    assert!((facts(&tetra.mesh).volume.unwrap() - 1.0 / 6.0).abs() < 1e-15);

    let strip = model("strip.ply");
    assert_eq!(strip.mesh.corners, [0, 1, 2, 2, 1, 3]);
    assert_eq!(strip.mesh.positions[1], DVec3::new(1.0, 0.0, 0.0));
    assert_eq!(strip.mesh.colours.as_ref().unwrap()[0], [30, 20, 10, 255]);

    let two = model("two.gltf");
    let f = facts(&two.mesh);
    assert!(two.format == MeshFormat::Gltf && f.closed && f.components == 2, "{f:?}");
    assert!(
        (f.volume.unwrap() - (1.0 + 8.0) / 6.0).abs() < 1e-12
            && f.bounds.min[0] == -2.0
            && f.bounds.max[0] == 6.0
    );
}

#[test]
fn a_round_trip_changes_nothing_that_the_format_can_hold() {
    let mut mesh = shapes::torus(3.0, 1.0 / 3.0, 17, 9);
    mesh.colours = Some((0..mesh.positions.len()).map(|i| [i as u8, 7, 200, 255]).collect());
    for kind in ["obj", "ply", "off"] {
        let back = parse(&format!("a.{kind}"), &bytes(kind, &mesh)).unwrap();
        assert_eq!(back.mesh, mesh, "{kind}");
        assert!(back.warnings.is_empty());
    }
    // In single precision the file is half as long, and still the same.
    let single = mesh.triangulate().0.to_poly();
    assert_eq!(parse("x", &bytes("ply", &single)).unwrap().mesh, single);
    for kind in ["stl", "glb", "3mf"] {
        let back = parse("by its content", &bytes(kind, &mesh)).unwrap();
        let (was, is) = (facts(&mesh), facts(&back.mesh));
        assert!(
            is.closed
                && is.genus == Some(1)
                && is.triangles == was.triangles
                && is.vertices == was.vertices,
            "{kind} {is:?}"
        );
        assert!(
            (is.volume.unwrap() - was.volume.unwrap()).abs() < 1e-5 * was.volume.unwrap(),
            "{kind}"
        );
        assert_eq!(bytes(kind, &mesh), bytes(kind, &mesh), "{kind}");
        if kind == "glb" {
            assert!(
                back.mesh
                    .colours
                    .unwrap()
                    .iter()
                    .zip(mesh.colours.as_ref().unwrap())
                    .all(|(a, b)| a[2].abs_diff(b[2]) < 3)
            );
        }
    }
    // Long polygons, groups, and a big-endian file made from the little-endian one.
    let mut disc = shapes::cylinder(1.0, 2.0, 300);
    disc.groups = Some((0..disc.face_count() as u32).map(|f| u32::from(f > 10)).collect());
    assert_eq!(parse("a.obj", &bytes("obj", &disc)).unwrap().mesh, disc);
    disc.groups = None;
    assert_eq!(parse("a.ply", &bytes("ply", &disc)).unwrap().mesh, disc);
    assert_eq!(parse("a.off", &bytes("off", &disc)).unwrap().mesh, disc);
    let little = bytes("ply", &mesh);
    let cut = little.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let mut big =
        String::from_utf8(little[..cut].to_vec()).unwrap().replace("little", "big").into_bytes();
    let vertices = mesh.positions.len() * 28;
    for row in little[cut..cut + vertices].chunks_exact(28) {
        big.extend(row[..24].chunks_exact(8).flat_map(|v| v.iter().rev()).chain(&row[24..]));
    }
    for row in little[cut + vertices..].chunks_exact(17) {
        big.push(row[0]);
        big.extend(row[1..].chunks_exact(4).flat_map(|v| v.iter().rev()));
    }
    let back = parse("a.ply", &big).unwrap();
    assert_eq!((back.format, back.mesh), (MeshFormat::PlyBig, mesh));
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let cube = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let stl = bytes("stl", &cube);
    for (name, text, want) in [
        (
            "a.obj",
            &b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n"[..],
            "line 5: expected a vertex index \
            from 1 to 3, found 4",
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n",
            "line 4: expected a vertex index from 1 \
            to 3, found 0",
        ),
        ("a.obj", b"v 0 0 0\nv nan 0 0\n", "line 2: expected a finite coordinate, found NaN"),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0\n",
            "line 2: expected three coordinates after \"v\", found \"v 1 \
            0\"",
        ),
        ("a.obj", b"v 0 0 0\nv 1 0 x\n", "line 2: expected a number of the vertex, found \"x\""),
        (
            "a.obj",
            b"v 0 0 0\nf 1 a 1\n",
            "line 2: expected a vertex index (not 0) of the face, \
            found \"a 1\"",
        ),
        (
            "a.obj",
            b"hello\n",
            "expected OBJ text with vertices (lines \"v x y z\"), found \
            \"hello\"",
        ),
        ("a.ply", b"this is no mesh\n", "line 1: expected \"ply\", found \"this is no mesh\""),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty \
            float y\nproperty float z\nend_header\n0 0 0\n",
            "byte 115: expected at least 6000000109 bytes for the counts in the header, found the \
                end of the file after 115 bytes",
        ),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float \
            y\nproperty float z\nend_header\n0 inf 0\n",
            "line 8: expected a finite coordinate, found a coordinate beyond 3.4e38",
        ),
        (
            "a.off",
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
            "line 6: expected a vertex index \
            from 0 to 2, found 3",
        ),
        (
            "a.off",
            b"OFF\n4 4 0\n0 0 0\n1 0 0\n",
            "line 5: expected three coordinates of vertex 2, \
            found the end of the file",
        ),
        (
            "a.off",
            b"OFF\n99999999 1 0\n",
            "line 2: expected as many vertices and faces as the file \
            has room for, found counts of 99999999 vertices and 1 faces in a file of 17 bytes",
        ),
        ("a.stl", b"", "byte 0: expected a mesh, found an empty file"),
        (
            "a.stl",
            &stl[..400],
            "byte 400: expected 684 bytes for the 12 triangles that the header \
            at byte 80 states, found the end of the file after 6 whole triangles (not text either: \
            it starts with \"sculptd",
        ),
        (
            "a.stl",
            b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 \
            0\nendloop\nendfacet\n",
            "line 7: expected three corners before the facet's end, not 2, found \"endfacet\"",
        ),
        (
            "a.stl",
            b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0",
            "line 5: \
            expected \"vertex\" and three numbers, found \"vertex 1 0\"",
        ),
        (
            "a.xyz",
            b"\x00\x01\x02",
            "byte 0: expected a mesh as OBJ, STL, PLY, OFF, glTF, GLB or \
            3MF, found \"...\"",
        ),
        (
            "a.glb",
            b"glTF\x02\x00\x00\x00\xff\x00\x00\x00",
            "byte 12: expected 255 bytes as the \
            header states, found the end of the file after 12 bytes",
        ),
        ("a.gltf", b"{\n \"asset\": 5}", "line 2: expected glTF 2.0 as JSON, found"),
        ("a.3mf", b"PK\x03\x04", "byte 4: expected a zip's directory at the end, found"),
    ] {
        let told = complaint(name, text);
        assert!(told.starts_with(want), "{name}: {told}");
    }
    let mut nan = stl;
    nan[84 + 50 + 12 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(complaint("a.stl", &nan), "byte 150: expected a finite coordinate, found NaN");
    let ply = bytes("ply", &cube);
    let told = complaint("a.ply", &ply[..ply.len() - 3]);
    assert!(told.contains("expected the rest of face 5 of 6, found the end of the file"), "{told}");
    let secret =
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"../../etc/passwd"}]}"#;
    assert!(complaint("a.gltf", secret).contains("it leads elsewhere"));
}

#[test]
fn a_binary_file_whose_header_says_solid_is_binary_all_the_same() {
    let mut stl = bytes("stl", &shapes::cuboid(DVec3::ZERO, DVec3::ONE));
    stl[..80].fill(b' ');
    stl[..26].copy_from_slice(b"solid facet normal endsoli");
    let loaded = parse("a.stl", &stl).unwrap();
    assert_eq!((loaded.format, loaded.mesh.positions.len()), (MeshFormat::StlBinary, 8));
    stl.extend(b"trailer");
    stl[..5].copy_from_slice(b"Solid");
    stl[20] = 0;
    assert_eq!(
        parse("a.stl", &stl).unwrap().warnings,
        ["7 bytes after the last triangle left out"]
    );
}

#[test]
fn no_cut_and_no_flipped_byte_makes_a_parser_panic() {
    let mut mesh = shapes::uv_sphere(1.0, 5, 6);
    mesh.colours = Some(vec![[1, 2, 3, 4]; mesh.positions.len()]);
    let mut files: Vec<(String, Vec<u8>)> = ["obj", "stl", "ply", "off", "glb", "3mf"]
        .map(|k| (format!("a.{k}"), bytes(k, &mesh)))
        .into();
    for name in ["pyramid.obj", "wedge.off", "tetra.stl", "strip.ply", "two.gltf"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(name);
        files.push((name.into(), std::fs::read(path).unwrap()));
    }
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 200_000 } else { 3_000 };
    let mut s = 7u64;
    let mut next = move |n: usize| {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (s >> 33) as usize % n.max(1)
    };
    let mut read = 0;
    for (name, whole) in &files {
        for _ in 0..rounds {
            let mut b = whole.clone();
            for _ in 0..1 + next(4) {
                let at = next(b.len());
                match next(4) {
                    0 => b.truncate(at),
                    1 => {
                        b.splice(at..at, [b'-', b'9', 0xff][..1 + next(3)].to_vec()).for_each(drop)
                    }
                    2 => b[at..].rotate_left(1),
                    _ if at < b.len() => b[at] = next(256) as u8,
                    _ => {}
                }
                if b.is_empty() {
                    break;
                }
            }
            if let Ok(loaded) = parse(name, &b) {
                read += 1;
                let m = loaded.mesh;
                assert!(m.corners.iter().all(|&c| (c as usize) < m.positions.len()));
                assert!(
                    m.faces().all(|f| f.len() >= 3)
                        && m.positions.iter().all(|p| p.as_vec3().is_finite())
                );
                assert!(m.groups.is_none_or(|g| g.len() == m.face_starts.len() - 1));
                assert!(m.colours.is_none_or(|c| c.len() == m.positions.len()));
            }
        }
    }
    println!("{read} of {} broken files still held a mesh", rounds * files.len());
    assert!(read > 0);
}

fn sculptd(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sculptd")).args(args).output().unwrap()
}

#[test]
fn the_commands_answer_and_bad_input_leaves_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    let at = |n: &str| dir.path().join(n).to_str().unwrap().to_string();
    let (cube, ply, fine, few) = (at("cube.obj"), at("cube.ply"), at("fine.glb"), at("few.stl"));
    write_mesh(Path::new(&cube), &shapes::cuboid(DVec3::ZERO, DVec3::ONE)).unwrap();
    let done = sculptd(&["--json", "convert", &cube, &ply, "--scale", "2"]);
    assert!(done.status.success(), "{done:?}");
    let info = sculptd(&["info", &ply, "--json"]);
    let v: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(
        (v["volume"].as_f64(), v["faces"].as_u64(), v["closed"].as_bool()),
        (Some(8.0), Some(6), Some(true))
    );
    for field in "vertices faces triangles components closed manifold oriented euler genus bounds \
        volume area self_intersections"
        .split(' ')
    {
        assert!(!v[field].is_null(), "{field}");
    }
    assert!(sculptd(&["subdivide", &ply, "--levels", "4", "-o", &fine]).status.success());
    assert!(sculptd(&["decimate", &fine, "--faces", "200", "-o", &few]).status.success());
    let v: serde_json::Value =
        serde_json::from_slice(&sculptd(&["info", &few, "--json"]).stdout).unwrap();
    assert!(
        v["faces"].as_u64() <= Some(200) && v["closed"] == true && v["self_intersections"] == 0,
        "{v}"
    );
    let before = std::fs::read_dir(dir.path()).unwrap().count();
    for (name, text) in
        [("e.stl", &b""[..]), ("n.obj", b"v nan 0 0\n"), ("t.ply", b"hello"), ("c.stl", &[0; 90])]
    {
        io::write_beside(&dir.path().join(name), |w| w.write_all(text)).unwrap();
        let out = sculptd(&["convert", &at(name), &at("out.obj")]);
        assert_eq!(out.status.code(), Some(6), "{name}");
        let told = String::from_utf8(out.stderr).unwrap();
        assert!(told.contains(name) && told.contains("expected"), "{told}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), before + 4);
    assert_eq!(sculptd(&["info", &at("absent.stl")]).status.code(), Some(6));
    assert_eq!(sculptd(&["convert", &cube, &at("out.doc")]).status.code(), Some(2));
}

#[test]
fn a_painted_file_has_the_filaments_that_the_command_reports() {
    let dir = tempfile::tempdir().unwrap();
    let at = |n: &str| dir.path().join(n).to_str().unwrap().to_string();
    let (ball, painted) = (at("ball.ply"), at("painted.3mf"));
    let mut mesh = shapes::icosphere(20.0, 16).to_poly();
    let colour = |p: &DVec3| {
        let [r, g, b] = (*p / 40.0 + 0.5).to_array().map(|v| (v * 255.0) as u8);
        [r, g, b, 255]
    };
    mesh.colours = Some(mesh.positions.iter().map(colour).collect());
    write_mesh(Path::new(&ball), &mesh).unwrap();
    let job = Job::default();
    assert_eq!(read_mesh(Path::new(&ball), &job).unwrap().mesh.colours, mesh.colours);
    let out = sculptd(&["convert", &ball, &painted, "--filaments", "5", "--json"]);
    assert!(out.status.success(), "{out:?}");
    let said: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let filaments = io::read_painting(Path::new(&painted), &job).unwrap();
    assert_eq!(said["filaments"].as_array().map(Vec::len), Some(5));
    let mut all = 0;
    for (i, [r, g, b]) in filaments.colours.iter().enumerate() {
        let of = &said["filaments"][i];
        assert_eq!(of["number"], i + 1);
        assert_eq!(of["colour"], format!("#{r:02X}{g:02X}{b:02X}"));
        let own = filaments.triangles.iter().filter(|&&k| usize::from(k) == i).count();
        assert_eq!(of["triangles"], own);
        all += own;
    }
    assert_eq!(all, mesh.face_count());
    let again = read_mesh(Path::new(&painted), &job).unwrap();
    assert_eq!(again.mesh.colours, mesh.colours, "the colours are beside the painting");
    let plain = at("plain.3mf");
    assert!(sculptd(&["convert", &ball, &plain]).status.success());
    assert!(io::read_painting(Path::new(&plain), &job).is_err(), "nothing is painted");
    let cube = at("cube.ply");
    write_mesh(Path::new(&cube), &shapes::cuboid(DVec3::ZERO, DVec3::ONE)).unwrap();
    for (args, code, expected) in [
        ([&ball, &at("a.ply"), "--filaments", "5"], 2, "3mf"),
        ([&ball, &at("a.3mf"), "--filaments", "0"], 2, "16"),
        ([&ball, &at("a.3mf"), "--filaments", "17"], 2, "16"),
        ([&cube, &at("a.3mf"), "--filaments", "5"], 6, "no colours"),
    ] {
        let out = sculptd(&[&["convert"], &args[..]].concat());
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(expected), "{args:?}: {said}");
    }
    assert!(!Path::new(&at("a.3mf")).exists() && !Path::new(&at("a.ply")).exists());
}
