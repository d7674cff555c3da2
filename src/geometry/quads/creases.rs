//! The lines that the quads keep: the border, and creases that are long enough to be meant.

use glam::DVec3;

use super::surface::{EditSurface, GONE};
use crate::disjoint_sets::DisjointSets;
use crate::portable::PortableMath;

/// Lines that turn by more than this cosine end at the turn: 50 degrees.
const TURN: f64 = 0.642_787_609_686_539_3;
/// Connected creases shorter than this many sides of a quad are noise.
const SHORTEST: f64 = 4.0;
/// Ends of creases shorter than this, in sides of a quad, are cut off.
const SPUR: f64 = 1.5;

/// Triangles lower than this, in sides of a quad, are slivers.
const SLIVER: f64 = 0.05;

/// Marks the border, and the edges whose faces turn by more than `creases` degrees; pins their
/// corners. The unit of `surface` is the side of a quad.
pub(super) fn find_lines(surface: &mut EditSurface, creases: Option<f64>) {
    let limit = creases.map(|degrees| degrees.clamp(0.0, 180.0).to_radians().portable_cos());
    let mut found = Vec::new();
    for (a, b) in surface.edges() {
        let [s, t] = surface.sides(a, b);
        if t == GONE {
            surface.add_line(a, b);
        } else if let Some(limit) = limit {
            let [m, n] = [s, t].map(|t| facing(surface, t));
            if m != DVec3::ZERO && n != DVec3::ZERO && m.dot(n) < limit {
                found.push((a, b));
            }
        }
    }
    let mut sets = DisjointSets::new(surface.positions.len());
    found.iter().for_each(|&(a, b)| sets.join(a, b));
    let length =
        |s: &EditSurface, a: u32, b: u32| s.positions[a as usize].distance(s.positions[b as usize]);
    let mut total = vec![0.0; surface.positions.len()];
    for &(a, b) in &found {
        total[sets.root(a) as usize] += length(surface, a, b);
    }
    found.retain(|&(a, _)| total[sets.root(a) as usize] >= SHORTEST);
    for &(a, b) in &found {
        surface.add_line(a, b);
    }
    for v in 0..surface.positions.len() as u32 {
        cut_spur(surface, v);
    }
    surface.pin_corners(TURN);
}

/// The unit normal of a triangle; of a sliver that of the one across its longest edge, because its
/// own is what rounding made of it. Of slivers in a row the fourth decides.
fn facing(s: &EditSurface, mut t: u32) -> DVec3 {
    for _ in 0..4 {
        let tri = s.triangles[t as usize];
        let side = |k: usize| {
            s.positions[tri[k] as usize].distance(s.positions[tri[(k + 1) % 3] as usize])
        };
        let longest = (0..3).fold(0, |m, k| if side(k) > side(m) { k } else { m });
        if s.normal(t).length() > SLIVER * side(longest) {
            break;
        }
        match s.sides(tri[longest], tri[(longest + 1) % 3]) {
            [_, GONE] => break,
            [x, y] => t = if x == t { y } else { x },
        }
    }
    s.normal(t).normalize_or_zero()
}

/// Numbers the chains of lines between pinned vertices, and tells the segments of each.
pub(super) fn number_chains(s: &mut EditSurface) -> Vec<Vec<[u32; 2]>> {
    let mut chains: Vec<Vec<[u32; 2]>> = Vec::new();
    for v in 0..s.positions.len() as u32 {
        if !s.pinned[v as usize] {
            continue;
        }
        for first in s.lines[v as usize].clone() {
            if s.pinned[first as usize] {
                if v < first {
                    s.direct.insert((v, first), chains.len() as u32);
                    chains.push(vec![[v, first]]);
                }
            } else if s.chain[first as usize] == GONE {
                let chain = walk(s, v, first, chains.len() as u32);
                chains.push(chain);
            }
        }
    }
    // The remaining lines are loops without a pinned vertex.
    for v in 0..s.positions.len() as u32 {
        if let [first, _] = s.lines[v as usize][..]
            && !s.pinned[v as usize]
            && s.chain[v as usize] == GONE
        {
            s.chain[v as usize] = chains.len() as u32;
            let chain = walk(s, v, first, chains.len() as u32);
            chains.push(chain);
        }
    }
    chains
}

/// Follows a chain from its first segment on, and marks its vertices.
fn walk(s: &mut EditSurface, from: u32, first: u32, chain: u32) -> Vec<[u32; 2]> {
    let mut out = vec![[from, first]];
    let (mut before, mut at) = (from, first);
    while !s.pinned[at as usize] && s.chain[at as usize] == GONE {
        s.chain[at as usize] = chain;
        let Some(&next) = s.lines[at as usize].iter().find(|&&w| w != before) else { break };
        out.push([at, next]);
        (before, at) = (at, next);
    }
    out
}

/// Takes away the lines from a loose end to where they meet others, if they are short.
fn cut_spur(s: &mut EditSurface, end: u32) {
    if s.lines[end as usize].len() != 1 {
        return;
    }
    let mut way = vec![end];
    let mut length = 0.0;
    loop {
        let at = way[way.len() - 1];
        let before = if way.len() > 1 { way[way.len() - 2] } else { GONE };
        let Some(&next) = s.lines[at as usize].iter().find(|&&w| w != before) else { return };
        length += s.positions[at as usize].distance(s.positions[next as usize]);
        way.push(next);
        if length > SPUR {
            return;
        }
        if s.lines[next as usize].len() != 2 {
            break;
        }
    }
    for ends in way.windows(2) {
        s.lines[ends[0] as usize].retain(|&w| w != ends[1]);
        s.lines[ends[1] as usize].retain(|&w| w != ends[0]);
    }
}
