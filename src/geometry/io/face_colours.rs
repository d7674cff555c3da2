//! Colours of faces, of which several formats know, as colours of vertices, which clay has.

/// Colour of vertices without one in a mesh where others have one.
const WHITE: [u8; 4] = [255; 4];

/// The colours of the vertices: those of the faces around them.
#[derive(Debug, Default)]
pub(super) struct FaceColours {
    colours: Vec<Option<[u8; 4]>>,
    /// True for vertices whose faces have several colours.
    differs: Vec<bool>,
}

impl FaceColours {
    /// Gives a corner of a face its colour, if it has one.
    pub(super) fn add(&mut self, vertex: u32, colour: Option<[u8; 4]>) {
        let Some(colour) = colour else { return };
        let v = vertex as usize;
        if v >= self.colours.len() {
            self.colours.resize(v + 1, None);
            self.differs.resize(v + 1, false);
        }
        let first = *self.colours[v].get_or_insert(colour);
        self.differs[v] |= first != colour;
    }

    /// Returns one colour for each of `count` vertices; `None`: no vertex has one.
    pub(super) fn of(self, count: usize, warnings: &mut Vec<String>) -> Option<Vec<[u8; 4]>> {
        let several = self.differs.iter().filter(|differs| **differs).count();
        if several > 0 {
            warnings.push(format!(
                "{several} vertices lie between faces of several colours: each has the colour of \
                 the first"
            ));
        }
        let mut colours = self.colours;
        if colours.is_empty() {
            return None;
        }
        colours.resize(count, None);
        Some(colours.into_iter().map(|colour| colour.unwrap_or(WHITE)).collect())
    }
}
