//! The sealed messages ([`crate::seal`]): whoever holds no key can neither read nor write one.
//! The messages before there is a key: [`super::greeting`].

use super::bytes::{BadBytes, ByteReader, put_bytes, put_number};
use super::frame::{Arrival, Batch, MAX_NAME, PersonId, Role};
use super::frame_codec::{put_batches, take_batches};
use super::keys::MAX_MEMBERSHIP;

/// Bytes of one chunk of a checkpoint.
pub const CHUNK: usize = 32 << 10;
/// Bytes of a reason.
pub(super) const MAX_REASON: usize = 512;
/// Challenges that one message among the heirs answers.
pub const MAX_HEARD: usize = 64;
/// Chunks of a checkpoint: 8 GiB.
const MAX_CHUNKS: u64 = 1 << 18;

/// A name for one process on the network, drawn at random.
pub type Address = u64;
/// Random bytes that are used once.
pub type Nonce = [u8; 16];

/// The turn of a host: its number, how far its log reached when it began, and its address. Of two
/// hosts the greater one stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Term {
    /// Counts takeovers, from 1.
    pub number: u32,
    /// The last frame of the log when the turn began.
    pub base: u64,
    /// The host's.
    pub host: Address,
}

impl Term {
    pub(super) fn put(&self, out: &mut Vec<u8>) {
        put_number(out, u64::from(self.number));
        put_number(out, self.base);
        out.extend(self.host.to_le_bytes());
    }

    pub(super) fn take(bytes: &mut ByteReader<'_>) -> Result<Term, BadBytes> {
        Ok(Term {
            number: bytes.at_most(u64::from(u32::MAX - 1))? as u32,
            base: bytes.at_most(u64::MAX >> 1)?,
            host: u64::from_le_bytes(bytes.array()?),
        })
    }
}

/// End of a log that a station already has: the term of its last frame, and its index.
pub type Reached = (Term, u64);

/// A checkpoint that can be fetched, by the frame right after which it was taken. Its first chunks
/// may be had while the last ones are still made.
pub type Offer = u64;

/// Terms of an member_key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The number of the person that joins.
    pub person: PersonId,
    /// The person whose daemon hosts.
    pub host: PersonId,
    /// The host's turn.
    pub term: Term,
    /// Ticks a second.
    pub rate_hz: u32,
    /// The last of the person's batches that is in the log: the next one is the one after it.
    pub applied: u64,
    /// The checkpoint to begin with; `None`: the frames after what is there follow.
    pub offer: Option<Offer>,
    /// Everybody with a number, and the last batch of each at the checkpoint, or at the end of the
    /// existing log.
    pub people: Vec<(Arrival, u64)>,
    /// The turns of the log, and the first frame of each.
    pub turns: Vec<(Term, u64)>,
    /// For those who may take over: the key of the group.
    pub group: Option<[u8; 32]>,
}

/// In the place of [`FromMember::Up::have`]: the member still waits for its [`Entry`].
pub const NOT_ENTERED: u64 = u64::MAX >> 1;

/// From a member to its host.
#[derive(Debug, Clone)]
pub enum FromMember {
    /// The first sealed one.
    Join {
        /// As the person wants to be called.
        name: String,
        /// Role that the person requests.
        role: Role,
        /// End of the log that is already present.
        reached: Option<Reached>,
    },
    /// Several times a second: the last received frame, and new input.
    Up {
        /// The frame up to which all are here.
        have: u64,
        /// The first frame after a gap, where one is; 0: no gap.
        after_gap: u64,
        /// The sender's clock, ms.
        sent_ms: u32,
        /// The newest clock of the other side, as it would be now.
        echo_ms: u32,
        /// Batches that the host is not known to have.
        batches: Vec<Batch>,
    },
    /// Chunks of a checkpoint are wanted.
    Want {
        /// Of the offer.
        index: u64,
        /// The first chunk.
        first: u32,
        /// Number of chunks.
        count: u32,
    },
    /// The hash after a frame with the mark.
    Hash {
        /// The frame's index.
        index: u64,
        /// Of the world.
        hash: u64,
    },
    /// The person goes.
    Leave,
    /// A list of members, signed by the owner: the sender is the owner, or knows a newer one.
    Members(Vec<u8>),
    /// The list of this version is known.
    KnowsMembers(u64),
}

