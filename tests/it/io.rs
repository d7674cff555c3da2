//! Mesh files: the real ones of the corpus, ours, and broken ones.

use std::path::{Path, PathBuf};

use sculptd::analysis::cancel::Job;
use sculptd::mesh::io::read_mesh;

use crate::corpus;

fn mesh_files(dir: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(dir.join("meshes"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e != "md"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_mesh_of_the_corpus_is_read() {
    let Some(dir) = corpus() else { return };
    let files = mesh_files(&dir);
    assert!(files.len() > 50);
    for f in &files {
        let loaded = read_mesh(f, &Job::default()).unwrap();
        assert!(loaded.mesh.face_count() > 0, "{}", f.display());
        if !loaded.warnings.is_empty() {
            println!("{}: {:?}", f.display(), loaded.warnings);
        }
    }
}
