//! Bare hands: from tracked joints to tools that touch the clay, and to the view that turns.
//!
//! Laws kept here:
//! * A hand acts by **contact**, never by a click: the swept path of its tool is what touches, so
//!   no speed tunnels through.
//! * Nothing acts at full strength at once: a hand that appears, a pose that changes, a hand at the
//!   edge of what is tracked or badly seen, all fade in ([`machine::Track::strength`],
//!   [`Volume::edge_fade`]).
//! * A hand that is lost for [`HandSettings::bridge_ms`] is the same hand; one lost for longer has
//!   let go.
//! * [`gate`] drops what a tracker cannot have seen, before anything acts on it.
//! * Every joint is steadied before anything looks at it, the same in a replay as live.
//! * The view does not move within [`HandSettings::view_rest_ms`] of sculpting.

pub mod acts;
pub mod comfort;
pub mod gate;
pub mod held_object;
pub mod machine;
pub mod menu;
pub mod pose;
mod reach_box;
pub mod settings;
mod volume;

pub use acts::{Act, Drag, PalmPress, Push};
pub use comfort::{Calibrated, Fatigue, ReachCalibration};
pub use gate::HandGate;
pub use held_object::{HeldObject, Similarity};
pub use machine::Track;
pub use menu::{Menu, MenuItem};
pub use pose::Pose;
pub use reach_box::ReachBox;
pub use settings::HandSettings;
pub use volume::Volume;

use std::collections::VecDeque;

use glam::{Quat, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use self::pose::Features;
use self::reach_box::BOX_HALF_MM;
use sculptd_devices::filter::HandsFilter;
use sculptd_devices::{DeviceId, Hands};
use sculptd_geometry::portable::turn_about;

/// Acts waiting for the tick's budget; beyond it the newest sweep is joined to the one before.
const MAX_WAITING: usize = 256;
/// Longest gap between two frames of a slow tracker, in microseconds; in a longer one it missed
/// frames.
const GAP_US: u64 = 40_000;
/// Fingers of a pinch that parted by more than this while the hand was unseen may have let go, mm.
const PARTED_MM: f32 = 3.0;
/// Time that the fingers of a pinch need to close after it is recognised, in microseconds.
const CLOSES_US: u64 = 250_000;
/// Step in which missed motion is made up for, in microseconds.
const STEP_US: u64 = 10_000;
/// Hands followed at a time, over all trackers.
const MAX_TRACKS: usize = 16;

/// Returns the number of frames over which to spread the motion of a hand that was last seen
/// `unseen_us` ago: 1, or more if it was missed. `frame_us` is the tracker's time between frames.
fn frames_in(unseen_us: u64, frame_us: u64) -> u64 {
    if unseen_us * 2 >= frame_us * 3 && frame_us > 0 {
        ((unseen_us + frame_us / 2) / frame_us).clamp(1, 32)
    } else if unseen_us > GAP_US {
        unseen_us.div_ceil(STEP_US).min(32)
    } else {
        1
    }
}

/// A hand as it was one frame ago, in the world.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct TrackedHand {
    track: Track,
    /// Last position of the tool; `None` just after the pose began.
    tool: Option<Vec3>,
    /// Orientation of the hand at that moment.
    turn: Option<Quat>,
    /// From the palm to the pinch when the pinch began, in the hand's own axes, mm.
    grip: Option<Vec3>,
    /// The palm when it last rested, mm: motion counts from here once it left the dead zone.
    anchor_mm: Vec3,
    free: bool,
    moved_us: u64,
}

/// The state of all hands between samples.
#[derive(Debug, Serialize, Deserialize)]
pub struct HandTools {
    /// Settings of the hand recognition.
    pub settings: HandSettings,
    held: Vec<TrackedHand>,
    waiting: VecDeque<Act>,
    volume: Volume,
    /// The camera's yaw that the volume was laid for.
    yaw: f32,
    /// The two world points that two pinching hands hold.
    pair: Option<[Vec3; 2]>,
    /// Distance of two open hands one frame ago, mm.
    apart_mm: Option<f32>,
    /// A thing is in the hands: pinches carry it and not the clay.
    pub carrying: bool,
    menu: Menu,
    chosen: Option<MenuItem>,
    fatigue: Fatigue,
    reach: Option<ReachCalibration>,
    sculpted_us: Option<u64>,
    now_us: u64,
    /// One for each tracker.
    steady: Vec<(DeviceId, HandsFilter)>,
    /// One for each tracker. A saved world stores them after its other parts, see [`Gates`].
    #[serde(skip)]
    gates: Gates,
}

