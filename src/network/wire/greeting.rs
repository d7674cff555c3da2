//! The messages in the clear, which lead to a key. Both sides sign theirs.

use super::bytes::{BadBytes, ByteReader, put_bytes, put_number};
use super::keys::{MAX_MEMBERSHIP, PublicKey, PublicValue, Signature};
use super::message::{Address, MAX_REASON, Nonce, Term};

/// The version of the messages; a host refuses others by name.
pub const VERSION: u16 = 6;

/// A greeting: somebody wants to join, or to know who hosts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hello {
    /// [`VERSION`].
    pub version: u16,
    /// Drawn for this greeting.
    pub nonce: Nonce,
    /// The member's part of the key agreement.
    pub value: PublicValue,
    /// The name of the invitation's key.
    pub key: [u8; 8],
    /// The sender is about to host, unless somebody does.
    pub claims: bool,
    /// Of all of this and the sender's address, by the invitation's key.
    pub signature: Signature,
}

/// The answer of a host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Challenge {
    /// Of the greeting that is answered.
    pub to: Nonce,
    /// The host's part of the key agreement.
    pub value: PublicValue,
    /// The sculpture, drawn when it was first shared: two of one name differ in it.
    pub sculpture: u64,
    /// The host's turn.
    pub term: Term,
    /// People who are here.
    pub here: u8,
    /// Seconds since the sculpture was first shared.
    pub age_s: u32,
    /// The list of members, signed by the owner.
    pub members: Vec<u8>,
    /// The host's key.
    pub host: PublicKey,
    /// Of all of this, the greeting's value and the host's address, by the host's key.
    pub signature: Signature,
}

/// In the clear: how a key is agreed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Greeting {
    /// To whoever hosts.
    Hello(Hello),
    /// To who greeted.
    Challenge(Box<Challenge>),
    /// The host refuses the greeting.
    Refused(Box<Refusal>),
}

/// A host's refusal. With the host's key it can be distinguished from a stranger's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Of the greeting that is answered.
    pub to: Nonce,
    /// For a person.
    pub reason: String,
    /// The host's key.
    pub host: PublicKey,
    /// Of all of this and the host's address, by the host's key.
    pub signature: Signature,
}

impl Refusal {
    /// The bytes that are signed.
    pub fn signed(&self, from: Address) -> Vec<u8> {
        let mut out = from.to_le_bytes().to_vec();
        self.put(&mut out);
        out
    }

    fn put(&self, out: &mut Vec<u8>) {
        out.extend(self.to);
        put_bytes(out, self.reason.as_bytes());
        out.extend(self.host.0);
    }
}

impl Hello {
    /// The bytes that are signed.
    pub fn signed(&self, from: Address) -> Vec<u8> {
        let mut out = from.to_le_bytes().to_vec();
        self.put(&mut out);
        out
    }

    fn put(&self, out: &mut Vec<u8>) {
        put_number(out, u64::from(self.version));
        out.extend(self.nonce);
        out.extend(self.value);
        out.extend(self.key);
        out.push(u8::from(self.claims));
    }
}

impl Challenge {
    /// The bytes that are signed.
    pub fn signed(&self, greeted: &PublicValue, from: Address) -> Vec<u8> {
        let mut out = from.to_le_bytes().to_vec();
        out.extend(greeted);
        self.put(&mut out);
        out
    }

    fn put(&self, out: &mut Vec<u8>) {
        out.extend(self.to);
        out.extend(self.value);
        out.extend(self.sculpture.to_le_bytes());
        self.term.put(out);
        out.push(self.here);
        put_number(out, u64::from(self.age_s));
        put_bytes(out, &self.members);
        out.extend(self.host.0);
    }
}

