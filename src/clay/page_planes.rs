//! Pages as bytes for a quick compressor: each number as its difference to the one before, and of
//! the differences first all lowest bytes, then all second ones, and so on. Neighbours in a page
//! are near each other on the surface, so the higher planes are almost all zeros.
//!
//! As [`Page::to_bytes`] and [`PageTopology::to_bytes`], which a session's file keeps, these give
//! the page again to the bit, and what is read is checked as there.

use std::sync::Arc;

use glam::Vec4;
use serde::{Deserialize, Serialize};

use crate::layers::PageLayers;
use crate::page::{Neighbour, Page, PageTopology, Ring};
use crate::page_sets::PageSets;
use crate::stored::BadPage;

/// The lengths of the lists, and the fields that are not lists of numbers.
#[derive(Serialize, Deserialize)]
struct PageHead {
    revision: u64,
    own: u32,
    halo: u32,
    triangles: u32,
    hexes: u32,
    ring_starts: u32,
    rings: u32,
    neighbours: Vec<Neighbour>,
    layers: Option<PageLayers>,
    sets: bool,
}

/// Appends the planes of numbers.
fn put_words(out: &mut Vec<u8>, values: impl ExactSizeIterator<Item = u32>) {
    let count = values.len();
    let first = out.len();
    out.resize(first + 4 * count, 0);
    let (a, rest) = out[first..].split_at_mut(count);
    let (b, rest) = rest.split_at_mut(count);
    let (c, d) = rest.split_at_mut(count);
    let mut before = 0u32;
    for ((((a, b), c), d), value) in a.iter_mut().zip(b).zip(c).zip(d).zip(values) {
        let difference = value.wrapping_sub(before);
        // Zigzag: small magnitudes have zeros in the higher bytes, whatever their sign.
        let zigzag = (difference << 1) ^ ((difference as i32 >> 31) as u32);
        before = value;
        [*a, *b, *c, *d] = zigzag.to_le_bytes();
    }
}

/// The same of numbers of two bytes.
fn put_halves(out: &mut Vec<u8>, values: impl ExactSizeIterator<Item = u16>) {
    let count = values.len();
    let mut before = 0u16;
    let first = out.len();
    out.resize(first + 2 * count, 0);
    let (low, high) = out[first..].split_at_mut(count);
    for ((low, high), value) in low.iter_mut().zip(high).zip(values) {
        let difference = value.wrapping_sub(before);
        let zigzag = (difference << 1) ^ ((difference as i16 >> 15) as u16);
        before = value;
        [*low, *high] = zigzag.to_le_bytes();
    }
}

/// Reads what [`put_words`] and [`put_halves`] wrote.
struct PlaneReader<'a>(&'a [u8]);

impl<'a> PlaneReader<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], BadPage> {
        let (bytes, rest) = self.0.split_at_checked(count).ok_or(BadPage)?;
        self.0 = rest;
        Ok(bytes)
    }

    fn words(&mut self, count: usize) -> Result<impl Iterator<Item = u32> + use<'a>, BadPage> {
        let bytes = self.bytes(count.checked_mul(4).ok_or(BadPage)?)?;
        let (a, rest) = bytes.split_at(count);
        let (b, rest) = rest.split_at(count);
        let (c, d) = rest.split_at(count);
        let mut before = 0u32;
        Ok(a.iter().zip(b).zip(c).zip(d).map(move |(((a, b), c), d)| {
            let zigzag = u32::from_le_bytes([*a, *b, *c, *d]);
            before = before.wrapping_add((zigzag >> 1) ^ (zigzag & 1).wrapping_neg());
            before
        }))
    }

    fn halves(&mut self, count: usize) -> Result<Vec<u16>, BadPage> {
        let bytes = self.bytes(count.checked_mul(2).ok_or(BadPage)?)?;
        let (low, high) = bytes.split_at(count);
        let mut before = 0u16;
        let value = |(low, high): (&u8, &u8)| {
            let zigzag = u16::from_le_bytes([*low, *high]);
            before = before.wrapping_add((zigzag >> 1) ^ (zigzag & 1).wrapping_neg());
            before
        };
        Ok(low.iter().zip(high).map(value).collect())
    }

    fn rows(&mut self, count: usize) -> Result<Vec<Vec4>, BadPage> {
        let mut lane = || self.words(count).map(|w| w.map(f32::from_bits));
        let (x, y, z, w) = (lane()?, lane()?, lane()?, lane()?);
        Ok(x.zip(y).zip(z).zip(w).map(|(((x, y), z), w)| Vec4::new(x, y, z, w)).collect())
    }
}

