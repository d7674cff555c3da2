//! 3MF: a zip of XML, its objects placed by the build list, in millimetres whatever unit the file
//! is in.
//!
//! Own reading over the kept crates `zip` and `quick-xml`: the kept reader of whole 3MF files reads
//! without a bound (a zip of a few kilobytes can hold gigabytes), keeps no place for messages and
//! no parts beyond the first.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use glam::{DMat4, DVec3, DVec4};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::gltf::MAX_INSTANCED;
use super::problem::{FilePlace, FileProblem, ParseError};
use super::text::{float, integer, refuse};
use crate::job::Job;
use crate::{PolyMesh, repair};

/// The name of an object: its part's path and its number.
type PartName = (String, i64);

#[derive(Default)]
struct ThreemfObject {
    mesh: PolyMesh,
    components: Vec<(PartName, DMat4)>,
}

#[derive(Default)]
struct ThreemfPackage {
    objects: BTreeMap<PartName, ThreemfObject>,
    build: Vec<(PartName, DMat4)>,
    /// Millimetres in the root part's unit.
    unit: f64,
    /// Groups of colours, materials and texture coordinates.
    properties: usize,
    beams: usize,
}

/// Extensions that a file may require: their parts are read, or named in a warning.
const EXTENSIONS: [&str; 5] =
    ["/core/", "/material/", "/production/", "/trianglesets/", "/beamlattice/"];

fn bad(at: FilePlace, expected: impl Into<String>, found: impl Into<String>) -> ParseError {
    FileProblem::new(at, expected.into(), found.into()).into()
}

pub(super) fn parse(
    bytes: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| {
        bad(FilePlace::Byte(bytes.len() as u64), "a zip's directory at the end", e.to_string())
    })?;
    // A choice, not a law of the format: what unpacks to more than this is taken for a trap. Small
    // files may be a hundred times as long unpacked, large ones eight times.
    let packed = bytes.len() as u64;
    let mut room = (packed * 100).min(packed * 8 + (256 << 20)) + (16 << 20);
    let mut part = |name: &str| -> Result<Vec<u8>, ParseError> {
        let entry = zip
            .by_name(name)
            .map_err(|e| bad(FilePlace::File, format!("a part {name}"), e.to_string()))?;
        let mut out = Vec::new();
        entry
            .take(room + 1)
            .read_to_end(&mut out)
            .map_err(|e| bad(FilePlace::File, format!("the part {name} whole"), e.to_string()))?;
        room = room.checked_sub(out.len() as u64).ok_or_else(|| {
            bad(
                FilePlace::File,
                "parts of at most a hundred times the file's length, or eight and 256 MiB",
                format!("more in {name}"),
            )
        })?;
        Ok(out)
    };
    let root = part("_rels/.rels")
        .ok()
        .and_then(|rels| model_of(&rels))
        .unwrap_or_else(|| "3D/3dmodel.model".into());
    let mut package = ThreemfPackage::default();
    let text = part(&root)?;
    model(&text, &root, true, &mut package, job)?;
    job.progress(0.6);
    // Parts that the root's components and items name.
    loop {
        let named = package
            .objects
            .values()
            .flat_map(|o| &o.components)
            .chain(&package.build)
            .map(|(n, _)| n);
        let missing = named
            .filter(|n| !package.objects.contains_key(n) && n.0 != root)
            .map(|n| n.0.clone())
            .next();
        let Some(path) = missing else { break };
        let text = part(&path)?;
        let before = package.objects.len();
        model(&text, &path, false, &mut package, job)?;
        if package.objects.len() == before {
            return Err(bad(
                FilePlace::File,
                format!("the objects named in {path}"),
                "none of them",
            ));
        }
    }
    if package.properties > 0 {
        warnings.push(format!(
            "{} groups of colours, materials or texture coordinates left out",
            package.properties
        ));
    }
    if package.beams > 0 {
        warnings.push(format!("{} beams of beam lattices left out", package.beams));
    }
    assemble(&package, job)
}

fn model_of(rels: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(rels);
    let mut reader = Reader::from_str(&text);
    loop {
        match reader.read_event().ok()? {
            Event::Empty(e) | Event::Start(e)
                if e.local_name().as_ref() == "Relationship"
                    && get(&e, "Type").is_some_and(|t| t.ends_with("/3dmodel")) =>
            {
                return get(&e, "Target").map(|t| t.trim_start_matches('/').to_string());
            }
            Event::Eof => return None,
            _ => {}
        }
    }
}

