//! Looks through a page for edges that are to be changed. Pages are only read, each by one task.

use glam::Vec3;

use super::shape::{FLIP_BELOW, LEAST, sine2};
use super::{Detail, PROTECTED, Within};
use crate::assembly::PAGE_VERTICES;
use crate::page::Page;

/// Balls that are looked at in one pass, at most.
pub(crate) const BALLS: usize = 16;

/// An operation on an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EdgeTask {
    Split,
    Collapse,
    Flip,
    /// The shortest edge of a sliver: its ends become one, however long it is.
    Merge,
}

/// An edge to be changed. Ordered by task, then by how urgent it is, then by its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Candidate {
    pub(crate) task: EdgeTask,
    /// The least is the most urgent.
    pub(crate) rank: u32,
    /// Page and own index of both ends, the lower page or index first.
    pub(crate) ends: [(u32, u16); 2],
    /// The index of the ball that requests it.
    pub(crate) ball: u8,
}

/// The result of one task, and its memory.
#[derive(Debug, Default)]
pub(crate) struct PageScan {
    pub(crate) page: u32,
    pub(crate) found: Vec<Candidate>,
    /// The balls that contain each row, one bit each.
    inside: Vec<u16>,
}

impl PageScan {
    /// With room for any page that is not tangled.
    pub(crate) fn new() -> PageScan {
        let found = Vec::with_capacity(4 * PAGE_VERTICES);
        PageScan { page: 0, found, inside: Vec::with_capacity(4 * PAGE_VERTICES) }
    }

    /// Finds each triangle's longest edge if it is too long, its shortest if it is too short, and
    /// its longest if the triangle is badly shaped; each once, the most urgent first. A triangle
    /// with an angle below 3 degrees is included if one corner is in a ball: brushes squeeze
    /// triangles at their rim too.
    pub(crate) fn scan(&mut self, page: &Page, balls: &[Detail], within: Within<'_>) {
        self.found.clear();
        self.find(page, balls, within);
        self.found.sort_unstable();
        self.found.dedup();
    }

    fn find(&mut self, page: &Page, balls: &[Detail], within: Within<'_>) {
        let t = &page.topology;
        self.inside.clear();
        let mut any = 0;
        self.inside.extend(page.points.iter().map(|p| {
            let at = p.truncate();
            let bits = if p.w >= PROTECTED {
                0
            } else {
                balls
                    .iter()
                    .enumerate()
                    .fold(0, |bits, (i, b)| bits | u16::from(b.contains(at)) << i)
            };
            let bits = if bits != 0 && !within.is_none_or(|w| w(at)) { 0 } else { bits };
            any |= bits;
            bits
        }));
        if any == 0 {
            return;
        }
        for corners in &t.triangles {
            let rows = corners.map(usize::from);
            let inside = rows.map(|r| self.inside[r]);
            let touched = inside[0] | inside[1] | inside[2];
            if touched == 0 {
                continue;
            }
            let edge_inside = [inside[0] & inside[1], inside[1] & inside[2], inside[2] & inside[0]];
            let p: [Vec3; 3] = rows.map(|r| page.points[r].truncate());
            let lengths = [
                (p[0] - p[1]).length_squared(),
                (p[1] - p[2]).length_squared(),
                (p[2] - p[0]).length_squared(),
            ];
            let (mut long, mut short) = (0, 0);
            for k in 1..3 {
                if lengths[k] > lengths[long] {
                    long = k;
                }
                if lengths[k] < lengths[short] {
                    short = k;
                }
            }
            let ball = |k: usize| {
                let bits = if edge_inside[k] != 0 { edge_inside[k] } else { touched };
                bits.trailing_zeros() as usize
            };
            let mut add = |task, rank, k: usize| {
                let end = |v: u16| match usize::from(v).checked_sub(t.own) {
                    None => (self.page, v),
                    Some(halo) => t.halo_home(halo),
                };
                let (a, b) = (end(corners[k]), end(corners[(k + 1) % 3]));
                let ends = [a.min(b), a.max(b)];
                self.found.push(Candidate { task, rank, ends, ball: ball(k) as u8 });
            };
            let shape = sine2(p[0], p[1], p[2]);
            if shape < LEAST {
                add(EdgeTask::Flip, shape.to_bits(), long);
                add(EdgeTask::Merge, shape.to_bits(), short);
            }
            if edge_inside[long] != 0 {
                let b = &balls[ball(long)];
                if b.split && lengths[long] > b.longest() * b.longest() {
                    add(EdgeTask::Split, !lengths[long].to_bits(), long);
                    continue;
                }
            }
            if edge_inside[short] != 0 {
                let b = &balls[ball(short)];
                if b.collapse && lengths[short] < b.shortest() * b.shortest() {
                    add(EdgeTask::Collapse, lengths[short].to_bits(), short);
                    continue;
                }
            }
            if edge_inside[long] != 0 && (LEAST..FLIP_BELOW * 0.75).contains(&shape) {
                add(EdgeTask::Flip, shape.to_bits(), long);
            }
        }
    }
}