/// From the host to a member.
#[derive(Debug, Clone)]
pub enum FromHost {
    /// Somebody is let in.
    Entry(Box<Entry>),
    /// Somebody is not, or no longer.
    Refused(String),
    /// Several times a second.
    Down {
        /// All batches up to this one have been received.
        received: u64,
        /// All batches up to this one are in frames that a replica has too.
        acknowledged: u64,
        /// As in [`FromMember::Up`].
        sent_ms: u32,
        /// As in [`FromMember::Up`].
        echo_ms: u32,
        /// Frames that follow each other ([`super::frame_codec`]): to read them, the log is needed.
        frames: Vec<u8>,
    },
    /// A part of a checkpoint.
    Chunk {
        /// Of the offer.
        index: u64,
        /// Which.
        number: u32,
        /// True for the last part.
        last: bool,
        /// At most [`CHUNK`].
        bytes: Vec<u8>,
    },
    /// A new list of members, and for possible successors a new key of the group.
    Members {
        /// Signed by the owner.
        members: Vec<u8>,
        /// As in [`Entry::group`].
        group: Option<[u8; 32]>,
    },
    /// The worlds differ after a frame: the member must rejoin.
    Differs {
        /// The frame's index.
        index: u64,
        /// The host's hash.
        hash: u64,
    },
}

/// Among those who may take over. A message counts only if it answers a challenge of the receiver:
/// one that was recorded is not taken for a living sender's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AmongHeirs {
    /// The sender's own challenge; 0: none.
    pub challenge: u64,
    /// The challenges that the sender heard within the last seconds, at most [`MAX_HEARD`].
    pub heard: Vec<u64>,
    /// The message.
    pub word: HeirsWord,
}

/// See [`AmongHeirs`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeirsWord {
    /// The host is alive.
    Host {
        /// Its turn.
        term: Term,
    },
    /// The host is gone, and the sender would take over.
    Candidate {
        /// The highest number of a turn that the sender knows of.
        known: u32,
        /// End of its log.
        reached: Reached,
        /// The sender.
        by: Address,
    },
    /// Who hosts?
    Who,
}

impl HeirsWord {
    /// All that [`HeirsWord::kind`] returns.
    pub const KINDS: [&'static str; 3] = ["host", "candidate", "who"];

    /// Name of the kind.
    pub fn kind(&self) -> &'static str {
        let at = match self {
            HeirsWord::Host { .. } => 0,
            HeirsWord::Candidate { .. } => 1,
            HeirsWord::Who => 2,
        };
        Self::KINDS[at]
    }
}

