//! Keys by which pages join: each with a role and, if wanted, an expiry.

use std::sync::Mutex;
use std::time::Duration;

use super::locked;
use crate::random_token::random_token;

/// Keys at a time; the oldest that is no longer valid goes first.
const MAX_KEYS: usize = 256;

/// What the holder of a key may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WebRole {
    /// Sees.
    Viewer,
    /// Sees and sculpts, with a view, a brush and an undo of their own.
    Sculptor,
    /// Is a tablet of the person at this machine.
    Device,
}

impl WebRole {
    /// Name of the role in messages.
    pub fn name(self) -> &'static str {
        match self {
            WebRole::Viewer => "viewer",
            WebRole::Sculptor => "sculptor",
            WebRole::Device => "device",
        }
    }
}

/// A key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WebKey {
    /// Name of the key for people, which is no secret.
    pub id: u32,
    pub role: WebRole,
    /// 128 bits that nobody can guess, as hexadecimal digits.
    pub secret: String,
    /// Time on the clock at which it expires; `None`: never.
    pub until_us: Option<u64>,
}

/// Every valid key.
#[derive(Debug, Default)]
pub struct KeyRing(Mutex<Ring>);

#[derive(Debug, Default)]
struct Ring {
    keys: Vec<WebKey>,
    last_id: u32,
}

impl KeyRing {
    /// Makes a key. `lasts`: time until it expires; `None`: never.
    ///
    /// # Errors
    /// Returns the system's error where it gives no random numbers, or an error where too many keys
    /// are valid.
    pub fn issue(
        &self,
        role: WebRole,
        lasts: Option<Duration>,
        now_us: u64,
    ) -> std::io::Result<WebKey> {
        let secret = random_token()?;
        let mut ring = locked(&self.0);
        ring.keys.retain(|k| k.until_us.is_none_or(|until| until > now_us));
        if ring.keys.len() >= MAX_KEYS {
            let text = format!("{MAX_KEYS} keys are valid already: revoke some");
            return Err(std::io::Error::other(text));
        }
        ring.last_id += 1;
        let until_us = lasts.map(|l| now_us.saturating_add(l.as_micros() as u64));
        let key = WebKey { id: ring.last_id, role, secret, until_us };
        ring.keys.push(key.clone());
        Ok(key)
    }

    /// Returns the key with this secret, if it is valid. Takes the same time for every wrong one of
    /// the right length.
    pub fn find(&self, secret: &str, now_us: u64) -> Option<WebKey> {
        let ring = locked(&self.0);
        let equal = |k: &WebKey| {
            let (a, b) = (k.secret.as_bytes(), secret.as_bytes());
            a.len() == b.len() && a.iter().zip(b).fold(0, |all, (x, y)| all | (x ^ y)) == 0
        };
        let mut found = None;
        for key in &ring.keys {
            if equal(key) {
                found = Some(key);
            }
        }
        found.filter(|k| k.until_us.is_none_or(|until| until > now_us)).cloned()
    }

    /// Returns true while the key with this number is valid.
    pub fn is_valid(&self, id: u32, now_us: u64) -> bool {
        let valid = |k: &WebKey| k.id == id && k.until_us.is_none_or(|until| until > now_us);
        locked(&self.0).keys.iter().any(valid)
    }

    /// Revokes a key: its pages are disconnected. Returns false if there is no such key.
    pub fn revoke(&self, id: u32) -> bool {
        let mut ring = locked(&self.0);
        let before = ring.keys.len();
        ring.keys.retain(|k| k.id != id);
        ring.keys.len() < before
    }

    /// Returns the valid keys, the oldest first.
    pub fn all(&self, now_us: u64) -> Vec<WebKey> {
        let valid = |k: &&WebKey| k.until_us.is_none_or(|until| until > now_us);
        locked(&self.0).keys.iter().filter(valid).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_good_until_it_expires_or_is_revoked() {
        let ring = KeyRing::default();
        let minute = Some(Duration::from_secs(60));
        let short = ring.issue(WebRole::Viewer, minute, 0).expect("a key");
        let long = ring.issue(WebRole::Sculptor, None, 0).expect("a key");
        assert_ne!(short.secret, long.secret);
        assert_eq!(short.secret.len(), 32);
        assert_eq!(ring.find(&short.secret, 59_999_999).map(|k| k.role), Some(WebRole::Viewer));
        assert_eq!(ring.find(&short.secret, 60_000_000), None);
        assert!(!ring.is_valid(short.id, 60_000_000));
        for wrong in ["", "0", &long.secret[1..], &format!("{}0", long.secret)] {
            assert_eq!(ring.find(wrong, 0), None, "{wrong}");
        }
        assert!(ring.is_valid(long.id, u64::MAX) && ring.revoke(long.id) && !ring.revoke(long.id));
        assert_eq!(ring.find(&long.secret, 0), None);
    }

    #[test]
    fn keys_are_bounded_and_expired_ones_make_room() {
        let ring = KeyRing::default();
        let second = Some(Duration::from_secs(1));
        for _ in 0..MAX_KEYS {
            ring.issue(WebRole::Viewer, second, 0).expect("room");
        }
        assert!(ring.issue(WebRole::Viewer, None, 0).is_err());
        assert!(ring.issue(WebRole::Viewer, None, 1_000_000).is_ok());
        assert_eq!(ring.all(1_000_000).len(), 1);
    }
}
