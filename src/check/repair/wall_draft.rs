//! Draft added to upright walls, so that a mould releases them.
//!
//! A wall turns about its foot until it has the angle. Vertices move across the pull direction
//! only, so that faces across it stay flat. A vertex between two walls moves to the line in which
//! the turned walls meet.

use glam::{DVec2, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::portable::PortableMath;

use super::{RepairError, ReshapedPart, direction};
use crate::moulding::draft_regions;
use crate::part::PreparedPart;
use crate::regions::FaceRegion;

/// Largest draft, degrees.
pub const MOST_DRAFT: f64 = 45.0;
/// Share of the larger one below which the smaller squared direction of a vertex's walls is none.
const FLAT: f64 = 1e-9;

/// The conditions on the movement of one vertex: how far along which directions.
#[derive(Debug, Clone, Copy, Default)]
struct WallConditions {
    /// The sum of the squared directions: xx, xy, yy.
    squares: [f64; 3],
    way: DVec2,
}

impl WallConditions {
    fn add(&mut self, along: DVec2, by: f64) {
        self.squares[0] += along.x * along.x;
        self.squares[1] += along.x * along.y;
        self.squares[2] += along.y * along.y;
        self.way += along * by;
    }

    /// The shortest movement that meets the conditions best.
    fn movement(&self) -> DVec2 {
        let [a, b, c] = self.squares;
        let (half, product) = ((a + c) * 0.5, a * c - b * b);
        let root = (half * half - product).max(0.0).sqrt();
        let (large, small) = (half + root, half - root);
        if !(large > 0.0) {
            return DVec2::ZERO;
        }
        if small > FLAT * large {
            return DVec2::new(c * self.way.x - b * self.way.y, a * self.way.y - b * self.way.x)
                / product;
        }
        // All walls are parallel.
        self.way / large
    }
}

/// Turns the walls of a part that have less than `angle` degrees of draft along `pull`.
///
/// # Errors
/// Returns an error if the angle is not above 0 and at most [`MOST_DRAFT`], or if every wall has
/// it.
pub fn add_draft(
    solid: &PolyMesh,
    pull: DVec3,
    angle: f64,
    job: &Job,
) -> Result<ReshapedPart, RepairError> {
    let pull = direction("pull direction", pull)?;
    if !(angle > 0.0 && angle <= MOST_DRAFT) {
        let range = format!("above 0 and at most {MOST_DRAFT} degrees");
        return Err(RepairError::OutOfRange { name: "draft", value: angle, range });
    }
    let part = PreparedPart::new(solid, 1.0, job)?;
    let regions = draft_regions(&part, pull, angle);
    if regions.is_empty() {
        return Err(RepairError::NoFinding("wall with too little draft"));
    }
    let (x, y) = pull.any_orthonormal_pair();
    let wanted = angle.to_radians().portable_tan();
    let mut conditions = vec![WallConditions::default(); solid.positions.len()];
    let (mut area, mut notes) = (0.0, Vec::new());
    for region in regions.iter().map(|r| &r.region) {
        job.check()?;
        let Some(sign) = opens(&part, region, pull) else {
            let [x, y, z] = part.to_file(region.position).to_array();
            notes.push(format!(
                "the wall at ({x:.3}, {y:.3}, {z:.3}) stayed: no half of a mould reaches it"
            ));
            continue;
        };
        area += region.area;
        let corners = |t: u32| part.centred.mesh.triangles[t as usize];
        let height = |v: u32| solid.positions[v as usize].dot(pull) * sign;
        let foot = region.triangles.iter().flat_map(|&t| corners(t)).map(height);
        let foot = foot.fold(f64::INFINITY, f64::min);
        for &t in &region.triangles {
            let normal = part.normals[t as usize];
            let across = DVec2::new(normal.dot(x), normal.dot(y));
            let length = across.length();
            let own = normal.dot(pull) * sign / length;
            for v in corners(t) {
                conditions[v as usize].add(across / length, -(height(v) - foot) * (wanted - own));
            }
        }
    }
    let mut mesh = solid.clone();
    for (p, own) in mesh.positions.iter_mut().zip(&conditions) {
        let by = own.movement();
        *p += x * by.x + y * by.y;
    }
    Ok(ReshapedPart { mesh, area, kept: notes.len(), notes })
}

/// Returns the number of connected walls with less than `angle` degrees of draft along `pull`.
///
/// # Errors
/// Returns an error if the direction has no length, and if the job was cancelled.
pub fn walls_below(
    mesh: &PolyMesh,
    pull: DVec3,
    angle: f64,
    job: &Job,
) -> Result<usize, RepairError> {
    let pull = direction("pull direction", pull)?;
    let part = PreparedPart::new(mesh, 1.0, job)?;
    Ok(draft_regions(&part, pull, angle).len())
}

/// The direction along `pull` in which a wall is released: 1 with it, -1 against it; `None` where
/// most of the wall is closed both ways.
fn opens(part: &PreparedPart, region: &FaceRegion, pull: DVec3) -> Option<f64> {
    let step = 16.0 * part.rounding();
    let (mut up, mut down) = (0.0, 0.0);
    for &t in &region.triangles {
        let from = part.middle(t) + part.normals[t as usize] * step;
        let own = part.areas[t as usize];
        up += if part.blocked(from, pull, 0.0) { 0.0 } else { own };
        down += if part.blocked(from, -pull, 0.0) { 0.0 } else { own };
    }
    let most = 0.5 * region.area;
    if up >= most && up >= down { Some(1.0) } else { (down >= most).then_some(-1.0) }
}