impl Greeting {
    /// All that [`Greeting::kind`] returns.
    pub const KINDS: [&'static str; 3] = ["hello", "challenge", "greeting refused"];

    /// Name of the kind.
    pub fn kind(&self) -> &'static str {
        let at = match self {
            Greeting::Hello(_) => 0,
            Greeting::Challenge(_) => 1,
            Greeting::Refused(_) => 2,
        };
        Self::KINDS[at]
    }

    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        match self {
            Greeting::Hello(hello) => {
                out.push(0);
                hello.put(&mut out);
                out.extend(hello.signature);
            }
            Greeting::Challenge(challenge) => {
                out.push(1);
                challenge.put(&mut out);
                out.extend(challenge.signature);
            }
            Greeting::Refused(refusal) => {
                out.push(2);
                refusal.put(&mut out);
                out.extend(refusal.signature);
            }
        }
        out
    }

    /// # Errors
    /// [`BadBytes`] where they are no greeting. A greeting of another version has its version, and
    /// nothing else of it is read.
    pub fn from_bytes(bytes: &[u8]) -> Result<Greeting, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let read = match b.byte()? {
            0 => {
                let (version, nonce) = (b.at_most(u64::from(u16::MAX))? as u16, b.array()?);
                if version != VERSION {
                    let (value, key, signature) = ([0; 32], [0; 8], [0; 64]);
                    let claims = false;
                    return Ok(Greeting::Hello(Hello {
                        version,
                        nonce,
                        value,
                        key,
                        claims,
                        signature,
                    }));
                }
                Greeting::Hello(Hello {
                    version,
                    nonce,
                    value: b.array()?,
                    key: b.array()?,
                    claims: b.byte()? != 0,
                    signature: b.array()?,
                })
            }
            1 => Greeting::Challenge(Box::new(Challenge {
                to: b.array()?,
                value: b.array()?,
                sculpture: u64::from_le_bytes(b.array()?),
                term: Term::take(&mut b)?,
                here: b.byte()?,
                age_s: b.at_most(u64::from(u32::MAX))? as u32,
                members: b.bytes(MAX_MEMBERSHIP)?.to_vec(),
                host: PublicKey(b.array()?),
                signature: b.array()?,
            })),
            2 => Greeting::Refused(Box::new(Refusal {
                to: b.array()?,
                reason: b.text(MAX_REASON)?,
                host: PublicKey(b.array()?),
                signature: b.array()?,
            })),
            _ => return Err(BadBytes),
        };
        b.end()?;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn greetings_come_back_and_every_torn_one_is_an_error() {
        let hello = Hello {
            version: VERSION,
            nonce: [1; 16],
            value: [2; 32],
            key: [3; 8],
            claims: true,
            signature: [4; 64],
        };
        let challenge = Challenge {
            to: [1; 16],
            value: [2; 32],
            sculpture: 3,
            term: Term { number: 4, base: 500, host: 6 },
            here: 7,
            age_s: 800,
            members: vec![9; 70],
            host: PublicKey([10; 32]),
            signature: [11; 64],
        };
        let (to, reason, host) = ([1; 16], "no".to_owned(), PublicKey([10; 32]));
        let refusal = Refusal { to, reason, host, signature: [11; 64] };
        let all = [
            Greeting::Hello(hello),
            Greeting::Challenge(Box::new(challenge)),
            Greeting::Refused(Box::new(refusal)),
        ];
        for greeting in all {
            let bytes = greeting.to_bytes();
            assert_eq!(Greeting::from_bytes(&bytes), Ok(greeting));
            for cut in 0..bytes.len() {
                assert_eq!(Greeting::from_bytes(&bytes[..cut]).err(), Some(BadBytes), "at {cut}");
            }
        }
    }

    #[test]
    fn a_greeting_of_another_version_has_its_version() {
        // As version 4 sent it.
        let old = [&[0, 4][..], &[7; 16], &[8; 8]].concat();
        let read = Greeting::from_bytes(&old);
        assert!(matches!(read, Ok(Greeting::Hello(h)) if h.version == 4 && h.nonce == [7; 16]));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_without_a_panic(
            bytes in proptest::collection::vec(any::<u8>(), 0..300),
            kind in 0u8..4,
        ) {
            let mut bytes = bytes;
            if let Some(first) = bytes.first_mut() {
                *first = kind;
            }
            let _ = Greeting::from_bytes(&bytes);
        }
    }
}
