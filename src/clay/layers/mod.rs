//! Layers: named displacements of the surface that can be weakened, strengthened, hidden and
//! removed after they were sculpted.
//!
//! Laws kept here:
//! * The surface of a page is the sum of its base and of its layers, each times its intensity, from
//!   the lowest layer up, in double precision, rounded once ([`LayerSum`]). The same sum makes the
//!   same bits, whichever way led to it. A stroke sets the offsets so that the sum is, to the bit,
//!   the surface that the stroke left.
//! * Base and offsets are kept by page, and only of pages that a layer changes. A page shares them
//!   with its older versions, so a change of an intensity copies no offsets, and a stroke copies
//!   them once, when it ends ([`LayerOperation::Capture`](crate::LayerOperation::Capture)).
//! * They lie in the pages themselves, and the list of layers ([`LayerStack`]) lies in the first
//!   page: whatever keeps or exchanges pages (undo, snapshots, the history of a session, duplicates
//!   of an object) keeps and exchanges the layers with them.
//! * An edit re-evaluates the pages of the layer that it is about and no others. The pages can be
//!   worked through in any portions ([`edit_layers`](crate::Clay::edit_layers),
//!   [`run_layers`](crate::Clay::run_layers)).
//!
//! Offsets are in the frame of the object, as in the shape keys of Blender and the morph targets of
//! glTF, not in a frame of the surface below. Then the order of the sum is the only order that
//! matters, a stroke on a lower layer does not turn what lies above it, and the cost of a stroke
//! follows what the stroke moved: with offsets in the frame of the surface below, a stroke on the
//! base would have to evaluate every layer above it, dab by dab.
//!
//! Where triangles change, offsets are carried along: a local Boolean leaves every vertex that
//! stays with its offsets, and what it adds belongs to the base. Dynamic topology leaves clay that
//! has layers alone. Whatever computes a whole new surface (remeshing, another level of detail, a
//! Boolean of everything) makes clay without layers of the surface as it is seen, and whoever asks
//! for it says so.

mod offsets;
mod stack;

pub use offsets::{LayerRow, LayerSum, PageLayers};
pub use stack::{
    LEAST_INTENSITY, Layer, LayerEdit, LayerError, LayerId, LayerOffsets, LayerStack,
    MAX_INTENSITY, MAX_LAYERS,
};
