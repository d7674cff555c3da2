//! Invitations: a key, the role that it gives, and the name that it is for, if for one only. The
//! host keeps all of them in a folder, a file each, and gives a person the file of theirs.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::seal::{KEY, Secret};
use crate::wire::frame::Role;

/// Source of random bytes from outside: this crate has none.
pub type Entropy = Box<dyn FnMut(&mut [u8]) + Send>;

/// Content of a file with the extension `.key`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invitation {
    /// The most that it allows.
    pub role: Role,
    /// The only name that it is for.
    pub name: Option<String>,
    /// The key.
    pub secret: Secret,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    role: Role,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    key: String,
}

/// Why keys cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// It is no invitation.
    #[error("{path}: not an invitation: {why}")]
    Bad {
        /// The file.
        path: String,
        /// The expected content.
        why: String,
    },
}

impl Invitation {
    /// Reads a file.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn read(path: &Path) -> Result<Invitation, KeyError> {
        let (written, secret) = read_key(path, |w: &Written| &w.key)?;
        Ok(Invitation { role: written.role, name: written.name, secret })
    }

    /// Writes a file that only its owner may read.
    ///
    /// # Errors
    /// [`KeyError::Io`]
    pub fn write(&self, path: &Path) -> Result<(), KeyError> {
        let (name, key) = (self.name.clone(), self.secret.to_hex());
        let what = "Whoever holds this file may join. Give it over a channel that you trust.";
        write_key(path, what, &Written { role: self.role, name, key })
    }

    /// Checks that a person of this name may have this role.
    ///
    /// # Errors
    /// The text gives the reason.
    pub fn allows(&self, name: &str, role: Role) -> Result<(), String> {
        if self.role != Role::Sculptor && self.role != role {
            return Err(format!(
                "the key is for a {}, and a {} was asked for",
                self.role.name(),
                role.name()
            ));
        }
        match &self.name {
            Some(only) if only != name => Err(format!("the key is for '{only}'")),
            _ => Ok(()),
        }
    }
}

fn io(path: &Path, source: std::io::Error) -> KeyError {
    KeyError::Io { path: path.display().to_string(), source }
}

/// Why a file is no key.
pub(crate) fn key_error(path: &Path, why: impl Into<String>) -> KeyError {
    KeyError::Bad { path: path.display().to_string(), why: why.into() }
}

/// Reads a key's file: what it says, and the key in it.
pub(crate) fn read_key<T: serde::de::DeserializeOwned>(
    path: &Path,
    key: impl Fn(&T) -> &str,
) -> Result<(T, Secret), KeyError> {
    let text = std::fs::read_to_string(path).map_err(|source| io(path, source))?;
    let written: T = toml::from_str(&text).map_err(|e| key_error(path, e.message()))?;
    let secret = from_hex(key(&written));
    let what = || key_error(path, format!("a key is {} hexadecimal digits", KEY * 2));
    Ok((written, secret.ok_or_else(what)?))
}

/// Writes a key's file, which only its owner may read; one that is there stays. `what` says in its
/// first line what it is.
pub(crate) fn write_key<T: Serialize>(path: &Path, what: &str, key: &T) -> Result<(), KeyError> {
    let text = toml::to_string(key).unwrap_or_default();
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(path).map_err(|source| io(path, source))?;
    std::io::Write::write_all(&mut file, format!("# {what}\n{text}").as_bytes())
        .map_err(|source| io(path, source))
}

/// A key from its hexadecimal digits.
pub(crate) fn from_hex(text: &str) -> Option<Secret> {
    let text = text.as_bytes();
    let mut secret = [0; KEY];
    if text.len() != KEY * 2 {
        return None;
    }
    for (byte, pair) in secret.iter_mut().zip(text.chunks_exact(2)) {
        let digit = |c: u8| (c as char).to_digit(16);
        *byte = (digit(pair[0])? * 16 + digit(pair[1])?) as u8;
    }
    Some(Secret(secret))
}

/// All invitations of a sculpture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Keyring(pub Vec<Invitation>);

/// An invitation as a successor is given it.
#[derive(Serialize, Deserialize)]
struct Carried(Role, Option<String>, [u8; KEY]);

