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
//! * Pages contain them, and the first page contains the list of layers ([`LayerStack`]): whatever
//!   keeps or exchanges pages (undo, snapshots, the history of a session, duplicates of an object)
//!   keeps and exchanges the layers with them.
//! * An edit re-evaluates the pages of the layer that it is about and no others. The pages can be
//!   worked through in any portions ([`edit_layers`](crate::Clay::edit_layers),
//!   [`run_layers`](crate::Clay::run_layers)).
//!
//! Offsets are in the frame of the object, as in the shape keys of Blender and the morph targets of
//! glTF, not in a frame of the surface below. Then the order of the sum is the only order that
//! matters, and a stroke on a lower layer does not turn the layers above it. The cost of a stroke
//! follows the vertices that it moved: with offsets in the frame of the surface below, a stroke on
//! the base would have to evaluate every layer above it, dab by dab.
//!
//! Where triangles change, offsets are kept: after a local Boolean every remaining vertex keeps its
//! offsets, and new vertices belong to the base. Dynamic topology leaves clay with layers alone.
//! Operations that compute a whole new surface (remeshing, another level of detail, a Boolean of
//! everything) make clay without layers of the visible surface, and their callers report that.

mod offsets;
mod stack;

pub use offsets::{LayerRow, LayerSum, PageLayers};
pub use stack::{
    LEAST_INTENSITY, Layer, LayerEdit, LayerError, LayerId, LayerOffsets, LayerStack,
    MAX_INTENSITY, MAX_LAYERS,
};
