//! The contents of the file: the tables, the bytes of a tick, the start mesh.
//!
//! **Layout 4.** An SQLite database in WAL mode, page size 4096, with
//! * `meta`: the start mesh and the settings (postcard), their checksums, the session's creation
//!   number ([`META_IDENTITY`]), and [`META_REPLAY_FROM`] where a replay from the start is
//!   impossible;
//! * `acknowledged`: one row in a separate page. The last tick that reached the disk is written
//!   into it without SQLite, see [`super::acknowledgement`]. `acknowledged_again` is a second copy
//!   some pages further on, so that damage in one place does not cost both. Older files have only
//!   the first;
//! * `input`: the samples and commands of a group of ticks a row. `number` counts from 1 without a
//!   gap. `crc` is the CRC-32 of the creation number, `number`, `first_tick`, `last_tick` and
//!   `data`, so that a row can be trusted alone. `chain` is the CRC-32 of the creation number and
//!   of the `data` of all rows up to this one, so that no row of another session and no order but
//!   the right one is accepted;
//! * the tables of the history, see [`super::history::store`].
//!
//! **Layout 3** ([`v3`]) had a table `log` in place of `input`, without numbers and chain, and no
//! acknowledgement. A file of it is opened at its newest checkpoint and brought to layout 4 in one
//! transaction when it is written to.
//!
//! Structs are stored by postcard as their fields in order. A struct grows only at its end, with
//! `#[serde(default)]`; the layout number goes up with the release that contains the change, and
//! the number of fields that each struct had before is kept in a table
//! ([`sculptd_engine::old_layout`]).

pub mod v3;

use serde::{Deserialize, Serialize};

use sculptd_clay::brush::BrushSettings;
use sculptd_devices::Sample;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::old_layout::{FieldCounts, take_from_bytes};

use super::VERSION;

/// The tables of the input.
pub const TABLES: &str = "
    CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL) WITHOUT ROWID;
    CREATE TABLE acknowledged (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
    CREATE TABLE input (
        number INTEGER PRIMARY KEY,
        first_tick INTEGER NOT NULL,
        last_tick INTEGER NOT NULL,
        crc INTEGER NOT NULL,
        chain INTEGER NOT NULL,
        data BLOB NOT NULL
    );
";

/// The tables of what is written twice. They come after all others, so that their pages lie far
/// from those of the first copies: a bad place of a disk is larger than a page.
pub const TABLES_OF_COPIES: &str = "
    CREATE TABLE acknowledged_again (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
    CREATE TABLE spare (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
";

/// Keys of `meta`.
pub const META_START: &str = "start_mesh";
pub const META_SETTINGS: &str = "settings";
/// The session's creation number, eight bytes, little-endian: copies of a file share it.
pub const META_IDENTITY: &str = "identity";
/// A [`ReplayFrom`]; absent where the session can be replayed from its start.
pub const META_REPLAY_FROM: &str = "replay_from";
/// The CRC-32 of both, in that order. Files from before it was written go unchecked.
pub const META_SUMS: &str = "sums";

/// Magic of a blob in the table `spare`: a second copy of an entry of `meta`, in separate pages,
/// for salvage. A replay needs the start and the settings, so damage in one place must not cost
/// them.
const SPARE_MAGIC: [u8; 16] = *b"sculptd:spare...";

/// Returns the blob of a spare copy: the magic, the CRC-32 of the rest, the key's length and the
/// key, the value.
pub fn spare_blob(key: &str, value: &[u8]) -> Vec<u8> {
    let rest = [&[key.len() as u8], key.as_bytes(), value].concat();
    [&SPARE_MAGIC[..], &crc32fast::hash(&rest).to_le_bytes(), &rest].concat()
}

/// Returns the key and the value of a spare copy; `None` if the bytes have changed.
pub fn from_spare_blob(blob: &[u8]) -> Option<(String, Vec<u8>)> {
    let (crc, rest) = blob.strip_prefix(&SPARE_MAGIC)?.split_first_chunk::<4>()?;
    let (length, text) = rest.split_first()?;
    let (key, value) = text.split_at_checked(usize::from(*length))?;
    let whole = crc32fast::hash(rest).to_le_bytes() == *crc;
    whole.then(|| Some((String::from_utf8(key.to_vec()).ok()?, value.to_vec())))?
}

/// Everything that a fresh world is made from, besides the mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    pub rate_hz: u32,
    pub dab_budget: u64,
    pub undo_bytes: u64,
    /// As given to `World::new`, before it framed the work.
    pub camera: Camera,
    pub brush: BrushSettings,
    pub hands: HandSettings,
}

/// Input that changed the world in one tick.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TickInput {
    pub tick: u64,
    pub samples: Vec<Sample>,
    pub commands: Vec<Command>,
}

/// Reason that a session can be opened at a checkpoint but cannot be replayed from its start.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReplayFrom {
    /// A replay can begin at checkpoints of this tick and later ones.
    pub tick: u64,
    /// Explanation for people.
    pub why: String,
}

