//! 3MF: a zip of XML, its objects placed by the build list, in millimetres whatever unit the file
//! is in.
//!
//! A file that breaks a rule of the specification is refused: the consortium's conformance suite is
//! the measure. One of its rules is left out, for its own files contradict each other: names of
//! metadata that nobody defined pass.
//!
//! Own reading over the kept crates `zip` and `quick-xml`: the kept reader of whole 3MF files reads
//! without a bound (a zip of a few kilobytes can hold gigabytes), keeps no place for messages and
//! no parts beyond the first.

mod assemble;
mod model;
pub(super) mod painting;
mod relationships;
mod resources;

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use glam::DMat4;
use quick_xml::events::BytesStart;

use super::problem::{FilePlace, FileProblem, ParseError};
use crate::PolyMesh;
use crate::filaments::{Filaments, MAX_FILAMENTS};
use crate::job::Job;
use assemble::assemble;
use painting::TrianglePaint;
use relationships::PartNames;

/// The name of an object: its part's path and its number.
type PartName = (String, i64);

#[derive(Default)]
struct ThreemfObject {
    mesh: PolyMesh,
    components: Vec<(PartName, DMat4)>,
    /// Colours of the faces' corners; empty: no face has any.
    colours: Vec<[Option<[u8; 4]>; 3]>,
    /// Filaments of the faces; empty: no face has any.
    painting: Vec<TrianglePaint>,
    /// An object of the type `other` is never built.
    other: bool,
    /// Material that carries the part while it is printed, and is no part of it.
    support: bool,
    /// For people; may be empty.
    name: String,
}

#[derive(Default)]
struct ThreemfPackage {
    objects: BTreeMap<PartName, ThreemfObject>,
    build: Vec<(PartName, DMat4)>,
    /// Millimetres in the root part's unit.
    unit: f64,
    /// Groups of composite materials, multiproperties and texture coordinates.
    properties: usize,
    /// The colours of all base materials.
    materials: Vec<Option<[u8; 4]>>,
    beams: usize,
    /// Stacks of slices beside the meshes of objects.
    slices: usize,
}

fn bad(at: FilePlace, expected: impl Into<String>, found: impl Into<String>) -> ParseError {
    FileProblem::new(at, expected.into(), found.into()).into()
}

pub(super) fn parse(
    bytes: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let package = unpack(bytes, job)?;
    if package.properties > 0 {
        warnings.push(format!(
            "{} groups of composite materials, multiproperties or texture coordinates left out",
            package.properties
        ));
    }
    if package.beams > 0 {
        warnings.push(format!("{} beams of beam lattices left out", package.beams));
    }
    if package.slices > 0 {
        warnings.push(format!("{} stacks of slices left out", package.slices));
    }
    assemble(&package, warnings, job)
}

/// Reads the filaments of a file of one object whose triangles are all painted whole, as
/// [`super::write_painted`] writes it: the base materials are the filaments.
pub(super) fn parse_painting(bytes: &[u8], job: &Job) -> Result<Filaments, ParseError> {
    let package = unpack(bytes, job)?;
    let wrong = |expected: &str, found: String| bad(FilePlace::File, expected, found);
    let mut painted = package.objects.values().filter(|o| o.mesh.face_count() > 0);
    let (Some(object), None) = (painted.next(), painted.next()) else {
        return Err(wrong("one object with triangles", package.objects.len().to_string()));
    };
    let colours: Option<Vec<[u8; 3]>> =
        package.materials.iter().map(|c| c.map(|[r, g, b, _]| [r, g, b])).collect();
    let Some(colours) = colours.filter(|c| c.len() <= MAX_FILAMENTS) else {
        let found = package.materials.len().to_string();
        return Err(wrong("at most 16 base materials with a colour", found));
    };
    let filament = |paint: &TrianglePaint| match paint {
        TrianglePaint::Filament(number) if usize::from(*number) <= colours.len() => Ok(number - 1),
        _ => Err(wrong("a filament of the base materials", format!("{paint:?}"))),
    };
    let triangles: Vec<u8> = object.painting.iter().map(filament).collect::<Result<_, _>>()?;
    match triangles.len() == object.mesh.face_count() {
        true => Ok(Filaments { colours, triangles }),
        false => Err(wrong("a filament for each triangle", "triangles without one".into())),
    }
}

fn unpack(bytes: &[u8], job: &Job) -> Result<ThreemfPackage, ParseError> {
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| {
        bad(FilePlace::Byte(bytes.len() as u64), "a zip's directory at the end", e.to_string())
    })?;
    let all: Vec<String> = zip.file_names().filter_map(Result::ok).map(String::from).collect();
    let names = PartNames::new(all.iter().map(String::as_str));
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
    let rels = part("_rels/.rels")?;
    let root = relationships::check(&rels, ("_rels/.rels", ""), &names)?.ok_or_else(|| {
        let expected = "a relationship to a 3dmodel in _rels/.rels";
        bad(FilePlace::File, expected, "none")
    })?;
    let (folder, file) = root.rsplit_once('/').unwrap_or(("", &root));
    let rels = format!("{folder}/_rels/{file}.rels");
    if let Some(rels) = names.find(&rels) {
        relationships::check(&part(rels)?, (rels, folder), &names)?;
    }
    let mut package = ThreemfPackage::default();
    let text = part(&root)?;
    model::read(&text, (&root, true), &mut package, job)?;
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
        let text = part(names.find(&path).unwrap_or(&path))?;
        let before = package.objects.len();
        model::read(&text, (&path, false), &mut package, job)?;
        if package.objects.len() == before {
            return Err(bad(
                FilePlace::File,
                format!("the objects named in {path}"),
                "none of them",
            ));
        }
    }
    Ok(package)
}

/// An attribute by its name without prefix.
fn get(e: &BytesStart, name: &str) -> Option<String> {
    e.attributes()
        .filter_map(Result::ok)
        .find(|a| a.key.local_name().as_ref() == name)
        .map(|a| a.value.to_string())
}

/// An attribute for people, its entities resolved; empty where there is none.
fn text_for_people(e: &BytesStart, name: &str) -> String {
    let text = get(e, name).unwrap_or_default();
    quick_xml::escape::unescape(&text).map_or_else(|_| text.clone(), |t| t.into_owned())
}

#[cfg(test)]
mod tests;
