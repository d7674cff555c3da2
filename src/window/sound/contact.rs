//! The sound of a contact, computed: from what the hand does to samples, as a pure function.
//!
//! A stroke is noise through a low-pass filter of first order and a sine, which give the brush its
//! colour. A touch, a lift and each dab are short sines that die away. Laws kept here:
//! * No sample is louder than [`PEAK`], and none is anything but a number.
//! * Loudness never jumps: what begins or ends takes [`GLIDE_S`].
//! * Without a contact, soon after the last one, every sample is zero.
//! * The same voice and the same touches give the same samples, however they are cut into blocks.

use std::f32::consts::TAU;

use sculptd_clay::brush::BrushKind;

/// The loudest sample, of full scale: 20 dB below it.
pub const PEAK: f32 = 0.1;
/// Seconds in which loudness goes most of the way to another.
pub const GLIDE_S: f32 = 0.02;
/// Seconds in which a touch or a dab dies away to a third.
const KNOCK_S: f32 = 0.03;
/// Greatest loudness of a stroke and of the touches on it, as shares of [`PEAK`]; together at most
/// 1.
const SHARES: (f32, f32) = (0.6, 0.4);
/// Loudness of a lift and of a dab, relative to a touch.
const LIFT: f32 = 0.4;
const DAB: f32 = 0.25;
/// View heights a second at which a stroke is half as loud, and as bright, as it can be.
const BRISK: f32 = 0.8;
/// A stroke that rests is so loud, of one that moves.
const RESTING: f32 = 0.3;
/// Share of the loudest below which the sound is silence: 80 dB.
const SILENT: f32 = 1e-4;

/// Contact with the clay at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touch {
    pub brush: BrushKind,
    /// Takes away instead of adding.
    pub carves: bool,
    /// 0 none to 1; anything else is taken as the nearest, no number as none.
    pub pressure: f32,
    /// Heights of the view a second, from 0.
    pub speed: f32,
    /// Counts dabs, and wraps round: another number is one more to be heard.
    pub dabs: u32,
}

/// The colour of a brush: its pitch, hertz; how much of it is noise, 0 to 1; how bright that is at
/// most, hertz.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Colour {
    pitch: f32,
    noise: f32,
    bright: f32,
}

fn colour(touch: &Touch) -> Colour {
    let (pitch, noise, bright) = match touch.brush {
        BrushKind::Smooth
        | BrushKind::Relax
        | BrushKind::SlideRelax
        | BrushKind::SurfaceSmooth
        | BrushKind::Density
        | BrushKind::Simplify => (220.0, 0.9, 700.0),
        BrushKind::Flatten | BrushKind::Plane | BrushKind::Scrape => (196.0, 0.8, 3000.0),
        BrushKind::Crease | BrushKind::Pinch => (330.0, 0.4, 2400.0),
        BrushKind::Grab | BrushKind::SnakeHook => (110.0, 0.2, 500.0),
        BrushKind::Paint | BrushKind::Mask | BrushKind::DrawFaceSets => (262.0, 0.85, 1800.0),
        _ => (147.0, 0.6, 1200.0),
    };
    // A fourth lower.
    let pitch = if touch.carves { pitch * 0.75 } else { pitch };
    Colour { pitch, noise, bright }
}

/// State of the sound, from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voice {
    /// Phases of the stroke's sine and of the knock's, in turns.
    phases: [f32; 2],
    /// Loudness of the stroke and of the knock, 0 to 1.
    levels: [f32; 2],
    /// The knock's pitch, hertz.
    knock: f32,
    /// State of the low-pass filter.
    filtered: f32,
    /// The state of the noise; never 0.
    noise: u32,
    touching: bool,
    dabs: u32,
}

impl Default for Voice {
    fn default() -> Voice {
        Voice {
            phases: [0.0; 2],
            levels: [0.0; 2],
            knock: 0.0,
            filtered: 0.0,
            noise: 0x9e37_79b9,
            touching: false,
            dabs: 0,
        }
    }
}

/// A number within bounds; what is none is the least.
fn bounded(x: f32, most: f32) -> f32 {
    if x.is_finite() { x.clamp(0.0, most) } else { 0.0 }
}

