//! A surface of quads and a few triangles that is edited in place: vertices between two faces are
//! removed, quads are closed along a diagonal, edges are turned within their two quads (Kinney,
//! "CleanUp: improving quadrilateral finite element meshes", 1997). Each keeps the surface a
//! manifold; lines and pinned vertices stay.

use glam::DVec3;

use super::surface::{EditSurface, GONE};

/// An editable surface of quads and triangles; `[GONE; 4]` where a face is gone.
#[derive(Debug, Clone)]
pub(super) struct QuadSurface {
    pub positions: Vec<DVec3>,
    /// Counter-clockwise; the last corner of a triangle is [`GONE`].
    pub faces: Vec<[u32; 4]>,
    pub around: Vec<Vec<u32>>,
    pub lines: Vec<Vec<u32>>,
    pub pinned: Vec<bool>,
    /// The chain of lines of each vertex.
    pub chain: Vec<u32>,
    /// True for each vertex on the border.
    pub border: Vec<bool>,
}

/// The corners of a face.
pub(super) fn corners(face: &[u32; 4]) -> &[u32] {
    if face[3] == GONE { &face[..3] } else { face }
}

impl QuadSurface {
    pub fn new(s: &EditSurface, faces: Vec<[u32; 4]>) -> QuadSurface {
        let mut around = vec![Vec::new(); s.positions.len()];
        for (f, face) in faces.iter().enumerate() {
            corners(face).iter().for_each(|&v| around[v as usize].push(f as u32));
        }
        let border = (0..s.positions.len() as u32)
            .map(|v| s.lines[v as usize].iter().any(|&w| s.sides(v, w)[1] == GONE))
            .collect();
        QuadSurface {
            positions: s.positions.clone(),
            faces,
            around,
            lines: s.lines.clone(),
            pinned: s.pinned.clone(),
            chain: s.chain.clone(),
            border,
        }
    }

    pub fn alive(&self, f: usize) -> bool {
        self.faces[f][0] != GONE
    }

    /// The vertices at the other ends of the edges of `v`, sorted.
    pub fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut out = Vec::with_capacity(12);
        for &f in &self.around[v as usize] {
            let c = corners(&self.faces[f as usize]);
            let k = c.iter().position(|&w| w == v).unwrap_or(0);
            out.extend([c[(k + 1) % c.len()], c[(k + c.len() - 1) % c.len()]]);
        }
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Twice the area of the face as a vector.
    pub fn normal(&self, f: u32) -> DVec3 {
        let p = |v: u32| self.positions[v as usize];
        let [a, b, c, d] = self.faces[f as usize];
        if d == GONE { (p(b) - p(a)).cross(p(c) - p(a)) } else { (p(c) - p(a)).cross(p(d) - p(b)) }
    }

    /// The unit normal at a vertex, weighted by area; zero where there is none.
    pub fn vertex_normal(&self, v: u32) -> DVec3 {
        self.around[v as usize].iter().map(|&f| self.normal(f)).sum::<DVec3>().normalize_or_zero()
    }

    fn drop_face(&mut self, f: u32) {
        for v in std::mem::replace(&mut self.faces[f as usize], [GONE; 4]) {
            if v != GONE {
                self.around[v as usize].retain(|&g| g != f);
            }
        }
    }

    fn put_face(&mut self, f: u32, face: [u32; 4]) {
        self.drop_face(f);
        self.faces[f as usize] = face;
        for &v in corners(&face) {
            self.around[v as usize].push(f);
        }
    }

    /// Joins the two faces around a free vertex that has no others; whether it did.
    pub fn remove_doublet(&mut self, v: u32) -> bool {
        let &[f, g] = &self.around[v as usize][..] else { return false };
        if !self.lines[v as usize].is_empty() {
            return false;
        }
        let (mut one, mut two) = (self.faces[f as usize], self.faces[g as usize]);
        let mut ids = (f, g);
        if one[3] == GONE {
            std::mem::swap(&mut one, &mut two);
            ids = (g, f);
        }
        if one[3] == GONE {
            return false;
        }
        let k = one.iter().position(|&w| w == v).unwrap_or(0);
        let [_, a, x, b] = [0, 1, 2, 3].map(|i| one[(k + i) % 4]);
        let c = corners(&two);
        let far = c.iter().copied().find(|w| ![v, a, b].contains(w));
        let joined = match far {
            Some(y) if y != x => [a, x, b, y],
            Some(_) => return false,
            None => [a, x, b, GONE],
        };
        self.drop_face(ids.1);
        self.put_face(ids.0, joined);
        true
    }

    /// Returns true if quad `f` may be closed by merging its corner `k + 2` into corner `k`.
    pub fn can_close(&self, f: u32, k: usize) -> bool {
        let face = self.faces[f as usize];
        if face[3] == GONE {
            return false;
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| face[(k + i) % 4]);
        if !self.lines[c as usize].is_empty() {
            return false;
        }
        let enough = |v: u32| {
            self.around[v as usize].len() > if self.lines[v as usize].is_empty() { 3 } else { 2 }
        };
        if !enough(b) || !enough(d) {
            return false;
        }
        if self.around[a as usize].len() + self.around[c as usize].len() < 5 {
            return false;
        }
        let both = self.around[c as usize].iter().filter(|g| self.around[a as usize].contains(g));
        if both.count() != 1 {
            return false;
        }
        let (near, other) = (self.neighbours(a), self.neighbours(c));
        other.iter().filter(|&w| near.binary_search(w).is_ok()).all(|&w| w == b || w == d)
            && near.binary_search(&c).is_err()
    }

