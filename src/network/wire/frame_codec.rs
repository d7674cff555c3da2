//! Frames and batches as bytes, by a range coder ([`super::range_coder`]).
//!
//! Frames are encoded as differences to earlier frames that the receiver is known to have; the
//! message names those. So a lost message makes no other one unreadable.

use std::sync::Arc;

use super::bytes::{BadBytes, ByteReader, put_number};
use super::frame::{
    Arrival, Batch, Frame, MAX_BATCHES, MAX_COMMAND, MAX_ENTRIES, MAX_TICKS, Mark, PersonId,
};
use super::range_coder::{BitModel, Coder, Decoder, Encoder, NumberModel};
use super::samples::SampleCodec;
use sculptd_devices::{Body, DeviceId, Pad, Sample};

/// Frames before a message from which it goes on: whoever sculpts has samples in the last two.
const CONTEXT: u64 = 16;
/// Frames of one message.
const MAX_FRAMES: u32 = 4096;
/// Samples and batches of one message.
const MAX_MESSAGE: usize = 32_768;
/// Bytes of somebody's arrival.
const MAX_ARRIVAL: usize = 128;

/// Probability models of batches and frames.
#[derive(Debug)]
struct FrameModels {
    other_person: BitModel,
    other_number: BitModel,
    samples: NumberModel,
    commands: BitModel,
    batches: NumberModel,
    ticks: NumberModel,
    mark: BitModel,
    arrivals: BitModel,
}

impl Default for FrameModels {
    fn default() -> Self {
        let number = NumberModel::default;
        let rare = BitModel::RARE;
        FrameModels {
            other_person: rare,
            other_number: rare,
            samples: number(),
            commands: rare,
            batches: number(),
            ticks: number(),
            mark: rare,
            arrivals: rare,
        }
    }
}

/// Writes and reads the batches of one message.
#[derive(Debug, Default)]
struct FrameCodec {
    samples: SampleCodec,
    models: Box<FrameModels>,
    /// Everybody's last batch.
    numbers: Vec<(PersonId, u64)>,
    /// Whose the batches of the last frame were.
    order: Vec<PersonId>,
    /// Samples and batches so far.
    entries: usize,
}

impl FrameCodec {
    fn number(&mut self, person: PersonId) -> &mut u64 {
        let at = self.numbers.iter().position(|n| n.0 == person).unwrap_or_else(|| {
            self.numbers.push((person, 0));
            self.numbers.len() - 1
        });
        &mut self.numbers[at].1
    }

    /// The other side has this frame too.
    fn follow(&mut self, frame: &Frame) {
        for batch in &frame.batches {
            *self.number(batch.person) = batch.number;
            for sample in &batch.samples {
                self.samples.follow(batch.person, sample);
            }
        }
        self.order = frame.batches.iter().map(|b| b.person).collect();
    }

    fn count(&mut self) -> Result<(), BadBytes> {
        self.entries += 1;
        if self.entries <= MAX_MESSAGE { Ok(()) } else { Err(BadBytes) }
    }

    fn batch(
        &mut self,
        c: &mut impl Coder,
        place: usize,
        batch: &Batch,
    ) -> Result<Batch, BadBytes> {
        self.count()?;
        let mut person = self.order.get(place).copied().unwrap_or(0);
        if c.bit(&mut self.models.other_person, batch.person != person)? {
            person = c.bits(u64::from(batch.person), 8)? as u8;
        }
        let mut number = self.number(person).wrapping_add(1);
        if c.bit(&mut self.models.other_number, batch.number != number)? {
            number = c.bits(batch.number, 64)?;
        }
        *self.number(person) = number;
        let count = c.number(&mut self.models.samples, batch.samples.len() as u32)? as usize;
        if count > MAX_ENTRIES {
            return Err(BadBytes);
        }
        let mut read = Batch { person, number, ..Batch::default() };
        let none = Body::Pad(Pad::default());
        let none = Sample { device: DeviceId(0), t_us: 0, device_t_us: None, body: none };
        for k in 0..count {
            self.count()?;
            let sample = batch.samples.get(k).unwrap_or(&none);
            read.samples.push(self.samples.code(c, person, sample)?);
        }
        if c.bit(&mut self.models.commands, !batch.commands.is_empty())? {
            let count = c.bits(batch.commands.len() as u64, 16)? as usize;
            if count > MAX_ENTRIES {
                return Err(BadBytes);
            }
            for k in 0..count {
                let written = batch.commands.get(k).map(postcard::to_stdvec);
                let written = written.and_then(Result::ok).unwrap_or_default();
                let bytes = c.bytes(&written, MAX_COMMAND)?;
                // A writer reads nothing.
                if batch.commands.is_empty() {
                    read.commands.push(postcard::from_bytes(&bytes).map_err(|_| BadBytes)?);
                }
            }
        }
        Ok(read)
    }

