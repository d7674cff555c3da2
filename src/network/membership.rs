//! Who may take part in a sculpture: a list of public keys, signed by the owner.
//!
//! An invitation is the secret half of a key; the list holds the public half, the role that it
//! gives, for whom it is, and until when. Every host has the list, and nobody has the secrets of
//! others: who is removed from the list keeps nothing that lets anybody in. The owner signs each
//! list; of two lists the one of the higher version is valid.

use ring::digest::{SHA256, digest};
use ring::signature::{ED25519, Ed25519KeyPair, KeyPair, UnparsedPublicKey};

use crate::seal::{KEY, Secret};
use crate::wire::bytes::{BadBytes, ByteReader, put_bytes, put_number};
use crate::wire::frame::Role;
use crate::wire::keys::{MAX_MEMBERSHIP, PublicKey, SIGNATURE, Signature};

/// Keys of one list.
pub const MAX_KEYS: usize = 1024;
fn signed(what: &str, bytes: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(what.len() + 1 + bytes.len());
    message.extend(what.as_bytes());
    message.push(0);
    message.extend(bytes);
    message
}

impl PublicKey {
    /// A short name for the key.
    pub fn name(&self) -> [u8; 8] {
        let mut name = [0; 8];
        name.copy_from_slice(
            &digest(&SHA256, &signed("sculptd key name 2", &self.0)).as_ref()[..8],
        );
        name
    }

    /// Returns true if the holder of the key signed these bytes for this purpose.
    pub fn has_signed(&self, what: &str, bytes: &[u8], signature: &Signature) -> bool {
        let key = UnparsedPublicKey::new(&ED25519, self.0);
        key.verify(&signed(what, bytes), signature).is_ok()
    }
}

impl Secret {
    fn pair(&self) -> Ed25519KeyPair {
        // Every 32 bytes are a seed.
        Ed25519KeyPair::from_seed_unchecked(&self.0)
            .unwrap_or_else(|_| unreachable!("the length is right"))
    }

    /// The public half.
    pub fn public(&self) -> PublicKey {
        let mut key = [0; KEY];
        key.copy_from_slice(self.pair().public_key().as_ref());
        PublicKey(key)
    }

    /// Signs bytes for a purpose.
    pub fn sign(&self, what: &str, bytes: &[u8]) -> Signature {
        let mut signature = [0; SIGNATURE];
        signature.copy_from_slice(self.pair().sign(&signed(what, bytes)).as_ref());
        signature
    }
}

/// One key of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemberKey {
    /// The key.
    pub key: PublicKey,
    /// The most that it allows.
    pub role: Role,
    /// A code of the only name that it is for; see [`MemberKey::code_of`].
    pub person: Option<[u8; 16]>,
    /// Seconds since 1970 at which it ends.
    pub expires_s: Option<u64>,
}

impl MemberKey {
    /// The list goes in the clear: a name is in it only as a code under the key.
    pub fn code_of(key: &PublicKey, name: &str) -> [u8; 16] {
        let mut code = [0; 16];
        let text = [&key.0[..], name.as_bytes()].concat();
        code.copy_from_slice(&digest(&SHA256, &signed("sculptd person 1", &text)).as_ref()[..16]);
        code
    }

    /// Checks that a person of this name may have this role at this time.
    ///
    /// # Errors
    /// The text gives the reason.
    pub fn allows(&self, name: &str, role: Role, now_s: u64) -> Result<(), String> {
        if self.expires_s.is_some_and(|end| now_s >= end) {
            return Err("the invitation has expired: ask for a new one".into());
        }
        if self.role != Role::Sculptor && self.role != role {
            let (key, asked) = (self.role.name(), role.name());
            return Err(format!("the key is for a {key}, and a {asked} was asked for"));
        }
        match self.person {
            Some(code) if code != MemberKey::code_of(&self.key, name) => {
                Err(format!("the key is for another person than '{name}'"))
            }
            _ => Ok(()),
        }
    }
}

/// The list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Membership {
    /// The key of the owner, who signs the list, and may sculpt and host.
    pub owner: PublicKey,
    /// Counts the lists of this owner.
    pub version: u64,
    /// All keys but the owner's.
    pub keys: Vec<MemberKey>,
}

impl Membership {
    /// What the key of this name allows.
    pub fn find(&self, name: &[u8; 8]) -> Option<MemberKey> {
        let owner =
            MemberKey { key: self.owner, role: Role::Sculptor, person: None, expires_s: None };
        let mut all = std::iter::once(&owner).chain(&self.keys);
        all.find(|a| a.key.name() == *name).cloned()
    }

    /// Returns true if the key may host at this time: a sculptor's.
    pub fn may_host(&self, key: &PublicKey, now_s: u64) -> bool {
        let found = self.find(&key.name()).filter(|a| a.key == *key && a.role == Role::Sculptor);
        found.is_some_and(|a| a.expires_s.is_none_or(|end| now_s < end))
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut out = self.owner.0.to_vec();
        put_number(&mut out, self.version);
        put_number(&mut out, self.keys.len() as u64);
        for a in &self.keys {
            out.extend(a.key.0);
            out.extend([a.role.code(), u8::from(a.person.is_some())]);
            out.extend(a.person.iter().flatten());
            put_number(&mut out, a.expires_s.map_or(0, |s| s.max(1)));
        }
        out
    }

