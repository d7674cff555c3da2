//! Hands on the wire: the data for gestures and tools, in whole numbers, and the joints as
//! precisely as a picture of a hand needs them. A hand takes about 20 bytes a frame instead of 600.
//!
//! Palm and fingertips to 0.05 mm, the palm's turn to 1/2048, joints, wrist and elbow to 1 mm from
//! the palm. Velocity, widths and directions of fingers, the tracker's own pinch and its clocks are
//! left out: nothing in the engine uses them.

use glam::{Quat, Vec3};

use super::bytes::BadBytes;
use super::frame::PersonId;
use super::range_coder::{BitModel, Coder, NumberModel};
use sculptd_devices::sample::MAX_HANDS;
use sculptd_devices::{Body, Finger, Hand, Hands, Sample};

const PER_MM: f32 = 20.0;
const PER_ONE: f32 = 2048.0;
const PER_SHARE: f32 = 255.0;
/// The farthest, in steps: 20 m.
const FAR: f32 = 400_000.0;

/// Three numbers each, from `PALM` on; `TIPS` five times, `JOINTS` 25 times.
const PALM: usize = 0;
const NORMAL: usize = 3;
const ORIENTATION: usize = 6;
const SHARES: usize = 10;
const WIDTH: usize = 12;
const WRIST: usize = 13;
const ELBOW: usize = 16;
const TIPS: usize = 19;
const JOINTS: usize = 34;
const NUMBERS: usize = JOINTS + 75;

/// Bits of the shape, in their order.
const SHAPE_BITS: u32 = 49;

/// A hand in whole numbers. Missing values are 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct WholeHand {
    id: i32,
    /// Flags of the values present.
    shape: u64,
    numbers: [i32; NUMBERS],
}

impl Default for WholeHand {
    fn default() -> Self {
        WholeHand { id: 0, shape: 0, numbers: [0; NUMBERS] }
    }
}

fn quantised(value: f32, steps: f32) -> i32 {
    // NaN becomes 0.
    (value * steps).round().clamp(-FAR, FAR) as i32
}

/// Writes a shape bit by bit, or reads one.
struct Shape {
    bits: u64,
    at: u32,
}

impl Shape {
    fn put(&mut self, bit: bool) -> bool {
        self.bits |= u64::from(bit) << self.at;
        self.at += 1;
        bit
    }

    fn take(&mut self) -> bool {
        self.at += 1;
        self.bits >> (self.at - 1) & 1 != 0
    }
}

impl WholeHand {
    fn of(hand: &Hand) -> WholeHand {
        let mut numbers = [0; NUMBERS];
        let mut shape = Shape { bits: 0, at: 0 };
        let mut put = |at: usize, values: &[f32], steps: f32| {
            for (to, value) in numbers[at..].iter_mut().zip(values) {
                *to = quantised(*value, steps);
            }
        };
        put(PALM, &hand.palm.to_array(), PER_MM);
        // Relative to the palm as it is sent.
        let palm = Vec3::from(hand.palm.to_array().map(|x| quantised(x, PER_MM) as f32 / PER_MM));
        let two = |shape: &mut Shape, told: Option<bool>| {
            shape.put(told.is_some());
            shape.put(told == Some(true));
        };
        two(&mut shape, hand.left);
        let mut vector = |shape: &mut Shape, at, value: Option<Vec3>, from: Vec3, steps| {
            if shape.put(value.is_some()) {
                put(at, &(value.unwrap_or_default() - from).to_array(), steps);
            }
        };
        vector(&mut shape, NORMAL, hand.palm_normal, Vec3::ZERO, PER_ONE);
        vector(&mut shape, WRIST, hand.wrist, palm, 1.0);
        vector(&mut shape, ELBOW, hand.elbow, palm, 1.0);
        for (k, finger) in hand.fingers.iter().enumerate() {
            vector(&mut shape, TIPS + 3 * k, finger.map(|f| f.tip), palm, PER_MM);
            two(&mut shape, finger.and_then(|f| f.extended));
            for j in 0..5 {
                let joint = finger.and_then(|f| f.joints[j]);
                vector(&mut shape, JOINTS + 3 * (5 * k + j), joint, palm, 1.0);
            }
        }
        if shape.put(hand.orientation.is_some()) {
            put(ORIENTATION, &hand.orientation.unwrap_or_default().to_array(), PER_ONE);
        }
        let mut number = |shape: &mut Shape, at, value: Option<f32>, steps: f32| {
            if shape.put(value.is_some()) {
                put(at, &[value.unwrap_or_default()], steps);
            }
        };
        number(&mut shape, SHARES, hand.grab, PER_SHARE);
        number(&mut shape, SHARES + 1, hand.confidence, PER_SHARE);
        number(&mut shape, WIDTH, hand.palm_width, 4.0);
        debug_assert_eq!(shape.at, SHAPE_BITS);
        WholeHand { id: hand.id, shape: shape.bits, numbers }
    }

