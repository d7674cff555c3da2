//! Several edits of one clay become one, where none changed what another has looked at.

use std::sync::Arc;

use super::edit::{CHANGED, Edit, NONE};
use crate::page::Page;

/// The place of each page of one edit in another: slot and first handle.
pub(crate) type SlotMap = Vec<(u32, u32)>;

impl Edit {
    /// Takes over what `other` changed. Neither may have changed a vertex in a page that is open to
    /// the other, and this one's pages were not read for another reason. `map`: memory.
    pub(crate) fn absorb(&mut self, pages: &[Arc<Page>], other: &mut Edit, map: &mut SlotMap) {
        map.clear();
        for s in &other.slots {
            let slot = self.slot(pages, s.page);
            map.push((slot, self.slots[slot as usize].base));
        }
        for at in 0..other.made.len() {
            let (h, new) = (other.made[at] as usize, self.reserve(1));
            other.number[h] = new;
            self.made.push(new);
            self.source[new as usize] = NONE;
            self.local[new as usize] = u16::MAX;
        }
        for s in &other.slots {
            for h in s.base..s.base + s.own {
                if other.state[h as usize] & CHANGED != 0 {
                    self.copy_vertex(other, map, h);
                }
            }
        }
        for &h in &other.made {
            self.copy_vertex(other, map, h);
        }
        let there = |t: &[u32; 3]| t.map(|h| counterpart(other, map, h));
        self.created.extend(other.created.iter().map(there));
        for &slot in &other.dirty {
            self.mark_page(map[slot as usize].0);
        }
    }

    fn copy_vertex(&mut self, other: &Edit, map: &SlotMap, h: u32) {
        let (to, from) = (counterpart(other, map, h) as usize, h as usize);
        self.state[to] = other.state[from];
        self.home[to] = map[other.home[from] as usize].0;
        self.points[to] = other.points[from];
        self.colours[to] = other.colours[from];
        self.sets[to] = other.sets[from];
        let ring = other.ring(h);
        self.valence[to] = ring.len() as u8;
        for (to, &n) in self.rings[to].iter_mut().zip(ring) {
            *to = counterpart(other, map, n);
        }
    }
}

/// The handle here of a vertex of `other`.
fn counterpart(other: &Edit, map: &SlotMap, h: u32) -> u32 {
    match other.source[h as usize] {
        NONE => other.number[h as usize],
        slot => map[slot as usize].1 + (h - other.slots[slot as usize].base),
    }
}