/// The samples of one block, mono, during which `touch` does not change; and the voice after it.
/// `rate`: samples a second, at least 8000.
pub fn sound(mut voice: Voice, touch: &Touch, rate: f32, out: &mut [f32]) -> Voice {
    let rate = if rate.is_finite() { rate.max(8_000.0) } else { 48_000.0 };
    let (pressure, speed) = (bounded(touch.pressure, 1.0), bounded(touch.speed, 100.0));
    let colour = colour(touch);
    let touching = pressure > 0.0;
    let strength = 0.3 + 0.7 * pressure;
    if touching != voice.touching {
        let (level, pitch) = if touching { (strength, 2.0) } else { (LIFT, 1.0) };
        voice.knock(level, colour.pitch * pitch);
    } else if touching && touch.dabs != voice.dabs {
        voice.knock(DAB * strength, colour.pitch * 2.0);
    }
    (voice.touching, voice.dabs) = (touching, touch.dabs);
    let lively = speed / (speed + BRISK);
    // Loudness is felt as a power of the amplitude: half the pressure is to be heard as half.
    let loud = pressure.powf(1.5) * (RESTING + (1.0 - RESTING) * lively);
    let glide = 1.0 - (-1.0 / (GLIDE_S * rate)).exp();
    let fade = (-1.0 / (KNOCK_S * rate)).exp();
    let cutoff = colour.bright * (0.25 + 0.75 * lively);
    let open = 1.0 - (-TAU * cutoff / rate).exp();
    for sample in out {
        voice.levels[0] += (loud - voice.levels[0]) * glide;
        voice.levels[1] *= fade;
        for (level, goal) in voice.levels.iter_mut().zip([loud, 0.0]) {
            if goal == 0.0 && *level < SILENT {
                *level = 0.0;
            }
        }
        if voice.levels == [0.0; 2] {
            *sample = 0.0;
            continue;
        }
        for (phase, pitch) in voice.phases.iter_mut().zip([colour.pitch, voice.knock]) {
            *phase = (*phase + pitch / rate).fract();
        }
        voice.filtered += (voice.hiss() - voice.filtered) * open;
        let [tone, knock] = voice.phases.map(|phase| (phase * TAU).sin());
        let stroke = tone + (voice.filtered - tone) * colour.noise;
        let heard = SHARES.0 * stroke * voice.levels[0] + SHARES.1 * knock * voice.levels[1];
        *sample = PEAK * heard.clamp(-1.0, 1.0);
    }
    voice
}

impl Voice {
    /// Returns true if the sound has faded out.
    pub fn is_silent(&self) -> bool {
        !self.touching && self.levels == [0.0; 2]
    }

    /// One that is still heard and louder goes on.
    fn knock(&mut self, level: f32, pitch: f32) {
        if level > self.levels[1] {
            // From where a sine is zero.
            (self.levels[1], self.knock, self.phases[1]) = (level, pitch, 0.0);
        }
    }

    /// White noise, -1 to 1, by xorshift (Marsaglia, Xorshift RNGs, 2003).
    fn hiss(&mut self) -> f32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        self.noise as i32 as f32 / 2_147_483_648.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f32 = 48_000.0;

    fn seconds(voice: Voice, touch: &Touch, s: f32) -> (Voice, Vec<f32>) {
        let mut out = vec![f32::NAN; (s * RATE) as usize];
        let voice = sound(voice, touch, RATE, &mut out);
        (voice, out)
    }

    fn loudness(samples: &[f32]) -> f32 {
        (samples.iter().map(|s| s * s).sum::<f32>() / samples.len() as f32).sqrt()
    }

    /// The loudness of a stroke under way, without its beginning.
    fn stroke(touch: &Touch) -> Vec<f32> {
        let (voice, _) = seconds(Voice::default(), touch, 0.5);
        seconds(voice, touch, 0.5).1
    }

    /// The share of the power that one pitch has: the Goertzel sum.
    fn share(samples: &[f32], hertz: f32) -> f32 {
        let turn = |i: usize| i as f32 / RATE * hertz * TAU;
        let sum = |f: fn(f32) -> f32| -> f32 {
            samples.iter().enumerate().map(|(i, s)| s * f(turn(i).rem_euclid(TAU))).sum()
        };
        let n = samples.len() as f32;
        let power = (sum(f32::cos).powi(2) + sum(f32::sin).powi(2)) * 2.0 / (n * n);
        power / loudness(samples).powi(2)
    }

    fn grab(pressure: f32, speed: f32) -> Touch {
        Touch { brush: BrushKind::Grab, pressure, speed, ..Touch::default() }
    }

    #[test]
    fn without_a_contact_there_is_no_sound() {
        let (voice, out) = seconds(Voice::default(), &Touch { dabs: 9, ..Touch::default() }, 1.0);
        assert!(out.iter().all(|s| *s == 0.0));
        assert!(voice.is_silent());
        // After one it dies away, and is none.
        let (voice, _) = seconds(Voice::default(), &grab(1.0, 1.0), 0.3);
        assert!(!voice.is_silent());
        let (voice, lift) = seconds(voice, &grab(0.0, 0.0), 1.0);
        assert!(voice.is_silent() && loudness(&lift) > 0.0);
        assert!(lift[lift.len() / 2..].iter().all(|s| *s == 0.0));
    }

