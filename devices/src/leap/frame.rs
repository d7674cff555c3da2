//! One message of the tracker, from text to [`Hands`].

use std::borrow::Cow;

use glam::{Mat3, Quat, Vec3};
use serde::Deserialize;

use super::lenient::{Scalar, Triple};
use crate::sample::{Finger, Hand, Hands, MAX_HANDS};

/// Longest message that is looked at, in bytes. Real frames with two hands and all bones have
/// 14,000.
pub const MAX_MESSAGE: usize = 256 * 1024;

/// Deepest nesting that is looked at. Real frames reach 6 (message, pointables, pointable, bases,
/// matrix, row).
pub const MAX_DEPTH: usize = 16;

/// Hands and fingers past these are not even looked at: 10 people's worth.
const MAX_LISTED: usize = 128;

/// Why a message gave nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The message has so many bytes.
    #[error("message of {0} bytes, more than {MAX_MESSAGE}")]
    TooLong(usize),
    /// Arrays and objects are nested too deeply, at this byte.
    #[error("nested deeper than {MAX_DEPTH} at byte {0}")]
    TooDeep(usize),
    /// The text is not JSON; the parser's reason.
    #[error("not JSON: {0}")]
    NotJson(String),
    /// The text is a message of another kind.
    #[error("a message, but not a frame")]
    NotAFrame,
}

/// A message of the server.
#[derive(Debug, Clone, PartialEq)]
// Nearly every message is a frame; a box would cost each of them an allocation.
#[allow(clippy::large_enum_variant)]
pub enum Message {
    /// The first message of a connection: the protocol's version, where it is stated.
    Version(Option<i64>),
    /// A tracker was attached or detached, or it started or stopped streaming.
    Device {
        /// A tracker is plugged in; `None` where the message does not say.
        attached: Option<bool>,
        /// It streams; `None` where the message does not say.
        streaming: Option<bool>,
    },
    /// A frame.
    Frame(Frame),
    /// Well-formed, and nothing that this client knows.
    Other,
}

/// A decoded frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Every hand of the frame.
    pub hands: Hands,
    /// Microseconds on the tracker's clock; its origin is unknown.
    pub device_t_us: Option<u64>,
    /// Frames a second as the tracker states them.
    pub rate: Option<f32>,
    /// Hands left out: over [`MAX_HANDS`], with no palm position, or with an id already taken.
    pub dropped_hands: u32,
    /// The text held `nan` or `inf`, which is not JSON; those numbers were read as absent.
    pub repaired: bool,
}

#[derive(Deserialize)]
struct RawMessage {
    version: Option<Scalar>,
    event: Option<RawEvent>,
    #[serde(default)]
    id: Scalar,
    #[serde(default)]
    timestamp: Scalar,
    #[serde(default, rename = "currentFrameRate")]
    rate: Scalar,
    hands: Option<Vec<RawHand>>,
    #[serde(default)]
    pointables: Option<Vec<RawFinger>>,
}

#[derive(Deserialize)]
struct RawEvent {
    state: Option<RawState>,
}