/// The state of each tracker's gate.
pub(crate) type Gates = Vec<(DeviceId, HandGate)>;

impl HandTools {
    /// No hands yet.
    pub fn new(settings: HandSettings) -> Self {
        HandTools {
            settings,
            held: Vec::with_capacity(MAX_TRACKS),
            waiting: VecDeque::with_capacity(MAX_WAITING),
            volume: Volume::over(Vec3::ZERO, 1.0, 0.0, &settings.reach),
            yaw: 0.0,
            pair: None,
            apart_mm: None,
            carrying: false,
            menu: Menu::default(),
            chosen: None,
            fatigue: Fatigue::default(),
            reach: None,
            sculpted_us: None,
            now_us: 0,
            steady: Vec::new(),
            gates: Vec::new(),
        }
    }

    /// Remaps the tracked volume onto a work. Touches and grips restart from the new positions: the
    /// jump between the two mappings is not a movement.
    pub fn place_volume(&mut self, middle: Vec3, extent: f32, yaw: f32) {
        self.volume = Volume::over(middle, extent, yaw, &self.settings.reach);
        self.yaw = yaw;
        self.pair = None;
        for held in &mut self.held {
            (held.tool, held.turn) = (None, None);
        }
    }

    /// The tracked volume over the object.
    pub fn volume(&self) -> &Volume {
        &self.volume
    }

    /// Every hand that is followed, for showing its state.
    pub fn tracks(&self) -> impl Iterator<Item = &Track> {
        self.held.iter().map(|h| &h.track)
    }

    /// The volume turns with the camera, whoever turned it: toward the user stays toward the user.
    pub fn follow(&mut self, target: Vec3, yaw: f32) {
        let by = yaw - self.yaw;
        if by != 0.0 {
            let turn = turn_about(Vec3::Y, by);
            self.volume.origin = target + turn * (self.volume.origin - target);
            self.volume.turn = (turn * self.volume.turn).normalize();
            self.yaw = yaw;
        }
    }

    /// Returns the gates, or `None` if no gate knows a hand.
    pub(crate) fn gates(&self) -> Option<&Gates> {
        self.gates.iter().any(|(_, gate)| !gate.is_empty()).then_some(&self.gates)
    }

    /// Restores the gates of a saved world.
    pub(crate) fn set_gates(&mut self, gates: Gates) {
        self.gates = gates;
    }

    /// Returns the hands of a frame that can be true.
    fn plausible(&mut self, device: DeviceId, t_us: u64, hands: &Hands) -> Hands {
        let at = self.gates.iter().position(|(d, _)| *d == device).unwrap_or_else(|| {
            let mut gate = HandGate::default();
            for held in self.held.iter().filter(|h| h.track.device == device) {
                let track = &held.track;
                gate.follow(track.id, track.left, track.palm, track.seen_us);
            }
            self.gates.push((device, gate));
            self.gates.len() - 1
        });
        self.gates[at].1.filter(t_us, hands)
    }

    /// A frame with the tremble taken out of it.
    fn steadied(&mut self, device: DeviceId, t_us: u64, hands: &Hands) -> Hands {
        let at = self.steady.iter().position(|(d, _)| *d == device).unwrap_or_else(|| {
            self.steady.push((device, HandsFilter::new(self.settings.steady)));
            self.steady.len() - 1
        });
        let filter = &mut self.steady[at].1;
        filter.figures = self.settings.steady;
        let mut hands = *hands;
        filter.apply(&mut hands, t_us);
        hands
    }

