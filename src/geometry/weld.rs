//! Exact welding: elements with equal keys become one.
//!
//! This is the one place in which equal positions are found; vertices that are only near each other
//! are merged by [`crate::repair::weld`]. An open-addressing hash table with linear probing, at
//! most half full: about one and a half probes an element.

use glam::Vec3;

use crate::job::{Cancelled, Job};

/// Elements between two looks at the job.
const CHECK: usize = 1 << 18;

/// A key that can be welded by.
pub(crate) trait WeldKey: Copy + PartialEq {
    /// Well mixed in its low bits.
    fn hash(&self) -> u64;
}

fn mix(words: impl Iterator<Item = u64>) -> u64 {
    let mut h = 0x9e37_79b9_7f4a_7c15u64;
    for w in words {
        h = (h ^ w).wrapping_mul(0xff51_afd7_ed55_8ccd);
        h ^= h >> 32;
    }
    h
}

impl WeldKey for [u32; 3] {
    fn hash(&self) -> u64 {
        mix(self.iter().map(|&w| w as u64))
    }
}

impl WeldKey for [u64; 3] {
    fn hash(&self) -> u64 {
        mix(self.iter().copied())
    }
}

/// The distinct keys in the order of their first use, and for each of the `count` elements the
/// index of its key. `count` is below 2^32.
pub(crate) fn weld_keys<K: WeldKey>(
    count: usize,
    job: &Job,
    key: impl Fn(usize) -> K,
) -> Result<(Vec<K>, Vec<u32>), Cancelled> {
    // A closed surface has a sixth as many vertices as corners; the table grows where there are
    // more.
    let mut table = vec![u32::MAX; (count / 2).max(16).next_power_of_two()];
    let mut unique: Vec<K> = Vec::with_capacity(count / 6 + 1);
    let mut of = Vec::with_capacity(count);
    for i in 0..count {
        if i.is_multiple_of(CHECK) {
            job.check()?;
        }
        if unique.len() * 2 >= table.len() {
            let size = table.len() * 2;
            table = vec![u32::MAX; size];
            for (n, k) in unique.iter().enumerate() {
                let mut slot = k.hash() as usize & (size - 1);
                while table[slot] != u32::MAX {
                    slot = (slot + 1) & (size - 1);
                }
                table[slot] = n as u32;
            }
        }
        let k = key(i);
        let mask = table.len() - 1;
        let mut slot = k.hash() as usize & mask;
        loop {
            let n = table[slot];
            if n == u32::MAX {
                table[slot] = unique.len() as u32;
                of.push(unique.len() as u32);
                unique.push(k);
                break;
            }
            if unique[n as usize] == k {
                of.push(n);
                break;
            }
            slot = (slot + 1) & mask;
        }
    }
    Ok((unique, of))
}

/// Positions with equal bits become one (-0 counts as 0), numbered by first appearance: the welded
/// index of each position, and the welded positions. Coordinates that are not numbers are kept.
pub fn weld_positions(positions: &[Vec3]) -> (Vec<u32>, Vec<Vec3>) {
    let key = |i: usize| (positions[i] + Vec3::ZERO).to_array().map(f32::to_bits);
    // A fresh job is never cancelled.
    let (keys, of) = weld_keys(positions.len(), &Job::default(), key).unwrap_or_default();
    (of, keys.into_iter().map(|k| Vec3::from(k.map(f32::from_bits))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_are_one_in_the_order_of_their_first_use() {
        let p = [Vec3::ONE, Vec3::ZERO, Vec3::ONE, Vec3::new(-0.0, 0.0, 0.0), Vec3::X];
        let (of, welded) = weld_positions(&p);
        assert_eq!(of, [0, 1, 0, 1, 2]);
        assert_eq!(welded, [Vec3::ONE, Vec3::ZERO, Vec3::X]);
        assert!(welded[1].x.is_sign_positive());
    }

    #[test]
    fn the_table_grows_with_what_is_distinct() {
        let many: Vec<Vec3> = (0..10_000).map(|i| Vec3::new(i as f32, 1.0, 2.0)).collect();
        let (of, welded) = weld_positions(&many);
        assert_eq!(welded, many);
        assert!(of.iter().enumerate().all(|(i, &w)| i == w as usize));
    }
}
