//! A surface that a result was computed from, and what has changed on it since.

use glam::{DVec3, Vec3};

use crate::carry_over::OldPlace;
use sculptd_clay::{Ranks, Snapshot};
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;

/// Changes of a vertex, as bits.
pub const MOVED: u8 = 1;
pub const PAINTED: u8 = 2;
pub const MASKED: u8 = 4;

/// An operand's surface as it was, in the frame of the result, and how its vertices differ now.
#[derive(Debug)]
pub struct BasisSurface {
    /// As it was.
    pub mesh: TriMesh,
    basis: Snapshot,
    old_masks: Option<Vec<f32>>,
    ranks: Ranks,
    /// From the object's frame to that of the result; `None`: they are the same.
    into: Option<ObjectTransform>,
    /// How each vertex differs.
    change: Vec<u8>,
    /// How far each has moved.
    by: Vec<DVec3>,
    /// Colours and masks as they are now.
    pub colours: Vec<[u8; 4]>,
    pub masks: Vec<f32>,
    /// The vertices that differ.
    changed: Vec<u32>,
    /// The farthest that one has moved.
    pub farthest: f64,
}

impl BasisSurface {
    /// Returns the surface of an object, with no change so far.
    pub fn new(basis: &Snapshot, into: Option<ObjectTransform>) -> BasisSurface {
        let mut mesh = basis.to_tri();
        if let Some(into) = &into {
            mesh.positions.iter_mut().for_each(|p| *p = into.point(*p));
        }
        let n = mesh.positions.len();
        let old_masks = basis.masks();
        BasisSurface {
            basis: basis.clone(),
            ranks: basis.ranks(),
            into,
            change: vec![0; n],
            by: vec![DVec3::ZERO; n],
            colours: mesh.colours.clone().unwrap_or_else(|| vec![[255; 4]; n]),
            masks: old_masks.clone().unwrap_or_else(|| vec![0.0; n]),
            old_masks,
            changed: Vec::new(),
            farthest: 0.0,
            mesh,
        }
    }

    /// Compares the surface with what it is now, which has the same triangles, at the cost of the
    /// pages that changed.
    pub fn compare(&mut self, now: &Snapshot) {
        let BasisSurface { basis, ranks, into, change, by, colours, masks, changed, .. } = self;
        // What an undo has brought back is as it was.
        for v in changed.drain(..).map(|v| v as usize) {
            change[v] = 0;
            colours[v] = self.mesh.colours.as_ref().map_or([255; 4], |c| c[v]);
            masks[v] = self.old_masks.as_ref().map_or(0.0, |m| m[v]);
        }
        let place = |p: Vec3| into.map_or(p.as_dvec3(), |into| into.apply(p.as_dvec3()));
        let mut farthest: f64 = 0.0;
        now.each_changed(basis, |i, page| {
            let was = basis.page(i);
            for (local, &id) in page.topology().ids.iter().enumerate() {
                let Some(v) = ranks.find(id) else { continue };
                let at = v as usize;
                let (from, to) = (was.point(local), page.point(local));
                let mut bits = 0;
                if from != to {
                    bits |= MOVED;
                    by[at] = place(to) - place(from);
                    farthest = farthest.max(by[at].length());
                } else {
                    by[at] = DVec3::ZERO;
                }
                (colours[at], masks[at]) = (page.colour(local), page.mask(local));
                bits |= if was.colour(local) == colours[at] { 0 } else { PAINTED };
                bits |= if was.mask(local) == masks[at] { 0 } else { MASKED };
                if bits != 0 {
                    change[at] = bits;
                    changed.push(v);
                }
            }
        });
        self.farthest = farthest;
    }

    /// Returns the changes at a place, as bits.
    pub fn change_at(&self, place: &OldPlace) -> u8 {
        self.mesh.triangles[place.triangle].iter().fold(0, |all, &v| all | self.change[v as usize])
    }

    /// Returns how far the surface has moved at a place.
    pub fn shift_at(&self, place: &OldPlace) -> DVec3 {
        place.shift(&self.mesh, |v| match self.change[v] & MOVED {
            0 => DVec3::ZERO,
            _ => self.by[v],
        })
    }

    /// Returns a ball around each triangle that has moved, which it did not leave on its way.
    pub fn swept(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let moved = |v: u32| self.change[v as usize] & MOVED != 0;
        let all = self.mesh.triangles.iter().filter(move |t| t.iter().any(|&v| moved(v)));
        all.map(move |t| {
            let was = t.map(|v| self.mesh.positions[v as usize].as_dvec3());
            let by = t.map(|v| if moved(v) { self.by[v as usize] } else { DVec3::ZERO });
            let now: [DVec3; 3] = std::array::from_fn(|k| was[k] + by[k]);
            let all = || was.iter().chain(&now);
            let middle = all().sum::<DVec3>() / 6.0;
            let radius = all().map(|p| p.distance(middle)).fold(0.0, f64::max);
            (middle, radius)
        })
    }

    /// Returns true if anything of the surface moved within `margin` of another one.
    pub fn swept_near(&self, other: &DistanceSolid, margin: f64) -> bool {
        self.swept().any(|(p, radius)| other.nearest_point(p, radius + margin).is_some())
    }
}
