use std::io::Write;
use std::path::{Path, PathBuf};

use super::*;

const RELS: &str = r#"<?xml version="1.0"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="r0" Target="/3D/a.model"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>"#;

const MODEL: &str = r##"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en"
 xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
 xmlns:vendor="http://example.org/own">
<metadata name="Title">A tetrahedron</metadata>
<resources>
<basematerials id="1">
<base name="Blue" displaycolor="#0000FF"/><base name="Red" displaycolor="#FF0000"/>
</basematerials>
<m:texture2d id="2" path="/3D/a.png" contenttype="image/png"/>
<m:colorgroup id="3"><m:color color="#00FF00"/><m:color color="#11223380"/></m:colorgroup>
<m:texture2dgroup id="4" texid="2"><m:tex2coord u="0" v="0"/></m:texture2dgroup>
<m:compositematerials id="5" matid="1" matindices="0 1">
<m:composite values="0.5 0.5"/>
</m:compositematerials>
<m:multiproperties id="6" pids="1 3"><m:multi pindices="0 0"/></m:multiproperties>
<object id="7" type="model" pid="1" pindex="0" vendor:note="kept by its maker"><mesh><vertices>
<vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/>
<vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/>
</vertices><triangles>
<triangle v1="0" v2="2" v3="1" pid="3" p1="0" p2="1" p3="0"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/>
</triangles></mesh></object>
<object id="8" type="other"><mesh><vertices/><triangles/></mesh></object>
</resources>
<build><item objectid="7"/></build>
</model>"##;

fn package(rels: &str, model: &str) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, text) in [("_rels/.rels", rels), ("3D/a.model", model), ("3D/a.png", "")] {
        zip.start_file(name, options).expect("a part");
        zip.write_all(text.as_bytes()).expect("written");
    }
    zip.finish().expect("a zip").into_inner()
}

fn read(rels: &str, model: &str) -> Result<(PolyMesh, Vec<String>), String> {
    let mut warnings = Vec::new();
    let mesh = parse(&package(rels, model), &mut warnings, &Job::default());
    match mesh {
        Ok(mesh) => Ok((mesh, warnings)),
        Err(e) => Err(e.of_file(Path::new("a.3mf")).to_string()),
    }
}

#[test]
fn colours_of_faces_become_those_of_vertices() {
    let (mesh, warnings) = read(RELS, MODEL).expect("valid");
    let blue = [0, 0, 255, 255];
    let colours = mesh.colours.expect("colours");
    // The first face has colours of its own, the others their object's: so has the tip.
    assert_eq!(colours, [[0, 255, 0, 255], [0, 255, 0, 255], [0x11, 0x22, 0x33, 0x80], blue]);
    assert!(warnings.iter().any(|w| w.starts_with("3 vertices lie between")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.starts_with("3 groups of composite")), "{warnings:?}");
}

