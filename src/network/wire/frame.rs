//! Frames: the ordered input. The host makes them, everybody steps them.
//!
//! A frame stands for all ticks after the one of the frame before it, up to and including its own;
//! only its own tick has input. A frame without input says that time has passed.

use super::bytes::{BadBytes, ByteReader, put_bytes, put_number};
use super::samples::SampleCodec;
use sculptd_devices::Sample;
use sculptd_engine::command::Command;

/// A person's number in one sculpture, from 1. Nobody has 0.
pub type PersonId = u8;

/// Bytes that a command may take: a mesh of about two hundred thousand triangles.
pub const MAX_COMMAND: usize = 8 << 20;
/// Samples and commands of one batch.
pub const MAX_ENTRIES: usize = 256;
/// Batches of one frame, and of one message.
pub const MAX_BATCHES: usize = 1024;
/// Ticks that a frame may stand for: over an hour at 1000 a second.
pub const MAX_TICKS: u64 = 1 << 22;
/// Bytes of a person's name.
pub const MAX_NAME: usize = 64;

/// What one person gave in one tick of the own loop.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    /// Whose it is.
    pub person: PersonId,
    /// Counts the person's batches, from 1 without a gap.
    pub number: u64,
    /// Rounded ([`super::samples::rounded`]); their devices are those of the person, from 0.
    pub samples: Vec<Sample>,
    /// In their order.
    pub commands: Vec<Command>,
}

/// What a replica does after the tick of a frame, besides stepping it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// Nothing.
    #[default]
    None,
    /// It computes the hash of its world, for the comparison.
    Compare,
    /// Every stroke ends and nothing can be taken back any more, so that a world made of a
    /// checkpoint of this tick goes on as all others do.
    Checkpoint,
}

/// What a person may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Sculpts, sees, and may take over from a host that is gone.
    Sculptor,
    /// Sees, and does nothing: a wall, a projector.
    Viewer,
    /// Sends samples, and sees nothing: a tablet on a computer without a screen.
    Device,
}

impl Role {
    /// As a person writes it.
    pub fn name(self) -> &'static str {
        match self {
            Role::Sculptor => "sculptor",
            Role::Viewer => "viewer",
            Role::Device => "device",
        }
    }

    pub(crate) fn code(self) -> u8 {
        match self {
            Role::Sculptor => 0,
            Role::Viewer => 1,
            Role::Device => 2,
        }
    }

    pub(crate) fn of_code(code: u8) -> Result<Role, BadBytes> {
        [Role::Sculptor, Role::Viewer, Role::Device].get(usize::from(code)).copied().ok_or(BadBytes)
    }
}

/// Somebody who came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrival {
    /// The person's number.
    pub person: PersonId,
    /// The person's name, at most [`MAX_NAME`] bytes.
    pub name: String,
    /// What the person may do.
    pub role: Role,
}

impl Arrival {
    pub(crate) fn put(&self, out: &mut Vec<u8>) {
        out.extend([self.person, self.role.code()]);
        put_bytes(out, self.name.as_bytes());
    }

    pub(crate) fn take(bytes: &mut ByteReader<'_>) -> Result<Arrival, BadBytes> {
        let person = bytes.byte()?;
        let role = Role::of_code(bytes.byte()?)?;
        Ok(Arrival { person, name: bytes.text(MAX_NAME)?, role })
    }
}

/// The input of one tick, in its order.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Counts frames, from 1 without a gap, across all hosts.
    pub index: u64,
    /// The tick of the input.
    pub tick: u64,
    /// What is done after the tick.
    pub mark: Mark,
    /// Who came before the tick.
    pub arrivals: Vec<Arrival>,
    /// In the order in which they are stepped.
    pub batches: Vec<Batch>,
}

impl Frame {
    /// Whether anybody gave anything.
    pub fn has_input(&self) -> bool {
        !self.batches.is_empty()
    }
}

