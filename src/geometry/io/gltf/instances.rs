//! The places of a node's mesh: the node's own, or the many of `EXT_mesh_gpu_instancing`.

use glam::{DMat4, DQuat, DVec3};
use gltf_json::scene::Node;

use super::{GltfFile, MAX_INSTANCED, bad};
use crate::io::problem::{FilePlace, ParseError};

/// The extension.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

impl GltfFile<'_> {
    /// Returns where the mesh of a node stands, in the node's frame.
    pub(super) fn places(&self, node: &Node, n: usize) -> Result<Vec<DMat4>, ParseError> {
        let many = node.extensions.as_ref().and_then(|e| e.others.get(INSTANCING));
        let Some(many) = many else { return Ok(vec![DMat4::IDENTITY]) };
        let of = |name: &str, parts: usize| {
            let number = many["attributes"][name].as_u64();
            let what = format!("instances of node {n} ({name})");
            let read = number.map(|at| self.accessor(at as usize, &what)).transpose()?;
            match read {
                Some(read) if read.parts != parts => {
                    let expected = format!("{parts} numbers for the {what}");
                    Err(bad(FilePlace::File, expected, read.parts.to_string()))
                }
                read => Ok(read),
            }
        };
        let (shifts, turns, scales) = (of("TRANSLATION", 3)?, of("ROTATION", 4)?, of("SCALE", 3)?);
        let counts = [&shifts, &turns, &scales].map(|a| a.as_ref().map(|a| a.count));
        let mut counts = counts.into_iter().flatten();
        let first = counts.next();
        let Some(count) = first.filter(|c| counts.all(|d| d == *c) && *c <= MAX_INSTANCED) else {
            let expected = format!("accessors of one length for the instances of node {n}");
            return Err(bad(FilePlace::File, expected, "others"));
        };
        let place = |i: usize| {
            let turn = turns.as_ref().map(|t| {
                let [x, y, z, w] = [0, 1, 2, 3].map(|k| t.value(i, k));
                DQuat::from_xyzw(x, y, z, w).normalize()
            });
            DMat4::from_scale_rotation_translation(
                scales.as_ref().map_or(DVec3::ONE, |s| s.vector(i)),
                turn.unwrap_or(DQuat::IDENTITY),
                shifts.as_ref().map_or(DVec3::ZERO, |s| s.vector(i)),
            )
        };
        Ok((0..count).map(place).collect())
    }
}