#[test]
fn a_coloured_mesh_comes_back_from_its_file() {
    let (mesh, _) = read(RELS, MODEL).expect("valid");
    let mut bytes = Vec::new();
    crate::io::encode("3mf", &mesh, &mut bytes).expect("written");
    let mut warnings = Vec::new();
    let again = parse(&bytes, &mut warnings, &Job::default()).expect("read");
    assert_eq!((again.positions, again.colours), (mesh.positions, mesh.colours));
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn what_a_file_requires_is_known_or_refused_by_its_name() {
    let with = |space: &str| {
        let beams = "</triangles><b:beamlattice><b:beam v1=\"0\" v2=\"1\"/></b:beamlattice>";
        let required = format!("<model requiredextensions=\"b\" xmlns:b=\"{space}\"");
        read(RELS, &MODEL.replace("<model", &required).replacen("</triangles>", beams, 1))
    };
    let beams = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02";
    let (_, warnings) = with(beams).expect("known");
    assert!(warnings.iter().any(|w| w == "1 beams of beam lattices left out"), "{warnings:?}");
    let unknown = "http://example.com/beamlattice/1";
    assert!(with(unknown).is_err_and(|e| e.contains(unknown)));
}

/// Each rule by a file that breaks it alone.
#[test]
fn a_file_that_breaks_a_rule_is_refused_with_its_name() {
    for (old, new, expected) in [
        ("<resources>", "<!DOCTYPE model>\n<resources>", "no DTD"),
        ("xml:lang=\"en\"", "xml:space=\"default\"", "xml:lang"),
        ("http://example.org/own", "http://www.w3.org/2001/XMLSchema-instance", "vendor:note"),
        ("http://example.org/own", "http://schemas.microsoft.com/3dmanufacturing/v9", "ignorable"),
        ("<resources>", "<metadata name=\"Title\"/><resources>", "each name of metadata once"),
        ("<metadata name=\"Title\">", "<metadata>", "\"name\""),
        ("</model>", "</model><model/>", "one <model>"),
        ("<build><item objectid=\"7\"/></build>", "", "a <build>"),
        ("<item objectid=\"7\"/>", "<item objectid=\"8\"/>", "of type other"),
        ("<item objectid=\"7\"/>", "<item objectid=\"9\"/>", "an object 9"),
        ("type=\"model\"", "type=\"cube\"", "solidsupport"),
        ("pid=\"1\" pindex=\"0\" ", "pindex=\"0\" ", "a pid beside the pindex"),
        ("pid=\"1\" pindex=\"0\" ", "pid=\"1\" pindex=\"2\" ", "below 2 into resource 1"),
        ("pid=\"3\" p1=\"0\"", "pid=\"3\" p1=\"5\"", "below 2 into resource 3"),
        ("pid=\"3\" p1=\"0\"", "pid=\"33\" p1=\"0\"", "no resource 33"),
        ("colorgroup id=\"3\"", "colorgroup id=\"2\"", "each resource id once"),
        ("<m:color color=\"#00FF00\"/>", "<m:color/>", "\"color\""),
        ("#00FF00", "green", "#RRGGBB"),
        ("texid=\"2\"", "", "\"texid\""),
        ("texid=\"2\"", "texid=\"1\"", "a texture2d"),
        ("matid=\"1\"", "matid=\"3\"", "basematerials"),
        ("matid=\"1\" matindices=\"0 1\"", "", "\"matid\""),
        ("matindices=\"0 1\"", "", "\"matindices\""),
        ("pids=\"1 3\"", "", "\"pids\""),
        ("pids=\"1 3\"", "pids=\"1 5\"", "at most one group"),
        ("pids=\"1 3\"", "pids=\"3 3\"", "at most one group"),
        ("pids=\"1 3\"", "pids=\"1 22\"", "no resource 22"),
        ("path=\"/3D/a.png\"", "", "\"path\""),
        ("image/png", "image/gif", "image/jpeg"),
    ] {
        assert!(MODEL.contains(old), "{old}");
        let said = read(RELS, &MODEL.replacen(old, new, 1)).expect_err(new);
        assert!(said.contains(expected), "{new}: {said}");
    }
    let second = "<Relationship Id=\"r1\" Target=\"/3D/a.model\" Type=\"x/3dmodel\"/></Rel";
    for (old, new, expected) in [
        ("3dmodel\"", "other\"", "a relationship to a 3dmodel"),
        ("/3D/a.model", "/3D/b.model", "no part /3D/b.model"),
        ("/3D/a.model", "C:/3D/a.model", "no part C:"),
        ("</Rel", second, "at most one relationship"),
        ("</Rel", &second.replace("r1", "r0"), "each Id once"),
    ] {
        let said = read(&RELS.replacen(old, new, 1), MODEL).expect_err(new);
        assert!(said.contains(expected), "{new}: {said}");
    }
    // Names differ by more than case, and percent signs stand for letters.
    assert!(read(&RELS.replace("/3D/a.model", "/3d/%61.MODEL"), MODEL).is_ok());
}

/// The consortium's conformance suite, where it is to be had.
#[test]
fn the_conformance_suite() {
    let Some(corpus) = std::env::var_os("SCULPTD_CORPUS").map(PathBuf::from) else {
        return println!("skipped: SCULPTD_CORPUS is not set");
    };
    let files = |folder: &str| -> Vec<PathBuf> {
        let folder = corpus.join("files/3mfval").join(folder);
        let all = std::fs::read_dir(folder).expect("a folder").filter_map(Result::ok);
        all.map(|entry| entry.path())
            .filter(|p| p.extension().is_some_and(|e| e == "3mf"))
            .collect()
    };
    let read = |path: &PathBuf| {
        let bytes = std::fs::read(path).expect("read");
        parse(&bytes, &mut Vec::new(), &Job::default()).map_err(|e| e.of_file(path).to_string())
    };
    for path in files("MUSTPASS") {
        if let Err(e) = read(&path) {
            panic!("refused: {e}");
        }
    }
    let accepted: Vec<String> = files("MUSTFAIL")
        .iter()
        .filter(|path| read(path).is_ok())
        .map(|path| path.file_name().unwrap_or_default().to_string_lossy().into_owned())
        .collect();
    // MUSTPASS_Chapter3.4.1c has the same fault.
    assert_eq!(accepted, ["MUSTFAIL_Chapter3.4.1a_MissingMetadataName.3mf"]);
}
