//! Invitations: a secret key, the role that it gives, for whom and until when. The owner of a
//! sculpture keeps all of them in a folder, a file each, beside the owner's own key, and gives a
//! person the file of theirs. The folder is the truth: a file that is deleted withdraws its
//! invitation, and the running daemon of the owner signs and sends a new list of members
//! ([`crate::membership`]).

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::membership::{MAX_KEYS, MemberKey, Membership, SignedMembership};
use crate::seal::{KEY, Secret, hex};
use crate::wire::frame::Role;
use crate::wire::keys::PublicKey;

/// Source of random bytes from outside: this crate has none.
pub type Entropy = Box<dyn FnMut(&mut [u8]) + Send>;

/// Content of a file with the extension `.key`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invitation {
    /// The most that it allows.
    pub role: Role,
    /// The only name that it is for.
    pub name: Option<String>,
    /// Seconds since 1970 at which it ends.
    pub expires_s: Option<u64>,
    /// The key.
    pub secret: Secret,
    /// The owner's key, by which the guest knows the host.
    pub owner: PublicKey,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    role: Role,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    expires_s: Option<u64>,
    key: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    owner: Option<String>,
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
        let owner = written.owner.as_deref().and_then(from_hex);
        let owner = owner.ok_or_else(|| {
            let why = "it does not name the owner's key, as it is damaged or of an older version; \
                       ask for a new one";
            key_error(path, why)
        })?;
        let Written { role, name, expires_s, .. } = written;
        Ok(Invitation { role, name, expires_s, secret, owner: PublicKey(owner.0) })
    }

    /// Writes a file that only its owner may read.
    ///
    /// # Errors
    /// [`KeyError::Io`]
    pub fn write(&self, path: &Path) -> Result<(), KeyError> {
        let what = "Whoever holds this file may join. Give it over a channel that you trust.";
        let written = Written {
            role: self.role,
            name: self.name.clone(),
            expires_s: self.expires_s,
            key: self.secret.to_hex(),
            owner: Some(hex(&self.owner.0)),
        };
        write_key(path, what, &written)
    }

    /// As the list of members has it.
    pub fn member_key(&self) -> MemberKey {
        let key = self.secret.public();
        let person = self.name.as_ref().map(|name| MemberKey::code_of(&key, name));
        MemberKey { key, role: self.role, person, expires_s: self.expires_s }
    }

    /// Checks that a person of this name may have this role at this time.
    ///
    /// # Errors
    /// The text gives the reason.
    pub fn allows(&self, name: &str, role: Role, now_s: u64) -> Result<(), String> {
        match &self.name {
            Some(only) if only != name => Err(format!("the key is for '{only}'")),
            _ => self.member_key().allows(name, role, now_s),
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

/// The owner's folder: the owner's key, and an invitation a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnerFolder {
    path: PathBuf,
    owner: Secret,
    /// The invitations, in the order of their files' names.
    pub invitations: Vec<(PathBuf, Invitation)>,
    version: u64,
}

/// The file with the owner's key, and that with the version of the list. They are no invitations.
const OWNER_FILE: &str = "owner.secret";
const VERSION_FILE: &str = "members.version";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenOwner {
    key: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenVersion {
    version: u64,
    digest: String,
}

impl OwnerFolder {
    /// Opens a folder. Where there is none, it is made with the owner's key and one invitation for
    /// each role: `sculptor.key`, `viewer.key`, `device.key`. The second value says whether
    /// invitations were made.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn open(path: &Path, entropy: &mut Entropy) -> Result<(OwnerFolder, bool), KeyError> {
        std::fs::create_dir_all(path).map_err(|source| io(path, source))?;
        let own = path.join(OWNER_FILE);
        let is_new = !own.exists();
        if is_new {
            let what = "Whoever holds this file owns the sculpture. Give it to nobody.";
            write_key(&own, what, &WrittenOwner { key: fresh(entropy).to_hex() })?;
        }
        let (_, owner) = read_key(&own, |w: &WrittenOwner| &w.key)?;
        let public = owner.public();
        let mut made = false;
        if is_new {
            // Files of an older version do not name the owner: the keys in them stay.
            for file in key_files(path)? {
                let (written, secret) = read_key(&file, |w: &Written| &w.key)?;
                let Written { role, name, expires_s, .. } = written;
                let invitation = Invitation { role, name, expires_s, secret, owner: public };
                let beside = file.with_extension("key.new");
                invitation.write(&beside)?;
                std::fs::rename(&beside, &file).map_err(|source| io(&file, source))?;
            }
            if key_files(path)?.is_empty() {
                made = true;
                for role in [Role::Sculptor, Role::Viewer, Role::Device] {
                    let secret = fresh(entropy);
                    let (name, expires_s) = (None, None);
                    let invitation = Invitation { role, name, expires_s, secret, owner: public };
                    invitation.write(&path.join(format!("{}.key", role.name())))?;
                }
            }
        }
        let mut folder =
            OwnerFolder { path: path.into(), owner, invitations: Vec::new(), version: 0 };
        folder.read_invitations()?;
        Ok((folder, made))
    }

    fn read_invitations(&mut self) -> Result<(), KeyError> {
        let files = key_files(&self.path)?;
        let read = |file: PathBuf| Invitation::read(&file).map(|invitation| (file, invitation));
        self.invitations = files.into_iter().map(read).collect::<Result<_, _>>()?;
        if let Some((file, _)) =
            self.invitations.iter().find(|(_, i)| i.owner != self.owner.public())
        {
            return Err(key_error(file, "it is for the sculpture of another owner"));
        }
        if self.invitations.len() > MAX_KEYS {
            let why = format!("at most {MAX_KEYS} invitations, and here are more");
            return Err(key_error(&self.path, why));
        }
        self.version = self.next_version()?;
        Ok(())
    }

    /// The version of the list: one more than the last one, if the invitations have changed.
    fn next_version(&self) -> Result<u64, KeyError> {
        let path = self.path.join(VERSION_FILE);
        let unsigned = self.list(0).signed(&self.owner).to_bytes();
        let digest = hex(ring::digest::digest(&ring::digest::SHA256, &unsigned).as_ref());
        let old = match std::fs::read_to_string(&path) {
            Ok(text) => {
                let read: WrittenVersion =
                    toml::from_str(&text).map_err(|e| key_error(&path, e.message()))?;
                Some(read)
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => None,
            Err(source) => return Err(io(&path, source)),
        };
        if let Some(old) = old.as_ref().filter(|old| old.digest == digest) {
            return Ok(old.version);
        }
        let version = old.map_or(1, |old| old.version + 1);
        let text = toml::to_string(&WrittenVersion { version, digest }).unwrap_or_default();
        let written =
            sculptd_geometry::io::write_beside(&path, |out| out.write_all(text.as_bytes()));
        written.map_err(|e| key_error(&path, e.to_string()))?;
        Ok(version)
    }

    fn list(&self, version: u64) -> Membership {
        let keys = self.invitations.iter().map(|(_, i)| i.member_key()).collect();
        Membership { owner: self.owner.public(), version, keys }
    }

    /// The list of members, signed.
    pub fn membership(&self) -> SignedMembership {
        self.list(self.version).signed(&self.owner)
    }

    /// Reads the folder again: the new list, where invitations came, went or changed.
    ///
    /// # Errors
    /// [`KeyError`]: the list stays as it was.
    pub fn look_again(&mut self) -> Result<Option<SignedMembership>, KeyError> {
        let mut read = OwnerFolder { invitations: Vec::new(), ..self.clone() };
        read.read_invitations()?;
        let changed = read.version != self.version;
        *self = read;
        Ok(changed.then(|| self.membership()))
    }

    /// The key with which the owner takes part.
    pub fn of_owner(&self) -> Invitation {
        let (owner, secret) = (self.owner.public(), self.owner.clone());
        Invitation { role: Role::Sculptor, name: None, expires_s: None, secret, owner }
    }

    /// Adds an invitation as a file that is named after its role and person.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn add(
        &mut self,
        role: Role,
        name: Option<String>,
        expires_s: Option<u64>,
        entropy: &mut Entropy,
    ) -> Result<Invitation, KeyError> {
        // Whatever the person's name is, the file's is one.
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let stem = match &name {
            Some(name) => {
                format!("{}-{}", role.name(), name.chars().map(plain).collect::<String>())
            }
            None => role.name().into(),
        };
        let free = (0..MAX_KEYS).map(|k| match k {
            0 => self.path.join(format!("{stem}.key")),
            k => self.path.join(format!("{stem}-{k}.key")),
        });
        let path = free.into_iter().find(|p| !p.exists());
        let path = path.ok_or_else(|| key_error(&self.path, "it has too many invitations"))?;
        let (secret, owner) = (fresh(entropy), self.owner.public());
        let invitation = Invitation { role, name, expires_s, secret, owner };
        invitation.write(&path)?;
        self.read_invitations()?;
        Ok(invitation)
    }
}

fn key_files(folder: &Path) -> Result<Vec<PathBuf>, KeyError> {
    let entries = std::fs::read_dir(folder).map_err(|source| io(folder, source))?;
    let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "key"));
    paths.sort();
    Ok(paths)
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
    fn a_folder_is_filled_once_and_each_change_of_it_is_a_new_list() {
        let folder = tempfile::tempdir().expect("a folder");
        let entropy = &mut counting();
        let (mut own, made) = OwnerFolder::open(folder.path(), entropy).expect("made");
        assert!(made && own.invitations.len() == 3);
        let first = own.membership();
        assert_eq!((first.list().version, first.list().keys.len()), (1, 3));
        let (again, made) = OwnerFolder::open(folder.path(), entropy).expect("read");
        assert_eq!((&again, made), (&own, false));
        assert_eq!(own.look_again().expect("read"), None, "nothing has changed");
        let bob = own.add(Role::Sculptor, Some("Bob".into()), Some(9), entropy).expect("added");
        let list = own.membership();
        assert_eq!((list.list().version, list.list().keys.len()), (2, 4));
        let found = list.list().find(&bob.secret.public().name()).expect("in the list");
        assert_eq!(found, bob.member_key());
        std::fs::remove_file(folder.path().join("sculptor-Bob.key")).expect("deleted");
        let list = own.look_again().expect("read").expect("another list");
        assert_eq!((list.list().version, list.list().find(&bob.secret.public().name())), (3, None));
        #[cfg(unix)]
        for file in ["viewer.key", "owner.secret"] {
            use std::os::unix::fs::PermissionsExt;
            let mode = folder.path().join(file).metadata().expect("there").permissions().mode();
            assert_eq!(mode & 0o077, 0, "others cannot read {file}");
        }
        std::fs::write(folder.path().join("bad.key"), "role = \"viewer\"\nkey = \"12\"\n")
            .expect("written");
        let e = own.look_again().expect_err("too short");
        assert!(e.to_string().contains("64 hexadecimal digits"), "{e}");
        assert_eq!(own.invitations.len(), 3, "the list stays");
    }

    #[test]
    #[allow(clippy::disallowed_methods)] // A file of an older version is what is wanted.
    fn a_folder_of_an_older_version_keeps_its_keys_and_gets_an_owner() {
        let folder = tempfile::tempdir().expect("a folder");
        let key = "ab".repeat(KEY);
        let old = format!("role = \"sculptor\"\nname = \"Bob\"\nkey = \"{key}\"\n");
        std::fs::write(folder.path().join("b.key"), old).expect("written");
        let e = Invitation::read(&folder.path().join("b.key")).expect_err("it names no owner");
        assert!(e.to_string().contains("ask for a new one"), "{e}");
        let (own, made) = OwnerFolder::open(folder.path(), &mut counting()).expect("read");
        assert!(!made && own.invitations.len() == 1);
        let (_, bob) = &own.invitations[0];
        assert_eq!((bob.secret.to_hex(), bob.name.as_deref()), (key, Some("Bob")));
        assert_eq!(bob.owner, own.of_owner().secret.public());
    }
}
