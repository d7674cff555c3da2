//! A region that is drawn over the view with the pointer, and what is done with it.

use egui::Pos2;

/// Shape with which a region is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegionShape {
    /// Freely, while the button is held.
    Lasso,
    /// From corner to corner.
    Box,
    /// The left side of a line.
    Line,
    /// Corner by corner, a press each.
    Polyline,
}

/// Purpose of a drawn region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegionPurpose {
    Mask,
    Unmask,
    Hide,
    /// All but it is hidden.
    Isolate,
    /// It becomes a face set.
    FaceSet,
    /// Its triangles get one size.
    Remesh,
    /// It is cut off; once, and by a box or a line only.
    Trim,
}

impl RegionPurpose {
    /// The one that Ctrl makes of it: the other way round, where there is one.
    pub fn opposite(self) -> RegionPurpose {
        match self {
            RegionPurpose::Mask => RegionPurpose::Unmask,
            RegionPurpose::Unmask => RegionPurpose::Mask,
            RegionPurpose::Hide => RegionPurpose::Isolate,
            RegionPurpose::Isolate => RegionPurpose::Hide,
            RegionPurpose::FaceSet | RegionPurpose::Remesh | RegionPurpose::Trim => self,
        }
    }
}

/// A region that is being drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionDrawing {
    pub shape: RegionShape,
    pub purpose: RegionPurpose,
    /// Positions of the pointer, in points: the path of a lasso, the corners of a polyline, else
    /// the start of the drag. Empty before it begins.
    pub points: Vec<Pos2>,
}

/// Regions drawn over the view.
#[derive(Debug)]
pub struct RegionTool {
    /// While it is there the pointer draws and does not sculpt.
    pub drawing: Option<RegionDrawing>,
    /// Shape of the next drawing if only its purpose is chosen.
    pub shape: RegionShape,
    /// Purpose of the next drawing if only its shape is chosen.
    pub purpose: RegionPurpose,
    /// Only what faces the eye.
    pub front_faces: bool,
    /// Target edge length for triangles of one size, times the usual length.
    pub edge: f32,
}

impl Default for RegionTool {
    fn default() -> Self {
        RegionTool {
            drawing: None,
            shape: RegionShape::Lasso,
            purpose: RegionPurpose::Mask,
            front_faces: false,
            edge: 1.0,
        }
    }
}

impl RegionTool {
    /// The pointer draws from now on.
    pub fn begin(&mut self, shape: RegionShape, purpose: RegionPurpose) {
        self.drawing = Some(RegionDrawing { shape, purpose, points: Vec::new() });
        if purpose != RegionPurpose::Trim {
            (self.shape, self.purpose) = (shape, purpose);
        }
    }

    /// The same by this shape, for what the last one was for.
    pub fn begin_shape(&mut self, shape: RegionShape) {
        self.begin(shape, self.purpose);
    }

    /// The same for this purpose, by the shape of the last one.
    pub fn begin_for(&mut self, purpose: RegionPurpose) {
        self.begin(self.shape, purpose);
    }

    /// The shape and the purpose that are drawn with now.
    pub fn now(&self) -> Option<(RegionShape, RegionPurpose)> {
        self.drawing.as_ref().map(|d| (d.shape, d.purpose))
    }
}