/// Appends batches.
pub fn put_batches(out: &mut Vec<u8>, batches: &[Batch], samples: &mut SampleCodec) {
    put_number(out, batches.len() as u64);
    for batch in batches {
        out.push(batch.person);
        put_number(out, batch.number);
        put_number(out, (batch.samples.len() as u64) << 1 | u64::from(!batch.commands.is_empty()));
        for sample in &batch.samples {
            let own = u64::from(batch.person) << 8;
            // The codec tells the devices of all persons apart.
            let device = sculptd_devices::DeviceId(sample.device.0 & 0xff | own as u16);
            samples.put(out, &Sample { device, ..*sample });
        }
        if !batch.commands.is_empty() {
            put_number(out, batch.commands.len() as u64);
            for command in &batch.commands {
                put_bytes(out, &postcard::to_stdvec(command).unwrap_or_default());
            }
        }
    }
}

/// Reads batches.
///
/// # Errors
/// [`BadBytes`] where they are none.
pub fn take_batches(
    bytes: &mut ByteReader<'_>,
    samples: &mut SampleCodec,
) -> Result<Vec<Batch>, BadBytes> {
    let count = bytes.count(MAX_BATCHES)?;
    let mut batches = Vec::with_capacity(count);
    for _ in 0..count {
        let person = bytes.byte()?;
        let number = bytes.number()?;
        let flags = bytes.at_most((MAX_ENTRIES as u64) << 1 | 1)?;
        let mut batch = Batch { person, number, ..Batch::default() };
        for _ in 0..flags >> 1 {
            let mut sample = samples.take(bytes)?;
            if sample.device.0 >> 8 != u16::from(person) {
                return Err(BadBytes);
            }
            sample.device.0 &= 0xff;
            batch.samples.push(sample);
        }
        if flags & 1 != 0 {
            for _ in 0..bytes.count(MAX_ENTRIES)? {
                let command = postcard::from_bytes(bytes.bytes(MAX_COMMAND)?);
                batch.commands.push(command.map_err(|_| BadBytes)?);
            }
        }
        batches.push(batch);
    }
    Ok(batches)
}

/// Appends frames that follow each other.
pub fn put_frames(out: &mut Vec<u8>, frames: &[std::sync::Arc<Frame>]) {
    put_number(out, frames.len() as u64);
    let Some(first) = frames.first() else { return };
    put_number(out, first.index);
    put_number(out, first.tick);
    let (mut tick, mut samples) = (first.tick, SampleCodec::default());
    for frame in frames {
        // One byte for the usual frame: the next tick, nothing but a batch or two.
        let mark = match frame.mark {
            Mark::None => 0,
            Mark::Compare => 1,
            Mark::Checkpoint => 2,
        };
        let more = u64::from(!frame.arrivals.is_empty()) << 1 | u64::from(frame.has_input());
        put_number(out, frame.tick.saturating_sub(tick) << 4 | mark << 2 | more);
        tick = frame.tick;
        if !frame.arrivals.is_empty() {
            put_number(out, frame.arrivals.len() as u64);
            frame.arrivals.iter().for_each(|a| a.put(out));
        }
        if frame.has_input() {
            put_batches(out, &frame.batches, &mut samples);
        }
    }
}

/// Reads frames that follow each other.
///
/// # Errors
/// [`BadBytes`] where they are none.
pub fn take_frames(bytes: &mut ByteReader<'_>) -> Result<Vec<Frame>, BadBytes> {
    let count = bytes.count(1 << 16)?;
    if count == 0 {
        return Ok(Vec::new());
    }
    let first = bytes.at_most(u64::MAX >> 1)?;
    let mut tick = bytes.at_most(u64::MAX >> 1)?;
    let mut samples = SampleCodec::default();
    let mut frames = Vec::new();
    for index in first..first + count as u64 {
        let flags = bytes.at_most(MAX_TICKS << 4)?;
        tick = tick.checked_add(flags >> 4).ok_or(BadBytes)?;
        let mark = match flags >> 2 & 3 {
            0 => Mark::None,
            1 => Mark::Compare,
            2 => Mark::Checkpoint,
            _ => return Err(BadBytes),
        };
        let mut frame = Frame { index, tick, mark, ..Frame::default() };
        if flags & 2 != 0 {
            for _ in 0..bytes.count(256)? {
                frame.arrivals.push(Arrival::take(bytes)?);
            }
        }
        if flags & 1 != 0 {
            frame.batches = take_batches(bytes, &mut samples)?;
        }
        frames.push(frame);
    }
    Ok(frames)
}