    fn hand(&self) -> Hand {
        let mut shape = Shape { bits: self.shape, at: 0 };
        let value = |at: usize, steps: f32| self.numbers[at] as f32 / steps;
        let vector =
            |at: usize, steps: f32| Vec3::from([0, 1, 2].map(|k: usize| value(at + k, steps)));
        let palm = vector(PALM, PER_MM);
        let two = |shape: &mut Shape| {
            let (some, yes) = (shape.take(), shape.take());
            some.then_some(yes && some)
        };
        let some = |shape: &mut Shape, at, steps| shape.take().then(|| vector(at, steps));
        let mut hand = Hand { id: self.id, palm, left: two(&mut shape), ..Hand::default() };
        hand.palm_normal = some(&mut shape, NORMAL, PER_ONE);
        hand.wrist = some(&mut shape, WRIST, 1.0).map(|v| palm + v);
        hand.elbow = some(&mut shape, ELBOW, 1.0).map(|v| palm + v);
        for (k, to) in hand.fingers.iter_mut().enumerate() {
            let tip = some(&mut shape, TIPS + 3 * k, PER_MM).map(|v| palm + v);
            let extended = two(&mut shape);
            let joints = [0, 1, 2, 3, 4]
                .map(|j| some(&mut shape, JOINTS + 3 * (5 * k + j), 1.0).map(|v| palm + v));
            *to = tip.map(|tip| Finger { joints, tip, extended, ..Finger::default() });
        }
        let turn = || Quat::from_array([0, 1, 2, 3].map(|k| value(ORIENTATION + k, PER_ONE)));
        hand.orientation = shape.take().then(turn);
        hand.grab = shape.take().then(|| value(SHARES, PER_SHARE));
        hand.confidence = shape.take().then(|| value(SHARES + 1, PER_SHARE));
        hand.palm_width = shape.take().then(|| value(WIDTH, 4.0));
        hand
    }
}

/// Hands as they are sent.
pub fn rounded(hands: &Hands) -> Hands {
    let mut out = Hands { frame: 0, count: hands.as_slice().len() as u8, ..Hands::default() };
    for (to, hand) in out.hands.iter_mut().zip(hands.as_slice()) {
        *to = WholeHand::of(hand).hand();
    }
    out
}

/// Directions and turns of unit length, as every replica steps them: rounded ones are not quite.
pub fn with_unit_lengths(sample: &mut Sample) {
    let Body::Hands(hands) = &mut sample.body else { return };
    for hand in &mut hands.hands {
        // Number by number: the same bits on every processor.
        if let Some(q) = hand.orientation {
            let length = (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w).sqrt();
            let turn = || Quat::from_xyzw(q.x / length, q.y / length, q.z / length, q.w / length);
            hand.orientation = (length > 0.5).then(turn);
        }
        if let Some(n) = hand.palm_normal {
            let length = (n.x * n.x + n.y * n.y + n.z * n.z).sqrt();
            hand.palm_normal = (length > 0.5).then(|| n / length);
        }
    }
}

