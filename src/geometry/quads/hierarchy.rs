//! The levels on which the fields are smoothed: pairs of neighbours are merged until a handful of
//! vertices is left (Jakob et al., "Instant Field-Aligned Meshes", 2015, section 3.3).

use glam::DVec3;
use rayon::prelude::*;

use super::surface::EditSurface;

/// The vertices on which a field is given. A level's fields are separate arrays.
#[derive(Debug, Clone, Default)]
pub(super) struct FieldLevel {
    pub positions: Vec<DVec3>,
    /// Of unit length.
    pub normals: Vec<DVec3>,
    areas: Vec<f64>,
    starts: Vec<u32>,
    /// Neighbour and weight.
    links: Vec<(u32, f64)>,
    /// The vertex of the next coarser level that each vertex goes into; empty on the coarsest.
    pub parent: Vec<u32>,
    /// The direction that the orientation has to follow, of unit length, or zero.
    pub along: Vec<DVec3>,
    /// The constraint of each vertex on the lattice: none, a line along `along`, or a point.
    pub hold: Vec<FieldHold>,
    /// The vertices by colour: no two of a colour are neighbours, so that they can be updated at
    /// the same time.
    pub colours: Vec<Vec<u32>>,
}

/// The constraint of a vertex on the position field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum FieldHold {
    #[default]
    Free,
    /// A lattice line passes through the vertex along its direction.
    Line,
    /// A lattice point coincides with the vertex.
    Point,
}

/// Levels are added until one has no more vertices than this.
const COARSEST: usize = 12;

impl FieldLevel {
    pub fn links(&self, v: usize) -> &[(u32, f64)] {
        &self.links[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The finest level: the vertices of a surface, none of which is gone.
    pub fn of(surface: &EditSurface) -> FieldLevel {
        let n = surface.positions.len();
        let mut level = FieldLevel { positions: surface.positions.clone(), ..Default::default() };
        level.starts.push(0);
        let mut near = Vec::new();
        for v in 0..n as u32 {
            let normal = surface.vertex_normal(v);
            level.areas.push(normal.length().max(1e-12));
            level.normals.push(normal.try_normalize().unwrap_or(DVec3::Z));
            surface.neighbours(v, &mut near);
            level.links.extend(near.iter().map(|&w| (w, 1.0)));
            level.starts.push(level.links.len() as u32);
            let p = surface.positions[v as usize];
            let (along, hold) = match surface.lines[v as usize][..] {
                _ if surface.pinned[v as usize] => (DVec3::ZERO, FieldHold::Point),
                [a, b] => {
                    let to = (surface.positions[a as usize] - p).normalize_or_zero();
                    let from = (p - surface.positions[b as usize]).normalize_or_zero();
                    let n = level.normals[v as usize];
                    let d = to + from;
                    ((d - n * d.dot(n)).normalize_or_zero(), FieldHold::Line)
                }
                _ => (DVec3::ZERO, FieldHold::Free),
            };
            level.along.push(along);
            level.hold.push(hold);
        }
        level
    }

    /// Computes `new(vertex)` colour by colour, in parallel within one, and puts it into `values`.
    pub fn update<T: Copy + Send + Sync>(
        &self,
        values: &mut [T],
        new: impl Fn(usize, &[T]) -> T + Sync,
    ) {
        for colour in &self.colours {
            let made: Vec<T> =
                colour.par_iter().with_min_len(256).map(|&v| new(v as usize, values)).collect();
            for (&v, made) in colour.iter().zip(made) {
                values[v as usize] = made;
            }
        }
    }

    /// Gives each vertex the first colour that no neighbour has.
    fn paint(&mut self) {
        let n = self.positions.len();
        let mut own = vec![u8::MAX; n];
        for v in 0..n {
            let mut taken = 0u128;
            for &(w, _) in self.links(v) {
                if own[w as usize] < 127 {
                    taken |= 1 << own[w as usize];
                }
            }
            own[v] = taken.trailing_ones().min(127) as u8;
            let colour = own[v] as usize;
            while self.colours.len() <= colour {
                self.colours.push(Vec::new());
            }
            self.colours[colour].push(v as u32);
        }
    }

    /// Merges pairs of neighbours that face alike, and notes in `self` which went where.
    fn coarser(&mut self) -> FieldLevel {
        let n = self.positions.len();
        let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
        for v in 0..n {
            for &(w, _) in self.links(v).iter().filter(|l| l.0 as usize > v) {
                let w = w as usize;
                let (a, b) = (self.areas[v], self.areas[w]);
                let facing = self.normals[v].dot(self.normals[w]);
                pairs.push((facing * (a / b).min(b / a), v as u32, w as u32));
            }
        }
        pairs.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut parent = vec![u32::MAX; n];
        let mut members: Vec<[u32; 2]> = Vec::new();
        for (_, a, b) in pairs {
            if parent[a as usize] == u32::MAX && parent[b as usize] == u32::MAX {
                parent[a as usize] = members.len() as u32;
                parent[b as usize] = members.len() as u32;
                members.push([a, b]);
            }
        }
        for v in 0..n {
            if parent[v] == u32::MAX {
                parent[v] = members.len() as u32;
                members.push([v as u32; 2]);
            }
        }
        let mut out = FieldLevel::default();
        out.starts.push(0);
        let mut near: Vec<(u32, f64)> = Vec::new();
        for &[a, b] in &members {
            let (a, b) = (a as usize, b as usize);
            let (u, v) = (self.areas[a], self.areas[b]);
            let share = u / (u + v);
            out.positions.push(self.positions[a] * share + self.positions[b] * (1.0 - share));
            let normal = self.normals[a] * u + self.normals[b] * v;
            out.normals.push(normal.try_normalize().unwrap_or(self.normals[a]));
            out.areas.push(if a == b { u } else { u + v });
            let leader = if self.hold[b] as u8 > self.hold[a] as u8 { b } else { a };
            out.hold.push(self.hold[leader]);
            let along =
                if self.along[leader] != DVec3::ZERO { self.along[leader] } else { self.along[a] };
            out.along.push(if along != DVec3::ZERO { along } else { self.along[b] });
            if self.hold[leader] != FieldHold::Free {
                let last = out.positions.len() - 1;
                out.positions[last] = self.positions[leader];
            }
            near.clear();
            for &(w, weight) in self.links(a).iter().chain(if a == b { &[] } else { self.links(b) })
            {
                near.push((parent[w as usize], weight));
            }
            near.sort_by_key(|l| l.0);
            for l in near.chunk_by(|x, y| x.0 == y.0) {
                if l[0].0 != parent[a] {
                    out.links.push((l[0].0, l.iter().map(|x| x.1).sum()));
                }
            }
            out.starts.push(out.links.len() as u32);
        }
        self.parent = parent;
        out
    }
}

/// The finest level first.
pub(super) fn levels(mut finest: FieldLevel) -> Vec<FieldLevel> {
    finest.paint();
    let mut all = vec![finest];
    loop {
        let last = all.len() - 1;
        let n = all[last].positions.len();
        if n <= COARSEST {
            return all;
        }
        let mut next = all[last].coarser();
        if next.positions.len() == n {
            all[last].parent.clear();
            return all;
        }
        next.paint();
        all.push(next);
    }
}
