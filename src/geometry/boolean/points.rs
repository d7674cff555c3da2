//! Points with an identity: two places within the tolerance are one point.

#![expect(
    clippy::disallowed_types,
    reason = "a fixed hash, and nothing here shows the map's order"
)]

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::DVec3;

/// A fixed, fast hash; no map's order is ever used.
#[derive(Debug, Default, Clone, Copy)]
pub struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 29)
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(b as u64));
    }
    fn write_u64(&mut self, x: u64) {
        self.0 = (self.0.rotate_left(23) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 31;
    }
    fn write_u32(&mut self, x: u32) {
        self.write_u64(x as u64);
    }
    fn write_i64(&mut self, x: i64) {
        self.write_u64(x as u64);
    }
    fn write_usize(&mut self, x: usize) {
        self.write_u64(x as u64);
    }
}

/// A hash map with a fixed hash.
pub type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mix>>;

/// All points, and a grid of the points that may be found again.
#[derive(Debug, Default)]
pub struct PointSet {
    /// The position of each point.
    pub at: Vec<DVec3>,
    /// The contacts decided by the tolerance so far.
    pub contact: Contact,
    eps: f64,
    cells: Map<[i64; 3], Vec<u32>>,
}

impl PointSet {
    /// Points with a tolerance; none of them is listed yet.
    pub fn new(at: Vec<DVec3>, eps: f64) -> PointSet {
        PointSet { at, contact: Contact::default(), eps, cells: Map::default() }
    }

    /// Length within which two places are one point.
    pub fn tolerance(&self) -> f64 {
        self.eps
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        let q = p / (self.eps * 4.0);
        [q.x.floor() as i64, q.y.floor() as i64, q.z.floor() as i64]
    }

    /// The nearest listed point within the tolerance.
    pub fn near(&self, p: DVec3) -> Option<u32> {
        let (lo, hi) = (self.cell(p - self.eps), self.cell(p + self.eps));
        let mut best: Option<(f64, u32)> = None;
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    for &i in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        let d = self.at[i as usize].distance_squared(p);
                        if d <= self.eps * self.eps && best.is_none_or(|b| (d, i) < b) {
                            best = Some((d, i));
                        }
                    }
                }
            }
        }
        best.map(|b| b.1)
    }

    /// Lists an existing point, or says which listed one it is.
    pub fn list(&mut self, i: u32) -> u32 {
        let p = self.at[i as usize];
        match self.near(p) {
            Some(known) => {
                self.contact.within(self.at[known as usize].distance(p));
                known
            }
            None => {
                self.cells.entry(self.cell(p)).or_default().push(i);
                i
            }
        }
    }

    /// The point at a place, made where there is none.
    pub fn point(&mut self, p: DVec3) -> u32 {
        self.near(p).unwrap_or_else(|| {
            let i = self.at.len() as u32;
            self.at.push(p);
            self.cells.entry(self.cell(p)).or_default().push(i);
            i
        })
    }
}

/// Distances that the tolerance decided: what was taken as contact, and what nearly was.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Places of one operand that were put on a place, an edge or a face of the other, or of its
    /// own.
    pub places: usize,
    /// The largest distance over which that was done.
    pub farthest: f64,
    /// Places that are not in contact but within four times the tolerance.
    pub near_misses: usize,
}

impl Contact {
    /// Notes a place in contact over a distance.
    pub fn within(&mut self, distance: f64) {
        self.places += 1;
        self.farthest = self.farthest.max(distance);
    }

    /// Adds what another step found.
    pub fn add(&mut self, other: Contact) {
        self.places += other.places;
        self.farthest = self.farthest.max(other.farthest);
        self.near_misses += other.near_misses;
    }

    /// Notes a distance that was held against the tolerance: in contact, nearly, or neither.
    pub fn compared(&mut self, distance: f64, eps: f64) -> bool {
        if distance <= eps {
            self.within(distance);
        } else if distance <= 4.0 * eps {
            self.near_misses += 1;
        }
        distance <= eps
    }
}
