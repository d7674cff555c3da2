//! The medial curve: lines along the middle of a solid's limbs, with the thickness along them.
//!
//! Each shell is cut into bands by the distance along its surface from a tip. A connected piece of
//! a band is a ring around one limb; its node is the mean of its medial points, each half a wall
//! below the surface, and nodes are joined where their pieces meet: a Reeb graph of the distance
//! (Lazarus and Verroust 1999, "Level set diagrams of polyhedral objects") through the medial
//! points of the shape diameter function. Side branches that end within the wall of where they
//! begin are noise and are left out.
//!
//! It describes limbs: a plate, whose middle is a sheet, gets a line through that sheet.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::bands::{BandPieces, area_of};
use super::partition::{SharedEdge, median_by_area, shared_edges};
use super::surface::WeldedSurface;
use super::{Thickness, ThicknessError};
use crate::job::Job;

/// Around a piece, what is thicker than this many of its medians is measured along the limb.
const ACROSS: f32 = 1.5;
/// A side branch whose tip is nearer to its joint than this share of the wall there is left out.
const STUB: f64 = 0.75;

/// A point of the curve. Lengths are in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct MedialNode {
    /// The mean of the medial points around it.
    pub position: [f64; 3],
    /// The mean thickness of the surface around it.
    pub thickness: f32,
    /// The area of that surface.
    pub area: f64,
}

/// A line of the curve between two tips or joints, or a closed one.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MedialBranch {
    /// Indices of its nodes in order; of a closed one the first is also the last.
    pub nodes: Vec<u32>,
    /// Along the nodes.
    pub length: f64,
    /// The mean thickness by area, without the joints at its ends.
    pub mean: f32,
    /// The node with the least thickness.
    pub thinnest: u32,
    /// For each end, true if it meets another branch.
    pub joined: [bool; 2],
}

/// The medial curve of a solid.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct MedialCurve {
    /// The points, shell by shell, from the tip onwards.
    pub nodes: Vec<MedialNode>,
    /// The lines, the longest first.
    pub branches: Vec<MedialBranch>,
}

impl MedialCurve {
    /// The same moved, from a mesh about the origin to where its file has it.
    pub fn moved(mut self, by: DVec3) -> MedialCurve {
        let nodes = self.nodes.iter_mut();
        nodes.for_each(|n| n.position = (DVec3::from(n.position) + by).to_array());
        self
    }
}

impl Thickness {
    /// Finds the medial curve. Needs values of the triangles
    /// ([`super::MeasuredPlaces::VerticesAndFaces`]), which should be small beside the walls.
    ///
    /// # Errors
    /// Returns an error if there are no values of triangles, or the job was cancelled.
    pub fn medial_curve(&self, job: &Job) -> Result<MedialCurve, ThicknessError> {
        if self.face_values.len() != self.surface.triangles.len() {
            return Err(ThicknessError::Setting {
                what: "the number of values of triangles",
                got: 0.0,
                expected: "one for each triangle",
            });
        }
        let edges = shared_edges(&self.surface);
        let pieces = BandPieces::cut(&self.surface, &self.face_values, &edges, job)?;
        job.progress(0.8);
        let mut graph = graph_of(&pieces, &self.surface, &self.face_values, &edges);
        graph.straighten();
        job.check()?;
        graph.trim();
        Ok(graph.curve())
    }
}

