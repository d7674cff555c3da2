//! Access rights in a fleet. Staff hold one key; each installation holds one that is derived from
//! it for its name alone, so that a stolen computer gives access to no other installation.
//!
//! A published state carries a tag (HMAC-SHA-256, RFC 2104); requests and answers are sealed
//! (ChaCha20-Poly1305) under keys that the sender draws for each message's stream.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::keyring::{Entropy, KeyError, fresh, key_error, read_key, write_key};
use crate::seal::{KEY, Seal, Secret};

/// Bytes of the tag of a state.
pub const TAG: usize = KEY;
/// Bytes that name a sender's stream of sealed messages.
const STREAM: usize = 16;

/// A key of a fleet, as a file with the ending `.key` holds it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FleetKey {
    /// Lists, and asks all installations for anything.
    Staff(Secret),
    /// Publishes as one installation, and takes its requests.
    Installation {
        /// The installation's name.
        name: String,
        /// Made of the staff's.
        secret: Secret,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum KeyRole {
    Staff,
    Installation,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenKey {
    role: KeyRole,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    key: String,
}

impl FleetKey {
    /// A new key for staff.
    pub fn staff(entropy: &mut Entropy) -> FleetKey {
        FleetKey::Staff(fresh(entropy))
    }

    /// The key of an installation, made of the staff's; `None`: this is not the staff's.
    pub fn for_installation(&self, name: &str) -> Option<FleetKey> {
        let FleetKey::Staff(_) = self else { return None };
        Some(FleetKey::Installation { name: name.into(), secret: self.secret_of(name)? })
    }

    /// The secret that is shared with an installation; `None`: with this one there is none.
    pub fn secret_of(&self, installation: &str) -> Option<Secret> {
        match self {
            FleetKey::Staff(secret) => {
                let parts: [&[u8]; 1] = [installation.as_bytes()];
                Some(secret.derived("sculptd fleet installation 1", &parts))
            }
            FleetKey::Installation { name, secret } => {
                (name == installation).then(|| secret.clone())
            }
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn read(path: &Path) -> Result<FleetKey, KeyError> {
        let (written, secret) = read_key(path, |w: &WrittenKey| &w.key)?;
        match (written.role, written.name) {
            (KeyRole::Staff, None) => Ok(FleetKey::Staff(secret)),
            (KeyRole::Installation, Some(name)) => Ok(FleetKey::Installation { name, secret }),
            (KeyRole::Staff, Some(_)) => Err(key_error(path, "the key of staff has no name")),
            (KeyRole::Installation, None) => {
                Err(key_error(path, "the key of an installation needs its name"))
            }
        }
    }

    /// Writes a file that only its owner may read; one that is there stays.
    ///
    /// # Errors
    /// [`KeyError::Io`]
    pub fn write(&self, path: &Path) -> Result<(), KeyError> {
        let written = |secret: &Secret| match self {
            FleetKey::Staff(_) => {
                WrittenKey { role: KeyRole::Staff, name: None, key: secret.to_hex() }
            }
            FleetKey::Installation { name, .. } => {
                let name = Some(name.clone());
                WrittenKey { role: KeyRole::Installation, name, key: secret.to_hex() }
            }
        };
        let what = match self {
            FleetKey::Staff(_) => {
                "Whoever holds this file may ask every installation for anything."
            }
            FleetKey::Installation { .. } => {
                "Whoever holds this file can pose as this installation."
            }
        };
        match self {
            FleetKey::Staff(secret) | FleetKey::Installation { secret, .. } => {
                write_key(path, what, &written(secret))
            }
        }
    }
}

/// The tag of a published state.
pub fn state_tag(secret: &Secret, json: &[u8]) -> [u8; TAG] {
    secret.derived("sculptd fleet state 1", &[json]).0
}

/// Returns true if a tag belongs to a state, in constant time.
pub fn is_tagged(secret: &Secret, json: &[u8], tag: &[u8]) -> bool {
    let expected = state_tag(secret, json);
    let differs = expected.iter().zip(tag).fold(0, |d, (a, b)| d | (a ^ b));
    tag.len() == TAG && differs == 0
}

/// Direction of a sealed message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FleetWay {
    /// From staff to an installation.
    Request,
    /// Back.
    Answer,
}

impl FleetWay {
    fn purpose(self) -> &'static str {
        match self {
            FleetWay::Request => "sculptd fleet request 1",
            FleetWay::Answer => "sculptd fleet answer 1",
        }
    }
}

/// Seals messages under a key that was drawn for this sender, so that no two share a nonce.
#[derive(Debug)]
pub struct FleetSeal {
    stream: [u8; STREAM],
    seal: Seal,
}

impl FleetSeal {
    /// Creates a seal with a new random stream.
    pub fn new(secret: &Secret, way: FleetWay, entropy: &mut Entropy) -> FleetSeal {
        let mut stream = [0; STREAM];
        entropy(&mut stream);
        FleetSeal { stream, seal: stream_seal(secret, way, &stream) }
    }

    /// The message, sealed: the stream, then what [`Seal::seal`] gives.
    pub fn seal(&mut self, plain: &[u8]) -> Vec<u8> {
        let mut bytes = self.stream.to_vec();
        bytes.extend(self.seal.seal(plain));
        bytes
    }
}

/// The message again; `None`: another key sealed it, or it was changed.
pub fn open_sealed(secret: &Secret, way: FleetWay, bytes: &[u8]) -> Option<Vec<u8>> {
    let (stream, sealed) = bytes.split_first_chunk::<STREAM>()?;
    stream_seal(secret, way, stream).open(sealed)
}

fn stream_seal(secret: &Secret, way: FleetWay, stream: &[u8; STREAM]) -> Seal {
    Seal::new(&secret.derived(way.purpose(), &[stream]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counting() -> Entropy {
        let mut next = 0u8;
        Box::new(move |bytes| {
            bytes.iter_mut().for_each(|b| {
                next = next.wrapping_add(1);
                *b = next;
            });
        })
    }

    #[test]
    fn keys_are_read_as_they_were_written_and_one_installation_opens_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let staff = FleetKey::staff(&mut counting());
        let hall = staff.for_installation("hall").expect("made of the staff's");
        for (key, name) in [(&staff, "staff.key"), (&hall, "hall.key")] {
            let path = folder.path().join(name);
            key.write(&path).expect("written");
            assert_eq!(FleetKey::read(&path).as_ref().ok(), Some(key));
            assert!(key.write(&path).is_err(), "a key is never written over");
        }
        assert_eq!(hall.secret_of("hall"), staff.secret_of("hall"));
        assert_eq!(hall.secret_of("foyer"), None);
        assert_eq!(hall.for_installation("foyer"), None);
        assert_ne!(staff.secret_of("foyer"), staff.secret_of("hall"));
    }

    #[test]
    fn a_state_of_another_or_a_changed_one_is_not_believed() {
        let staff = FleetKey::staff(&mut counting());
        let secret = |name| staff.secret_of(name).expect("one for each");
        let tag = state_tag(&secret("hall"), b"{}");
        assert!(is_tagged(&secret("hall"), b"{}", &tag));
        assert!(!is_tagged(&secret("foyer"), b"{}", &tag));
        assert!(!is_tagged(&secret("hall"), b"{ }", &tag));
        assert!(!is_tagged(&secret("hall"), b"{}", &tag[..31]));
        assert!(!is_tagged(&secret("hall"), b"{}", &[]));
    }

    #[test]
    fn a_request_is_no_answer_and_every_changed_byte_is_noticed() {
        let secret = FleetKey::staff(&mut counting()).secret_of("hall").expect("one");
        let mut seal = FleetSeal::new(&secret, FleetWay::Request, &mut counting());
        let sealed = seal.seal(b"restart");
        let open = |bytes: &[u8]| open_sealed(&secret, FleetWay::Request, bytes);
        assert_eq!(open(&sealed).as_deref(), Some(&b"restart"[..]));
        assert_eq!(open_sealed(&secret, FleetWay::Answer, &sealed), None);
        for at in 0..sealed.len() {
            let mut changed = sealed.clone();
            changed[at] ^= 1;
            assert_eq!(open(&changed), None, "byte {at}");
            assert_eq!(open(&sealed[..at]), None, "cut at {at}");
        }
    }
}