#[derive(Deserialize)]
struct RawState {
    #[serde(default)]
    attached: Scalar,
    #[serde(default)]
    streaming: Scalar,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct RawHand {
    id: Scalar,
    #[serde(rename = "type")]
    side: Scalar,
    palm_position: Triple,
    palm_normal: Triple,
    palm_velocity: Triple,
    direction: Triple,
    grab_strength: Scalar,
    pinch_strength: Scalar,
    confidence: Scalar,
    time_visible: Scalar,
    palm_width: Scalar,
    wrist: Triple,
    elbow: Triple,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct RawFinger {
    id: Scalar,
    hand_id: Scalar,
    #[serde(rename = "type")]
    kind: Scalar,
    tool: Scalar,
    width: Scalar,
    direction: Triple,
    tip_position: Triple,
    carp_position: Triple,
    mcp_position: Triple,
    pip_position: Triple,
    dip_position: Triple,
    btip_position: Triple,
    extended: Scalar,
}

/// Decodes a frame; any other message is [`FrameError::NotAFrame`].
pub fn parse_frame(json: &str) -> Result<Frame, FrameError> {
    match parse_message(json)? {
        Message::Frame(frame) => Ok(frame),
        _ => Err(FrameError::NotAFrame),
    }
}

/// Decodes any message of protocol 6 or 7.
pub fn parse_message(json: &str) -> Result<Message, FrameError> {
    let holds_nan = check(json)?;
    let text = if holds_nan { numbers_repaired(json) } else { Cow::Borrowed(json) };
    let mut raw: RawMessage =
        serde_json::from_str(&text).map_err(|e| FrameError::NotJson(e.to_string()))?;
    if let Some(hands) = raw.hands.take() {
        let mut frame = Frame {
            hands: Hands { frame: raw.id.int().unwrap_or(0), ..Hands::default() },
            device_t_us: raw.timestamp.int().and_then(|t| u64::try_from(t).ok()),
            rate: raw.rate.f32().filter(|r| *r >= 0.0),
            dropped_hands: 0,
            repaired: holds_nan,
        };
        fill(&mut frame, &hands, raw.pointables.as_deref().unwrap_or_default());
        return Ok(Message::Frame(frame));
    }
    if let Some(state) = raw.event.and_then(|e| e.state) {
        return Ok(Message::Device {
            attached: state.attached.bool(),
            streaming: state.streaming.bool(),
        });
    }
    Ok(raw.version.map_or(Message::Other, |v| Message::Version(v.int())))
}

/// Checks size and depth against their limits before anything is built from the text; returns true
/// if it contains `nan` or `inf` outside strings.
fn check(json: &str) -> Result<bool, FrameError> {
    if json.len() > MAX_MESSAGE {
        return Err(FrameError::TooLong(json.len()));
    }
    let (mut depth, mut bad) = (0usize, false);
    let mut in_string = false;
    let mut bytes = json.bytes().enumerate();
    while let Some((at, b)) = bytes.next() {
        match (in_string, b) {
            (true, b'\\') => {
                bytes.next();
            }
            (_, b'"') => in_string = !in_string,
            (true, _) => {}
            (false, b'[' | b'{') => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Err(FrameError::TooDeep(at));
                }
            }
            (false, b']' | b'}') => depth = depth.saturating_sub(1),
            // `null` has an n too, but neither `na` nor `i`; `NaN` and `Infinity` have capitals.
            (false, b'N' | b'I' | b'i' | b'a') => bad |= !ends_with(json, at, "fa"),
            _ => {}
        }
    }
    Ok(bad)
}

fn ends_with(json: &str, at: usize, word: &str) -> bool {
    json.as_bytes()[..=at].ends_with(word.as_bytes())
}

/// Writes `null` for every bare word that begins like `nan` or `inf`, with its sign.
fn numbers_repaired(json: &str) -> Cow<'_, str> {
    let mut out = String::with_capacity(json.len() + 64);
    let mut in_string = false;
    let mut chars = json.chars().peekable();
    while let Some(c) = chars.next() {
        if in_string || c == '"' {
            out.push(c);
            if c == '\\' {
                out.extend(chars.next());
            } else if c == '"' {
                in_string = !in_string;
            }
            continue;
        }
        if !(c.is_ascii_alphabetic() || c == '-') {
            out.push(c);
            continue;
        }
        let mut word = String::from(c);
        while let Some(n) = chars.next_if(|n| {
            n.is_ascii_alphanumeric() || matches!(n, '.' | '+' | '-' | '(' | ')' | '_')
        }) {
            word.push(n);
        }
        let bare = word.trim_start_matches('-').to_ascii_lowercase();
        out.push_str(if bare.starts_with("nan") || bare.starts_with("inf") {
            "null"
        } else {
            &word
        });
    }
    Cow::Owned(out)
}

