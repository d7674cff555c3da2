//! Keys and sealed messages.
//!
//! A greeting and its answer hold a public value each (X25519, RFC 7748), of which member and host
//! make a key for each direction (HMAC-SHA-256, RFC 2104). Both are signed: the member's by the key
//! of the invitation, the host's by a key that may host ([`crate::membership`]). Every message
//! after it is sealed by ChaCha20-Poly1305 (RFC 8439), and opened once: a recorded message is not
//! taken again. A member cannot write as another, and whoever learns an invitation's key later
//! cannot read what was said before. The ciphers are those of `ring`.

use ring::aead::{Aad, CHACHA20_POLY1305, LessSafeKey, Nonce as Once, UnboundKey};
use ring::agreement::{EphemeralPrivateKey, UnparsedPublicKey, X25519, agree_ephemeral};
use ring::hmac;
use ring::rand::SystemRandom;

use crate::wire::keys::PublicValue;

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
    /// A key that is made of this one for one purpose; nothing leads back from it.
    pub(crate) fn derived(&self, what: &str, parts: &[&[u8]]) -> Secret {
        Secret(code(self, what, parts))
    }

    /// As a key's file holds it.
    pub(crate) fn to_hex(&self) -> String {
        hex(&self.0)
    }

    /// The seal of messages among those who may take over. `stream` is drawn by the one sender that
    /// seals with it, so that no two messages share a nonce.
    pub fn heirs_seal(&self, stream: u64) -> Seal {
        Seal::new(&self.derived("sculptd heirs 2", &[&stream.to_le_bytes()]))
    }
}

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// One side of a key agreement, for one use.
#[derive(Debug)]
pub struct Agreement {
    private: EphemeralPrivateKey,
    /// For the other side.
    pub public: PublicValue,
}

impl Agreement {
    /// Draws a value, from the operating system's random bytes: the cipher takes no others.
    ///
    /// # Panics
    /// If the operating system has none: no key may be made then.
    pub fn draw() -> Agreement {
        let private = EphemeralPrivateKey::generate(&X25519, &SystemRandom::new());
        #[allow(clippy::expect_used)] // As documented.
        let private = private.expect("the operating system gives no random bytes");
        let mut public = [0; 32];
        if let Ok(value) = private.compute_public_key() {
            public.copy_from_slice(value.as_ref());
        }
        Agreement { private, public }
    }

    /// The seals from the member to the host, and back. `context`: what both sides know of the
    /// greeting. `None`: the other side's value is none.
    pub fn seals(self, theirs: &PublicValue, context: &[&[u8]]) -> Option<(Seal, Seal)> {
        let shared =
            agree_ephemeral(self.private, &UnparsedPublicKey::new(&X25519, theirs), |bytes| {
                let mut secret = [0; KEY];
                secret.copy_from_slice(bytes);
                Secret(secret)
            });
        let shared = shared.ok()?;
        let seal = |what| Seal::new(&shared.derived(what, context));
        Some((seal("sculptd up 2"), seal("sculptd down 2")))
    }
}

/// Messages that may overtake each other: parts of a checkpoint wait behind all else.
const WINDOW: u64 = 8192;

/// The counters of the messages that were opened.
#[derive(Debug)]
struct Opened {
    newest: u64,
    /// One bit a counter, of the last [`WINDOW`].
    seen: Vec<u64>,
}

impl Opened {
    /// Returns true if this counter was not taken before.
    fn take(&mut self, counter: u64) -> bool {
        if self.seen.is_empty() {
            self.seen = vec![0; (WINDOW / 64) as usize];
        }
        if counter == 0 || counter + WINDOW <= self.newest {
            return false;
        }
        let place = |c: u64| ((c % WINDOW / 64) as usize, 1u64 << (c % 64));
        for passed in (self.newest + 1..=counter).rev().take(WINDOW as usize) {
            let (word, bit) = place(passed);
            self.seen[word] &= !bit;
        }
        self.newest = self.newest.max(counter);
        let (word, bit) = place(counter);
        let is_new = self.seen[word] & bit == 0;
        self.seen[word] |= bit;
        is_new
    }
}

/// Seals messages in one direction, or opens them.
pub struct Seal {
    key: LessSafeKey,
    sealed: u64,
    opened: Opened,
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
        Seal { key, sealed: 0, opened: Opened { newest: 0, seen: Vec::new() } }
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

    /// The message again; `None` where another key sealed it, it was changed, or it was opened
    /// before.
    pub fn open(&mut self, sealed: &[u8]) -> Option<Vec<u8>> {
        let (counter, rest) = sealed.split_first_chunk::<8>()?;
        let mut bytes = rest.to_vec();
        let counter = u64::from_le_bytes(*counter);
        let length = self.key.open_in_place(once(counter), Aad::empty(), &mut bytes).ok()?.len();
        bytes.truncate(length);
        self.opened.take(counter).then_some(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agreed(context: &[&[u8]]) -> ((Seal, Seal), (Seal, Seal)) {
        let (member, host) = (Agreement::draw(), Agreement::draw());
        let (a, b) = (member.public, host.public);
        let member = member.seals(&b, context).expect("a key");
        (member, host.seals(&a, context).expect("a key"))
    }

    #[test]
    fn only_the_same_greeting_opens_and_a_changed_bit_is_noticed() {
        let ((mut up, mut down), (mut host_up, mut host_down)) = agreed(&[b"a"]);
        let sealed = up.seal(b"a batch");
        assert_ne!(sealed, up.seal(b"a batch"), "a counter is never used twice");
        for bit in 0..sealed.len() * 8 {
            let mut changed = sealed.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(host_up.open(&changed), None, "bit {bit}");
        }
        assert_eq!(down.open(&sealed), None, "the other direction");
        assert_eq!(agreed(&[b"a"]).1.0.open(&sealed), None, "another greeting");
        assert_eq!(host_up.open(&sealed).as_deref(), Some(&b"a batch"[..]));
        assert_eq!(down.open(&host_down.seal(b"x")).as_deref(), Some(&b"x"[..]));
        let (member, host) = (Agreement::draw(), Agreement::draw());
        let (a, b) = (member.public, host.public);
        let (mut up, _) = member.seals(&b, &[b"here"]).expect("a key");
        let (mut other, _) = host.seals(&a, &[b"there"]).expect("a key");
        assert_eq!(other.open(&up.seal(b"x")), None, "another context");
        assert!(Agreement::draw().seals(&[0; 32], &[]).is_none(), "a value that is none");
        assert!(!format!("{:?} {up:?}", Secret([7; KEY])).contains('7'));
    }

    #[test]
    fn a_message_is_opened_once_in_whatever_order_they_come() {
        let ((mut up, _), (mut host, _)) = agreed(&[]);
        let all: Vec<Vec<u8>> = (0..3 * WINDOW).map(|k| up.seal(&k.to_le_bytes())).collect();
        // Each pair swapped, each message twice.
        for pair in all[..1000].chunks(2) {
            assert!(host.open(&pair[1]).is_some() && host.open(&pair[0]).is_some());
            assert!(host.open(&pair[1]).is_none() && host.open(&pair[0]).is_none());
        }
        // One that is far ahead: those within the window come still, older ones do not.
        let last = all.len() - 1;
        assert!(host.open(&all[last]).is_some());
        let oldest = last + 1 - WINDOW as usize;
        assert!(host.open(&all[oldest]).is_some() && host.open(&all[oldest]).is_none());
        assert!(host.open(&all[oldest - 1]).is_none() && host.open(&all[0]).is_none());
    }
}
