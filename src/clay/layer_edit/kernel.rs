//! What an edit does to one page: to its offsets, and to its surface.

use std::sync::Arc;

use glam::DVec3;

use crate::layers::{LayerId, LayerOffsets, LayerRow, LayerStack, LayerSum, PageLayers};
use crate::{Kernel, PageIn, PageOut};

/// An operation on each page of a list. All but [`LayerOperation::Capture`] and
/// [`LayerOperation::Bake`] then set the surface to the sum of its layers.
#[derive(Debug, Clone)]
pub enum LayerOperation {
    /// Only re-evaluates: an intensity, the visibility or the order changed.
    Evaluate,
    /// Stores the open step's changes to the surface as offsets of the active layer, or in the
    /// base.
    Capture,
    /// Removes the offsets of a layer.
    Drop(LayerId),
    /// The offsets of a layer, times a weight, are added to the base or to those of another layer,
    /// times another weight.
    Merge {
        /// The layer that goes, and its weight.
        upper: (LayerId, f64),
        /// The layer that it is added to, and its weight; `None`: the base.
        lower: Option<(LayerId, f64)>,
    },
    /// The offsets of a layer become those of another, too.
    Copy {
        /// The layer that has offsets.
        from: LayerId,
        /// The layer that gets them.
        to: LayerId,
    },
    /// The surface becomes the base, and all offsets go.
    Bake,
    /// Layers get offsets by the numbers of vertices.
    Insert(Vec<LayerId>, Arc<Vec<LayerOffsets>>),
}

impl LayerOperation {
    /// Returns true if the surface is the sum of its layers afterwards, whatever it was before.
    fn evaluates(&self) -> bool {
        !matches!(self, LayerOperation::Capture | LayerOperation::Bake)
    }

    /// Returns the new layer data of the page; `None` keeps the current one.
    fn apply(&self, page: &PageIn<'_>, stack: &LayerStack) -> Option<PageLayers> {
        let old = page.layers();
        match self {
            LayerOperation::Evaluate => None,
            LayerOperation::Capture => capture(page, stack),
            LayerOperation::Drop(id) => {
                let mut new = old.filter(|l| l.row(*id).is_some())?.clone();
                new.rows.retain(|r| r.layer != *id);
                Some(new)
            }
            LayerOperation::Merge { upper, lower } => {
                let old = old?;
                let mut new = old.clone();
                new.rows.retain(|r| r.layer != upper.0);
                let scaled = |(id, weight): (LayerId, f64)| {
                    let row = old.row(id).unwrap_or(&[]);
                    move |v: usize| row.get(v).map_or(DVec3::ZERO, |o| *o * weight)
                };
                let add = scaled(*upper);
                match lower {
                    None => {
                        let base = old.base.iter().enumerate().map(|(v, b)| *b + add(v));
                        new.base = Arc::new(base.collect());
                    }
                    Some(lower) => {
                        let below = scaled(*lower);
                        new.put(lower.0, (0..page.own()).map(|v| below(v) + add(v)).collect());
                    }
                }
                Some(new)
            }
            LayerOperation::Copy { from, to } => {
                let mut new = old?.clone();
                let row = new.rows.iter().find(|r| r.layer == *from)?.offsets.clone();
                new.rows.push(LayerRow { layer: *to, offsets: row });
                Some(new)
            }
            LayerOperation::Bake => {
                let mut new = old.filter(|l| !l.rows.is_empty())?.clone();
                new.rows.clear();
                Some(new)
            }
            LayerOperation::Insert(ids, layers) => {
                let mut new = old.cloned().unwrap_or_default();
                for (id, layer) in ids.iter().zip(layers.iter()) {
                    let offset = |v: usize| {
                        let at = layer.offsets.binary_search_by_key(&page.id(v), |o| o.0).ok()?;
                        let o = DVec3::from_array(layer.offsets[at].1.map(f64::from));
                        Some(o).filter(|o| o.is_finite())
                    };
                    let row = (0..page.own()).map(|v| offset(v).unwrap_or_default()).collect();
                    new.put(*id, row);
                }
                if new.rows.len() == old.map_or(0, |l| l.rows.len()) {
                    return None;
                }
                if new.base.is_empty() {
                    let places = (0..page.own()).map(|v| page.point(v as u16).as_dvec3());
                    new.base = Arc::new(places.collect());
                }
                Some(new)
            }
        }
    }
}

/// The offsets of the active layer, or the base, with which the sum is the surface as it is.
/// `None`: it is that already.
fn capture(page: &PageIn<'_>, stack: &LayerStack) -> Option<PageLayers> {
    let own = page.own();
    let old = page.layers();
    let moved =
        |was: &dyn Fn(usize) -> glam::Vec3| (0..own).any(|v| was(v) != page.positions.get(v));
    let Some(sum) = old.and_then(|l| LayerSum::new(stack, l)) else {
        // No layer changes the page yet. If its triangles changed, the old positions of its
        // vertices are unknown: the page stays a part of the base.
        let active = stack.active().filter(|l| l.takes_strokes())?.id;
        let new = PageLayers {
            base: Arc::new((0..own).map(|v| page.before(v).as_dvec3()).collect()),
            ..old.cloned().unwrap_or_default()
        };
        let sum = LayerSum::new(stack, &new).filter(|_| moved(&|v| page.before(v)))?;
        let offsets = offsets(page, &sum);
        let mut new = new;
        new.put(active, offsets);
        return Some(new);
    };
    if !moved(&|v| sum.at(v)) {
        return None;
    }
    let mut new = old.cloned()?;
    // Movement goes to the base if the active layer takes no strokes.
    match stack.active().filter(|l| l.takes_strokes()) {
        Some(active) => new.put(active.id, offsets(page, &sum)),
        None => {
            let base = (0..own).map(|v| match page.positions.get(v) {
                p if p == sum.at(v) => new.base[v],
                p => sum.base_for(v, p),
            });
            new.base = Arc::new(base.collect());
        }
    }
    Some(new)
}

fn offsets(page: &PageIn<'_>, sum: &LayerSum<'_>) -> Vec<DVec3> {
    let one = |v| match page.positions.get(v) {
        p if p == sum.at(v) => sum.offset(v),
        p => sum.offset_for(v, p),
    };
    (0..page.own()).map(one).collect()
}

/// An operation as a kernel.
#[derive(Debug)]
pub(super) struct LayerKernel<'a> {
    pub(super) operation: &'a LayerOperation,
    pub(super) stack: &'a LayerStack,
}

impl Kernel for LayerKernel<'_> {
    const CHANGES_HIDDEN: bool = true;

    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let new = self.operation.apply(page, self.stack);
        out.visit_many(page.own());
        if self.operation.evaluates()
            && let Some(layers) = new.as_ref().or(page.layers())
        {
            // A page whose last layer went is where its base is.
            if let Some(sum) = LayerSum::new(self.stack, layers) {
                (0..page.own()).for_each(|v| out.set(v, sum.at(v)));
            }
        }
        if let Some(new) = new {
            out.set_layers(new.shared());
        }
    }
}

/// Gives the first page another list of layers.
#[derive(Debug)]
pub(super) struct StackKernel<'a>(pub(super) &'a Arc<LayerStack>);

impl Kernel for StackKernel<'_> {
    const CHANGES_HIDDEN: bool = true;

    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let mut new = page.layers().cloned().unwrap_or_default();
        new.stack = Some(self.0.clone());
        out.set_layers(new.shared());
    }
}