    /// Closes the quad; after [`QuadSurface::can_close`]. Corner `k` stays where it is.
    pub fn close(&mut self, f: u32, k: usize) {
        let (a, c) = (self.faces[f as usize][k], self.faces[f as usize][(k + 2) % 4]);
        self.drop_face(f);
        for g in std::mem::take(&mut self.around[c as usize]) {
            for v in &mut self.faces[g as usize] {
                if *v == c {
                    *v = a;
                }
            }
            self.around[a as usize].push(g);
        }
    }

    /// The six corners around two quads `f` and `g` that share the edge from corner `k` of `f`,
    /// from that corner on: the edge runs from the first to the fourth. `None` where there is no
    /// such pair or the edge is a line.
    pub fn hexagon(&self, f: u32, k: usize) -> Option<(u32, [u32; 6])> {
        let face = self.faces[f as usize];
        if face[3] == GONE {
            return None;
        }
        // Edge from q (corner k) to p (corner k + 1); seen from the other face it runs p to q.
        let [q, p, x, y] = [0, 1, 2, 3].map(|i| face[(k + i) % 4]);
        if self.lines[q as usize].contains(&p) {
            return None;
        }
        let g = *self.around[q as usize].iter().find(|&&g| {
            let other = self.faces[g as usize];
            g != f && other[3] != GONE && (0..4).any(|i| other[i] == p && other[(i + 1) % 4] == q)
        })?;
        let other = self.faces[g as usize];
        let i = (0..4).find(|&i| other[i] == p)?;
        // f = [p, x, y, q], g = [q, z, w, p].
        let (z, w) = (other[(i + 2) % 4], other[(i + 3) % 4]);
        let six = [p, x, y, q, z, w];
        let twice = (0..6).any(|m| six[m + 1..].contains(&six[m]));
        (!twice).then_some((g, six))
    }

    /// The corners around `f` and the face across its edge from corner `k`, which is no line: the
    /// edge runs from the first of them to the one with the number of `f`'s corners less one.
    pub fn ring(&self, f: u32, k: usize) -> Option<(u32, Vec<u32>)> {
        let own = corners(&self.faces[f as usize]);
        let n = own.len();
        let (q, p) = (own[k], own[(k + 1) % n]);
        if self.lines[q as usize].contains(&p) {
            return None;
        }
        let follows = |c: &[u32]| (0..c.len()).position(|i| c[i] == p && c[(i + 1) % c.len()] == q);
        let &g = self.around[q as usize]
            .iter()
            .find(|&&g| g != f && follows(corners(&self.faces[g as usize])).is_some())?;
        let other = corners(&self.faces[g as usize]);
        let i = follows(other)?;
        let mut ring: Vec<u32> = (1..=n).map(|m| own[(k + m) % n]).collect();
        ring.extend((2..other.len()).map(|m| other[(i + m) % other.len()]));
        let twice = (0..ring.len()).any(|m| ring[m + 1..].contains(&ring[m]));
        (!twice).then_some((g, ring))
    }

    /// Replaces two faces by others, the second of which may be none.
    pub fn replace(&mut self, f: u32, g: u32, one: [u32; 4], two: Option<[u32; 4]>) {
        self.drop_face(g);
        self.put_face(f, one);
        if let Some(two) = two {
            self.put_face(g, two);
        }
    }

    /// Returns true if an edge joins two vertices.
    pub fn joined(&self, a: u32, b: u32) -> bool {
        self.neighbours(a).binary_search(&b).is_ok()
    }

    /// The two quads of a hexagon cut from its corner `k`.
    pub fn cut(six: [u32; 6], k: usize) -> [[u32; 4]; 2] {
        let v = |i: usize| six[(k + i) % 6];
        [[v(0), v(1), v(2), v(3)], [v(3), v(4), v(5), v(0)]]
    }

    /// Replaces two quads by those of their hexagon cut from corner `k`.
    pub fn turn(&mut self, f: u32, g: u32, six: [u32; 6], k: usize) {
        let [one, two] = QuadSurface::cut(six, k);
        self.put_face(f, one);
        self.put_face(g, two);
    }

    /// Cuts quad `f` along the diagonal that leaves both triangles the most upright.
    pub fn cut_quad(&mut self, f: u32) {
        let face = self.faces[f as usize];
        let p = face.map(|v| self.positions[v as usize]);
        let up = (p[2] - p[0]).cross(p[3] - p[1]);
        let least = |k: usize| {
            let c = |i: usize| p[(k + i) % 4];
            let m = (c(1) - c(0)).cross(c(2) - c(0)).dot(up);
            m.min((c(2) - c(0)).cross(c(3) - c(0)).dot(up))
        };
        let k = usize::from(least(1) > least(0));
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| face[(k + i) % 4]);
        if self.joined(a, c) {
            return;
        }
        self.put_face(f, [a, b, c, GONE]);
        let g = self.faces.len() as u32;
        self.faces.push([GONE; 4]);
        self.put_face(g, [a, c, d, GONE]);
    }
}
