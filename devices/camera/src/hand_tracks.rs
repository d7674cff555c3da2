//! Follows hands from picture to picture. The palm detector runs only while a hand is missing, and
//! then only now and again; a hand that is followed costs one run of the landmark model.
//!
//! Rules:
//! * At most two hands, one left and one right: the first person's. A further hand is ignored.
//! * The side of a hand is decided by all its pictures together, so hands that cross keep theirs.
//! * Two crops that run into one hand become one.

use glam::Vec2;

use crate::inference::ModelError;
use crate::landmarks::{LandmarkModel, SeenHand};
use crate::palm::PalmDetector;
use crate::picture::{Crop, Picture};

/// Most hands.
pub const MAX_TRACKS: usize = 2;
/// Below this presence a hand is lost.
const LOST_BELOW: f32 = 0.5;
/// A hand that appears must be this sure.
const FOUND_ABOVE: f32 = 0.6;
/// Presence in a detector's crop below which there is no hand.
const HOPELESS: f32 = 0.1;
/// Looks at a hand that appears, after the first one.
const LOOKS: usize = 3;
/// Pictures between two searches for a second hand while the first is followed.
const SEARCH_EVERY: u32 = 15;
/// Pictures between two searches while no hand is seen: a third of the time, so that an empty
/// room costs little.
const EMPTY_SEARCH_EVERY: u32 = 2;
/// Pictures between two searches for a second hand that was lost less than a second ago.
const SOON: u32 = 3;
const SOON_PICTURES: u32 = 30;
/// A detected palm that is nearer to a hand than this share of its size is that hand's.
const SAME_PLACE: f32 = 0.6;
/// Two palms that are nearer than this share of their size are one hand.
const ONE_HAND: f32 = 0.45;
/// A second hand whose palm is smaller or larger than the first by this factor belongs to someone
/// else: hands of one person are at most an arm's length apart in depth.
const OTHER_PERSON: f32 = 2.2;
/// Weight of one picture in the decision about the side, and its limit.
const SIDE_LIMIT: f32 = 12.0;

/// A hand that is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandTrack {
    /// Number that no other hand of the run has.
    pub id: i32,
    /// The hand in the newest picture.
    pub seen: SeenHand,
    /// Evidence for a left hand; negative for a right one.
    side: f32,
    /// Pictures in which it was seen.
    pub pictures: u32,
    crop: Crop,
}

impl HandTrack {
    /// Returns true for a left hand.
    pub fn is_left(&self) -> bool {
        self.side > 0.0
    }
}

/// Models and the hands that they follow.
#[derive(Debug)]
pub struct HandTracks {
    palms: PalmDetector,
    model: LandmarkModel,
    tracks: Vec<HandTrack>,
    next_id: i32,
    since_search: u32,
    /// Pictures since a hand was lost.
    since_loss: u32,
    /// Hands of other people that the last search saw.
    pub ignored: usize,
    /// Score of the surest palm of the last search.
    pub best_score: f32,
    /// Runs of the palm detector.
    pub searches: u64,
}

/// Keeps a crop until the hand has left it by enough to matter, so that a hand at rest is seen in
/// the same pixels.
fn steadied(old: Crop, new: Crop) -> Crop {
    let moved = old.centre.distance(new.centre) > 0.04 * old.side;
    let grown = (new.side / old.side.max(1.0) - 1.0).abs() > 0.08;
    let turned = Vec2::from_angle(old.angle).angle_to(Vec2::from_angle(new.angle)).abs() > 0.12;
    if moved || grown || turned { new } else { old }
}

impl HandTracks {
    /// Loads both models.
    ///
    /// # Errors
    /// Returns an error if a file is not the model that it should be.
    pub fn new(palm: &[u8], landmark: &[u8]) -> Result<Self, ModelError> {
        Ok(HandTracks {
            palms: PalmDetector::new(palm)?,
            model: LandmarkModel::new(landmark)?,
            tracks: Vec::new(),
            next_id: 1,
            since_search: u32::MAX,
            since_loss: u32::MAX,
            ignored: 0,
            best_score: 0.0,
            searches: 0,
        })
    }

    /// Looks at the next picture. Returns the hands that were seen in it.
    pub fn look(&mut self, picture: &Picture) -> &[HandTrack] {
        let before = self.tracks.len();
        for track in &mut self.tracks {
            let seen = self.model.look(picture, &track.crop);
            track.follow(seen, picture);
        }
        self.tracks.retain(|t| t.seen.presence >= LOST_BELOW);
        self.drop_twins();
        let lost = self.tracks.len() < before;
        self.since_search = self.since_search.saturating_add(1);
        self.since_loss = if lost { 0 } else { self.since_loss.saturating_add(1) };
        let every = match self.tracks.is_empty() {
            true => EMPTY_SEARCH_EVERY,
            false if self.since_loss < SOON_PICTURES => SOON,
            false => SEARCH_EVERY,
        };
        if self.tracks.len() < MAX_TRACKS && (lost || self.since_search >= every) {
            self.search(picture);
        }
        &self.tracks
    }

