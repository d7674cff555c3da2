//! Random numbers of the system, for links that nobody can guess.

/// Returns 128 random bits as hexadecimal digits.
///
/// # Errors
/// Returns the system's error where it gives none.
pub fn random_token() -> std::io::Result<String> {
    let mut bytes = [0u8; 16];
    std::io::Read::read_exact(&mut std::fs::File::open("/dev/urandom")?, &mut bytes)?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}
