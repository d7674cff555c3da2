//! Keys and sealed messages.
//!
//! A greeting of two nonces gives member and host a key for each direction
//! (HMAC-SHA-256, RFC 2104, of both nonces under the invitation's key), and every message after it
//! is sealed by ChaCha20-Poly1305 (RFC 8439): whoever does not hold the invitation can neither read
//! nor write one, and a member cannot write as another. The ciphers are those of `ring`.
//!
//! Not given: secrecy of old messages once an invitation's key becomes known.

use ring::aead::{Aad, CHACHA20_POLY1305, LessSafeKey, Nonce as Once, UnboundKey};
use ring::hmac;

use crate::wire::message::{Nonce, Term};

/// Bytes of a key.
pub const KEY: usize = 32;
/// Bytes that a seal adds: the counter and the tag.
pub const SEAL: usize = 8 + 16;

/// A secret of 256 bits. It is never printed.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(pub [u8; KEY]);

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret(..)")
    }
}

fn code(key: &Secret, what: &str, parts: &[&[u8]]) -> [u8; KEY] {
    let mut context = hmac::Context::with_key(&hmac::Key::new(hmac::HMAC_SHA256, &key.0));
    context.update(what.as_bytes());
    for part in parts {
        context.update(&(part.len() as u64).to_le_bytes());
        context.update(part);
    }
    let mut out = [0; KEY];
    out.copy_from_slice(context.sign().as_ref());
    out
}

impl Secret {
    /// Returns the name of the key, from which the secret cannot be derived.
    pub fn name(&self) -> [u8; 8] {
        let mut name = [0; 8];
        name.copy_from_slice(&code(self, "sculptd key name 1", &[])[..8]);
        name
    }

    /// The host's proof that it holds the key.
    pub fn proof(&self, member: &Nonce, host: &Nonce, term: &Term) -> [u8; KEY] {
        let [number, base] = [u64::from(term.number), term.base].map(u64::to_le_bytes);
        let parts: [&[u8]; 5] = [member, host, &number, &base, &term.host.to_le_bytes()];
        code(self, "sculptd proof 1", &parts)
    }

    /// Returns true if a proof is the host's, in constant time.
    pub fn proves(&self, proof: &[u8; KEY], member: &Nonce, host: &Nonce, term: &Term) -> bool {
        let expected = self.proof(member, host, term);
        expected.iter().zip(proof).fold(0, |d, (a, b)| d | (a ^ b)) == 0
    }

    /// A key that is made of this one for one purpose; nothing leads back from it.
    pub(crate) fn derived(&self, what: &str, parts: &[&[u8]]) -> Secret {
        Secret(code(self, what, parts))
    }

    /// As a key's file holds it.
    pub(crate) fn to_hex(&self) -> String {
        self.0.iter().map(|b| format!("{b:02x}")).collect()
    }

    /// The seals of a greeting: from the member to the host, and back.
    pub fn seals(&self, member: &Nonce, host: &Nonce) -> (Seal, Seal) {
        let seal = |what| Seal::new(&Secret(code(self, what, &[member, host])));
        (seal("sculptd up 1"), seal("sculptd down 1"))
    }

    /// The seal of messages among those who may take over. `stream` is drawn by the one sender that
    /// seals with it, so that no two messages share a nonce.
    pub fn heirs_seal(&self, stream: u64) -> Seal {
        Seal::new(&Secret(code(self, "sculptd heirs 1", &[&stream.to_le_bytes()])))
    }
}

/// Seals messages in one direction, or opens them.
pub struct Seal {
    key: LessSafeKey,
    sealed: u64,
}

impl std::fmt::Debug for Seal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Seal").field("sealed", &self.sealed).finish_non_exhaustive()
    }
}

fn once(counter: u64) -> Once {
    let mut bytes = [0; 12];
    bytes[..8].copy_from_slice(&counter.to_le_bytes());
    Once::assume_unique_for_key(bytes)
}

impl Seal {
    pub(crate) fn new(key: &Secret) -> Seal {
        let key = UnboundKey::new(&CHACHA20_POLY1305, &key.0);
        // A key of 32 bytes is a key of this cipher.
        let key = LessSafeKey::new(key.unwrap_or_else(|_| unreachable!("the length is right")));
        Seal { key, sealed: 0 }
    }

    /// The message, sealed: a counter, the ciphertext, the tag.
    pub fn seal(&mut self, plain: &[u8]) -> Vec<u8> {
        self.sealed += 1;
        let mut out = Vec::with_capacity(plain.len() + SEAL);
        out.extend(self.sealed.to_le_bytes());
        out.extend(plain);
        let tag =
            self.key.seal_in_place_separate_tag(once(self.sealed), Aad::empty(), &mut out[8..]);
        match tag {
            Ok(tag) => out.extend(tag.as_ref()),
            // Only beyond 256 GiB: no message is so large.
            Err(_) => out.clear(),
        }
        out
    }

    /// The message again; `None` where another key sealed it, or it was changed.
    pub fn open(&self, sealed: &[u8]) -> Option<Vec<u8>> {
        let (counter, rest) = sealed.split_first_chunk::<8>()?;
        let mut bytes = rest.to_vec();
        let at = once(u64::from_le_bytes(*counter));
        let length = self.key.open_in_place(at, Aad::empty(), &mut bytes).ok()?.len();
        bytes.truncate(length);
        Some(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_key_opens_and_a_changed_bit_is_noticed() {
        let (key, other) = (Secret([7; KEY]), Secret([8; KEY]));
        let (a, b) = ([1; 16], [2; 16]);
        let (mut up, down) = key.seals(&a, &b);
        let sealed = up.seal(b"a batch");
        let again = up.seal(b"a batch");
        assert_ne!(sealed, again, "a counter is never used twice");
        assert_eq!(key.seals(&a, &b).0.open(&sealed).as_deref(), Some(&b"a batch"[..]));
        assert_eq!(down.open(&sealed), None, "the other direction");
        assert_eq!(other.seals(&a, &b).0.open(&sealed), None, "another key");
        assert_eq!(key.seals(&b, &b).0.open(&sealed), None, "another greeting");
        for bit in 0..sealed.len() * 8 {
            let mut changed = sealed.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(up.open(&changed), None, "bit {bit}");
        }
        let term = Term { number: 1, base: 0, host: 5 };
        let proof = key.proof(&a, &b, &term);
        assert!(key.proves(&proof, &a, &b, &term) && !other.proves(&proof, &a, &b, &term));
        assert!(!format!("{key:?} {up:?}").contains('7'));
    }
}
