//! The bytes of a glTF file's buffers: the binary chunk, base64 inside the JSON, or a file beside
//! it.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use gltf_json::Root;

use super::bad;
use super::meshopt::is_fallback;
use crate::io::problem::{FilePlace, ParseError, excerpt};
use crate::io::{MAX_FILE, read_regular};
use crate::job::Job;

/// Returns the bytes of every buffer, at least as many as the file states.
pub(super) fn read<'a>(
    root: &Root,
    binary: Option<&'a [u8]>,
    name: &Path,
    job: &Job,
) -> Result<Vec<Cow<'a, [u8]>>, ParseError> {
    let mut all = Vec::new();
    for (n, buffer) in root.buffers.iter().enumerate() {
        job.check()?;
        if buffer.uri.is_none() && is_fallback(buffer) {
            all.push(Cow::Borrowed(&[][..]));
            continue;
        }
        let bytes = match &buffer.uri {
            None if n == 0 => binary
                .map(Cow::Borrowed)
                .ok_or_else(|| bad(FilePlace::File, "a binary chunk for buffer 0", "none"))?,
            None => return Err(bad(FilePlace::File, format!("a uri of buffer {n}"), "none")),
            Some(uri) => Cow::Owned(fetch(uri, name, n)?),
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let found = format!("{} bytes", bytes.len());
            return Err(bad(
                FilePlace::File,
                format!("{} bytes in buffer {n}", buffer.byte_length.0),
                found,
            ));
        }
        all.push(bytes);
    }
    Ok(all)
}

/// A buffer's bytes, inside the JSON or in a file in the same folder or below it, and nowhere else.
fn fetch(uri: &str, name: &Path, n: usize) -> Result<Vec<u8>, ParseError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let body = data.split_once(";base64,").map(|(_, b)| b);
        return body.and_then(base64).ok_or_else(|| {
            bad(FilePlace::File, format!("base64 data in buffer {n}"), excerpt(uri.as_bytes()))
        });
    }
    let refused = |why: &str| {
        bad(
            FilePlace::File,
            format!("the name of a file beside this one as buffer {n}"),
            format!("\"{uri}\" ({why})"),
        )
    };
    let relative = PathBuf::from(percent(uri).ok_or_else(|| refused("no valid name"))?);
    if uri.contains("://")
        || !relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
    {
        return Err(refused("it leads elsewhere"));
    }
    let folder = match name.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let told = |e: std::io::Error| refused(&e.to_string());
    let path = folder.join(&relative).canonicalize().map_err(told)?;
    if !path.starts_with(folder.canonicalize().map_err(told)?) {
        return Err(refused("it leads elsewhere"));
    }
    read_regular(&path, MAX_FILE).map_err(told)
}

fn percent(uri: &str) -> Option<String> {
    let mut out = Vec::with_capacity(uri.len());
    let mut bytes = uri.bytes();
    while let Some(b) = bytes.next() {
        if b == b'%' {
            let digits = [bytes.next()?, bytes.next()?];
            out.push(u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?);
        } else {
            out.push(b);
        }
    }
    String::from_utf8(out).ok().filter(|s| !s.contains('\0'))
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut n) = (0u32, 0);
    for b in text.trim_end_matches('=').bytes() {
        let v = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | v as u32;
        n += 6;
        if n >= 8 {
            n -= 8;
            out.push((bits >> n) as u8);
        }
    }
    Some(out)
}