/// How the names of the 3MF Consortium's extensions begin.
const NAMESPACES: &str = "http://schemas.microsoft.com/3dmanufacturing";

/// The name of the extension that an element gives a prefix.
fn namespace(e: &BytesStart, prefix: &str) -> Option<String> {
    let key = format!("xmlns:{prefix}");
    let found = e.attributes().filter_map(Result::ok).find(|a| a.key.as_ref() == key.as_str());
    found.map(|a| a.value.to_string())
}

/// An attribute by its name without prefix.
fn get(e: &BytesStart, name: &str) -> Option<String> {
    e.attributes()
        .filter_map(Result::ok)
        .find(|a| a.key.local_name().as_ref() == name)
        .map(|a| a.value.to_string())
}

fn model(
    text: &[u8],
    path: &str,
    root: bool,
    package: &mut ThreemfPackage,
    job: &Job,
) -> Result<(), ParseError> {
    let text =
        std::str::from_utf8(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)).map_err(|e| {
            bad(FilePlace::Byte(e.valid_up_to() as u64), format!("UTF-8 in {path}"), "other bytes")
        })?;
    let mut reader = Reader::from_str(text);
    let mut now: Option<(i64, ThreemfObject)> = None;
    let mut count = 0u32;
    if root {
        package.unit = 1.0;
    }
    loop {
        count = count.wrapping_add(1);
        if count.is_multiple_of(1 << 14) {
            job.check()?;
        }
        let at = FilePlace::Byte(reader.buffer_position());
        let wrong =
            |expected: &str, found: String| bad(at, format!("{expected} (in {path})"), found);
        let event = reader.read_event().map_err(|e| wrong("well-formed XML", e.to_string()))?;
        let (e, empty) = match event {
            Event::Start(e) => (e, false),
            Event::Empty(e) => (e, true),
            Event::End(e) if e.local_name().as_ref() == "object" => {
                if let Some((id, object)) = now.take() {
                    package.objects.insert((path.to_string(), id), object);
                }
                continue;
            }
            Event::Eof => break,
            _ => continue,
        };
        let number = |name: &str| -> Result<f64, ParseError> {
            let text = get(&e, name)
                .ok_or_else(|| wrong(&format!("the attribute \"{name}\""), "none".into()))?;
            let value = float(text.as_bytes())
                .ok_or_else(|| wrong(&format!("a number as \"{name}\""), text.clone()))?;
            match refuse(value) {
                None => Ok(value),
                Some(found) => Err(wrong("a finite number", found.into())),
            }
        };
        let index = |name: &str| -> Result<i64, ParseError> {
            let text = get(&e, name)
                .ok_or_else(|| wrong(&format!("the attribute \"{name}\""), "none".into()))?;
            integer(text.as_bytes())
                .ok_or_else(|| wrong(&format!("a whole number as \"{name}\""), text.clone()))
        };
        let target = || -> Result<(PartName, DMat4), ParseError> {
            let place =
                get(&e, "path").map_or(path.to_string(), |p| p.trim_start_matches('/').to_string());
            let transform = match get(&e, "transform") {
                None => DMat4::IDENTITY,
                Some(t) => transform(&t)
                    .ok_or_else(|| wrong("twelve numbers of an invertible \"transform\"", t))?,
            };
            Ok(((place, index("objectid")?), transform))
        };
        match e.local_name().as_ref() {
            "model" => {
                for prefix in get(&e, "requiredextensions").unwrap_or_default().split_whitespace() {
                    let space = namespace(&e, prefix).unwrap_or_else(|| prefix.into());
                    let known = space.starts_with(NAMESPACES)
                        && EXTENSIONS.iter().any(|known| space.contains(known));
                    if !known {
                        return Err(wrong("required extensions that are known here", space));
                    }
                }
                if !root {
                    continue;
                }
                package.unit = match get(&e, "unit").as_deref() {
                    None | Some("millimeter") => 1.0,
                    Some("micron") => 1e-3,
                    Some("centimeter") => 10.0,
                    Some("inch") => 25.4,
                    Some("foot") => 304.8,
                    Some("meter") => 1e3,
                    Some(other) => {
                        return Err(wrong(
                            "micron, millimeter, centimeter, inch, foot or meter",
                            other.into(),
                        ));
                    }
                };
            }
            "object" => {
                let object =
                    (index("id")?, ThreemfObject { mesh: PolyMesh::new(), components: Vec::new() });
                if empty {
                    package.objects.insert((path.to_string(), object.0), object.1);
                } else {
                    now = Some(object);
                }
            }
            "vertex" => {
                if let Some((_, o)) = &mut now {
                    o.mesh.positions.push(DVec3::new(number("x")?, number("y")?, number("z")?));
                }
            }
            "triangle" => {
                if let Some((_, o)) = &mut now {
                    let n = o.mesh.positions.len() as i64;
                    let mut corners = [0; 3];
                    for (c, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
                        let i = index(name)?;
                        if !(0..n).contains(&i) {
                            return Err(wrong(&format!("a vertex index below {n}"), i.to_string()));
                        }
                        *c = i as u32;
                    }
                    o.mesh.push_face(&corners);
                }
            }
            "basematerials" | "colorgroup" | "texture2dgroup" | "compositematerials"
            | "multiproperties" => package.properties += 1,
            "beam" | "ball" => package.beams += 1,
            "component" => {
                if let Some((_, o)) = &mut now {
                    o.components.push(target()?);
                }
            }
            "item" if root => package.build.push(target()?),
            _ => {}
        }
    }
    Ok(())
}

