//! Edits of an object's layers: the list is changed at once, the pages in portions.

use std::sync::Arc;

use super::kernel::{LayerKernel, LayerOperation, StackKernel};
use crate::layers::{
    Layer, LayerEdit, LayerError, LayerId, LayerStack, LayerSum, MAX_INTENSITY, MAX_LAYERS,
    PageLayers,
};
use crate::{Clay, DabReport, Workers};

/// The page updates that remain after a change of the list of layers.
#[derive(Debug)]
pub struct LayerJob {
    /// The operation on each page.
    pub operation: LayerOperation,
    /// The pages, ascending.
    pub pages: Vec<u32>,
    /// The layer that was made, or that it was about.
    pub layer: Option<LayerId>,
}

impl Clay {
    /// The layers of the object; `None`: it never had any.
    pub fn layers(&self) -> Option<&Arc<LayerStack>> {
        self.pages.first()?.layers.as_ref()?.stack.as_ref()
    }

    /// Returns the number of layers.
    pub fn layer_count(&self) -> usize {
        self.layers().map_or(0, |s| s.layers.len())
    }

    /// Returns true if strokes can change the active layer: it is the base, or it is visible and
    /// its intensity is not near 0.
    pub fn takes_strokes(&self) -> bool {
        self.layers().is_none_or(|s| s.takes_strokes())
    }

    /// Carries out an edit: the list of layers is the new one at once, and what is left is to be
    /// given to [`Clay::run_layers`], page by page, before anything else changes the clay. Part of
    /// the open undo step. Costs as much as there are pages.
    ///
    /// # Errors
    /// [`LayerError`] where it cannot be carried out; nothing was changed then.
    pub fn edit_layers(
        &mut self,
        edit: &LayerEdit,
        workers: &Workers,
    ) -> Result<LayerJob, LayerError> {
        let old = self.layers().cloned().unwrap_or_default();
        let mut stack = LayerStack::clone(&old);
        let at = |id: LayerId| old.index_of(id).ok_or(LayerError::NoLayer(id));
        let room = |more: usize| {
            if old.layers.len() + more <= MAX_LAYERS { Ok(()) } else { Err(LayerError::Full) }
        };
        let made = |stack: &mut LayerStack, place: usize, name: &str, intensity: f32| {
            let id = LayerId(stack.next);
            stack.next += 1;
            let name = name.to_owned();
            stack.layers.insert(place, Layer { id, name, intensity, visible: true });
            id
        };
        let in_range = |i: f32| {
            if i.is_finite() {
                Ok(i.clamp(-MAX_INTENSITY, MAX_INTENSITY))
            } else {
                Err(LayerError::Intensity)
            }
        };
        let nothing = LayerOperation::Evaluate;
        let (operation, concerned, layer) = match edit {
            LayerEdit::Add(name) => {
                room(1)?;
                let id = made(&mut stack, old.layers.len(), name, 1.0);
                stack.active = Some(id);
                (nothing, None, Some(id))
            }
            LayerEdit::Import(layers) => {
                room(layers.len())?;
                let mut ids = Vec::with_capacity(layers.len());
                for layer in layers.iter() {
                    let place = stack.layers.len();
                    let intensity = in_range(layer.intensity)?;
                    ids.push(made(&mut stack, place, &layer.name, intensity));
                    stack.layers[place].visible = layer.visible;
                }
                let first = ids.first().copied();
                let pages = self.pages_of(|p| p.own() > 0);
                let operation = LayerOperation::Insert(ids, layers.clone());
                let job = LayerJob { operation, pages, layer: first };
                self.put_stack(stack, workers);
                return Ok(job);
            }
            LayerEdit::Remove(id) => {
                let place = at(*id)?;
                stack.layers.remove(place);
                if stack.active == Some(*id) {
                    stack.active = place.checked_sub(1).map(|below| stack.layers[below].id);
                }
                (LayerOperation::Drop(*id), Some(*id), Some(*id))
            }
            LayerEdit::Rename(id, name) => {
                stack.layers[at(*id)?].name.clone_from(name);
                (nothing, None, Some(*id))
            }
            LayerEdit::Move(id, to) => {
                let layer = stack.layers.remove(at(*id)?);
                let to = (*to as usize).min(stack.layers.len());
                stack.layers.insert(to, layer);
                (nothing, Some(*id), Some(*id))
            }
            LayerEdit::Set { id, intensity, visible, live: _ } => {
                let layer = &mut stack.layers[at(*id)?];
                if let Some(intensity) = intensity {
                    layer.intensity = in_range(*intensity)?;
                }
                layer.visible = visible.unwrap_or(layer.visible);
                (nothing, Some(*id), Some(*id))
            }
            LayerEdit::Activate(id) => {
                id.map(at).transpose()?;
                stack.active = *id;
                (nothing, None, *id)
            }
            LayerEdit::MergeDown(id) => {
                let place = at(*id)?;
                let upper = &old.layers[place];
                let lower = place.checked_sub(1).map(|below| &old.layers[below]);
                if let Some(hidden) =
                    [Some(upper), lower].into_iter().flatten().find(|l| !l.visible)
                {
                    return Err(LayerError::Hidden(hidden.id));
                }
                stack.layers.remove(place);
                if let Some(below) = place.checked_sub(1) {
                    stack.layers[below].intensity = 1.0;
                }
                if stack.active == Some(*id) {
                    stack.active = lower.map(|l| l.id);
                }
                let weighted = |l: &Layer| (l.id, l.weight());
                let operation =
                    LayerOperation::Merge { upper: weighted(upper), lower: lower.map(weighted) };
                // The intensity of the lower one is another: all its pages are concerned.
                let has = |l: &PageLayers, id| l.row(id).is_some();
                let pages = self.pages_of(|p| {
                    p.layers().is_some_and(|l| has(l, *id) || lower.is_some_and(|w| has(l, w.id)))
                });
                let job = LayerJob { operation, pages, layer: lower.map(|l| l.id) };
                self.put_stack(stack, workers);
                return Ok(job);
            }
            LayerEdit::Duplicate(id) => {
                room(1)?;
                let place = at(*id)?;
                let Layer { name, intensity, .. } = old.layers[place].clone();
                let to = made(&mut stack, place + 1, &name, intensity);
                stack.layers[place + 1].visible = false;
                stack.active = Some(to);
                (LayerOperation::Copy { from: *id, to }, Some(*id), Some(to))
            }
            LayerEdit::Clear(id) => {
                at(*id)?;
                (LayerOperation::Drop(*id), Some(*id), Some(*id))
            }
            LayerEdit::Bake => {
                if old.layers.is_empty() {
                    return Err(LayerError::None);
                }
                stack.layers.clear();
                stack.active = None;
                let pages = self.pages_of(|p| p.layers().is_some_and(|l| !l.rows.is_empty()));
                let job = LayerJob { operation: LayerOperation::Bake, pages, layer: None };
                self.put_stack(stack, workers);
                return Ok(job);
            }
        };
        let pages = concerned.map_or(Vec::new(), |id| self.pages_of_layer(id));
        self.put_stack(stack, workers);
        Ok(LayerJob { operation, pages, layer })
    }

