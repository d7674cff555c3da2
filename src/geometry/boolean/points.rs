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

pub type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mix>>;

/// All points, and a grid of those that may be met again.
#[derive(Debug, Default)]
pub struct Points {
    pub at: Vec<DVec3>,
    eps: f64,
    cells: Map<[i64; 3], Vec<u32>>,
}

impl Points {
    pub fn new(at: Vec<DVec3>, eps: f64) -> Points {
        Points { at, eps, cells: Map::default() }
    }

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
        self.near(p).unwrap_or_else(|| {
            self.cells.entry(self.cell(p)).or_default().push(i);
            i
        })
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
