//! Reading a pack, a folder or a `.zip` file, and writing one.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::score::Goal;
use super::{Exhibit, ExhibitStep, MANIFEST, Manifest, PICTURE, forms};
use crate::kiosk::gallery::portrait;
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::{encode, parse, write_beside};
use sculptd_geometry::job::Job;

/// Most bytes of one file of a pack, unpacked.
const MAX_BYTES: u64 = 256 << 20;
/// Most triangles of a mesh of a pack: a goal is drawn and measured while visitors sculpt.
pub const MAX_TRIANGLES: usize = 1_000_000;

/// Opens an exhibit: a folder, a `.zip` file, or the name of one that comes with the program.
///
/// # Errors
/// Returns a message that names the file and what was expected.
pub fn open(place: &Path, job: &Job) -> Result<Exhibit, String> {
    let name = place.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    if !place.exists() {
        let made = place.to_str().and_then(|text| forms::make(text, job));
        return made.unwrap_or_else(|| {
            let known = forms::NAMES.join(", ");
            Err(format!(
                "{}: expected a folder, a .zip file, or one of {known}, found nothing",
                place.display()
            ))
        });
    }
    let read: Box<dyn FnMut(&str) -> Result<Vec<u8>, String>> = match place.is_dir() {
        true => Box::new(|file: &str| from_folder(place, file)),
        false => {
            let file = std::fs::File::open(place);
            let file = file.map_err(|e| format!("{}: {e}", place.display()))?;
            let zip = zip::ZipArchive::new(std::io::BufReader::new(file));
            let mut zip = zip.map_err(|e| format!("{}: {e}", place.display()))?;
            Box::new(move |file: &str| from_zip(&mut zip, file))
        }
    };
    assemble(name, read, job).map_err(|e| format!("{}: {e}", place.display()))
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
            let loaded = parse(&read(file)?, path, job);
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
/// As [`open`].
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
    let text = toml::to_string(manifest).map_err(|e| e.to_string())?;
    let mut files = vec![(MANIFEST.to_owned(), text.into_bytes())];
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
/// Returns a message that names the file. A folder that exists is an error.
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
    if to.exists() {
        return Err(at(to, &"it exists already: expected the name of a new folder"));
    }
    std::fs::create_dir_all(&part).map_err(|e| at(&part, &e))?;
    for (name, bytes) in &files {
        let file = part.join(name);
        write_beside(&file, |out| out.write_all(bytes)).map_err(|e| at(&file, &e))?;
    }
    std::fs::rename(&part, to).map_err(|e| at(to, &e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kiosk::exhibit::{StepManifest, Texts};
    use sculptd_geometry::shapes;

    fn exhibit() -> Exhibit {
        let step = StepManifest {
            goal: "goal.ply".into(),
            tolerance: 0.5,
            tools: vec!["carve".into()],
            ghost: true,
            text: Texts::new("Find the ball"),
        };
        let manifest = Manifest {
            start: "start.ply".into(),
            minutes: 3.0,
            radius: 0.1,
            strength: 0.0,
            symmetry: 1,
            title: Texts::new("A ball"),
            step: vec![step],
        };
        let (start, goal) = (shapes::icosphere(12.0, 12), shapes::icosphere(10.0, 12));
        let meshes = [("start.ply", &start), ("goal.ply", &goal)];
        of_meshes("ball", &manifest, &meshes, &Job::default()).expect("an exhibit")
    }

    #[test]
    fn a_pack_comes_back_from_a_folder_and_from_a_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let made = exhibit();
        for name in ["ball", "ball.zip"] {
            let place = dir.path().join(name);
            write(&made, &place).expect("written");
            let read = open(&place, &Job::default()).expect("read");
            assert_eq!(*read.start, *made.start);
            assert_eq!((read.name.as_str(), &read.manifest.title), ("ball", &made.manifest.title));
            let [a, b] = [&read, &made].map(|e| e.steps[0].goal.clone().expect("a goal"));
            assert_eq!((&a.mesh, a.tolerance), (&b.mesh, b.tolerance));
        }
        assert!(write(&made, &dir.path().join("ball")).is_err_and(|e| e.contains("exists")));
        let folder: Vec<_> = std::fs::read_dir(dir.path()).expect("listed").collect();
        assert_eq!(folder.len(), 2, "nothing half-written is left");
    }

    #[test]
    fn a_broken_pack_says_where() {
        let dir = tempfile::tempdir().expect("a folder");
        let place = dir.path().join("ball");
        write(&exhibit(), &place).expect("written");
        let text = std::fs::read_to_string(place.join(MANIFEST)).expect("a text");
        let with = |old: &str, new: &str| {
            #[allow(clippy::disallowed_methods)] // A broken file is what this test is about.
            std::fs::write(place.join(MANIFEST), text.replace(old, new)).expect("written");
            open(&place, &Job::default()).expect_err("refused")
        };
        assert!(with("goal-1.ply", "../goal-1.ply").contains("without a folder"));
        assert!(with("goal-1.ply", "/etc/passwd").contains("without a folder"));
        assert!(with("goal-1.ply", "none.ply").contains("none.ply"));
        assert!(with("minutes = 3.0", "minutes = three").contains(MANIFEST));
        #[allow(clippy::disallowed_methods)] // As above.
        std::fs::write(place.join("goal-1.ply"), b"ply\n").expect("written");
        assert!(with("nothing", "nothing").contains("goal-1.ply"));
        let said = open(&dir.path().join("nowhere"), &Job::default()).expect_err("refused");
        assert!(said.contains("figurine, pot, relief"), "{said}");
        #[allow(clippy::disallowed_methods)] // As above.
        std::fs::write(dir.path().join("a.zip"), b"PK no").expect("written");
        assert!(
            open(&dir.path().join("a.zip"), &Job::default()).is_err_and(|e| e.contains("a.zip"))
        );
    }
}