    /// The pages that a layer changes, ascending. Costs a little for each page.
    pub fn pages_of_layer(&self, id: LayerId) -> Vec<u32> {
        self.pages_of(|p| p.layers().is_some_and(|l| l.row(id).is_some()))
    }

    fn pages_of(&self, which: impl Fn(&crate::Page) -> bool) -> Vec<u32> {
        (0u32..).zip(&self.pages).filter(|(_, p)| which(p)).map(|(i, _)| i).collect()
    }

    fn put_stack(&mut self, stack: LayerStack, workers: &Workers) {
        if self.layers().is_none_or(|old| **old != stack) {
            self.dab_on(&[0], &StackKernel(&Arc::new(stack)), workers);
        }
    }

    /// Does what an edit left to be done to these pages, ascending. Part of the open undo step.
    pub fn run_layers(
        &mut self,
        operation: &LayerOperation,
        pages: &[u32],
        workers: &Workers,
    ) -> DabReport {
        let Some(stack) = self.layers().cloned() else { return DabReport::default() };
        self.dab_on(pages, &LayerKernel { operation, stack: &stack }, workers)
    }

    /// The pages whose offsets a stroke has to take over ([`LayerOperation::Capture`]): all that
    /// the open step has touched, in an object that has layers. `out` is emptied first.
    pub fn touched_by_step(&self, out: &mut Vec<u32>) {
        out.clear();
        let Some(stack) = self.layers() else { return };
        let active = stack.active.is_some();
        self.history.each_before(|i, _| {
            let page = &self.pages[i as usize];
            if active || page.layers().is_some_and(|l| !l.rows.is_empty()) {
                out.push(i);
            }
        });
        out.sort_unstable();
    }

    /// Checks that each page changed by layers equals, to the bit, the sum of them. Not valid while
    /// a stroke or an edit is under way.
    ///
    /// # Errors
    /// Returns the condition that does not hold.
    pub fn verify_layers(&self) -> Result<(), String> {
        let empty = LayerStack::default();
        let stack = self.layers().map_or(&empty, |s| s);
        for (i, page) in self.pages.iter().enumerate() {
            let Some(layers) = page.layers() else { continue };
            if i > 0 && layers.stack.is_some() {
                return Err(format!("page {i}: it has a list of layers"));
            }
            if !layers.fits(page.own()) {
                return Err(format!("page {i}: its layers do not fit it"));
            }
            if let Some(r) = layers.rows.iter().find(|r| stack.layer(r.layer).is_none()) {
                return Err(format!("page {i}: there is no layer {}", r.layer));
            }
            let Some(sum) = LayerSum::new(stack, layers) else { continue };
            for v in 0..page.own() {
                let (p, there) = (page.point(v), sum.at(v));
                if p != there {
                    return Err(format!("page {i}: vertex {v} is at {p}, its layers say {there}"));
                }
            }
        }
        Ok(())
    }
}