fn fill(frame: &mut Frame, hands: &[RawHand], fingers: &[RawFinger]) {
    let out = &mut frame.hands;
    for raw in hands.iter().take(MAX_LISTED) {
        let taken = |id: i32| out.as_slice().iter().any(|h| h.id == id);
        let full = out.count as usize == MAX_HANDS;
        match (raw.id.int(), raw.palm_position.vec()) {
            // Ids are small counters; one beyond 32 bits still names the same hand by its low half.
            (Some(id), Some(palm)) if !full && !taken(id as i32) => {
                let mut hand = decode_hand(raw, id as i32, palm);
                attach_fingers(&mut hand, id, fingers);
                out.hands[out.count as usize] = hand;
                out.count += 1;
            }
            _ => frame.dropped_hands += 1,
        }
    }
    frame.dropped_hands += hands.len().saturating_sub(MAX_LISTED) as u32;
    // A tracker's list order jumps; by id, a hand keeps its place as long as it is seen.
    out.hands[..out.count as usize].sort_by_key(|h| h.id);
}

fn decode_hand(raw: &RawHand, id: i32, palm: Vec3) -> Hand {
    let ratio = |s: Scalar| s.f32().map(|v| v.clamp(0.0, 1.0));
    let (direction, palm_normal) = (raw.direction.unit(), raw.palm_normal.unit());
    Hand {
        id,
        left: raw.side.left(),
        palm,
        palm_normal,
        direction,
        palm_velocity: raw.palm_velocity.vec(),
        grab: ratio(raw.grab_strength),
        pinch: ratio(raw.pinch_strength),
        confidence: ratio(raw.confidence),
        time_visible: raw.time_visible.f32().filter(|t| *t >= 0.0),
        palm_width: raw.palm_width.f32().filter(|w| *w > 0.0 && *w < 1000.0),
        orientation: direction.zip(palm_normal).and_then(|(d, n)| palm_orientation(d, n)),
        wrist: raw.wrist.vec(),
        elbow: raw.elbow.vec(),
        fingers: [None; 5],
    }
}

/// The turn that brings the tracker's axes onto the hand's: x across the palm, y out of the back of
/// the hand, z from the fingers to the wrist. A flat hand, palm down, fingers away from the user,
/// has none.
fn palm_orientation(direction: Vec3, normal: Vec3) -> Option<Quat> {
    let z = -direction;
    let y = (-normal + z * normal.dot(z)).try_normalize()?;
    Some(Quat::from_mat3(&Mat3::from_cols(y.cross(z), y, z)).normalize())
}

fn attach_fingers(hand: &mut Hand, hand_id: i64, fingers: &[RawFinger]) {
    for raw in fingers.iter().take(MAX_LISTED) {
        if raw.hand_id.int() != Some(hand_id) || raw.tool.bool() == Some(true) {
            continue;
        }
        // Some servers leave the type out; the id then says it: ten times the hand's, plus the
        // finger.
        let kind =
            raw.kind.int().or_else(|| Some(raw.id.int()?.wrapping_sub(hand_id.wrapping_mul(10))));
        let Some(slot) = kind.and_then(|k| hand.fingers.get_mut(usize::try_from(k).ok()?)) else {
            continue;
        };
        if slot.is_none() {
            *slot = decode_finger(raw);
        }
    }
}

fn decode_finger(raw: &RawFinger) -> Option<Finger> {
    let places = [
        raw.carp_position,
        raw.mcp_position,
        raw.pip_position,
        raw.dip_position,
        raw.btip_position,
    ];
    let joints = places.map(Triple::vec);
    Some(Finger {
        joints,
        tip: raw.tip_position.vec().or(joints[4])?,
        direction: raw.direction.unit(),
        width: raw.width.f32().filter(|w| *w > 0.0 && *w < 200.0),
        extended: raw.extended.bool(),
    })
}

#[cfg(test)]
#[path = "frame_tests.rs"]
mod tests;
