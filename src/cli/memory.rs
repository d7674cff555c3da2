//! Whether there is room, asked before the work and not found out in its middle.

use super::Fail;

/// Bytes that this machine can still give without swapping, where it tells.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb * 1024)
}

/// An error that names both numbers if `need` bytes are more than there are.
pub fn room_for(need: u64, what: &str) -> Result<(), Fail> {
    let gib = |b: u64| b as f64 / f64::from(1 << 30);
    match available() {
        Some(have) if need > have => Err(Fail::Input(format!(
            "{what} needs about {:.1} GiB of memory, and this machine has {:.1} GiB left: not even \
                tried",
            gib(need),
            gib(have)
        ))),
        _ => Ok(()),
    }
}