/// The nodes of the pieces, joined where the pieces meet.
fn graph_of(
    pieces: &BandPieces,
    surface: &WeldedSurface,
    values: &[f32],
    edges: &[SharedEdge],
) -> Graph {
    let outward = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let mut members: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    for (t, &piece) in pieces.of.iter().enumerate() {
        if values[t].is_finite() && surface.corners(t).is_some() {
            members.entry((pieces.band[piece as usize], piece)).or_default().push(t as u32);
        }
    }
    let mut graph = Graph::default();
    let mut number: BTreeMap<u32, usize> = BTreeMap::new();
    for ((band, piece), own) in members {
        let mut walls: Vec<(f32, f64)> =
            own.iter().map(|&t| (values[t as usize], area_of(surface, t))).collect();
        let most = median_by_area(&mut walls).map_or(0.0, |m| m * ACROSS);
        let (mut place, mut wall, mut all) = (DVec3::ZERO, 0.0, 0.0);
        for &t in own.iter().filter(|&&t| values[t as usize] <= most) {
            let Some([a, b, c]) = surface.corners(t as usize) else { continue };
            let (value, area) = (values[t as usize], area_of(surface, t));
            let middle: Vec3 = (a + b + c) / 3.0;
            let below = surface.face_normals[t as usize] * (0.5 * outward * value);
            place += (middle - below).as_dvec3() * area;
            wall += f64::from(value) * area;
            all += area;
        }
        if all > 0.0 {
            number.insert(piece, graph.points.len());
            graph.points.push(Point { place: place / all, wall: wall / all, area: all, band });
            graph.beside.push(Vec::new());
        }
    }
    for e in edges {
        let [a, b] = e.triangles.map(|t| number.get(&pieces.of[t as usize]).copied());
        if let (Some(a), Some(b)) = (a, b) {
            graph.join(a, b);
        }
    }
    graph
}

#[derive(Debug, Clone, Copy)]
struct Point {
    place: DVec3,
    wall: f64,
    area: f64,
    band: u32,
}

/// Points and their neighbours, each list rising; a point without neighbours of a larger graph is
/// kept, one that was left out has no area.
#[derive(Debug, Default)]
struct Graph {
    points: Vec<Point>,
    beside: Vec<Vec<usize>>,
}

impl Graph {
    fn join(&mut self, a: usize, b: usize) {
        for (a, b) in [(a, b), (b, a)] {
            if a != b
                && let Err(at) = self.beside[a].binary_search(&b)
            {
                self.beside[a].insert(at, b);
            }
        }
    }

    fn part(&mut self, a: usize, b: usize) {
        self.beside[a].retain(|&x| x != b);
        self.beside[b].retain(|&x| x != a);
    }

    fn apart(&self, a: usize, b: usize) -> f64 {
        self.points[a].place.distance(self.points[b].place)
    }

    /// Takes out what is no limb: rings within the wall of each other become one, and of three
    /// points that are all joined the ends of the longest side are parted.
    fn straighten(&mut self) {
        let mut at = 0;
        while at < self.points.len() {
            let near = self.beside[at].clone();
            let mut merged = false;
            for (i, &a) in near.iter().enumerate() {
                for &b in &near[i + 1..] {
                    let [p, q] = [self.points[a], self.points[b]];
                    if p.band == q.band && self.apart(a, b) < 0.5 * p.wall.max(q.wall) {
                        self.merge(a, b);
                        merged = true;
                    } else if self.beside[a].contains(&b) {
                        let sides = [(at, a), (at, b), (a, b)];
                        let length = |s: &(usize, usize)| self.apart(s.0, s.1);
                        let longest =
                            sides.into_iter().max_by(|s, t| length(s).total_cmp(&length(t)));
                        if let Some((x, y)) = longest {
                            self.part(x, y);
                            merged = true;
                        }
                    }
                    if merged {
                        break;
                    }
                }
                if merged {
                    break;
                }
            }
            // A merged point may make its surroundings simpler again.
            at = if merged { at.saturating_sub(1).min(near[0]) } else { at + 1 };
        }
    }

    fn merge(&mut self, a: usize, b: usize) {
        let [p, q] = [self.points[a], self.points[b]];
        let area = p.area + q.area;
        self.points[a] = Point {
            place: (p.place * p.area + q.place * q.area) / area,
            wall: (p.wall * p.area + q.wall * q.area) / area,
            area,
            band: p.band,
        };
        for other in std::mem::take(&mut self.beside[b]) {
            self.beside[other].retain(|&x| x != b);
            self.join(a, other);
        }
        self.points[b].area = 0.0;
    }

