//! Reading a whole file that somebody else named: a regular file only, through a stated bound.
//!
//! A device or a pipe has no length to hold against a bound and may never end; a sparse file may be
//! longer than the memory that there is.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The bytes of the regular file at `path`, at most `limit` of them.
///
/// # Errors
/// [`ErrorKind::IsADirectory`] for a folder, [`ErrorKind::InvalidInput`] for a device, a pipe or a
/// socket, [`ErrorKind::FileTooLarge`] beyond the limit, [`ErrorKind::OutOfMemory`] where there is
/// no memory for it, and what the system says of reading.
pub fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>> {
    // Asked before it is opened: opening a pipe waits for its other end.
    check(&std::fs::metadata(path)?, limit)?;
    let file = File::open(path)?;
    let length = check(&file.metadata()?, limit)?;
    let mut bytes = Vec::new();
    let room = usize::try_from(length).map_err(|_| too_large(length, limit))?;
    bytes.try_reserve_exact(room).map_err(|e| Error::new(ErrorKind::OutOfMemory, e))?;
    // A file that grows while it is read is read as long as it was.
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The length, of a regular file within the limit.
fn check(meta: &Metadata, limit: u64) -> Result<u64> {
    if meta.is_dir() {
        let text = "expected a regular file, found a folder";
        return Err(Error::new(ErrorKind::IsADirectory, text));
    }
    if !meta.is_file() {
        let text = "expected a regular file, found a device, a pipe or a socket";
        return Err(Error::new(ErrorKind::InvalidInput, text));
    }
    if meta.len() > limit {
        return Err(too_large(meta.len(), limit));
    }
    Ok(meta.len())
}

fn too_large(length: u64, limit: u64) -> Error {
    Error::new(ErrorKind::FileTooLarge, format!("{length} bytes; at most {limit} are read"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[allow(clippy::disallowed_methods)] // A crash of this test leaves nothing of worth.
    #[test]
    fn only_regular_files_within_the_bound() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a");
        std::fs::write(&path, b"12345").expect("written");
        assert_eq!(read_regular(&path, 5).expect("within"), b"12345");
        let kind = |path: &Path, limit| read_regular(path, limit).expect_err("refused").kind();
        assert_eq!(kind(&path, 4), ErrorKind::FileTooLarge);
        assert_eq!(kind(dir.path(), 4), ErrorKind::IsADirectory);
        assert_eq!(kind(&dir.path().join("none"), 4), ErrorKind::NotFound);
        #[cfg(unix)]
        assert_eq!(kind(Path::new("/dev/zero"), 4), ErrorKind::InvalidInput);
        // A terabyte of holes.
        let sparse = dir.path().join("sparse");
        File::create(&sparse).and_then(|f| f.set_len(1 << 40)).expect("made");
        assert_eq!(kind(&sparse, 1 << 30), ErrorKind::FileTooLarge);
    }
}