    /// Takes one frame of one tracker.
    pub fn take(&mut self, device: DeviceId, t_us: u64, hands: &Hands) {
        let s = self.settings;
        let frame_us = t_us.saturating_sub(self.now_us);
        let hands = self.plausible(device, t_us, hands);
        let hands = &self.steadied(device, t_us, &hands);
        self.now_us = t_us;
        self.forget(t_us);
        self.fatigue.take(t_us, hands.as_slice());
        if let Some(reach) = &mut self.reach {
            match reach.take(t_us, hands.as_slice()) {
                Calibrated::Listening(_) => return,
                Calibrated::TooLittle => self.reach = None,
                Calibrated::Done(found) => (self.settings.reach, self.reach) = (found, None),
            }
        }
        // The number of frames over which each hand's motion is spread.
        let mut frames = [1; MAX_TRACKS];
        for hand in hands.as_slice() {
            let known = self
                .held
                .iter()
                .position(|h| h.track.device == device && h.track.id == hand.id)
                .or_else(|| {
                    // The tracker gave the same hand a new number.
                    let lost = |h: &TrackedHand| {
                        h.track.device == device
                            && !hands.as_slice().iter().any(|o| o.id == h.track.id)
                            && h.track.may_continue(t_us, hand, &s)
                    };
                    self.held.iter().position(lost)
                });
            match known {
                Some(i) => {
                    let held = &mut self.held[i];
                    frames[i] = frames_in(t_us.saturating_sub(held.track.seen_us), frame_us);
                    let gaps = held.track.pinch_mm.zip(Features::of(hand).pinch_mm);
                    if frames[i] > 1 && gaps.is_some_and(|(was, now)| now > was + PARTED_MM) {
                        // Nobody saw where the fingers parted: the clay stays where it was.
                        held.track.open_unseen(t_us);
                        (held.tool, held.grip) = (None, None);
                    }
                    let changed = held.track.take(t_us, hand, &s);
                    if changed {
                        (held.tool, held.turn, held.grip) = (None, None, None);
                        (held.free, held.anchor_mm) = (false, hand.palm);
                    }
                }
                None if self.held.len() < MAX_TRACKS => self.held.push(TrackedHand {
                    track: Track::new(device, t_us, hand),
                    tool: None,
                    turn: None,
                    grip: None,
                    anchor_mm: hand.palm,
                    free: false,
                    moved_us: t_us,
                }),
                None => {}
            }
        }
        let tip = self.held.iter().find(|h| h.track.seen_us == t_us && h.track.pose == Pose::Point);
        let tip = tip.and_then(|h| h.track.index_tip);
        if let Some(choice) = self.menu.take(tip, t_us, self.carrying, &s) {
            self.chosen = Some(choice);
        }
        self.act(t_us, &frames);
    }

    /// Takes the menu choice made since the last call.
    pub fn take_choice(&mut self) -> Option<MenuItem> {
        self.chosen.take()
    }

    /// The menu beside the object.
    pub fn menu(&self) -> &Menu {
        &self.menu
    }

    /// Returns how tired the arms are.
    pub fn fatigue(&self) -> &Fatigue {
        &self.fatigue
    }

    /// From now on the hands' movement says what the person can reach, for five seconds; they do
    /// nothing else meanwhile.
    pub fn calibrate(&mut self) {
        self.lift();
        self.reach = Some(ReachCalibration::default());
    }

    /// Returns true while the hands' movement is measured for their reach.
    pub fn is_calibrating(&self) -> bool {
        self.reach.is_some()
    }

    /// Lets go of hands that were not seen for longer than is bridged.
    fn forget(&mut self, t_us: u64) {
        let bridge_us = (self.settings.bridge_ms * 1000.0) as u64;
        self.held.retain(|h| t_us.saturating_sub(h.track.seen_us) <= bridge_us);
    }

    /// Returns true if two hands act together and this frame shows only one of them. They continue
    /// when both are seen again.
    fn waits_for_second(&self, t_us: u64) -> bool {
        let together = self.pair.is_some() || self.apart_mm.is_some();
        together && self.held.len() > 1 && self.held.iter().any(|h| h.track.seen_us != t_us)
    }

    fn act(&mut self, t_us: u64, frames: &[u64; MAX_TRACKS]) {
        if self.waits_for_second(t_us) {
            return;
        }
        let mut posed = self.held.iter().filter(|h| h.track.seen_us == t_us);
        let two = posed.next().zip(posed.next()).map(|(a, b)| [a.track, b.track]);
        let both = |pose: Pose| two.filter(|p| p.iter().all(|t| t.pose == pose));
        if let Some([a, b]) = both(Pose::Pinch) {
            self.hold_between(a, b);
            return;
        }
        self.pair = None;
        if let Some([a, b]) = both(Pose::Open) {
            self.zoom_between(a, b, t_us);
            return;
        }
        self.apart_mm = None;
        for i in 0..self.held.len() {
            if self.held[i].track.seen_us == t_us {
                self.one_hand(i, t_us, frames[i]);
            }
        }
    }

