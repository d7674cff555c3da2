//! The points and triangles of a primitive.

use glam::DVec3;
use gltf_json::accessor::ComponentType;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::{GltfFile, bad};
use crate::io::problem::{FilePlace, ParseError};

/// The points of a mesh's primitives, one after the other.
#[derive(Default)]
pub(super) struct PrimitivePoints {
    pub(super) places: Vec<DVec3>,
    /// As many; white where a primitive has none.
    pub(super) colours: Vec<[u8; 4]>,
    /// Of the first set, v upwards; as many, or fewer where the last primitives have none.
    pub(super) uvs: Vec<Option<[f64; 2]>>,
}

impl PrimitivePoints {
    fn truncate(&mut self, count: usize) {
        self.places.truncate(count);
        self.colours.truncate(count);
        self.uvs.truncate(count);
    }
}

impl GltfFile<'_> {
    /// Appends a primitive's points; its triangles' corners, or `None` if it has none.
    pub(super) fn primitive(
        &mut self,
        primitive: &Primitive,
        what: &str,
        out: &mut PrimitivePoints,
    ) -> Result<Option<Vec<u32>>, ParseError> {
        let (Checked::Valid(mode), Some(at)) =
            (primitive.mode, primitive.attributes.get(&Checked::Valid(Semantic::Positions)))
        else {
            self.left_out.primitives += 1;
            return Ok(None);
        };
        let place = self.accessor(at.value(), &format!("positions of {what}"))?;
        if place.parts != 3 {
            return Err(bad(
                FilePlace::File,
                format!("three coordinates in the positions of {what}"),
                place.parts.to_string(),
            ));
        }
        let first = out.places.len();
        out.places.extend((0..place.count).map(|i| place.vector(i)));
        out.colours.resize(out.places.len(), [255; 4]);
        if let Some(c) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) {
            let c = self.accessor(c.value(), &format!("colours of {what}"))?;
            let top = match c.kind {
                ComponentType::U8 => 255.0,
                ComponentType::U16 => 65535.0,
                _ => 1.0,
            };
            for i in 0..c.count.min(place.count) {
                for part in 0..c.parts.min(4) {
                    let linear = (c.get(i, part) / top).clamp(0.0, 1.0);
                    let v = if part == 3 { linear } else { to_srgb(linear) };
                    out.colours[first + i][part] = (v * 255.0).round() as u8;
                }
            }
        }
        let count = place.count as u32;
        self.texture_coordinates(primitive, what, (first, place.count), &mut out.uvs)?;
        let order: Vec<u32> = match primitive.indices {
            None => (0..count).collect(),
            Some(i) => {
                let list = self.accessor(i.value(), &format!("indices of {what}"))?;
                if !matches!(list.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
                    || list.parts != 1
                {
                    return Err(bad(
                        FilePlace::File,
                        format!("whole numbers as indices of {what}"),
                        "another type",
                    ));
                }
                (0..list.count).map(|i| list.get(i, 0) as u32).collect()
            }
        };
        if let Some(out) = order.iter().find(|&&i| i >= count) {
            return Err(bad(
                FilePlace::File,
                format!("indices below {count} in {what}"),
                out.to_string(),
            ));
        }
        Ok(Some(match mode {
            Mode::Triangles => order[..order.len() - order.len() % 3].to_vec(),
            Mode::TriangleStrip => order
                .windows(3)
                .enumerate()
                .flat_map(|(n, w)| if n % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
                .collect(),
            Mode::TriangleFan => {
                order.windows(2).skip(1).flat_map(|w| [order[0], w[0], w[1]]).collect()
            }
            _ => {
                self.left_out.primitives += 1;
                out.truncate(first);
                return Ok(None);
            }
        }))
    }

    /// Reads the texture coordinates of a primitive whose `count` points begin at `first`. In glTF
    /// v goes down the picture, here and in OBJ up.
    fn texture_coordinates(
        &mut self,
        primitive: &Primitive,
        what: &str,
        (first, count): (usize, usize),
        uvs: &mut Vec<Option<[f64; 2]>>,
    ) -> Result<(), ParseError> {
        let set = |k| primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(k)));
        let Some(at) = set(0) else { return Ok(()) };
        self.left_out.sets += (1..8).filter(|k| set(*k).is_some()).count();
        let read = self.accessor(at.value(), &format!("texture coordinates of {what}"))?;
        let plain = (0..count.min(read.count)).map(|i| [read.value(i, 0), read.value(i, 1)]);
        if read.parts != 2 || read.count != count || plain.clone().flatten().any(|v| !v.is_finite())
        {
            self.left_out.bad_uvs += 1;
            return Ok(());
        }
        uvs.resize(first, None);
        uvs.extend(plain.map(|[u, v]| Some([u, 1.0 - v])));
        Ok(())
    }
}

fn to_srgb(v: f64) -> f64 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}