impl FromMember {
    /// All that [`FromMember::kind`] returns.
    pub const KINDS: [&'static str; 7] =
        ["join", "up", "want", "hash", "leave", "members", "knows members"];

    /// Name of the kind.
    pub fn kind(&self) -> &'static str {
        let at = match self {
            FromMember::Join { .. } => 0,
            FromMember::Up { .. } => 1,
            FromMember::Want { .. } => 2,
            FromMember::Hash { .. } => 3,
            FromMember::Leave => 4,
            FromMember::Members(_) => 5,
            FromMember::KnowsMembers(_) => 6,
        };
        Self::KINDS[at]
    }

    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        match self {
            FromMember::Join { name, role, reached } => {
                out.extend([0, role.code(), u8::from(reached.is_some())]);
                put_bytes(&mut out, name.as_bytes());
                if let Some((term, index)) = reached {
                    term.put(&mut out);
                    put_number(&mut out, *index);
                }
            }
            FromMember::Up { have, after_gap, sent_ms, echo_ms, batches } => {
                out.push(1);
                put_number(&mut out, *have);
                put_number(&mut out, *after_gap);
                put_number(&mut out, u64::from(*sent_ms));
                put_number(&mut out, u64::from(*echo_ms));
                put_batches(&mut out, batches);
            }
            FromMember::Want { index, first, count } => {
                out.push(2);
                put_number(&mut out, *index);
                put_number(&mut out, u64::from(*first));
                put_number(&mut out, u64::from(*count));
            }
            FromMember::Hash { index, hash } => {
                out.push(3);
                put_number(&mut out, *index);
                out.extend(hash.to_le_bytes());
            }
            FromMember::Leave => out.push(4),
            FromMember::Members(members) => {
                out.push(5);
                put_bytes(&mut out, members);
            }
            FromMember::KnowsMembers(version) => {
                out.push(6);
                put_number(&mut out, *version);
            }
        }
        out
    }

    /// # Errors
    /// [`BadBytes`] where they are no such message.
    pub fn from_bytes(bytes: &[u8]) -> Result<FromMember, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let read = match b.byte()? {
            0 => {
                let role = Role::of_code(b.byte()?)?;
                let reached = b.byte()? != 0;
                let name = b.text(MAX_NAME)?;
                let reached = match reached {
                    true => Some((Term::take(&mut b)?, b.at_most(u64::MAX >> 1)?)),
                    false => None,
                };
                FromMember::Join { name, role, reached }
            }
            1 => FromMember::Up {
                have: b.at_most(u64::MAX >> 1)?,
                after_gap: b.at_most(u64::MAX >> 1)?,
                sent_ms: b.at_most(u64::from(u32::MAX))? as u32,
                echo_ms: b.at_most(u64::from(u32::MAX))? as u32,
                batches: take_batches(ByteReader::new(b.rest()))?,
            },
            2 => FromMember::Want {
                index: b.number()?,
                first: b.at_most(MAX_CHUNKS)? as u32,
                count: b.at_most(MAX_CHUNKS)? as u32,
            },
            3 => FromMember::Hash { index: b.number()?, hash: u64::from_le_bytes(b.array()?) },
            4 => FromMember::Leave,
            5 => FromMember::Members(b.bytes(MAX_MEMBERSHIP)?.to_vec()),
            6 => FromMember::KnowsMembers(b.number()?),
            _ => return Err(BadBytes),
        };
        b.end()?;
        Ok(read)
    }
}

impl Entry {
    fn put(&self, out: &mut Vec<u8>) {
        out.extend([self.person, self.host]);
        self.term.put(out);
        put_number(out, u64::from(self.rate_hz));
        put_number(out, self.applied);
        out.push(u8::from(self.offer.is_some()));
        if let Some(index) = self.offer {
            put_number(out, index);
        }
        put_number(out, self.people.len() as u64);
        for (person, applied) in &self.people {
            person.put(out);
            put_number(out, *applied);
        }
        put_number(out, self.turns.len() as u64);
        for (term, first) in &self.turns {
            term.put(out);
            put_number(out, *first);
        }
        put_group(out, self.group.as_ref());
    }

    fn take(b: &mut ByteReader<'_>) -> Result<Entry, BadBytes> {
        let (person, host) = (b.byte()?, b.byte()?);
        let term = Term::take(b)?;
        let rate_hz = b.at_most(1000)? as u32;
        let applied = b.at_most(u64::MAX >> 1)?;
        let offer = match b.byte()? {
            0 => None,
            _ => Some(b.at_most(u64::MAX >> 1)?),
        };
        let mut people = Vec::new();
        for _ in 0..b.count(256)? {
            people.push((Arrival::take(b)?, b.at_most(u64::MAX >> 1)?));
        }
        let mut turns = Vec::new();
        for _ in 0..b.count(1 << 16)? {
            turns.push((Term::take(b)?, b.at_most(u64::MAX >> 1)?));
        }
        let group = take_group(b)?;
        Ok(Entry { person, host, term, rate_hz, applied, offer, people, turns, group })
    }
}

