//! Reading a pack, a folder or a `.zip` file, and writing one.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::score::Goal;
use super::{Exhibit, ExhibitStep, MANIFEST, Manifest, PICTURE};
use crate::kiosk::gallery::portrait;
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::{encode, parse_in_millimetres, write_beside};
use sculptd_geometry::job::Job;

/// Most bytes of one file of a pack, unpacked.
const MAX_BYTES: u64 = 256 << 20;
/// Most triangles of a mesh of a pack: a goal is drawn and measured while visitors sculpt.
pub const MAX_TRIANGLES: usize = 1_000_000;

/// Reads a pack: a folder or a `.zip` file.
///
/// # Errors
/// Returns a message that names the file and what was expected.
pub fn read(place: &Path, job: &Job) -> Result<Exhibit, String> {
    let name = place.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let at_place = |e: String| format!("{}: {e}", place.display());
    if place.is_dir() {
        return assemble(name, |file| from_folder(place, file), job).map_err(at_place);
    }
    let file = std::fs::File::open(place).map_err(|e| at_place(e.to_string()))?;
    let zip = zip::ZipArchive::new(std::io::BufReader::new(file));
    let mut zip = zip.map_err(|e| at_place(e.to_string()))?;
    assemble(name, |file| from_zip(&mut zip, file), job).map_err(at_place)
}

/// Puts an exhibit together from its files.
fn assemble(
    name: String,
    mut read: impl FnMut(&str) -> Result<Vec<u8>, String>,
    job: &Job,
) -> Result<Exhibit, String> {
    let in_manifest = |e: String| format!("{MANIFEST}: {e}");
    let text = String::from_utf8(read(MANIFEST)?).map_err(|e| in_manifest(e.to_string()))?;
    let manifest = Manifest::parse(&text).map_err(in_manifest)?;
    let mut meshes: BTreeMap<String, TriMesh> = BTreeMap::new();
    let goals = manifest.step.iter().map(|step| &step.goal).filter(|goal| !goal.is_empty());
    for file in goals.chain([&manifest.start]) {
        if !meshes.contains_key(file) {
            let path = Path::new(file);
            let loaded = parse_in_millimetres(&read(file)?, path, job);
            let loaded = loaded.map_err(|e| e.of_file(path).to_string())?;
            let mesh = loaded.mesh.triangulate().0;
            let found = mesh.triangles.len();
            if !(1..=MAX_TRIANGLES).contains(&found) {
                return Err(format!(
                    "{file}: expected 1 to {MAX_TRIANGLES} triangles, found {found}"
                ));
            }
            meshes.insert(file.clone(), mesh);
        }
    }
    let mesh = |file: &str| meshes.get(file).cloned().unwrap_or_default();
    let start = Arc::new(mesh(&manifest.start));
    let mut steps = Vec::new();
    for (i, step) in manifest.step.iter().enumerate() {
        let in_step = |e: String| format!("{MANIFEST}: step {}: {e}", i + 1);
        let goal = match step.goal.is_empty() {
            true => None,
            false => {
                let goal = Goal::new(mesh(&step.goal), &start, step.tolerance, job);
                Some(Arc::new(goal.map_err(|e| in_step(format!("{}: {e}", step.goal)))?))
            }
        };
        let tools = step.tools().map_err(in_step)?;
        steps.push(ExhibitStep { text: step.text.clone(), tools, goal, ghost: step.ghost });
    }
    let goal = steps.iter().rev().find_map(|step| step.goal.as_ref());
    let [width, height] = PICTURE;
    let shown = goal.map_or(&start, |goal| &goal.mesh);
    let picture = Arc::new(portrait(shown, width, height));
    Ok(Exhibit { name, manifest, start, steps, picture })
}

/// Makes an exhibit of a manifest and the meshes that it names.
///
/// # Errors
/// As [`read`].
pub fn of_meshes(
    name: &str,
    manifest: &Manifest,
    meshes: &[(&str, &TriMesh)],
    job: &Job,
) -> Result<Exhibit, String> {
    let files = files_of(manifest, meshes)?;
    let read = |file: &str| {
        let found = files.iter().find(|(name, _)| name == file);
        found.map(|f| f.1.clone()).ok_or_else(|| format!("{file}: the pack does not have it"))
    };
    assemble(name.to_owned(), read, job)
}