    fn batches(&mut self, c: &mut impl Coder, batches: &[Batch]) -> Result<Vec<Batch>, BadBytes> {
        let expected = self.order.len() as i32;
        let more = c.signed(&mut self.models.batches, batches.len() as i32 - expected)?;
        let count = expected.checked_add(more).ok_or(BadBytes)?;
        let count = usize::try_from(count).ok().filter(|n| *n <= MAX_BATCHES).ok_or(BadBytes)?;
        let (none, mut read) = (Batch::default(), Vec::new());
        for k in 0..count {
            read.push(self.batch(c, k, batches.get(k).unwrap_or(&none))?);
        }
        self.order = read.iter().map(|b| b.person).collect();
        Ok(read)
    }

    fn frame(
        &mut self,
        c: &mut impl Coder,
        (index, tick): (u64, u64),
        frame: &Frame,
    ) -> Result<Frame, BadBytes> {
        let passed = frame.tick.saturating_sub(tick).min(MAX_TICKS) as u32;
        let passed = c.number(&mut self.models.ticks, passed)?;
        let tick = tick.checked_add(u64::from(passed)).ok_or(BadBytes)?;
        let mut read = Frame { index, tick, ..Frame::default() };
        if c.bit(&mut self.models.mark, frame.mark != Mark::None)? {
            let checkpoint = c.bits(u64::from(frame.mark == Mark::Checkpoint), 1)? != 0;
            read.mark = if checkpoint { Mark::Checkpoint } else { Mark::Compare };
        }
        if c.bit(&mut self.models.arrivals, !frame.arrivals.is_empty())? {
            for k in 0..c.bits(frame.arrivals.len() as u64, 8)? as usize {
                let mut written = Vec::new();
                if let Some(arrival) = frame.arrivals.get(k) {
                    arrival.put(&mut written);
                }
                let bytes = c.bytes(&written, MAX_ARRIVAL)?;
                if frame.arrivals.is_empty() {
                    read.arrivals.push(Arrival::take(&mut ByteReader::new(&bytes))?);
                }
            }
        }
        read.batches = self.batches(c, &frame.batches)?;
        Ok(read)
    }
}

/// Appends batches, up to the end of a message.
pub fn put_batches(out: &mut Vec<u8>, batches: &[Batch]) {
    let mut encoder = Encoder::default();
    // A writer does not fail.
    let _ = FrameCodec::default().batches(&mut encoder, batches);
    encoder.finish(out);
}

/// Reads batches, up to the end of a message.
///
/// # Errors
/// [`BadBytes`] where they are none.
pub fn take_batches(bytes: ByteReader<'_>) -> Result<Vec<Batch>, BadBytes> {
    let mut decoder = Decoder::new(bytes)?;
    let batches = FrameCodec::default().batches(&mut decoder, &[])?;
    decoder.end()?;
    Ok(batches)
}

/// The frames that somebody has, for what is written as differences to them.
pub trait KnownFrames {
    /// The index of the last frame.
    fn last_index(&self) -> u64;
    /// At most so many frames from that index on; `None`: they are kept no more.
    fn frames_from(&self, first: u64, most: usize) -> Option<Vec<Arc<Frame>>>;
}

/// The frames after `from` up to `base`, of which the writer knows that the reader has them.
fn context(log: &impl KnownFrames, from: u64, base: u64) -> Option<FrameCodec> {
    let mut codec = FrameCodec::default();
    if base < from || base - from > CONTEXT || base > log.last_index() {
        return None;
    }
    for frame in log.frames_from(from + 1, (base - from) as usize)? {
        codec.follow(&frame);
    }
    Some(codec)
}

/// Frames that follow each other, as bytes for somebody who has the frames after `first` up to
/// `have` as the log has them.
pub fn frames_to_bytes(
    frames: &[Arc<Frame>],
    log: &impl KnownFrames,
    (first, have): (u64, u64),
) -> Vec<u8> {
    let mut out = Vec::new();
    let Some(next) = frames.first() else { return out };
    let base = have.min(next.index - 1);
    let from = first.max(base.saturating_sub(CONTEXT)).min(base);
    let found = context(log, from, base);
    let known = found.as_ref().map_or(0, |_| base - from);
    put_number(&mut out, frames.len() as u64);
    put_number(&mut out, next.index);
    put_number(&mut out, next.index - 1 - base);
    put_number(&mut out, known);
    put_number(&mut out, next.tick);
    let (mut codec, mut encoder) = (found.unwrap_or_default(), Encoder::default());
    let mut at = (next.index, next.tick);
    for frame in frames {
        let _ = codec.frame(&mut encoder, at, frame);
        at = (frame.index + 1, frame.tick);
    }
    encoder.finish(&mut out);
    out
}

