//! The lines that the quads keep: the border, and creases that are long enough to be meant.

use super::surface::{EditSurface, GONE};
use crate::disjoint_sets::DisjointSets;
use crate::portable::PortableMath;

/// Lines that turn by more than this cosine end at the turn: 50 degrees.
const TURN: f64 = 0.642_787_609_686_539_3;
/// Creases that hang together for less than so many sides of a quad are noise.
const SHORTEST: f64 = 4.0;
/// Ends of creases shorter than this, in sides of a quad, are cut off.
const SPUR: f64 = 1.5;

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
            let [m, n] = [s, t].map(|t| surface.normal(t).normalize_or_zero());
            if m != glam::DVec3::ZERO && n != glam::DVec3::ZERO && m.dot(n) < limit {
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
