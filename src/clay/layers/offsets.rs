//! The layers of one page: its base, the offsets of each layer, and their sum.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::stack::{LayerId, LayerStack, MAX_LAYERS};

/// The offsets of a layer in a page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LayerRow {
    /// The layer.
    pub layer: LayerId,
    /// One offset per owned vertex, in the object frame, in mesh units.
    pub offsets: Arc<Vec<DVec3>>,
}

/// The layer data of a page.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PageLayers {
    /// The list of layers; in the first page only.
    pub(crate) stack: Option<Arc<LayerStack>>,
    /// The positions of the owned vertices without any layer; empty if no layer changes the page,
    /// whose surface is then its base.
    pub(crate) base: Arc<Vec<DVec3>>,
    /// The layers that change the page, in no particular order.
    pub(crate) rows: Vec<LayerRow>,
}

impl PageLayers {
    /// The offsets of a layer; `None`: it does not change the page.
    pub fn row(&self, id: LayerId) -> Option<&[DVec3]> {
        self.rows.iter().find(|r| r.layer == id).map(|r| r.offsets.as_slice())
    }

    /// The offsets of all layers that change the page.
    pub fn rows(&self) -> &[LayerRow] {
        &self.rows
    }

    /// Returns the positions of the owned vertices without any layer; empty if no layer changes the
    /// page.
    pub fn base(&self) -> &[DVec3] {
        &self.base
    }

    /// Itself for a page; nothing where there is nothing in it.
    pub(crate) fn shared(mut self) -> Option<Arc<PageLayers>> {
        if self.rows.is_empty() {
            self.base = Arc::default();
        }
        let empty = self.stack.is_none() && self.rows.is_empty();
        (!empty).then(|| Arc::new(self))
    }

    /// Replaces the offsets of a layer.
    pub(crate) fn put(&mut self, layer: LayerId, offsets: Vec<DVec3>) {
        self.rows.retain(|r| r.layer != layer);
        if offsets.iter().any(|o| *o != DVec3::ZERO) {
            self.rows.push(LayerRow { layer, offsets: Arc::new(offsets) });
        }
    }

    /// Returns true if it fits a page of `own` owned vertices.
    pub(crate) fn fits(&self, own: usize) -> bool {
        let finite = |all: &[DVec3]| all.iter().all(|p| p.is_finite());
        let base = if self.rows.is_empty() { 0 } else { own };
        self.base.len() == base
            && finite(&self.base)
            && self.rows.len() <= MAX_LAYERS
            && self.stack.as_ref().is_none_or(|s| s.is_sane())
            && self.rows.iter().enumerate().all(|(i, r)| {
                r.offsets.len() == own
                    && finite(&r.offsets)
                    && self.rows[..i].iter().all(|other| other.layer != r.layer)
            })
    }