    /// Leaves out side branches that end within the wall of their joint, the shortest first.
    fn trim(&mut self) {
        loop {
            let stubs = (0..self.points.len()).filter(|&tip| self.beside[tip].len() == 1);
            let stub = stubs
                .filter_map(|tip| {
                    let chain = self.chain(tip, self.beside[tip][0]);
                    let joint = *chain.last()?;
                    let reach = self.apart(tip, joint);
                    let noise =
                        self.beside[joint].len() > 2 && reach < STUB * self.points[joint].wall;
                    noise.then_some((reach, tip, chain))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let Some((_, _, chain)) = stub else { return };
            for two in chain.windows(2) {
                self.part(two[0], two[1]);
                self.points[two[0]].area = 0.0;
            }
        }
    }

    /// The points from `from` by way of `to` up to a tip, a joint or `from` again.
    fn chain(&self, from: usize, to: usize) -> Vec<usize> {
        let mut chain = vec![from, to];
        loop {
            let [.., before, last] = chain[..] else { return chain };
            let [a, b] = self.beside[last][..] else { return chain };
            if last == from {
                return chain;
            }
            chain.push(if a == before { b } else { a });
        }
    }

    fn curve(&self) -> MedialCurve {
        let kept: Vec<usize> =
            (0..self.points.len()).filter(|&p| self.points[p].area > 0.0).collect();
        let number = |p: usize| kept.partition_point(|&k| k < p) as u32;
        let nodes = kept
            .iter()
            .map(|&p| {
                let Point { place, wall, area, .. } = self.points[p];
                MedialNode { position: place.to_array(), thickness: wall as f32, area }
            })
            .collect();
        let mut chains: Vec<Vec<usize>> = Vec::new();
        let mut passed = vec![false; self.points.len()];
        for closed in [false, true] {
            for &p in &kept {
                let ends = self.beside[p].len();
                if (ends == 2) != closed || (closed && passed[p]) {
                    continue;
                }
                if ends == 0 {
                    chains.push(vec![p]);
                }
                for &to in &self.beside[p] {
                    let chain = self.chain(p, to);
                    // Each is met from both of its ends.
                    let inner = &chain[1..chain.len() - 1];
                    let met = inner.iter().any(|&x| passed[x]);
                    if met || inner.is_empty() && chain[0] > chain[1] {
                        continue;
                    }
                    inner.iter().for_each(|&x| passed[x] = true);
                    passed[p] |= closed;
                    chains.push(chain);
                }
            }
        }
        let mut branches: Vec<MedialBranch> = chains
            .iter()
            .map(|chain| {
                let joined = |p: usize| self.beside[p].len() > 2;
                // A joint is as thick as what meets there.
                let only = chain.iter().all(|&p| joined(p));
                let own = chain.iter().filter(|&&p| only || !joined(p)).map(|&p| self.points[p]);
                let area: f64 = own.clone().map(|p| p.area).sum();
                let by_wall = |a: &&usize, b: &&usize| {
                    self.points[**a].wall.total_cmp(&self.points[**b].wall)
                };
                let thinnest = chain.iter().min_by(by_wall).copied().unwrap_or(chain[0]);
                MedialBranch {
                    nodes: chain.iter().map(|&p| number(p)).collect(),
                    length: chain.windows(2).map(|two| self.apart(two[0], two[1])).sum(),
                    mean: (own.map(|p| p.wall * p.area).sum::<f64>() / area) as f32,
                    thinnest: number(thinnest),
                    joined: [joined(chain[0]), joined(chain[chain.len() - 1])],
                }
            })
            .collect();
        branches.sort_by(|a, b| b.length.total_cmp(&a.length).then(a.nodes.cmp(&b.nodes)));
        MedialCurve { nodes, branches }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MeasuredPlaces, ThicknessMethod, ThicknessSettings, measure};
    use super::*;
    use crate::TriMesh;
    use crate::implicit::surface;
    use crate::shapes;

    fn curve_of(mesh: &TriMesh) -> MedialCurve {
        let settings = ThicknessSettings {
            method: ThicknessMethod::Sphere,
            at: MeasuredPlaces::VerticesAndFaces,
            ..ThicknessSettings::default()
        };
        let measured = measure(mesh, &settings, &Job::default()).expect("not cancelled");
        measured.medial_curve(&Job::default()).expect("values of triangles")
    }

    /// The distance from a rod with round ends.
    fn rod(p: DVec3, a: DVec3, b: DVec3, radius: f64) -> f64 {
        let along = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
        p.distance(a + (b - a) * along) - radius
    }

    #[test]
    fn a_ring_is_one_closed_line_through_its_middle() {
        let curve = curve_of(&shapes::torus(20.0, 3.0, 160, 32).triangulate().0);
        let [ring] = &curve.branches[..] else { panic!("{:?}", curve.branches) };
        assert_eq!(ring.nodes.first(), ring.nodes.last());
        let expected = 2.0 * std::f64::consts::PI * 20.0;
        assert!((ring.length / expected - 1.0).abs() < 0.03, "{}", ring.length);
        assert!((ring.mean - 6.0).abs() < 0.1, "{}", ring.mean);
        // At the place where the distances from both sides meet, a node is the mean of a long arc.
        let off = |n: &MedialNode| {
            let p = DVec3::from(n.position);
            (p.truncate().length() - 20.0).hypot(p.z)
        };
        let mut away: Vec<f64> = curve.nodes.iter().map(off).collect();
        away.sort_by(f64::total_cmp);
        assert!(away[away.len() - 3] < 0.3 && away[away.len() - 1] < 1.6, "{away:?}");
    }

    #[test]
    fn a_rod_is_a_line_between_the_middles_of_its_ends() {
        let (a, b) = (DVec3::new(-3.0, 0.0, -20.0), DVec3::new(5.0, 2.0, 20.0));
        let field = |p: DVec3| rod(p, a, b, 2.0);
        let bounds = (DVec3::splat(-24.0), DVec3::splat(24.0));
        let curve = curve_of(&surface(field, bounds, 128, &Job::default()).expect("a rod"));
        let [line] = &curve.branches[..] else { panic!("{:?}", curve.branches) };
        assert_eq!(line.joined, [false, false]);
        // The first and the last node are the means of their bands, half a band inside.
        let long = a.distance(b);
        assert!(line.length > long - 3.0 && line.length < long + 0.5, "{} {long}", line.length);
        assert!((line.mean - 4.0).abs() < 0.1, "{}", line.mean);
        for n in &curve.nodes {
            let off = rod(DVec3::from(n.position), a, b, 0.0);
            assert!(off < 0.2, "{off}");
        }
    }

    #[test]
    fn limbs_meet_in_one_joint_and_the_thin_one_is_found() {
        let ends = [DVec3::new(0.0, 0.0, 30.0), DVec3::new(26.0, 0.0, -15.0)];
        let thin = DVec3::new(-26.0, 0.0, -15.0);
        let field = |p: DVec3| {
            let thick = ends.map(|e| rod(p, DVec3::ZERO, e, 4.0));
            thick[0].min(thick[1]).min(rod(p, DVec3::ZERO, thin, 2.5))
        };
        let bounds = (DVec3::splat(-36.0), DVec3::splat(36.0));
        let curve = curve_of(&surface(field, bounds, 160, &Job::default()).expect("limbs"));
        assert_eq!(curve.branches.len(), 3, "{:?}", curve.branches);
        let joints: Vec<[bool; 2]> = curve.branches.iter().map(|b| b.joined).collect();
        assert!(joints.iter().all(|j| j[0] != j[1]), "{joints:?}");
        for branch in &curve.branches {
            assert!((branch.length - 30.0).abs() < 6.0, "{}", branch.length);
        }
        let least = curve.branches.iter().min_by(|a, b| a.mean.total_cmp(&b.mean));
        let least = least.expect("three");
        assert!((least.mean - 5.0).abs() < 0.4, "{}", least.mean);
        let place = DVec3::from(curve.nodes[least.thinnest as usize].position);
        assert!(place.x < -3.0 && place.z < 0.0, "{place}");
    }

    #[test]
    fn a_ball_is_a_point_or_a_stub_and_shells_have_curves_of_their_own() {
        let ball = shapes::icosphere(10.0, 20);
        let curve = curve_of(&ball);
        assert_eq!(curve.branches.len(), 1);
        assert!(curve.branches[0].length < 2.0, "{:?}", curve.branches);
        let mut two = ball.clone();
        let first = two.positions.len() as u32;
        two.positions.extend(ball.positions.iter().map(|p| *p + Vec3::X * 50.0));
        two.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
        assert_eq!(curve_of(&two).branches.len(), 2);
        let none = curve_of(&TriMesh::default());
        assert_eq!(none, MedialCurve::default());
    }
}