    /// Two pinches hold two points of the world: move, turn, scale.
    fn hold_between(&mut self, a: Track, b: Track) {
        if self.carrying {
            self.carry_between(a, b);
            return;
        }
        if a.lets_go(&self.settings) || b.lets_go(&self.settings) {
            self.pair = None;
            return;
        }
        let Some((pa, pb)) = a.pinch_point.zip(b.pinch_point) else { return };
        let fingers = [self.volume.to_world(pa), self.volume.to_world(pb)];
        let held = *self.pair.get_or_insert(fingers);
        if let Some(volume) = self.volume.holding(held, [pa, pb]) {
            let before = self.volume;
            self.volume = volume;
            self.wait(Act::Hold { before, after: volume });
        }
    }

    /// Two pinches carry a thing: by their grips, so that fingers that open leave it where it is.
    fn carry_between(&mut self, a: Track, b: Track) {
        let index = |t: Track| {
            self.held.iter().position(|h| (h.track.device, h.track.id) == (t.device, t.id))
        };
        let Some((i, j)) = index(a).zip(index(b)) else { return };
        let Some((pa, pb)) = self.grip_mm(i).zip(self.grip_mm(j)) else { return };
        let now = [self.volume.to_world(pa), self.volume.to_world(pb)];
        let before = self.pair.replace(now);
        for held in &mut self.held {
            (held.tool, held.turn) = (None, None);
        }
        if let Some(by) = before.and_then(|before| Similarity::between(before, now)) {
            self.wait(Act::Carry(by));
        }
    }

    /// Returns the pinch point as if the fingers had kept still since the pinch began: a carried
    /// object follows the palm.
    fn grip_mm(&mut self, i: usize) -> Option<Vec3> {
        let held = &mut self.held[i];
        let (track, turn) = (held.track, held.track.orientation.unwrap_or(Quat::IDENTITY));
        let grip = match held.grip {
            Some(grip) => grip,
            None => *held.grip.insert(turn.inverse() * (track.pinch_point? - track.palm)),
        };
        Some(track.palm + turn * grip)
    }

    /// Moves the grip with the fingers while they close, so that neither the moment of recognition
    /// nor the fingers' own motion moves clay.
    fn close_grip(&mut self, i: usize, t_us: u64) {
        let scale = self.volume;
        let held = &mut self.held[i];
        let (track, turn) = (held.track, held.track.orientation.unwrap_or(Quat::IDENTITY));
        let Some((was, point)) = held.grip.zip(track.pinch_point) else { return };
        if t_us.saturating_sub(track.pose_us) < CLOSES_US {
            let now = turn.inverse() * (point - track.palm);
            held.grip = Some(now);
            let by = scale.to_world(turn * (now - was)) - scale.to_world(Vec3::ZERO);
            held.tool = held.tool.map(|tool| tool + by);
        }
    }

    fn zoom_between(&mut self, a: Track, b: Track, t_us: u64) {
        let apart = (a.palm - b.palm).length();
        if let Some(before) = self.apart_mm
            && self.view_may_move(t_us)
            && before > 30.0
        {
            self.wait(Act::Zoom((apart / before).clamp(0.8, 1.25)));
        }
        self.apart_mm = Some(apart);
    }

    fn view_may_move(&self, t_us: u64) -> bool {
        self.sculpted_us
            .is_none_or(|at| t_us.saturating_sub(at) as f32 * 1e-3 > self.settings.view_rest_ms)
    }

    /// World units a millimetre of a tool. A person who reaches less far moves more of the work
    /// with each millimetre, but a fingertip stays as small beside the work as anybody's.
    fn tool_scale(&self) -> f32 {
        self.volume.scale * (self.settings.reach.half_mm / BOX_HALF_MM)
    }