    fn from_bytes(bytes: &[u8]) -> Result<Membership, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let (owner, version) = (PublicKey(b.array()?), b.number()?);
        let mut keys = Vec::new();
        for _ in 0..b.count(MAX_KEYS)? {
            let (key, role) = (PublicKey(b.array()?), Role::of_code(b.byte()?)?);
            let person = match b.byte()? {
                0 => None,
                _ => Some(b.array()?),
            };
            let expires_s = Some(b.number()?).filter(|s| *s > 0);
            keys.push(MemberKey { key, role, person, expires_s });
        }
        b.end()?;
        Ok(Membership { owner, version, keys })
    }

    /// The list, signed by its owner.
    pub fn signed(self, owner: &Secret) -> SignedMembership {
        let signature = owner.sign(PURPOSE, &self.to_bytes());
        SignedMembership { list: self, signature }
    }
}

const PURPOSE: &str = "sculptd members 1";

/// A list whose signature was checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignedMembership {
    list: Membership,
    signature: Signature,
}

impl SignedMembership {
    /// The list.
    pub fn list(&self) -> &Membership {
        &self.list
    }

    /// As it is sent.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put_bytes(&mut out, &self.list.to_bytes());
        out.extend(self.signature);
        out
    }

    /// Reads a list, and checks that this owner signed it.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes are no list, or not this owner's.
    pub fn from_bytes(bytes: &[u8], owner: &PublicKey) -> Result<SignedMembership, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let list = b.bytes(MAX_MEMBERSHIP)?;
        let signature = b.array()?;
        b.end()?;
        let is_theirs = owner.has_signed(PURPOSE, list, &signature);
        let list = Membership::from_bytes(list)?;
        match is_theirs && list.owner == *owner {
            true => Ok(SignedMembership { list, signature }),
            false => Err(BadBytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list() -> (Secret, Membership) {
        let (owner, guest) = (Secret([1; KEY]), Secret([2; KEY]).public());
        let person = Some(MemberKey::code_of(&guest, "Bob"));
        let member_key = MemberKey { key: guest, role: Role::Viewer, person, expires_s: Some(100) };
        let plain = MemberKey {
            key: Secret([3; KEY]).public(),
            role: Role::Sculptor,
            person: None,
            expires_s: None,
        };
        let list = Membership { owner: owner.public(), version: 7, keys: vec![member_key, plain] };
        (owner, list)
    }

    #[test]
    fn a_list_is_valid_only_as_its_owner_signed_it() {
        let (owner, list) = list();
        let signed = list.clone().signed(&owner);
        let bytes = signed.to_bytes();
        let public = owner.public();
        assert_eq!(SignedMembership::from_bytes(&bytes, &public), Ok(signed));
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1;
            assert!(SignedMembership::from_bytes(&changed, &public).is_err(), "byte {at}");
            assert!(SignedMembership::from_bytes(&bytes[..at], &public).is_err(), "cut at {at}");
        }
        let other = Secret([9; KEY]);
        assert!(SignedMembership::from_bytes(&bytes, &other.public()).is_err());
        // Signed by another who calls himself the owner, and by another for the owner.
        let posing = list.signed(&other).to_bytes();
        assert!(SignedMembership::from_bytes(&posing, &public).is_err());
        assert!(SignedMembership::from_bytes(&posing, &other.public()).is_err());
    }

    #[test]
    fn a_key_gives_its_role_and_less_to_its_person_and_in_its_time() {
        let (owner, list) = list();
        let of = |key: u8| list.find(&Secret([key; KEY]).public().name());
        let viewer = of(2).expect("in the list");
        assert_eq!(viewer.allows("Bob", Role::Viewer, 99), Ok(()));
        assert!(viewer.allows("Bob", Role::Viewer, 100).is_err_and(|e| e.contains("expired")));
        assert!(viewer.allows("Bob", Role::Sculptor, 0).is_err_and(|e| e.contains("for a viewer")));
        assert!(viewer.allows("Eve", Role::Viewer, 0).is_err_and(|e| e.contains("another person")));
        let sculptor = of(3).expect("in the list");
        for role in [Role::Sculptor, Role::Viewer, Role::Device] {
            assert_eq!(sculptor.allows("Ada", role, u64::MAX), Ok(()));
        }
        assert_eq!(of(9), None);
        let hosts = |key: &Secret| list.may_host(&key.public(), 0);
        assert!(hosts(&owner) && hosts(&Secret([3; KEY])));
        assert!(!hosts(&Secret([2; KEY])) && !hosts(&Secret([9; KEY])));
        let bytes = list.clone().signed(&owner).to_bytes();
        assert!(!bytes.windows(3).any(|w| w == b"Bob"), "names do not go in the clear");
    }
}
