//! The outline in which a part stands on its plate, and the regions of the plate that it encloses.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::part::{PreparedPart, Standing};

/// A closed loop of the outline: vertices in order, and their places in the plan.
#[derive(Debug, Clone)]
struct ContactLoop {
    vertices: Vec<u32>,
    points: Vec<DVec2>,
    /// Positive where the solid is inside.
    area: f64,
}

/// A part's contact with its plate.
#[derive(Debug, Clone, Default)]
pub struct PlateContact {
    /// True for each triangle on the plate.
    pub triangles: Vec<bool>,
    /// The area on the plate.
    pub area: f64,
    loops: Vec<ContactLoop>,
    /// The loops around the regions that the part encloses, as indices into `loops`.
    holes: Vec<usize>,
}

/// The region of the plate outside of all outlines.
pub const OUTSIDE: u32 = 0;

impl PlateContact {
    /// Finds the triangles on the plate and their outline.
    pub fn new(part: &PreparedPart, stand: &Standing) -> PlateContact {
        let names = &part.topology().triangles;
        let on = |t: usize| {
            part.areas[t] > 0.0 && part.normals[t].dot(stand.up) < 0.0 && stand.on_plate(&names[t])
        };
        let triangles: Vec<bool> = (0..names.len()).map(on).collect();
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut area = 0.0;
        for t in (0..names.len()).filter(|&t| triangles[t]) {
            area += part.areas[t] * -part.normals[t].dot(stand.up);
            for k in 0..3 {
                let beyond = part.across(t as u32, k).filter(|&u| triangles[u as usize]);
                if beyond.is_none() {
                    // Seen from above a face that looks down runs the other way round.
                    next.entry(names[t][(k + 1) % 3]).or_default().push(names[t][k]);
                }
            }
        }
        let (u, v) = stand.plan();
        let flat = |n: u32| {
            let p: DVec3 = part.places[n as usize];
            DVec2::new(p.dot(u), p.dot(v))
        };
        let mut loops = Vec::new();
        while let Some((&start, _)) = next.first_key_value() {
            let (mut vertices, mut at) = (Vec::new(), start);
            while let Some(ways) = next.get_mut(&at) {
                vertices.push(at);
                let to = ways.pop();
                if ways.is_empty() {
                    next.remove(&at);
                }
                match to {
                    Some(to) if to != start => at = to,
                    _ => break,
                }
            }
            let points: Vec<DVec2> = vertices.iter().map(|&n| flat(n)).collect();
            let o = points.first().copied().unwrap_or_default();
            let twice: f64 = (0..points.len())
                .map(|i| (points[i] - o).perp_dot(points[(i + 1) % points.len()] - o))
                .sum();
            loops.push(ContactLoop { vertices, points, area: twice * 0.5 });
        }
        let holes = (0..loops.len()).filter(|&i| loops[i].area < 0.0).collect();
        PlateContact { triangles, area, loops, holes }
    }

    /// The number of enclosed regions; they are numbered from 1 on.
    pub fn regions(&self) -> usize {
        self.holes.len()
    }

    /// The smallest enclosed region that holds a point of the plan, or [`OUTSIDE`].
    pub fn region_at(&self, p: DVec2, except: Option<usize>) -> u32 {
        let around = self.holes.iter().enumerate().filter(|(_, l)| Some(**l) != except);
        let around = around.filter(|(_, l)| inside(&self.loops[**l].points, p));
        let least = around
            .min_by(|a, b| self.loops[*a.1].area.abs().total_cmp(&self.loops[*b.1].area.abs()));
        least.map_or(OUTSIDE, |(i, _)| i as u32 + 1)
    }

    /// Each loop's vertices with the region of the plate beside it, and the area of each region
    /// that no part of the contact covers.
    pub fn beside(&self) -> (Vec<(&[u32], u32)>, Vec<f64>) {
        let mut free = vec![0.0; self.holes.len() + 1];
        let mut out = Vec::new();
        for (i, l) in self.loops.iter().enumerate() {
            let own = self.holes.iter().position(|&h| h == i);
            let region = match own {
                Some(r) => r as u32 + 1,
                None => l.points.first().map_or(OUTSIDE, |&p| self.region_at(p, None)),
            };
            if region != OUTSIDE {
                free[region as usize] -= l.area;
            }
            out.push((&l.vertices[..], region));
        }
        (out, free)
    }

    /// The corners of the outline.
    pub fn points(&self) -> impl Iterator<Item = DVec2> {
        self.loops.iter().flat_map(|l| l.points.iter().copied())
    }
}

/// Returns true if a point is inside a closed polygon.
fn inside(ring: &[DVec2], p: DVec2) -> bool {
    let mut odd = false;
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)) {
            odd = !odd;
        }
    }
    odd
}
