//! What stands in the file: the tables, the bytes of a tick, the start mesh.

use serde::{Deserialize, Serialize};

use sculptd_clay::brush::BrushSettings;
use sculptd_devices::Sample;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;

/// The tables. `log` holds groups of ticks in order; `crc` is the CRC-32 of `data`.
pub const TABLES: &str = "
    CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL) WITHOUT ROWID;
    CREATE TABLE log (
        id INTEGER PRIMARY KEY,
        first_tick INTEGER NOT NULL,
        last_tick INTEGER NOT NULL,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL
    );
";

/// Keys of `meta`.
pub const META_START: &str = "start_mesh";
pub const META_SETTINGS: &str = "settings";
/// Names what lies in memory beside the file, see [`crate::session::shared_memory_log`]; eight
/// bytes.
pub const META_TAIL: &str = "tail";
/// The CRC-32 of both, in that order. Files from before it was written go unchecked.
pub const META_SUMS: &str = "sums";

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

/// What changed the world in one tick.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TickInput {
    pub tick: u64,
    pub samples: Vec<Sample>,
    pub commands: Vec<Command>,
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
pub fn ticks(mut data: &[u8]) -> impl Iterator<Item = Result<TickInput, postcard::Error>> + '_ {
    std::iter::from_fn(move || {
        if data.is_empty() {
            return None;
        }
        match postcard::take_from_bytes::<TickInput>(data) {
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
        let back: Vec<_> = ticks(&bytes).collect::<Result<_, _>>().expect("whole");
        assert_eq!(back.len(), 2);
        assert_eq!((back[0].tick, back[0].samples.clone()), (1, vec![pen, hands]));
        assert_eq!((back[1].tick, back[1].commands.len()), (5, 2));
        for cut in 1..bytes.len() {
            let read: Vec<_> = ticks(&bytes[..cut]).collect();
            let whole = read.iter().filter(|r| r.is_ok()).count();
            assert_eq!(whole, usize::from(cut >= first));
        }
    }
}