#[derive(Debug)]
struct LastHand {
    person: PersonId,
    place: usize,
    hand: WholeHand,
    /// The palm's, from the frame before.
    moved: [i32; 3],
}

/// Probability models of hands.
#[derive(Debug)]
struct HandModels {
    id: BitModel,
    shape: BitModel,
    count: NumberModel,
    /// Palm, unit lengths, shares, wrist and elbow, tips, joints.
    numbers: [NumberModel; 6],
}

/// The model of a number, and the first number of each model's.
const KINDS: [usize; 6] = [PALM, NORMAL, SHARES, WRIST, TIPS, JOINTS];

/// Writes and reads the hands of one message.
#[derive(Debug, Default)]
pub struct HandsCodec {
    models: Option<Box<HandModels>>,
    hands: Vec<LastHand>,
}

impl HandsCodec {
    fn last(&mut self, person: PersonId, place: usize) -> &mut LastHand {
        let at = self.hands.iter().position(|l| l.person == person && l.place == place);
        let at = at.unwrap_or_else(|| {
            let hand = WholeHand::default();
            self.hands.push(LastHand { person, place, hand, moved: [0; 3] });
            self.hands.len() - 1
        });
        &mut self.hands[at]
    }

    fn follow_one(&mut self, person: PersonId, place: usize, now: WholeHand) {
        let last = self.last(person, place);
        let known = last.hand.shape != 0 && last.hand.id == now.id;
        last.moved = [0, 1, 2].map(|k: usize| match known {
            true => now.numbers[PALM + k] - last.hand.numbers[PALM + k],
            false => 0,
        });
        last.hand = now;
    }

    /// Hands that the other side has too are before the message.
    pub fn follow(&mut self, person: PersonId, hands: &Hands) {
        for (place, hand) in hands.as_slice().iter().enumerate() {
            self.follow_one(person, place, WholeHand::of(hand));
        }
    }

    /// Writes the rounded hands of a frame, or reads some.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes are of none.
    pub fn code(
        &mut self,
        c: &mut impl Coder,
        person: PersonId,
        hands: &Hands,
    ) -> Result<Hands, BadBytes> {
        let mut models = self.models.take().unwrap_or_else(|| {
            Box::new(HandModels {
                id: BitModel::RARE,
                shape: BitModel::RARE,
                count: NumberModel::default(),
                numbers: Default::default(),
            })
        });
        let count = c.number(&mut models.count, hands.as_slice().len() as u32)? as usize;
        if count > MAX_HANDS {
            return Err(BadBytes);
        }
        let mut read = Hands { frame: 0, count: count as u8, ..Hands::default() };
        for place in 0..count {
            let written = WholeHand::of(&hands.hands[place]);
            let last = self.last(person, place);
            let (mut now, moved) = (last.hand, last.moved);
            if c.bit(&mut models.id, written.id != now.id)? {
                now.id = c.bits(u64::from(written.id as u32), 32)? as u32 as i32;
            }
            if c.bit(&mut models.shape, written.shape != now.shape)? {
                now.shape = c.bits(written.shape, SHAPE_BITS)?;
            }
            for k in 0..NUMBERS {
                let kind = KINDS.iter().rposition(|first| k >= *first).unwrap_or(0);
                let expected = now.numbers[k] + if k < 3 { moved[k] } else { 0 };
                let difference = written.numbers[k].saturating_sub(expected);
                let value = expected.checked_add(c.signed(&mut models.numbers[kind], difference)?);
                let value = value.filter(|v| v.abs() <= FAR as i32).ok_or(BadBytes)?;
                now.numbers[k] = value;
            }
            read.hands[place] = now.hand();
            // Missing values are 0 again: a reader goes on from the values that a writer would see.
            self.follow_one(person, place, WholeHand::of(&read.hands[place]));
        }
        self.models = Some(models);
        Ok(read)
    }
}
