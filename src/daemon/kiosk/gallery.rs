//! Finished works: a mesh and a picture each, a page that shows them, a line a visit.

use std::io::Write;
use std::path::{Path, PathBuf};

use glam::Vec3;
use serde::Serialize;

pub use super::names::works;
use super::names::{number, sent};
use sculptd_geometry::io::{SceneMesh, write_beside, write_scene};
use sculptd_geometry::job::Job;
use sculptd_geometry::picture::{self, Camera, Picture};
use sculptd_geometry::{PolyMesh, TriMesh};

/// Size of a picture, pixels.
const WIDTH: usize = 640;
/// See [`WIDTH`].
const HEIGHT: usize = 480;

/// Colour of clay that nobody painted, sRGB.
const CLAY: [u8; 3] = [205, 148, 122];

/// The page before its first work.
const HEAD: &str = r#"<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>sculptd gallery</title>
<style>
body { margin: 2rem; background: #1d1f21; color: #eceae4; font: 16px system-ui, sans-serif }
h1 { font-weight: 500 }
ul { display: grid; gap: 1rem; padding: 0 }
ul { grid-template-columns: repeat(auto-fill, minmax(14rem, 1fr)) }
li { list-style: none; background: #2a2c2f; border-radius: 8px; overflow: hidden }
a { display: block; color: inherit; text-decoration: none }
a:focus-visible { outline: 3px solid #e0a060 }
img { display: block; width: 100% }
b { display: block; padding: .75rem; font-weight: 500 }
</style>
"#;

/// Adds a work under the next free name. See [`next`] and [`keep_as`].
///
/// # Errors
/// Returns the system's error.
pub fn keep(folder: &Path, mesh: &PolyMesh) -> std::io::Result<PathBuf> {
    let path = next(folder)?;
    keep_as(&path, mesh)?;
    Ok(path)
}

/// Returns the path of the next work of a gallery.
///
/// # Errors
/// Returns the system's error.
pub fn next(folder: &Path) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    // A number is never used twice, even if staff has emptied the folder: a sculpture that was
    // already sent would be overwritten.
    let last = works(folder)?.iter().filter_map(|n| number(n)).max().unwrap_or(0);
    let next = last.max(sent(folder)) + 1;
    Ok(folder.join(format!("work-{next:06}.glb")))
}

/// Writes a file into a folder and removes it again. A folder that does not exist yet is not made:
/// its nearest existing parent is tried.
///
/// # Errors
/// Returns the system's error.
pub fn takes_files(folder: &Path) -> std::io::Result<()> {
    let exists = |folder: &&Path| folder.exists() || folder.as_os_str().is_empty();
    let there = folder.ancestors().find(exists).unwrap_or(folder);
    let there = if there.as_os_str().is_empty() { Path::new(".") } else { there };
    let trial = there.join(format!(".sculptd-{}", std::process::id()));
    std::fs::OpenOptions::new().write(true).create_new(true).open(&trial)?.write_all(b"a trial")?;
    std::fs::remove_file(&trial)
}

/// Adds a picture, its sculpture and rewrites the page, in this order: each sculpture has its
/// picture already. Each file is written under a temporary name and renamed. The page lists the
/// folder, so the next call repairs an interruption between the two.
///
/// # Errors
/// Returns the system's error.
pub fn keep_as(path: &Path, mesh: &PolyMesh) -> std::io::Result<()> {
    let work = SceneMesh { mesh: mesh.clone(), ..SceneMesh::default() };
    if let Err(e) = draw(&path.with_extension("png"), mesh) {
        tracing::error!("{}: no picture of it is written: {e}", path.display());
    }
    write_scene(path, &[work], &Job::default()).map_err(std::io::Error::other)?;
    // The sculpture is kept, with or without the page that lists it.
    if let Some(Err(e)) = path.parent().map(page) {
        tracing::error!("{}: the page is not written, the next one mends it: {e}", path.display());
    }
    Ok(())
}

/// Deletes a work and its picture, and rewrites the page. A work that is gone already is no error.
///
/// # Errors
/// Returns the system's error.
pub fn remove(path: &Path) -> std::io::Result<()> {
    for file in [path.to_path_buf(), path.with_extension("png")] {
        match std::fs::remove_file(&file) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(e),
            _ => {}
        }
    }
    path.parent().map_or(Ok(()), page)
}

/// Draws a form from its front, a little from the side and from above.
pub fn portrait(mesh: &TriMesh, width: usize, height: usize) -> Picture {
    let from = Vec3::new(0.35, 0.3, 1.0);
    let camera =
        Camera { up: Vec3::Y, ..Camera::from_side(mesh, from, width as f32 / height as f32) };
    let colours: Vec<[u8; 3]> = match &mesh.colours {
        Some(all) => all.iter().map(|c| [c[0], c[1], c[2]]).collect(),
        None => vec![CLAY; mesh.positions.len()],
    };
    picture::draw(mesh, Some(&colours), &camera, width, height)
}

/// Writes the picture of a work.
fn draw(file: &Path, mesh: &PolyMesh) -> std::io::Result<()> {
    let picture = portrait(&mesh.triangulate().0, WIDTH, HEIGHT);
    let png = picture.png().map_err(std::io::Error::other)?;
    write_beside(file, |out| out.write_all(&png))
}

/// The page: plain HTML, no scripts, the newest work first.
pub fn page(folder: &Path) -> std::io::Result<()> {
    let names = works(folder)?;
    write_beside(&folder.join("index.html"), |out| {
        let count = names.len();
        writeln!(out, "{HEAD}<h1>{count} work{}</h1><ul>", if count == 1 { "" } else { "s" })?;
        for name in names.iter().rev() {
            // Names are digits and fixed letters: nothing to escape.
            let stem = name.strip_suffix(".glb").unwrap_or(name);
            let number = number(name).unwrap_or_default();
            let picture = match folder.join(format!("{stem}.png")).exists() {
                true => format!("<img src=\"{stem}.png\" alt=\"\" loading=\"lazy\">"),
                false => String::new(),
            };
            writeln!(out, "<li><a href=\"{name}\" download>{picture}<b>No. {number}</b></a></li>")?;
        }
        writeln!(out, "</ul></html>")
    })
}

/// One visit, as the audit file has it: nothing of the person.
#[derive(Debug, Clone, Serialize)]
pub struct VisitLine {
    /// Number of the visit since the program started.
    pub visit: u64,
    pub seconds: u64,
    pub dabs: u64,
    /// True if the work is in the gallery.
    pub kept: bool,
    /// Name of the work in the gallery.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub work: Option<String>,
    /// True if the program was killed during the visit. `seconds` and `dabs` count from the next
    /// start.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
    /// The exhibit's name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exhibit: Option<String>,
    /// Score of the work against the exhibit's goal, in whole percent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub percent: Option<u32>,
}

/// Appends a line for a visit.
///
/// # Errors
/// Returns the system's error.
pub fn audit(file: &Path, line: &VisitLine) -> std::io::Result<()> {
    let mut text = serde_json::to_string(line).map_err(std::io::Error::other)?;
    text.push('\n');
    let mut out = std::fs::OpenOptions::new().append(true).create(true).open(file)?;
    // In one call: lines of two writers do not mix.
    out.write_all(text.as_bytes())?;
    out.sync_data()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes;

    #[test]
    fn a_folder_that_takes_no_files_is_found_out_and_nothing_stays_in_one_that_does() {
        let dir = tempfile::tempdir().expect("a folder");
        for folder in [dir.path().to_path_buf(), dir.path().join("works/of/today")] {
            takes_files(&folder).expect("takes them");
        }
        assert_eq!(std::fs::read_dir(dir.path()).expect("listed").count(), 0);
        for folder in ["/proc/gallery", "/dev/null/gallery"] {
            assert!(takes_files(Path::new(folder)).is_err(), "{folder}");
        }
    }

    #[test]
    fn half_a_work_is_not_in_the_gallery_and_the_next_work_mends_the_page() {
        let dir = tempfile::tempdir().expect("a folder");
        let ball = shapes::uv_sphere(1.0, 6, 8);
        keep(dir.path(), &ball).expect("kept");
        // A hundred cuts in the middle of the second: a part under its hidden name, and a page that
        // was torn.
        for n in 0..100 {
            #[allow(clippy::disallowed_methods)] // Half a file is what this test is about.
            std::fs::write(dir.path().join(format!(".work-000002.glb.1-{n}.part")), vec![b'g'; n])
                .expect("torn");
            assert_eq!(works(dir.path()).expect("listed"), ["work-000001.glb"]);
        }
        let second = keep(dir.path(), &ball).expect("kept");
        assert!(second.ends_with("work-000002.glb"));
        let text = std::fs::read_to_string(dir.path().join("index.html")).expect("the page");
        assert!(text.contains("2 works") && text.contains("work-000001.glb"));
        assert!(text.contains("<img src=\"work-000002.png\""), "{text}");
        let png = std::fs::read(dir.path().join("work-000002.png")).expect("a picture");
        assert!(png.starts_with(b"\x89PNG"));
        assert_eq!(number("work-1.glb"), None);
        assert_eq!(number("work-00000x.glb"), None);
    }
}