fn put_group(out: &mut Vec<u8>, group: Option<&[u8; 32]>) {
    out.push(u8::from(group.is_some()));
    out.extend(group.into_iter().flatten());
}

fn take_group(b: &mut ByteReader<'_>) -> Result<Option<[u8; 32]>, BadBytes> {
    match b.byte()? {
        0 => Ok(None),
        _ => Ok(Some(b.array()?)),
    }
}

impl FromHost {
    /// All that [`FromHost::kind`] returns.
    pub const KINDS: [&'static str; 6] =
        ["entry", "refused", "down", "chunk", "members and group", "differs"];

    /// Name of the kind.
    pub fn kind(&self) -> &'static str {
        let at = match self {
            FromHost::Entry(_) => 0,
            FromHost::Refused(_) => 1,
            FromHost::Down { .. } => 2,
            FromHost::Chunk { .. } => 3,
            FromHost::Members { .. } => 4,
            FromHost::Differs { .. } => 5,
        };
        Self::KINDS[at]
    }

    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        match self {
            FromHost::Entry(entry) => {
                out.push(0);
                entry.put(&mut out);
            }
            FromHost::Refused(reason) => {
                out.push(1);
                put_bytes(&mut out, reason.as_bytes());
            }
            FromHost::Down { received, acknowledged, sent_ms, echo_ms, frames } => {
                out.push(2);
                put_number(&mut out, *received);
                put_number(&mut out, *acknowledged);
                put_number(&mut out, u64::from(*sent_ms));
                put_number(&mut out, u64::from(*echo_ms));
                out.extend(frames);
            }
            FromHost::Chunk { index, number, last, bytes } => {
                out.push(3);
                put_number(&mut out, *index);
                put_number(&mut out, u64::from(*number));
                out.push(u8::from(*last));
                put_bytes(&mut out, bytes);
            }
            FromHost::Differs { index, hash } => {
                out.push(4);
                put_number(&mut out, *index);
                out.extend(hash.to_le_bytes());
            }
            FromHost::Members { members, group } => {
                out.push(5);
                put_bytes(&mut out, members);
                put_group(&mut out, group.as_ref());
            }
        }
        out
    }

    /// # Errors
    /// [`BadBytes`] where they are no such message.
    pub fn from_bytes(bytes: &[u8]) -> Result<FromHost, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let read = match b.byte()? {
            0 => FromHost::Entry(Box::new(Entry::take(&mut b)?)),
            1 => FromHost::Refused(b.text(MAX_REASON)?),
            2 => FromHost::Down {
                received: b.number()?,
                acknowledged: b.number()?,
                sent_ms: b.at_most(u64::from(u32::MAX))? as u32,
                echo_ms: b.at_most(u64::from(u32::MAX))? as u32,
                frames: b.rest().to_vec(),
            },
            3 => FromHost::Chunk {
                index: b.number()?,
                number: b.at_most(MAX_CHUNKS)? as u32,
                last: b.byte()? != 0,
                bytes: b.bytes(CHUNK)?.to_vec(),
            },
            4 => FromHost::Differs { index: b.number()?, hash: u64::from_le_bytes(b.array()?) },
            5 => {
                let members = b.bytes(MAX_MEMBERSHIP)?.to_vec();
                FromHost::Members { members, group: take_group(&mut b)? }
            }
            _ => return Err(BadBytes),
        };
        b.end()?;
        Ok(read)
    }
}