    fn one_hand(&mut self, i: usize, t_us: u64, frames: u64) {
        let s = self.settings;
        let TrackedHand { track, turn, .. } = self.held[i];
        let v = self.volume;
        if self.carrying && track.pose == Pose::Pinch {
            let now = track.orientation.map(|q| (v.turn * q).normalize());
            let to = self.grip_mm(i).map(|p| v.to_world(p));
            if let Some((from, to)) = self.held[i].tool.zip(to) {
                let turned =
                    turn.zip(now).map_or(Quat::IDENTITY, |(a, b)| (b * a.inverse()).normalize());
                self.wait(Act::Carry(Similarity::carried(from, to, turned)));
            }
            (self.held[i].tool, self.held[i].turn) = (to, now);
            return;
        }
        let strength = track.strength(t_us, &s);
        let at_mm = match track.pose {
            Pose::Point => track.index_tip,
            Pose::Pinch if track.lets_go(&s) => None,
            // Held clay follows the palm: fingers that close or open carry nothing.
            Pose::Pinch => {
                self.close_grip(i, t_us);
                self.grip_mm(i)
            }
            Pose::Flat => Some(track.palm),
            Pose::Neutral | Pose::Grab | Pose::Open => None,
        };
        if let Some(mm) = at_mm {
            let tool_scale = self.tool_scale();
            let to = v.to_world(mm);
            let strength = strength * Volume::edge_fade(mm, &s.reach);
            if let Some(start) = self.held[i].tool.filter(|_| strength > 0.0) {
                // Missed motion is made up for step by step, as it would have been seen.
                for k in 0..frames {
                    let part = |k: u64| start.lerp(to, k as f32 / frames as f32);
                    let (from, to) = if frames == 1 { (start, to) } else { (part(k), part(k + 1)) };
                    match track.pose {
                        Pose::Point => self.wait(Act::Push(Push {
                            from,
                            to,
                            radius: s.tip_radius_mm * tool_scale,
                            strength,
                        })),
                        Pose::Pinch => {
                            self.wait(Act::Drag(Drag {
                                from,
                                to,
                                radius: s.pinch_radius_mm * tool_scale,
                                strength,
                            }));
                        }
                        _ => {
                            let normal = track.palm_normal.map_or(-Vec3::Y, |n| v.direction(n));
                            let radius = s.palm_radius_mm * tool_scale;
                            self.wait(Act::Palm(PalmPress { from, to, normal, radius, strength }));
                        }
                    }
                }
            }
            self.held[i].tool = Some(to);
            return;
        }
        self.held[i].tool = None;
        if matches!(track.pose, Pose::Grab | Pose::Open) {
            self.view_by(i, t_us);
        }
    }

    /// An open hand turns the work, a fist moves it, once the palm has left its dead zone.
    fn view_by(&mut self, i: usize, t_us: u64) {
        let s = self.settings;
        let may = self.view_may_move(t_us);
        let held = &mut self.held[i];
        let by = held.track.palm - held.anchor_mm;
        let rests_ms = t_us.saturating_sub(held.moved_us) as f32 * 1e-3;
        let zone = s.dead_zone_mm + if rests_ms > s.view_rest_ms { s.dwell_zone_mm } else { 0.0 };
        if !held.free {
            held.free = by.length() > zone;
            if held.free {
                held.anchor_mm = held.track.palm;
            }
            return;
        }
        if by.length() < 0.3 {
            if rests_ms > s.view_rest_ms {
                held.free = false;
            }
            return;
        }
        (held.anchor_mm, held.moved_us) = (held.track.palm, t_us);
        let pose = held.track.pose;
        if may {
            let act = match pose {
                // 300 mm of travel, a comfortable sweep of the forearm, is a half turn.
                Pose::Open => Act::Orbit(Vec2::new(by.x, -by.y) / 300.0),
                _ => Act::Move(self.volume.direction(by) * self.volume.scale),
            };
            self.wait(act);
        }
    }

    fn wait(&mut self, act: Act) {
        if self.waiting.len() >= MAX_WAITING {
            if let Some(last) = self.waiting.back_mut()
                && last.join(&act)
            {
                return;
            }
            self.waiting.pop_front();
        }
        self.waiting.push_back(act);
    }

    /// Returns the world position where the carrying hand holds; of several hands, the first.
    pub fn grip_point(&self) -> Option<Vec3> {
        let palm = |h: &TrackedHand| {
            h.tool.or(h.grip.and(h.track.pinch_point.map(|p| self.volume.to_world(p))))
        };
        self.held.iter().filter(|h| h.track.pose == Pose::Pinch).find_map(palm)
    }

    /// Returns true if a hand carries something: its pinch is closed and has a grip.
    pub fn is_gripping(&self) -> bool {
        self.held.iter().any(|h| h.track.pose == Pose::Pinch && h.grip.is_some())
    }

    /// Returns true if an act waits for the budget of a tick.
    pub fn has_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// The oldest act that waits, which then waits no more.
    pub fn next_act(&mut self) -> Option<Act> {
        self.waiting.pop_front()
    }

    /// The world tells that an act moved clay: the view rests for a while.
    pub fn sculpted(&mut self) {
        self.sculpted_us = Some(self.now_us);
    }

    /// A tool is on the clay or an act waits: the undo step stays open.
    pub fn is_touching(&self) -> bool {
        !self.waiting.is_empty() || self.held.iter().any(|h| h.tool.is_some())
    }

    /// Forgets every hand: what was touching stops.
    pub fn lift(&mut self) {
        self.held.clear();
        self.pair = None;
        self.apart_mm = None;
    }
}