    #[test]
    fn it_is_quiet_whatever_is_asked_for() {
        let odd = [f32::NAN, f32::INFINITY, -1.0, 1e30, 0.7];
        for kind in BrushKind::ALL {
            for (i, pressure) in odd.into_iter().enumerate() {
                let mut voice = Voice::default();
                for (dabs, speed) in odd.into_iter().enumerate() {
                    let touch = Touch {
                        brush: *kind,
                        carves: i % 2 == 0,
                        pressure,
                        speed,
                        dabs: dabs as u32,
                    };
                    let (next, out) = seconds(voice, &touch, 0.02);
                    assert!(out.iter().all(|s| s.abs() <= PEAK), "{touch:?}");
                    voice = next;
                }
            }
        }
        let mut out = [0.0; 64];
        sound(Voice::default(), &grab(1.0, 1.0), f32::NAN, &mut out);
        assert!(out.iter().all(|s| s.is_finite()));
    }

    #[test]
    fn more_pressure_and_more_speed_are_louder() {
        let heard = |pressure, speed| loudness(&stroke(&grab(pressure, speed)));
        assert!(heard(0.9, 1.0) > 1.5 * heard(0.5, 1.0));
        assert!(heard(0.5, 1.0) > 1.5 * heard(0.2, 1.0));
        assert!(heard(0.5, 3.0) > 1.2 * heard(0.5, 0.5));
        assert!(heard(0.5, 0.0) > 0.0, "a hand that rests is heard");
        // 20 dB and more below full scale, also at its loudest.
        assert!(heard(1.0, 100.0) < PEAK * 0.6);
    }

    #[test]
    fn speed_is_brightness() {
        // Changes of sign a second grow with the pitch of noise.
        let bright = |speed: f32| {
            let touch =
                Touch { brush: BrushKind::Scrape, pressure: 0.8, speed, ..Touch::default() };
            stroke(&touch).windows(2).filter(|w| (w[0] < 0.0) != (w[1] < 0.0)).count()
        };
        assert!(bright(4.0) > bright(0.1) * 5 / 4, "{} and {}", bright(4.0), bright(0.1));
    }

    #[test]
    fn a_brush_has_its_pitch_and_carving_is_a_fourth_lower() {
        let raised = stroke(&grab(0.8, 0.5));
        let carved = stroke(&Touch { carves: true, ..grab(0.8, 0.5) });
        assert!(share(&raised, 110.0) > 0.9, "{}", share(&raised, 110.0));
        assert!(share(&carved, 82.5) > 0.9, "{}", share(&carved, 82.5));
        let smooth = Touch { brush: BrushKind::Smooth, ..grab(0.8, 0.5) };
        assert!(share(&stroke(&smooth), 220.0) < 0.5, "mostly noise");
    }

    #[test]
    fn a_touch_and_a_dab_are_heard_once() {
        // Light enough that the stroke itself is hardly heard.
        let light = grab(0.02, 0.0);
        let (voice, first) = seconds(Voice::default(), &light, 0.2);
        assert!(loudness(&first[..4_800]) > 4.0 * loudness(&first[7_000..]));
        let (voice, later) = seconds(voice, &light, 0.2);
        assert!(loudness(&later) < 0.1 * loudness(&first), "the touch was once");
        let (voice, dab) = seconds(voice, &Touch { dabs: 1, ..light }, 0.1);
        assert!(loudness(&dab) > 3.0 * loudness(&later));
        let (_, same) = seconds(voice, &Touch { dabs: 1, ..light }, 0.1);
        assert!(loudness(&same) < 0.3 * loudness(&dab));
    }

    #[test]
    fn nothing_jumps() {
        // A full stroke that begins, turns into another brush, and ends.
        let mut all = Vec::new();
        let mut voice = Voice::default();
        for touch in [grab(1.0, 0.2), grab(0.3, 0.2), grab(1.0, 2.0), grab(0.0, 0.0)] {
            let (next, out) = seconds(voice, &touch, 0.1);
            all.extend(out);
            voice = next;
        }
        let step = all.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f32::max);
        assert!(step < 0.15 * PEAK, "{step}");
    }

    #[test]
    fn blocks_of_any_length_are_the_same_sound() {
        let touch = Touch { brush: BrushKind::Clay, dabs: 3, ..grab(0.7, 1.3) };
        let (end, whole) = seconds(Voice::default(), &touch, 0.25);
        for block in [1, 7, 480, 4096] {
            let mut cut = vec![0.0; whole.len()];
            let mut voice = Voice::default();
            for out in cut.chunks_mut(block) {
                voice = sound(voice, &touch, RATE, out);
            }
            assert!(cut == whole && voice == end, "blocks of {block}");
        }
    }
}