/// One row of `input`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputRow {
    /// Counts from 1, without gaps.
    pub number: u64,
    pub first: u64,
    pub last: u64,
    pub crc: u32,
    pub chain: u32,
    pub data: Vec<u8>,
}

/// The chain before the first row.
pub fn chain_start(identity: u64) -> u32 {
    crc32fast::hash(&identity.to_le_bytes())
}

/// The chain after more bytes.
pub fn chain(before: u32, data: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(data);
    hasher.finalize()
}

impl InputRow {
    /// The row after one whose number and chain are `before`.
    pub fn after(
        before: (u64, u32),
        identity: u64,
        ticks: std::ops::RangeInclusive<u64>,
        data: Vec<u8>,
    ) -> InputRow {
        let (number, first, last) = (before.0 + 1, *ticks.start(), *ticks.end());
        let mut row = InputRow { number, first, last, crc: 0, chain: chain(before.1, &data), data };
        row.crc = row.sum(identity);
        row
    }

    fn sum(&self, identity: u64) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        for value in [identity, self.number, self.first, self.last] {
            hasher.update(&value.to_le_bytes());
        }
        hasher.update(&self.data);
        hasher.finalize()
    }

    /// Returns true if the row's checksum matches this session.
    pub fn is_whole(&self, identity: u64) -> bool {
        self.sum(identity) == self.crc
    }

    /// Returns true if the row directly follows one with this number and chain.
    pub fn follows(&self, before: (u64, u32)) -> bool {
        self.number == before.0 + 1 && chain(before.1, &self.data) == self.chain
    }
}

/// The number of fields that structs had in a layout. `None`: this version does not know it.
pub fn field_counts(layout: u32) -> Option<&'static FieldCounts> {
    match layout {
        VERSION => Some(&[]),
        v3::LAYOUT => Some(v3::FIELD_COUNTS),
        _ => None,
    }
}

/// The same, borrowed, for writing.
#[derive(Debug, Serialize)]
struct TickRef<'a> {
    tick: u64,
    samples: &'a [Sample],
    commands: &'a [Command],
}

/// Appends one tick to `out`. Postcard: a pen sample takes about 60 bytes, a hand about 500.
pub fn append(out: &mut Vec<u8>, tick: u64, samples: &[Sample], commands: &[Command]) {
    let length = out.len();
    let done = postcard::to_extend(&TickRef { tick, samples, commands }, std::mem::take(out));
    match done {
        Ok(all) => *out = all,
        // Plain data always serialises; if a type ever does not, the tick is left out whole.
        Err(_) => out.truncate(length),
    }
}

/// The ticks of one group, in order; stops at the first byte that makes no sense.
pub fn ticks<'a>(
    mut data: &'a [u8],
    counts: &'a FieldCounts,
) -> impl Iterator<Item = Result<TickInput, postcard::Error>> + 'a {
    std::iter::from_fn(move || {
        if data.is_empty() {
            return None;
        }
        match take_from_bytes::<TickInput>(data, counts) {
            Ok((tick, rest)) => {
                data = rest;
                Some(Ok(tick))
            }
            Err(e) => {
                data = &[];
                Some(Err(e))
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::{Body, DeviceId, Hands, Pen};

    #[test]
    fn ticks_come_back_as_they_went_in_and_a_torn_tail_is_an_error_not_a_panic() {
        let pen = Sample {
            device: DeviceId(3),
            t_us: 77,
            device_t_us: None,
            body: Body::Pen(Pen::default()),
        };
        let hands = Sample { body: Body::Hands(Hands::default()), ..pen };
        let mut bytes = Vec::new();
        append(&mut bytes, 1, &[pen, hands], &[Command::Undo]);
        let first = bytes.len();
        append(&mut bytes, 5, &[], &[Command::Redo, Command::LiftAll]);
        let back: Vec<_> = ticks(&bytes, &[]).collect::<Result<_, _>>().expect("whole");
        assert_eq!(back.len(), 2);
        assert_eq!((back[0].tick, back[0].samples.clone()), (1, vec![pen, hands]));
        assert_eq!((back[1].tick, back[1].commands.len()), (5, 2));
        for cut in 1..bytes.len() {
            let read: Vec<_> = ticks(&bytes[..cut], &[]).collect();
            let whole = read.iter().filter(|r| r.is_ok()).count();
            assert_eq!(whole, usize::from(cut >= first));
        }
    }
}