impl AmongHeirs {
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = self.challenge.to_le_bytes().to_vec();
        put_number(&mut out, self.heard.len() as u64);
        self.heard.iter().for_each(|h| out.extend(h.to_le_bytes()));
        match self.word {
            HeirsWord::Host { term } => {
                out.push(0);
                term.put(&mut out);
            }
            HeirsWord::Candidate { known, reached, by } => {
                out.push(1);
                put_number(&mut out, u64::from(known));
                reached.0.put(&mut out);
                put_number(&mut out, reached.1);
                out.extend(by.to_le_bytes());
            }
            HeirsWord::Who => out.push(2),
        }
        out
    }

    /// # Errors
    /// [`BadBytes`] where they are no such message.
    pub fn from_bytes(bytes: &[u8]) -> Result<AmongHeirs, BadBytes> {
        let mut b = ByteReader::new(bytes);
        let challenge = u64::from_le_bytes(b.array()?);
        let mut heard = Vec::new();
        for _ in 0..b.count(MAX_HEARD)? {
            heard.push(u64::from_le_bytes(b.array()?));
        }
        let word = match b.byte()? {
            0 => HeirsWord::Host { term: Term::take(&mut b)? },
            1 => HeirsWord::Candidate {
                known: b.at_most(u64::from(u32::MAX - 1))? as u32,
                reached: (Term::take(&mut b)?, b.number()?),
                by: u64::from_le_bytes(b.array()?),
            },
            2 => HeirsWord::Who,
            _ => return Err(BadBytes),
        };
        b.end()?;
        Ok(AmongHeirs { challenge, heard, word })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn messages() -> Vec<Vec<u8>> {
        let term = Term { number: 3, base: 900, host: 77 };
        let person = Arrival { person: 2, name: "Ada".into(), role: Role::Viewer, here: false };
        let frames = vec![9; 40];
        let entry = Entry {
            person: 2,
            host: 1,
            term,
            rate_hz: 120,
            applied: 9,
            offer: Some(4),
            people: vec![(person, 8)],
            turns: vec![(term, 1)],
            group: Some([1; 32]),
        };
        let [sent_ms, echo_ms] = [5, 6];
        vec![
            FromHost::Entry(Box::new(entry)).to_bytes(),
            FromHost::Refused("no".into()).to_bytes(),
            FromHost::Down { received: 1, acknowledged: 2, sent_ms, echo_ms, frames }.to_bytes(),
            FromHost::Chunk { index: 4, number: 1, last: true, bytes: vec![3; 99] }.to_bytes(),
            FromHost::Differs { index: 4, hash: 5 }.to_bytes(),
            FromHost::Members { members: vec![4; 50], group: Some([5; 32]) }.to_bytes(),
        ]
    }

    #[test]
    fn messages_come_back_and_every_torn_one_is_an_error() {
        for bytes in messages() {
            let read = FromHost::from_bytes(&bytes).expect("whole");
            assert_eq!(read.to_bytes(), bytes);
            // Frames are read with the log: [`super::super::frame_codec`] tests them.
            let whole = if bytes[0] == 2 { bytes.len() - 40 } else { bytes.len() };
            for cut in 0..whole {
                assert_eq!(FromHost::from_bytes(&bytes[..cut]).err(), Some(BadBytes), "at {cut}");
            }
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_without_a_panic(
            bytes in proptest::collection::vec(any::<u8>(), 0..300),
            kind in 0u8..8,
        ) {
            let mut bytes = bytes;
            if let Some(first) = bytes.first_mut() {
                *first = kind;
            }
            let _ = FromMember::from_bytes(&bytes);
            let _ = FromHost::from_bytes(&bytes);
            let _ = AmongHeirs::from_bytes(&bytes);
        }

        #[test]
        fn a_message_with_wrong_bytes_is_read_without_a_panic(
            which in 0usize..6,
            changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        ) {
            let mut bytes = messages()[which].clone();
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            let _ = FromHost::from_bytes(&bytes);
        }
    }
}
