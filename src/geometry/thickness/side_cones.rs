//! The parts of a tree in which all facets belong to a site's own side, and so hold no ball there:
//! on a smooth surface most of what is near a large ball is of this kind.

use glam::Vec3;

use super::opposed::NormalCone;
use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE};
use crate::portable::PortableMath;

/// cos 20 degrees: a touch at a smaller angle seen from the ball's centre is the same side of the
/// wall.
pub(super) const SAME_SIDE: f32 = 0.94;
/// Room for the rounding of angles, radians.
const ROUNDING: f32 = 2e-3;
/// More than the cosine of any angle.
const NEVER: f32 = 2.0;

/// For each child of each node a cone around the normals of the facets below.
#[derive(Debug)]
pub struct SideCones {
    /// The axis, and the cosine of the largest angle between it and a site's normal at which all
    /// facets are of the site's side.
    nodes: Vec<[[f32; 8]; 4]>,
}

impl SideCones {
    /// `face_normals`: one per triangle of the tree, of unit length or zero.
    pub fn new(tree: &Bvh8, face_normals: &[Vec3]) -> SideCones {
        let of_leaf = |pack: u32| {
            let mut own = [NormalCone::NONE; 4];
            let ids = tree.packs()[pack as usize].id;
            for (t, to) in ids.into_iter().filter(|&t| t != NO_TRIANGLE).zip(&mut own) {
                *to = NormalCone { axis: face_normals[t as usize], angle: 0.0 };
            }
            NormalCone::around(&own)
        };
        let same = SAME_SIDE.portable_acos() - ROUNDING;
        let nodes = tree.nodes();
        let mut whole = vec![NormalCone::NONE; nodes.len()];
        let none = [[0.0; 8], [0.0; 8], [0.0; 8], [NEVER; 8]];
        let mut out = vec![none; nodes.len()];
        // Children come after their parent.
        for n in (0..nodes.len()).rev() {
            let mut own = [NormalCone::NONE; 8];
            for i in (0..8).filter(|&i| nodes[n].planes[0][i] != f32::INFINITY) {
                let child = nodes[n].child[i];
                let leaf = child & LEAF != 0;
                let cone = if leaf { of_leaf(child & !LEAF) } else { whole[child as usize] };
                let least = same - cone.angle;
                if cone.angle >= 0.0 && least > 0.0 {
                    let [x, y, z] = cone.axis.to_array();
                    let lanes = [x, y, z, least.portable_cos()];
                    for (row, value) in out[n].iter_mut().zip(lanes) {
                        row[i] = value;
                    }
                }
                own[i] = cone;
            }
            whole[n] = NormalCone::around(&own);
        }
        SideCones { nodes: out }
    }

    /// Returns a bit for each child of a node below which a facet may turn from `away` so far that
    /// it is of another side.
    #[inline(always)]
    pub(super) fn others(&self, node: usize, away: Vec3) -> u32 {
        let [x, y, z, least] = &self.nodes[node];
        let mut mask = 0;
        for i in 0..8 {
            let along = x[i] * away.x + y[i] * away.y + z[i] * away.z;
            mask |= u32::from(!(along >= least[i])) << i;
        }
        mask
    }
}
