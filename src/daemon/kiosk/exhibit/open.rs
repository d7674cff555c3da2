//! Opening an exhibit by its place or by its name.

use std::path::Path;

use super::{Exhibit, forms, pack};
use sculptd_geometry::job::Job;

/// Opens an exhibit: a folder, a `.zip` file, or the name of a built-in one.
///
/// # Errors
/// Returns a message that names the file and what was expected.
pub fn open(place: &Path, job: &Job) -> Result<Exhibit, String> {
    if place.exists() {
        return pack::read(place, job);
    }
    let made = place.to_str().and_then(|text| forms::make(text, job));
    made.unwrap_or_else(|| {
        let known = forms::NAMES.join(", ");
        Err(format!(
            "{}: expected a folder, a .zip file, or one of {known}, found nothing",
            place.display()
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::super::pack::{of_meshes, write};
    use super::super::{MANIFEST, Manifest, StepManifest, Texts};
    use super::*;
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
        for name in ["ball", "ball.zip"] {
            assert!(write(&made, &dir.path().join(name)).is_err_and(|e| e.contains("exists")));
        }
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
