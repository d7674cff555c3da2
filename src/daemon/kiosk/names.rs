//! The names of finished sculptures in a gallery's folder, and which of them were sent.

use std::path::Path;

/// The folder within the gallery of what is noted about sending.
pub(super) const OUTGOING: &str = "outgoing";
/// The file in it that holds the number of the newest work that was sent.
pub(super) const SENT: &str = "sent";
/// Names of whole works in `folder`, in order. What a power cut left half-written has another name
/// and is not among them.
pub fn works(folder: &Path) -> std::io::Result<Vec<String>> {
    let mut names: Vec<String> = std::fs::read_dir(folder)?
        .filter_map(|e| e.ok().and_then(|e| e.file_name().into_string().ok()))
        .filter(|n| number(n).is_some())
        .collect();
    names.sort();
    Ok(names)
}

/// `work-000123.glb` is number 123.
pub(super) fn number(name: &str) -> Option<u64> {
    let digits = name.strip_prefix("work-")?.strip_suffix(".glb")?;
    (digits.len() >= 6 && digits.bytes().all(|b| b.is_ascii_digit()))
        .then(|| digits.parse().ok())?
}

/// The number of the newest work that was ever sent from `folder`; 0: none.
pub fn sent(folder: &Path) -> u64 {
    let text = std::fs::read_to_string(folder.join(OUTGOING).join(SENT)).unwrap_or_default();
    text.trim().parse().unwrap_or(0)
}