/// Reads frames that follow each other. `None`: they go on from frames that are not here.
///
/// # Errors
/// [`BadBytes`] where they are none.
pub fn frames_from_bytes(
    bytes: &[u8],
    log: &impl KnownFrames,
) -> Result<Option<Vec<Frame>>, BadBytes> {
    if bytes.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let mut b = ByteReader::new(bytes);
    let count = b.at_most(u64::from(MAX_FRAMES))?;
    let first = b.at_most(u64::MAX >> 1)?;
    let base = first.checked_sub(1).and_then(|f| f.checked_sub(b.number().ok()?));
    let base = base.ok_or(BadBytes)?;
    let known = b.at_most(CONTEXT)?;
    let mut tick = b.at_most(u64::MAX >> 1)?;
    let mut codec = FrameCodec::default();
    if known > 0 {
        let from = base.checked_sub(known).ok_or(BadBytes)?;
        match context(log, from, base) {
            Some(found) => codec = found,
            None => return Ok(None),
        }
    }
    let mut decoder = Decoder::new(b)?;
    let mut frames = Vec::new();
    for index in first..first + count {
        let frame = codec.frame(&mut decoder, (index, tick), &Frame::default())?;
        tick = frame.tick;
        frames.push(frame);
    }
    decoder.end()?;
    Ok(Some(frames))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replica_log::ReplicaLog;
    use sculptd_devices::Pen;

    fn frame(index: u64, people: u8) -> Arc<Frame> {
        let sample = |person: u8| {
            let x = index as f32 * 0.4 + f32::from(person);
            let pos_mm = glam::Vec2::new(x, 50.0 + (x * 0.3).sin() * 4.0);
            let area_mm = glam::Vec2::new(224.0, 148.0);
            let pressure = Some(0.5 + 0.3 * (x * 0.2).sin());
            let pen =
                Pen { in_range: true, tip: true, pos_mm, area_mm, pressure, ..Pen::default() };
            let body = Body::Pen(pen);
            let sample = Sample { device: DeviceId(1), t_us: 0, device_t_us: None, body };
            super::super::samples::rounded(&sample).expect("a pen")
        };
        let batch = |person| Batch {
            person,
            number: index,
            samples: vec![sample(person)],
            commands: vec![],
        };
        let batches = (1..=people).map(batch).collect();
        Arc::new(Frame { index, tick: index * 2, batches, ..Frame::default() })
    }

    fn same(read: &[Frame], written: &[Arc<Frame>]) {
        assert_eq!(read.len(), written.len());
        for (a, b) in read.iter().zip(written) {
            assert_eq!(format!("{a:?}"), format!("{b:?}"));
        }
    }

    #[test]
    fn frames_go_on_from_those_that_both_sides_have_and_from_no_others() {
        let mut log = ReplicaLog::at(100, 200, vec![], vec![]);
        (101..=160).for_each(|k| assert!(log.append(&frame(k, 8))));
        let frames = log.from(141, 6).expect("kept");
        // The reader has less, but what the writer knows of.
        let mut reader = ReplicaLog::at(110, 220, vec![], vec![]);
        (111..=135).for_each(|k| assert!(reader.append(&frame(k, 8))));
        let known = frames_to_bytes(&frames, &log, (110, 135));
        let read = frames_from_bytes(&known, &reader).expect("whole").expect("known");
        same(&read, &frames);
        let cold = frames_to_bytes(&frames, &log, (140, 140));
        same(&frames_from_bytes(&cold, &reader).expect("whole").expect("known"), &frames);
        assert!(known.len() * 4 < cold.len() * 3, "{} and {}", known.len(), cold.len());
        // A reader without the earlier frames reports this, and reads nothing else instead.
        let mut late = ReplicaLog::at(110, 220, vec![], vec![]);
        (111..=134).for_each(|k| assert!(late.append(&frame(k, 8))));
        assert!(matches!(frames_from_bytes(&known, &late), Ok(None)));
        for cut in 1..known.len() {
            let read = frames_from_bytes(&known[..cut], &reader);
            assert!(matches!(read, Err(BadBytes)), "at {cut} of {}", known.len());
        }
    }
}