fn files_of(
    manifest: &Manifest,
    meshes: &[(&str, &TriMesh)],
) -> Result<Vec<(String, Vec<u8>)>, String> {
    let mut files = vec![(MANIFEST.to_owned(), manifest.text().into_bytes())];
    for (name, mesh) in meshes {
        let mut bytes = Vec::new();
        let written = encode("ply", &mesh.to_poly(), &mut Cursor::new(&mut bytes));
        written.map_err(|e| format!("{name}: {e}"))?;
        files.push(((*name).to_owned(), bytes));
    }
    Ok(files)
}

/// Refuses names that lead out of the pack.
fn plain_name(file: &str) -> Result<(), String> {
    let mut parts = Path::new(file).components();
    let first = parts.next();
    match (first, parts.next()) {
        (Some(std::path::Component::Normal(_)), None) => Ok(()),
        _ => Err(format!("\"{file}\": expected the name of a file of the pack, without a folder")),
    }
}

fn from_folder(folder: &Path, file: &str) -> Result<Vec<u8>, String> {
    plain_name(file)?;
    let found = sculptd_geometry::io::read_regular(&folder.join(file), MAX_BYTES);
    found.map_err(|e| format!("{file}: {e}"))
}

fn from_zip<R: Read + Seek>(zip: &mut zip::ZipArchive<R>, file: &str) -> Result<Vec<u8>, String> {
    plain_name(file)?;
    let in_file = |e: String| format!("{file}: {e}");
    let entry = zip.by_name(file).map_err(|e| in_file(e.to_string()))?;
    let mut bytes = Vec::new();
    // The size in the entry may be wrong.
    let read = entry.take(MAX_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|e| in_file(e.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(in_file(format!("expected at most {MAX_BYTES} bytes")));
    }
    Ok(bytes)
}

/// Writes an exhibit as a pack: a `.zip` file if the path ends so, or else a new folder. Meshes are
/// written as binary PLY.
///
/// # Errors
/// Returns a message that names the file. A pack that exists is an error.
pub fn write(exhibit: &Exhibit, to: &Path) -> Result<(), String> {
    let at = |path: &Path, e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let mut manifest = exhibit.manifest.clone();
    manifest.start = "start.ply".into();
    let mut meshes: Vec<(String, &TriMesh)> = vec![(manifest.start.clone(), &exhibit.start)];
    for (i, (step, ready)) in manifest.step.iter_mut().zip(&exhibit.steps).enumerate() {
        if let Some(goal) = &ready.goal {
            step.goal = format!("goal-{}.ply", i + 1);
            meshes.push((step.goal.clone(), &goal.mesh));
        }
    }
    if to.exists() {
        return Err(at(to, &"it exists already: remove it first, or give another name"));
    }
    let named: Vec<(&str, &TriMesh)> = meshes.iter().map(|(n, m)| (n.as_str(), *m)).collect();
    let files = files_of(&manifest, &named)?;
    if to.extension().is_some_and(|e| e.eq_ignore_ascii_case("zip")) {
        return write_beside(to, |out| {
            let mut zip = zip::ZipWriter::new_stream(out);
            let options = zip::write::SimpleFileOptions::default();
            for (name, bytes) in &files {
                zip.start_file(name.as_str(), options).map_err(std::io::Error::other)?;
                zip.write_all(bytes)?;
            }
            zip.finish().map(drop).map_err(std::io::Error::other)
        })
        .map_err(|e| at(to, &e));
    }
    // Under another name until it is whole.
    let part = PathBuf::from(format!("{}.part", to.display()));
    std::fs::create_dir_all(&part).map_err(|e| at(&part, &e))?;
    for (name, bytes) in &files {
        let file = part.join(name);
        write_beside(&file, |out| out.write_all(bytes)).map_err(|e| at(&file, &e))?;
    }
    std::fs::rename(&part, to).map_err(|e| at(to, &e))
}