    /// Returns the layer data of a page assembled from vertices. Each vertex has a position, and
    /// the layer data of its old page if it had one. A new vertex belongs to the base.
    pub(crate) fn gathered<'a>(
        vertices: impl ExactSizeIterator<Item = (Vec3, Option<(&'a PageLayers, usize)>)>,
    ) -> Option<Arc<PageLayers>> {
        let count = vertices.len();
        let mut base = Vec::with_capacity(count);
        let mut rows: Vec<(LayerId, Vec<DVec3>)> = Vec::new();
        for (v, (place, from)) in vertices.enumerate() {
            let old = from.and_then(|(l, v)| l.base.get(v).map(|base| (l, v, *base)));
            base.push(old.map_or(place.as_dvec3(), |o| o.2));
            let Some((layers, at, _)) = old else { continue };
            for row in &layers.rows {
                let k = rows.iter().position(|r| r.0 == row.layer).unwrap_or_else(|| {
                    rows.push((row.layer, vec![DVec3::ZERO; count]));
                    rows.len() - 1
                });
                rows[k].1[v] = row.offsets[at];
            }
        }
        let mut new = PageLayers { base: Arc::new(base), ..PageLayers::default() };
        rows.sort_unstable_by_key(|r| r.0);
        rows.into_iter().for_each(|(layer, offsets)| new.put(layer, offsets));
        new.shared()
    }

    /// Everything that it holds, as words for a hash.
    pub(crate) fn words(&self) -> Vec<u32> {
        let mut out = Vec::new();
        if let Some(stack) = &self.stack {
            out.extend([stack.next, stack.active.map_or(u32::MAX, |id| id.0)]);
            for layer in &stack.layers {
                out.extend([layer.id.0, layer.intensity.to_bits(), u32::from(layer.visible)]);
                out.extend(layer.name.bytes().map(u32::from));
            }
        }
        let mut all = |places: &[DVec3]| {
            for x in places.iter().flat_map(|p| p.to_array()) {
                out.extend([x.to_bits() as u32, (x.to_bits() >> 32) as u32]);
            }
        };
        all(&self.base);
        let mut rows: Vec<&LayerRow> = self.rows.iter().collect();
        rows.sort_unstable_by_key(|r| r.layer);
        rows.iter().for_each(|r| all(&r.offsets));
        out.extend(rows.iter().map(|r| r.layer.0));
        out
    }

    /// Returns its size in the undo budget, in bytes.
    pub(crate) fn weight(&self) -> usize {
        size_of::<PageLayers>() + self.base.len() * 24 * (1 + self.rows.len())
    }
}

/// The base and the layers of a page with the weight of each, from the lowest up. The one place
/// that says where the vertices of a page are.
#[derive(Debug, Clone, Copy)]
pub struct LayerSum<'a> {
    base: &'a [DVec3],
    parts: [(&'a [DVec3], f64); MAX_LAYERS],
    count: usize,
    /// The index of the active layer's part.
    active: Option<usize>,
}

impl<'a> LayerSum<'a> {
    /// The sum of a page that a layer changes; `None` for another. An active layer that does not
    /// change the page yet is a part of no offsets.
    pub fn new(stack: &LayerStack, page: &'a PageLayers) -> Option<LayerSum<'a>> {
        if page.base.is_empty() {
            return None;
        }
        let mut sum =
            LayerSum { base: &page.base, parts: [(&[], 0.0); MAX_LAYERS], count: 0, active: None };
        for layer in stack.layers.iter().take(MAX_LAYERS) {
            let row = page.row(layer.id).unwrap_or(&[]);
            let active = stack.active == Some(layer.id);
            if active || (!row.is_empty() && layer.weight() != 0.0) {
                if active {
                    sum.active = Some(sum.count);
                }
                sum.parts[sum.count] = (row, layer.weight());
                sum.count += 1;
            }
        }
        Some(sum)
    }

    /// Returns the position of owned vertex `v`, with this offset in part `other`.
    #[inline(always)]
    fn with(&self, v: usize, other: usize, offset: DVec3) -> DVec3 {
        let mut p = self.base[v];
        for (k, (row, weight)) in self.parts[..self.count].iter().enumerate() {
            if k == other {
                p += offset * *weight;
            } else if let Some(o) = row.get(v)
                && *weight != 0.0
            {
                p += *o * *weight;
            }
        }
        p
    }

    /// Returns the position of owned vertex `v`.
    #[inline(always)]
    pub fn at(&self, v: usize) -> Vec3 {
        self.with(v, usize::MAX, DVec3::ZERO).as_vec3()
    }

    /// Returns the position of owned vertex `v` without the active layer; without any layer if the
    /// base is active.
    #[inline(always)]
    pub fn below(&self, v: usize) -> Vec3 {
        match self.active {
            Some(active) => self.with(v, active, DVec3::ZERO).as_vec3(),
            None => self.base[v].as_vec3(),
        }
    }

    /// The offset of the active layer with which own vertex `v` is at `p`. The active layer takes
    /// strokes.
    pub(crate) fn offset_for(&self, v: usize, p: Vec3) -> DVec3 {
        let Some(active) = self.active else { return DVec3::ZERO };
        let weight = self.parts[active].1;
        let mut offset = (p.as_dvec3() - self.with(v, active, DVec3::ZERO)) / weight;
        // One round is enough unless the magnitudes differ by more than double precision spans.
        for _ in 0..3 {
            let there = self.with(v, active, offset);
            if there.as_vec3() == p {
                break;
            }
            offset += (p.as_dvec3() - there) / weight;
        }
        offset
    }

    /// The offset of the active layer at own vertex `v`.
    pub(crate) fn offset(&self, v: usize) -> DVec3 {
        let row = self.active.map_or(&[][..], |k| self.parts[k].0);
        row.get(v).copied().unwrap_or(DVec3::ZERO)
    }

    /// Returns the base position of owned vertex `v` that puts the vertex at `p`.
    pub(crate) fn base_for(&self, v: usize, p: Vec3) -> DVec3 {
        let mut base = self.base[v] + (p.as_dvec3() - self.with(v, usize::MAX, DVec3::ZERO));
        for _ in 0..3 {
            let mut there = LayerSum { base: &[base], ..*self };
            // The parts are those of `v`, the base is the new one.
            for part in &mut there.parts[..there.count] {
                part.0 = part.0.get(v..v + 1).unwrap_or(&[]);
            }
            let there = there.with(0, usize::MAX, DVec3::ZERO);
            if there.as_vec3() == p {
                break;
            }
            base += p.as_dvec3() - there;
        }
        base
    }
}