impl Page {
    /// Appends the page with its topology.
    pub fn put_planes(&self, out: &mut Vec<u8>) {
        let t = self.topology();
        let head = PageHead {
            revision: self.revision,
            own: t.own as u32,
            halo: t.halo_sources.len() as u32,
            triangles: t.triangles.len() as u32,
            hexes: t.hexes.len() as u32,
            ring_starts: t.ring_starts.len() as u32,
            rings: t.rings.len() as u32,
            neighbours: t.neighbours.clone(),
            layers: self.layers().cloned(),
            sets: self.sets().is_some(),
        };
        // Plain data always serialises.
        let head = postcard::to_stdvec(&head).unwrap_or_default();
        out.extend_from_slice(&(head.len() as u32).to_le_bytes());
        out.extend_from_slice(&head);
        out.extend(t.kinds.iter().map(|k| *k as u8));
        put_words(out, t.ids.iter().copied());
        put_words(out, t.triangle_ids.iter().copied());
        put_halves(out, t.triangles.as_flattened().iter().copied());
        put_halves(out, t.hexes.flat().iter().copied());
        put_halves(out, t.ring_starts.iter().copied());
        put_halves(out, t.rings.iter().copied());
        put_halves(out, t.halo_sources.iter().copied());
        if let Some(sets) = self.sets() {
            put_halves(out, sets.rows().iter().copied());
        }
        for rows in [&self.points, &self.normals] {
            for lane in 0..4 {
                put_words(out, rows.iter().map(|r| r[lane].to_bits()));
            }
        }
    }

    /// Reads a page from the beginning of `bytes`, and gives what follows it.
    ///
    /// # Errors
    /// [`BadPage`] where the bytes are not those of a page.
    pub fn take_planes(bytes: &[u8]) -> Result<(Page, &[u8]), BadPage> {
        let (size, bytes) = bytes.split_first_chunk::<4>().ok_or(BadPage)?;
        let size = u32::from_le_bytes(*size) as usize;
        let (head, bytes) = bytes.split_at_checked(size).ok_or(BadPage)?;
        let head: PageHead = postcard::from_bytes(head).map_err(|_| BadPage)?;
        let mut from = PlaneReader(bytes);
        let (own, halo) = (head.own as usize, head.halo as usize);
        let all = own.checked_add(halo).ok_or(BadPage)?;
        let kind = |byte: &u8| match byte {
            0 => Ok(Ring::Closed),
            1 => Ok(Ring::Open),
            2 => Ok(Ring::ManyFans),
            _ => Err(BadPage),
        };
        let kinds = from.bytes(own)?.iter().map(kind).collect::<Result<_, _>>()?;
        let ids = from.words(own)?.collect();
        let triangle_ids = from.words(head.triangles as usize)?.collect();
        let corners = |count: u32, each: usize| (count as usize).checked_mul(each).ok_or(BadPage);
        let triangles = from.halves(corners(head.triangles, 3)?)?;
        let hexes = from.halves(corners(head.hexes, 6)?)?;
        let topology = PageTopology {
            own,
            ids,
            triangles: triangles.as_chunks().0.to_vec(),
            triangle_ids,
            hexes: hexes.as_chunks().0.to_vec().into(),
            ring_starts: from.halves(head.ring_starts as usize)?,
            rings: from.halves(head.rings as usize)?,
            kinds,
            halo_sources: from.halves(halo)?,
            neighbours: head.neighbours,
            ..PageTopology::default()
        };
        let topology = Arc::new(topology.checked()?);
        let sets = if head.sets { PageSets::shared(from.halves(all)?) } else { None };
        let layers = head.layers.unwrap_or_default();
        if !layers.fits(own) {
            return Err(BadPage);
        }
        let (points, normals) = (from.rows(all)?, from.rows(all)?);
        let page = Page {
            topology,
            points,
            normals,
            revision: head.revision,
            layers: layers.shared(),
            sets,
            ..Page::default()
        };
        Ok((page.of_read()?, from.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clay::Clay;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    fn same(a: &Page, b: &Page) -> bool {
        (a.revision(), a.to_bytes(), a.topology().to_bytes(), a.lo, a.hi)
            == (b.revision(), b.to_bytes(), b.topology().to_bytes(), b.lo, b.hi)
    }

    #[test]
    fn pages_come_back_to_the_bit_and_broken_ones_are_refused() {
        let mut mesh =
            Clay::build(&shapes::sphere_of_about(3_000), &Job::default()).expect("a ball");
        let clay = mesh.snapshot();
        let mut bytes = Vec::new();
        clay.pages().for_each(|p| p.put_planes(&mut bytes));
        let mut rest = &bytes[..];
        for page in clay.pages() {
            let (again, after) = Page::take_planes(rest).expect("a page");
            assert!(same(page, &again));
            rest = after;
        }
        assert!(rest.is_empty());
        for cut in (0..bytes.len()).step_by(997) {
            let mut rest = &bytes[..cut];
            while let Ok((_, after)) = Page::take_planes(rest) {
                rest = after;
            }
        }
        let first = bytes.len().min(40_000);
        for at in (0..first).step_by(61) {
            let mut changed = bytes[..first].to_vec();
            changed[at] ^= 0x5a;
            // Refused, or a page of sane places: nothing else may come of it.
            if let Ok((page, _)) = Page::take_planes(&changed) {
                assert!(page.points.iter().all(|p| p.is_finite()));
            }
        }
    }
}
