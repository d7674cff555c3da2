//! Texture: an alpha becomes relief along the stroke, bent as the stroke is, repeating along it.
//!
//! The relief is laid on the surface as the stroke found it, along that surface's normals:
//! `strength * radius` high where the alpha is 1. Strokes that cross themselves do not pile up.

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use super::falloff::Falloff;
use super::footprint::Footprint;
use super::preset::OwnNumber;
use crate::Reach;
use crate::brush::surface_query::SurfaceQuery;

/// One dab of texture, made ready.
#[derive(Debug, Clone, Copy)]
pub struct TextureBrush {
    /// The newest samples' numbers; vertices that belong to older ones stay as they are.
    newest: u32,
}

impl Brush for TextureBrush {
    const CUTS: bool = false;
    const FOUND: bool = true;
    const OWN_NUMBERS: &'static [OwnNumber] = &[
        OwnNumber {
            name: "scale",
            value: 1.0,
            min: 0.1,
            max: 10.0,
            about: "length of one repeat, in widths of the brush",
        },
        OwnNumber {
            name: "floor",
            value: 0.0,
            min: 0.0,
            max: 1.0,
            about: "the height of the alpha that stays on the surface; what is lower is pressed in",
        },
        OwnNumber {
            name: "width",
            value: 1.0,
            min: 0.1,
            max: 10.0,
            about: "width of the alpha in brush widths: below 1 it repeats, above 1 it is cropped",
        },
    ];

    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        TextureBrush { newest: on.unroll(dab) }
    }

    fn reach(dab: &Dab<'_>) -> Reach {
        dab.ball(wide(dab))
    }

    /// Returns the area that the dab may change; the coordinates decide the change there.
    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        let ball = Footprint::ball(dab);
        let radius = if self.newest > 0 { dab.radius * wide(dab) } else { f32::MIN_POSITIVE };
        Some(Footprint { radius, hardness: 0.0, falloff: Falloff::Constant, ..ball })
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let Some(unroll) = spot.scratch.unrolled(dab.image) else { return VertexChange::default() };
        if unroll.owner(spot.number, spot.v) + 1 < self.newest {
            return VertexChange::default();
        }
        let Some([u, v]) = unroll.walk.place(spot.number, spot.v) else {
            return VertexChange::default();
        };
        let far = unroll.off_stroke([u, v]);
        // A square of the alpha is as wide as the brush, and `scale` times as long.
        let width = dab.radius * dab.extra(2);
        let (s, t) = (u / (2.0 * dab.radius * dab.extra(0)), 0.5 + 0.5 * v * dab.hand / width);
        let t = if (0.0..=1.0).contains(&t) { t } else { t - t.floor() };
        let (alpha, picture) = (dab.settings.alpha, spot.scratch.picture());
        // Transparent parts of the picture leave the surface as it is, whatever the floor.
        let relief = alpha.at(s, t, picture) - dab.extra(1) * alpha.cover(s, t, picture);
        let h = dab.whole_height() * relief * dab.fade(far * far) * spot.weight;
        VertexChange::held(spot.page.normal_before(spot.v) * h)
    }
}

/// Returns the reach of a dab, in radii. It recomputes the stretch between the last two samples of
/// the stroke, which may have been raised since if the dab is measured on the current surface.
fn wide(dab: &Dab<'_>) -> f32 {
    let raised = if dab.found { 0.0 } else { dab.strength };
    1.05 + 1.1 * dab.settings.spacing.max(0.2) + raised
}
