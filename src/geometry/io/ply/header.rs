//! The header, and the plan that it becomes.

use super::super::problem::{FilePlace, FileProblem, excerpt};

/// The roles that a vertex's properties play, in the order of the values that
/// a vertex is built from.
pub(super) const ROLES: [&str; 9] = ["x", "y", "z", "red", "green", "blue", "alpha", "u", "v"];

/// The values of a vertex, by [`ROLES`].
pub(super) type PlyValues = [f64; ROLES.len()];

/// Values of a vertex that its row does not state. `scale`: of its colours to bytes.
pub(super) fn values(scale: f64) -> PlyValues {
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 255.0 / scale, 0.0, 0.0]
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlyEncoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlyScalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl PlyScalar {
    fn named(name: &str) -> Option<PlyScalar> {
        Some(match name {
            "char" | "int8" => PlyScalar::I8,
            "uchar" | "uint8" => PlyScalar::U8,
            "short" | "int16" => PlyScalar::I16,
            "ushort" | "uint16" => PlyScalar::U16,
            "int" | "int32" => PlyScalar::I32,
            "uint" | "uint32" => PlyScalar::U32,
            "float" | "float32" => PlyScalar::F32,
            "double" | "float64" => PlyScalar::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            PlyScalar::I8 | PlyScalar::U8 => 1,
            PlyScalar::I16 | PlyScalar::U16 => 2,
            PlyScalar::I32 | PlyScalar::U32 | PlyScalar::F32 => 4,
            PlyScalar::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, PlyScalar::F32 | PlyScalar::F64)
    }

    /// Returns the factor that scales a colour of this type to a byte.
    pub(super) fn colour_scale(self) -> f64 {
        match self {
            PlyScalar::I16 | PlyScalar::U16 => 255.0 / 65535.0,
            PlyScalar::F32 | PlyScalar::F64 => 255.0,
            _ => 1.0,
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct PlyProperty {
    pub name: String,
    /// Type of the count, if this is a list.
    pub list: Option<PlyScalar>,
    pub kind: PlyScalar,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlyRole {
    Vertex,
    Face,
    Strips,
    Other,
}

#[derive(Debug, Clone)]
pub(super) struct PlyElement {
    pub name: String,
    pub role: PlyRole,
    pub count: usize,
    pub properties: Vec<PlyProperty>,
}

impl PlyElement {
    /// Bytes of a row with all lists empty.
    pub(super) fn least(&self) -> usize {
        self.properties.iter().map(|p| p.list.unwrap_or(p.kind).size()).sum()
    }

    pub(super) fn fixed(&self) -> bool {
        self.properties.iter().all(|p| p.list.is_none())
    }

    /// Returns the index of the property that holds the corners.
    pub(super) fn corners(&self) -> Option<usize> {
        let named = |n: &str| self.properties.iter().position(|p| p.name == n && p.list.is_some());
        named("vertex_indices").or_else(|| named("vertex_index"))
    }

    /// Returns the index of the property that holds two texture coordinates for each corner.
    pub(super) fn texture_coordinates(&self) -> Option<usize> {
        let own = |p: &PlyProperty| p.name == "texcoord" && p.list.is_some();
        (self.role == PlyRole::Face).then(|| self.properties.iter().position(own)).flatten()
    }

    /// For each property the place among [`ROLES`] that it fills.
    pub(super) fn roles(&self) -> Vec<Option<usize>> {
        self.properties
            .iter()
            .map(|p| {
                let name = p.name.strip_prefix("diffuse_").unwrap_or(&p.name);
                let name = match name {
                    "r" => "red",
                    "g" => "green",
                    "b" => "blue",
                    "a" => "alpha",
                    "s" | "s0" | "texture_u" | "texture_s" => "u",
                    "t" | "t0" | "texture_v" | "texture_t" => "v",
                    n => n,
                };
                ROLES.iter().position(|r| *r == name).filter(|_| p.list.is_none())
            })
            .collect()
    }
}

#[derive(Debug, Clone)]
pub(super) struct PlyHeader {
    pub encoding: PlyEncoding,
    pub elements: Vec<PlyElement>,
    /// The start of the data.
    pub data: usize,
    /// The line on which text data starts.
    pub data_line: u64,
}

impl PlyHeader {
    pub(super) fn vertices(&self) -> Option<&PlyElement> {
        self.elements.iter().find(|e| e.role == PlyRole::Vertex)
    }

    pub(super) fn coloured(&self) -> bool {
        self.vertices().is_some_and(|e| {
            let roles = e.roles();
            (3..6).all(|r| roles.contains(&Some(r)))
        })
    }

    /// Returns true if the vertices have texture coordinates.
    pub(super) fn textured(&self) -> bool {
        self.vertices().is_some_and(|e| {
            let roles = e.roles();
            (7..9).all(|r| roles.contains(&Some(r)))
        })
    }

    /// Returns true if the corners of faces have texture coordinates.
    pub(super) fn textures_faces(&self) -> bool {
        let faces = self.elements.iter().find(|e| e.role == PlyRole::Face);
        faces.is_some_and(|e| e.texture_coordinates().is_some())
    }

    /// The factor that scales the faces' colours to bytes, if faces alone have colours.
    pub(super) fn face_colour_scale(&self) -> Option<f64> {
        let faces = self.elements.iter().find(|e| e.role == PlyRole::Face)?;
        let roles = faces.roles();
        let whole = !self.coloured() && (3..6).all(|r| roles.contains(&Some(r)));
        let red = roles.iter().position(|r| *r == Some(3)).filter(|_| whole)?;
        Some(faces.properties[red].kind.colour_scale())
    }

    /// Names the data of the file that is not read, one sentence an element. Normals are not named:
    /// they follow from the surface.
    pub(super) fn unread(&self) -> Vec<String> {
        let mut out = Vec::new();
        for e in self.elements.iter().filter(|e| e.count > 0) {
            let (roles, corners) = (e.roles(), e.corners());
            let uvs = e.texture_coordinates();
            let read = |i: usize, name: &str| match e.role {
                PlyRole::Vertex if roles[i].is_some_and(|r| r >= 7) => {
                    self.textured() && !self.textures_faces()
                }
                PlyRole::Vertex if roles[i].is_some_and(|r| r >= 3) => self.coloured(),
                PlyRole::Vertex => roles[i].is_some() || matches!(name, "nx" | "ny" | "nz"),
                PlyRole::Face if roles[i].is_some_and(|r| (3..7).contains(&r)) => {
                    self.face_colour_scale().is_some()
                }
                PlyRole::Face | PlyRole::Strips => corners == Some(i) || uvs == Some(i),
                PlyRole::Other => false,
            };
            let names = e.properties.iter().enumerate().filter(|(i, p)| !read(*i, &p.name));
            let names: Vec<&str> = names.map(|(_, p)| p.name.as_str()).collect();
            if e.role == PlyRole::Other {
                out.push(format!("{} rows of \"{}\" left out", e.count, e.name));
            } else if !names.is_empty() {
                out.push(format!("properties of \"{}\" left out: {}", e.name, names.join(", ")));
            }
        }
        out
    }

    /// 255 over the colours' largest value.
    pub(super) fn colour_scale(&self) -> f64 {
        self.vertices()
            .and_then(|e| {
                let red = e.roles().iter().position(|&r| r == Some(3))?;
                Some(e.properties[red].kind.colour_scale())
            })
            .unwrap_or(1.0)
    }

    /// That the counts stated fit into the file, before any memory is taken for them.
    pub(super) fn check(&self, bytes: usize) -> Result<(), FileProblem> {
        let Some(vertex) = self.vertices() else {
            return Err(FileProblem::new(
                FilePlace::Line(1),
                "an element \"vertex\"",
                "none in the header",
            ));
        };
        let roles = vertex.roles();
        for (r, name) in ROLES.iter().enumerate().take(3) {
            if !roles.contains(&Some(r)) {
                return Err(FileProblem::new(
                    FilePlace::Line(1),
                    format!("a vertex property \"{name}\""),
                    "none in the header",
                ));
            }
        }
        if vertex.count == 0 {
            return Err(FileProblem::new(
                FilePlace::Line(1),
                "at least one vertex",
                "a count of 0",
            ));
        }
        let mut need = self.data as u128;
        for e in &self.elements {
            if e.count >= u32::MAX as usize {
                return Err(FileProblem::new(
                    FilePlace::Line(1),
                    "fewer than 2^32 of an element",
                    format!("{} of \"{}\"", e.count, e.name),
                ));
            }
            if e.count > 0 && e.properties.is_empty() {
                return Err(FileProblem::new(
                    FilePlace::Line(1),
                    format!("a property of \"{}\"", e.name),
                    "none in the header",
                ));
            }
            let row = match self.encoding {
                // A digit and a separator each.
                PlyEncoding::Ascii => e.properties.len() * 2,
                _ => e.least(),
            };
            need += e.count as u128 * row as u128;
        }
        // The last separator may be missing.
        if need > bytes as u128 + 1 {
            let found = format!("the end of the file after {bytes} bytes");
            return Err(FileProblem::new(
                FilePlace::Byte(bytes as u64),
                format!("at least {need} bytes for the counts in the header"),
                found,
            ));
        }
        Ok(())
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<PlyHeader, FileProblem> {
    let mut at = 0;
    let mut number = 0u64;
    let mut encoding = None;
    let mut elements: Vec<PlyElement> = Vec::new();
    loop {
        number += 1;
        let rest = &bytes[at..];
        // Old writers end lines with CR alone; data starts after the first line end of
        // "end_header".
        let end = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let line = rest[..end].trim_ascii();
        let problem = |expected: &str| {
            FileProblem::new(FilePlace::Line(number), expected.to_string(), excerpt(line))
        };
        at = (at + end + 1).min(bytes.len());
        if rest.get(end) == Some(&b'\r') && bytes.get(at) == Some(&b'\n') {
            at += 1;
        }
        if number == 1 {
            if line != b"ply" {
                return Err(problem("\"ply\""));
            }
            continue;
        }
        if rest.is_empty() {
            return Err(FileProblem::new(
                FilePlace::Line(number),
                "\"end_header\"",
                "the end of the file",
            ));
        }
        let Ok(line_text) = std::str::from_utf8(line) else {
            if line.starts_with(b"comment") || line.starts_with(b"obj_info") {
                continue;
            }
            return Err(problem("header text"));
        };
        let words: Vec<&str> = line_text.split_ascii_whitespace().collect();
        match words.as_slice() {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", kind, _version @ ..] => {
                encoding = Some(match *kind {
                    "ascii" => PlyEncoding::Ascii,
                    "binary_little_endian" => PlyEncoding::LittleEndian,
                    "binary_big_endian" => PlyEncoding::BigEndian,
                    _ => {
                        return Err(problem(
                            "format ascii, binary_little_endian or binary_big_endian",
                        ));
                    }
                });
            }
            ["element", name, count] => {
                let Ok(count) = count.parse::<usize>() else {
                    return Err(problem("\"element\", a name and a count"));
                };
                let role = match *name {
                    "vertex" => PlyRole::Vertex,
                    "face" => PlyRole::Face,
                    "tristrips" => PlyRole::Strips,
                    _ => PlyRole::Other,
                };
                if role != PlyRole::Other && elements.iter().any(|e| e.role == role) {
                    return Err(problem("each element once"));
                }
                elements.push(PlyElement {
                    name: name.to_string(),
                    role,
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", "list", count, kind, name] => {
                let (Some(count), Some(kind)) =
                    (PlyScalar::named(count).filter(|s| s.is_integer()), PlyScalar::named(kind))
                else {
                    return Err(problem(
                        "\"property list\", a whole type for the count, a type, a name",
                    ));
                };
                let Some(element) = elements.last_mut() else {
                    return Err(problem("an element before its properties"));
                };
                element.properties.push(PlyProperty {
                    name: name.to_string(),
                    list: Some(count),
                    kind,
                });
            }
            ["property", kind, name] => {
                let Some(kind) = PlyScalar::named(kind) else {
                    return Err(problem("\"property\", a type, a name"));
                };
                let Some(element) = elements.last_mut() else {
                    return Err(problem("an element before its properties"));
                };
                element.properties.push(PlyProperty { name: name.to_string(), list: None, kind });
            }
            ["end_header"] => break,
            _ => return Err(problem("format, element, property, comment or end_header")),
        }
        if number > 10_000 {
            return Err(problem("\"end_header\" within 10,000 lines"));
        }
    }
    let Some(encoding) = encoding else {
        return Err(FileProblem::new(
            FilePlace::Line(2),
            "a line \"format ...\"",
            "none in the header",
        ));
    };
    Ok(PlyHeader { encoding, elements, data: at, data_line: number + 1 })
}