    /// Forgets all hands.
    pub fn clear(&mut self) {
        self.tracks.clear();
        self.since_search = u32::MAX;
    }

    fn search(&mut self, picture: &Picture) {
        (self.since_search, self.searches) = (0, self.searches + 1);
        let palms = self.palms.detect(picture);
        self.best_score = palms.first().map_or(0.0, |p| p.score);
        self.ignored = 0;
        let mut candidates = Vec::new();
        for palm in palms {
            let known = |t: &HandTrack| {
                let size = t.seen.palm_px().max(palm.size.max_element());
                t.seen.palm().distance(palm.centre) < SAME_PLACE * size
            };
            if !self.tracks.iter().any(known) {
                candidates.push(palm);
            }
        }
        // The nearest hands are the sculptor's.
        candidates.sort_by(|a, b| b.size.max_element().total_cmp(&a.size.max_element()));
        for palm in candidates {
            if self.tracks.len() == MAX_TRACKS {
                self.ignored += 1;
                continue;
            }
            let Some(seen) = self.settle(picture, palm.hand_crop()) else { continue };
            if self.tracks.iter().any(|t| is_twin(&t.seen, &seen)) {
                continue;
            }
            if self.tracks.iter().any(|t| t.is_of_another_person(&seen)) {
                self.ignored += 1;
                continue;
            }
            let side = evidence(&seen);
            let crop = seen.next_crop();
            self.tracks.push(HandTrack { id: self.next_id, seen, side, pictures: 1, crop });
            self.next_id = self.next_id.checked_add(1).unwrap_or(1);
        }
        self.tracks.sort_by_key(|t| t.id);
    }

    /// Looks until the crop fits the hand: the first one is the detector's, and it cuts off the
    /// fingers of a hand that is near.
    fn settle(&mut self, picture: &Picture, crop: Crop) -> Option<SeenHand> {
        let mut seen = self.model.look(picture, &crop);
        for _ in 0..LOOKS {
            if !seen.is_finite() || seen.presence < HOPELESS {
                return None;
            }
            seen = self.model.look(picture, &seen.next_crop());
            if seen.presence >= FOUND_ABOVE && seen.is_finite() {
                return Some(seen);
            }
        }
        None
    }

    /// Of two tracks on one hand, the longer one stays.
    fn drop_twins(&mut self) {
        if let [a, b] = self.tracks.as_slice()
            && is_twin(&a.seen, &b.seen)
        {
            let drop = if a.pictures >= b.pictures { b.id } else { a.id };
            self.tracks.retain(|t| t.id != drop);
        }
    }
}

/// Evidence of one picture about the side: the log of the odds, limited.
fn evidence(seen: &SeenHand) -> f32 {
    let p = seen.left.clamp(0.02, 0.98);
    (p / (1.0 - p)).ln() * seen.presence
}

fn is_twin(a: &SeenHand, b: &SeenHand) -> bool {
    let size = a.palm_px().min(b.palm_px());
    let apart: f32 =
        a.joints.iter().zip(&b.joints).map(|(a, b)| a.distance(*b)).sum::<f32>() / 21.0;
    apart < ONE_HAND * size
}

impl HandTrack {
    fn follow(&mut self, seen: SeenHand, picture: &Picture) {
        if !seen.is_finite() {
            self.seen.presence = 0.0;
            return;
        }
        let next = seen.next_crop();
        let inside = next.centre.clamp(Vec2::ZERO, picture.size()) == next.centre;
        let side = next.side < 3.0 * picture.size().max_element();
        // A hand cannot double its size between two pictures, nor jump by its own length twice.
        let jumps = next.centre.distance(self.crop.centre) > 1.5 * self.crop.side;
        self.seen = seen;
        if !inside || !side || jumps {
            self.seen.presence = 0.0;
            return;
        }
        self.side = (self.side + evidence(&seen)).clamp(-SIDE_LIMIT, SIDE_LIMIT);
        self.pictures = self.pictures.saturating_add(1);
        self.crop = steadied(self.crop, next);
    }

    fn is_of_another_person(&self, seen: &SeenHand) -> bool {
        let ratio = self.seen.palm_px() / seen.palm_px().max(1.0);
        let same_side = (evidence(seen) > 0.0) == self.is_left();
        // Only a sure side counts: it is the first picture of that hand.
        let sure = evidence(seen).abs() > 1.4 && self.side.abs() > 4.0;
        ratio > OTHER_PERSON || ratio < 1.0 / OTHER_PERSON || same_side && sure
    }
}