impl Keyring {
    /// The invitations of a folder. Where it holds none, one for each role is made there:
    /// `sculptor.key`, `viewer.key`, `device.key`. The second value says whether that was done.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn of_folder(folder: &Path, entropy: &mut Entropy) -> Result<(Keyring, bool), KeyError> {
        std::fs::create_dir_all(folder).map_err(|source| io(folder, source))?;
        let entries = std::fs::read_dir(folder).map_err(|source| io(folder, source))?;
        let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
        paths.retain(|p| p.extension().is_some_and(|e| e == "key"));
        paths.sort();
        if !paths.is_empty() {
            let all: Result<Vec<_>, _> = paths.iter().map(|p| Invitation::read(p)).collect();
            return Ok((Keyring(all?), false));
        }
        let mut keyring = Keyring::default();
        for role in [Role::Sculptor, Role::Viewer, Role::Device] {
            let invitation = Invitation { role, name: None, secret: fresh(entropy) };
            invitation.write(&folder.join(format!("{}.key", role.name())))?;
            keyring.0.push(invitation);
        }
        Ok((keyring, true))
    }

    /// The invitation whose key has this name.
    pub fn find(&self, name: &[u8; 8]) -> Option<&Invitation> {
        self.0.iter().find(|i| i.secret.name() == *name)
    }

    /// Returns the invitation with which the host takes part itself: a sculptor's that is for
    /// nobody by name. One that is for another person would give the host that person's identity.
    pub fn of_host(&self) -> Option<&Invitation> {
        self.0.iter().find(|i| i.role == Role::Sculptor && i.name.is_none())
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let carried = |i: &Invitation| Carried(i.role, i.name.clone(), i.secret.0);
        let all: Vec<_> = self.0.iter().map(carried).collect();
        postcard::to_stdvec(&all).unwrap_or_default()
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Keyring {
        let all: Vec<Carried> = postcard::from_bytes(bytes).unwrap_or_default();
        let read = |c: Carried| Invitation { role: c.0, name: c.1, secret: Secret(c.2) };
        Keyring(all.into_iter().map(read).collect())
    }
}

/// A new key.
pub fn fresh(entropy: &mut Entropy) -> Secret {
    let mut key = [0; KEY];
    entropy(&mut key);
    Secret(key)
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
    #[allow(clippy::disallowed_methods)] // A broken file is what is wanted.
    fn a_folder_is_filled_once_and_read_afterwards() {
        let folder = tempfile::tempdir().expect("a folder");
        let (made, new) = Keyring::of_folder(folder.path(), &mut counting()).expect("made");
        assert!(new && made.0.len() == 3);
        let (read, new) = Keyring::of_folder(folder.path(), &mut counting()).expect("read");
        assert!(!new);
        for invitation in &made.0 {
            assert_eq!(read.find(&invitation.secret.name()), Some(invitation));
        }
        assert_eq!(Keyring::from_bytes(&read.to_bytes()), read);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let file = folder.path().join("viewer.key");
            let mode = file.metadata().expect("there").permissions().mode();
            assert_eq!(mode & 0o077, 0, "others cannot read a key");
        }
        std::fs::write(folder.path().join("bad.key"), "role = \"viewer\"\nkey = \"12\"\n")
            .expect("written");
        let e = Keyring::of_folder(folder.path(), &mut counting()).expect_err("too short");
        assert!(e.to_string().contains("64 hexadecimal digits"), "{e}");
    }

    #[test]
    fn the_host_never_takes_an_invitation_that_names_a_person() {
        let of = |role, name: Option<&str>, key| Invitation {
            role,
            name: name.map(String::from),
            secret: Secret([key; KEY]),
        };
        let named = of(Role::Sculptor, Some("Bob"), 1);
        let viewer = of(Role::Viewer, None, 2);
        let anyone = of(Role::Sculptor, None, 3);
        assert_eq!(Keyring(vec![named.clone(), viewer.clone()]).of_host(), None);
        let keyring = Keyring(vec![named, viewer, anyone.clone()]);
        assert_eq!(keyring.of_host(), Some(&anyone));
    }

    #[test]
    fn a_key_gives_its_role_and_less_but_never_more() {
        let of = |role, name: Option<&str>| Invitation {
            role,
            name: name.map(String::from),
            secret: Secret([1; KEY]),
        };
        let sculptor = of(Role::Sculptor, None);
        for role in [Role::Sculptor, Role::Viewer, Role::Device] {
            assert_eq!(sculptor.allows("Ada", role), Ok(()));
            assert_eq!(of(Role::Viewer, None).allows("Ada", role).is_ok(), role == Role::Viewer);
            assert_eq!(of(Role::Device, None).allows("Ada", role).is_ok(), role == Role::Device);
        }
        assert!(of(Role::Sculptor, Some("Bob")).allows("Ada", Role::Sculptor).is_err());
    }
}
