//! How much of a disk is free.

use std::path::Path;

/// Returns the bytes available to write in a folder, which need not exist: those of its nearest
/// existing parent. An empty path means the current folder. `None` if the system does not report
/// it.
#[cfg(unix)]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let here = Path::new(".");
    let there = folder.ancestors().find(|p| !p.as_os_str().is_empty() && p.exists());
    let disk = rustix::fs::statvfs(there.unwrap_or(here)).ok()?;
    disk.f_bavail.checked_mul(disk.f_frsize)
}

/// Bytes that may still be written where a folder is; `None`: the system does not tell.
#[cfg(not(unix))]
pub fn free_bytes(_folder: &Path) -> Option<u64> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_there_yet_is_on_the_disk_of_its_parent() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(free_bytes(folder.path()).is_some_and(|bytes| bytes > 0));
        assert!(free_bytes(&folder.path().join("a/b/c")).is_some());
        assert!(free_bytes(Path::new("")).is_some());
    }
}