/// Twelve numbers, a row vector's matrix by rows; `None` of one without an inverse.
fn transform(text: &str) -> Option<DMat4> {
    let v: Vec<f64> = text
        .split_ascii_whitespace()
        .map(|w| float(w.as_bytes()).filter(|v| v.is_finite()))
        .collect::<Option<_>>()?;
    let row = |i: usize, w: f64| DVec4::new(v[i], v[i + 1], v[i + 2], w);
    let matrix = (v.len() == 12)
        .then(|| DMat4::from_cols(row(0, 0.0), row(3, 0.0), row(6, 0.0), row(9, 1.0)));
    // A part that is pressed flat has no volume (3MF core specification, 3.3).
    matrix.filter(|m| m.determinant() != 0.0)
}

/// Objects may hold objects; deeper than this is a circle.
const DEPTH: usize = 32;

fn assemble(package: &ThreemfPackage, job: &Job) -> Result<PolyMesh, ParseError> {
    let mut out = PolyMesh::new();
    let mut groups = Vec::new();
    let mut todo: Vec<(&PartName, DMat4, usize, u32)> = package
        .build
        .iter()
        .enumerate()
        .rev()
        .map(|(n, (name, t))| {
            (name, DMat4::from_scale(DVec3::splat(package.unit)) * *t, 0, n as u32)
        })
        .collect();
    if todo.is_empty() {
        // A file without a build list: all objects as they stand.
        let scale = DMat4::from_scale(DVec3::splat(package.unit));
        todo.extend(package.objects.keys().enumerate().map(|(n, name)| (name, scale, 0, n as u32)));
    }
    let mut visits = 0usize;
    while let Some((name, place, depth, group)) = todo.pop() {
        job.check()?;
        visits += 1;
        let Some(object) = package.objects.get(name) else {
            return Err(bad(
                FilePlace::File,
                format!("an object {} in {}", name.1, name.0),
                "none",
            ));
        };
        if depth > DEPTH || visits > 1_000_000 {
            return Err(bad(
                FilePlace::File,
                "objects within objects, up to 32 deep",
                "a circle or too many",
            ));
        }
        if out.corners.len() + object.mesh.corners.len() > MAX_INSTANCED {
            return Err(bad(
                FilePlace::File,
                format!("at most {MAX_INSTANCED} corners in all objects"),
                "more",
            ));
        }
        let base = out.positions.len() as u32;
        for p in &object.mesh.positions {
            let q = place.transform_point3(*p);
            if let Some(found) = q.to_array().into_iter().find_map(refuse) {
                return Err(bad(FilePlace::File, "finite coordinates after the transforms", found));
            }
            out.positions.push(q);
        }
        let mut part = PolyMesh::new();
        object.mesh.faces().for_each(|f| part.push_face(&[f[0] + base, f[1] + base, f[2] + base]));
        if place.determinant() < 0.0 {
            repair::flip(&mut part);
        }
        part.faces().for_each(|f| out.push_face(f));
        groups.resize(out.face_count(), group);
        todo.extend(object.components.iter().rev().map(|(n, t)| (n, place * *t, depth + 1, group)));
    }
    if out.face_count() == 0 {
        return Err(bad(FilePlace::File, "an object with triangles in the build list", "none"));
    }
    out.groups = groups.windows(2).any(|w| w[0] != w[1]).then_some(groups);
    Ok(out)
}
