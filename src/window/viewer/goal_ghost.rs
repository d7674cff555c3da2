//! A form that shows through the clay.

use std::sync::Arc;

use super::overlay_mesh::Triangles;
use sculptd_engine::hand::Similarity;
use sculptd_geometry::TriMesh;

/// Colour of the form, sRGB and opacity.
const GHOST: [u8; 4] = [70, 190, 255, 110];

/// A form that shows through the clay.
#[derive(Debug, Default)]
pub(super) struct Ghost {
    pub(super) triangles: Triangles,
    /// The mesh that the triangles are of.
    of: Option<Arc<TriMesh>>,
}

impl Ghost {
    /// Shows a form; `None`: none.
    pub(super) fn show(&mut self, form: Option<&Arc<TriMesh>>) {
        let same = match (&self.of, form) {
            (Some(old), Some(new)) => Arc::ptr_eq(old, new),
            (old, new) => old.is_none() == new.is_none(),
        };
        if same {
            return;
        }
        self.triangles.clear();
        if let Some(form) = form {
            self.triangles.form(form, &Similarity::NONE, GHOST);
        }
        self.of = form.cloned();
    }

    /// The triangles, if there are any.
    pub(super) fn shown(&self) -> Option<&Triangles> {
        self.of.is_some().then_some(&self.triangles)
    }
}
