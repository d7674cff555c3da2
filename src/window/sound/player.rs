//! Plays the sound of a contact on the usual device, by cpal.
//!
//! A separate thread opens, starts and stops the device, because a sound server may be slow.
//! Atomics pass the contact to the sound system's thread: neither thread waits for the other, and
//! nothing is allocated once a stream exists.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{FromSample, Sample, SampleFormat, SizedSample, Stream, StreamConfig};
use crossbeam_channel::{Receiver, Sender, bounded, unbounded};
use sculptd_clay::brush::BrushKind;

use super::contact::{Touch, Voice, sound};
use super::no_sound::NoSound;

/// Samples that are computed at a time.
const BLOCK: usize = 256;

/// The newest touch. Its numbers are written one by one: a block that has some of the next touch
/// is a block between two.
#[derive(Debug, Default)]
struct SharedTouch {
    pressure: AtomicU32,
    speed: AtomicU32,
    /// The index of the brush in [`BrushKind::ALL`], times two, plus one where it carves.
    brush: AtomicU32,
    dabs: AtomicU32,
}

impl SharedTouch {
    fn set(&self, touch: &Touch) {
        let index = BrushKind::ALL.iter().position(|k| *k == touch.brush).unwrap_or(0) as u32;
        self.pressure.store(touch.pressure.to_bits(), Relaxed);
        self.speed.store(touch.speed.to_bits(), Relaxed);
        self.brush.store(index * 2 + u32::from(touch.carves), Relaxed);
        self.dabs.store(touch.dabs, Relaxed);
    }

    fn get(&self) -> Touch {
        let brush = self.brush.load(Relaxed);
        Touch {
            brush: BrushKind::ALL.get(brush as usize / 2).copied().unwrap_or_default(),
            carves: brush % 2 == 1,
            pressure: f32::from_bits(self.pressure.load(Relaxed)),
            speed: f32::from_bits(self.speed.load(Relaxed)),
            dabs: self.dabs.load(Relaxed),
        }
    }
}

/// A device that plays, or is about to. Dropped, it is closed.
#[derive(Debug)]
pub struct Player {
    shared: Arc<SharedTouch>,
    /// Sends whether the stream runs; dropping it closes the device.
    runs: Sender<bool>,
    running: bool,
    failed: Receiver<NoSound>,
}

impl Player {
    /// Begins to open the usual device; it is silent until [`Player::play`].
    ///
    /// # Errors
    /// [`NoSound::Failed`] if its thread cannot be started. A fault of the device is reported
    /// later, by [`Player::play`].
    pub fn open() -> Result<Player, NoSound> {
        let shared = Arc::new(SharedTouch::default());
        let (runs, wanted) = unbounded();
        let (say, failed) = bounded(1);
        let heard = shared.clone();
        let serve = move || {
            if let Err(e) = serve(&wanted, &heard, &say) {
                let _ = say.try_send(NoSound::Failed(e));
            }
        };
        std::thread::Builder::new()
            .name("sculptd-sound".into())
            .spawn(serve)
            .map_err(|e| NoSound::Failed(e.to_string()))?;
        Ok(Player { shared, runs, running: false, failed })
    }

    /// Lets this touch be heard, while the stream `runs`. Says what is wrong with the device, once.
    pub fn play(&mut self, touch: &Touch, runs: bool) -> Option<NoSound> {
        self.shared.set(touch);
        if runs != self.running {
            self.running = runs;
            let _ = self.runs.send(runs);
        }
        self.failed.try_recv().ok()
    }
}

/// Opens the device when something is to be heard for the first time, and starts and stops it until
/// the other end is gone.
fn serve(
    wanted: &Receiver<bool>,
    shared: &Arc<SharedTouch>,
    say: &Sender<NoSound>,
) -> Result<(), String> {
    let mut stream = None;
    while let Ok(runs) = wanted.recv() {
        if !runs {
            if let Some(stream) = &stream {
                Stream::pause(stream).map_err(|e| e.to_string())?;
            }
            continue;
        }
        let open = match stream.take() {
            Some(open) => open,
            None => open(shared, say)?,
        };
        open.play().map_err(|e| e.to_string())?;
        stream = Some(open);
    }
    Ok(())
}

fn open(shared: &Arc<SharedTouch>, say: &Sender<NoSound>) -> Result<Stream, String> {
    let host = cpal::default_host();
    let device = host.default_output_device().ok_or("the computer has no device that plays")?;
    let usual = device.default_output_config().map_err(|e| e.to_string())?;
    let config = usual.config();
    let (shared, say) = (shared.clone(), say.clone());
    match usual.sample_format() {
        SampleFormat::F32 => build::<f32>(&device, config, shared, say),
        SampleFormat::I16 => build::<i16>(&device, config, shared, say),
        SampleFormat::I32 => build::<i32>(&device, config, shared, say),
        SampleFormat::U16 => build::<u16>(&device, config, shared, say),
        other => Err(format!("the device takes samples as {other} only")),
    }
}

fn build<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: StreamConfig,
    shared: Arc<SharedTouch>,
    say: Sender<NoSound>,
) -> Result<Stream, String> {
    let (rate, channels) = (config.sample_rate as f32, usize::from(config.channels.max(1)));
    let mut voice = Voice::default();
    let fill = move |out: &mut [T], _: &cpal::OutputCallbackInfo| {
        voice = interleaved(voice, &shared.get(), (rate, channels), out);
    };
    let wrong = move |e: cpal::Error| {
        let _ = say.try_send(NoSound::Failed(e.to_string()));
    };
    device.build_output_stream(config, fill, wrong, None).map_err(|e| e.to_string())
}

/// The same sound in every channel.
fn interleaved<T: Sample + FromSample<f32>>(
    mut voice: Voice,
    touch: &Touch,
    (rate, channels): (f32, usize),
    out: &mut [T],
) -> Voice {
    let mut mono = [0.0; BLOCK];
    for frames in out.chunks_mut(BLOCK * channels) {
        let mono = &mut mono[..frames.len().div_ceil(channels)];
        voice = sound(voice, touch, rate, mono);
        for (frame, sample) in frames.chunks_mut(channels).zip(mono) {
            frame.fill(T::from_sample(*sample));
        }
    }
    voice
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_has_the_same_and_nothing_is_left_out() {
        let touch = Touch { pressure: 0.8, speed: 1.0, ..Touch::default() };
        let mut mono = vec![0.0; 1000];
        let end = sound(Voice::default(), &touch, 44_100.0, &mut mono);
        let mut stereo = vec![f32::NAN; 2000];
        assert_eq!(interleaved(Voice::default(), &touch, (44_100.0, 2), &mut stereo), end);
        for (frame, sample) in stereo.chunks(2).zip(&mono) {
            assert_eq!(frame, [*sample; 2]);
        }
        let mut whole = vec![0i16; 1000];
        interleaved(Voice::default(), &touch, (44_100.0, 1), &mut whole);
        let close = |(a, b): (&i16, &f32)| (f32::from(*a) / 32_768.0 - b).abs() < 1e-4;
        assert!(whole.iter().zip(&mono).all(close));
    }

    #[test]
    fn a_touch_comes_through_as_it_was() {
        let shared = SharedTouch::default();
        for (i, brush) in BrushKind::ALL.iter().enumerate() {
            let touch = Touch {
                brush: *brush,
                carves: i % 2 == 0,
                pressure: 0.1 * i as f32,
                speed: 3.5,
                dabs: u32::MAX - i as u32,
            };
            shared.set(&touch);
            assert_eq!(shared.get(), touch);
        }
    }
}
