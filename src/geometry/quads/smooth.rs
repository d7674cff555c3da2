//! Squarer quads: every face asks its corners to be those of the regular polygon that fits it best,
//! every vertex goes to the mean of what it is asked, along the surface (Bouaziz et al.,
//! "Shape-Up: shaping discrete geometry with projections", 2012), and is projected back.

use glam::DVec3;
use rayon::prelude::*;

use super::quad_surface::{QuadSurface, corners};
use super::target::ProjectionTarget;
use crate::job::{Cancelled, Job};

/// Rounds of smoothing.
pub(super) fn smooth(
    s: &mut QuadSurface,
    target: &ProjectionTarget,
    step: f64,
    rounds: usize,
    job: &Job,
) -> Result<(), Cancelled> {
    for _ in 0..rounds {
        job.check()?;
        let asked: Vec<[DVec3; 4]> =
            (0..s.faces.len()).into_par_iter().map(|f| regular(s, f, step)).collect();
        let moved: Vec<DVec3> =
            (0..s.positions.len()).into_par_iter().map(|v| place(s, target, &asked, v)).collect();
        s.positions = moved;
    }
    Ok(())
}

/// The corners of the regular polygon that fits a face best, its size drawn half way to `step`.
fn regular(s: &QuadSurface, f: usize, step: f64) -> [DVec3; 4] {
    let mut out = [DVec3::ZERO; 4];
    if !s.alive(f) {
        return out;
    }
    let face = corners(&s.faces[f]);
    let p = |k: usize| s.positions[face[k] as usize];
    let n = face.len();
    let centre = (0..n).map(p).sum::<DVec3>() / n as f64;
    let up = s.normal(f as u32).normalize_or_zero();
    // Turn every corner onto the first.
    let (cos, sin, radius) = if n == 4 {
        (0.0, 1.0, std::f64::consts::FRAC_1_SQRT_2)
    } else {
        // The corners of an equilateral triangle of the quad's side.
        (-0.5, 0.866_025_403_784_438_6, 0.577_350_269_189_625_8)
    };
    let turn = |d: DVec3, back: bool| {
        let flat = d - up * up.dot(d);
        flat * cos + up.cross(flat) * if back { -sin } else { sin }
    };
    let mut mean = DVec3::ZERO;
    for k in 0..n {
        let mut d = p(k) - centre;
        d -= up * up.dot(d);
        for _ in 0..k {
            d = turn(d, true);
        }
        mean += d / n as f64;
    }
    let length = mean.length();
    let wanted = length + (radius * step - length) * 0.5;
    let mut d = mean.normalize_or_zero() * wanted;
    for slot in out.iter_mut().take(n) {
        *slot = centre + d;
        d = turn(d, false);
    }
    out
}

fn place(s: &QuadSurface, target: &ProjectionTarget, asked: &[[DVec3; 4]], v: usize) -> DVec3 {
    let p = s.positions[v];
    if s.pinned[v] || s.around[v].is_empty() {
        return p;
    }
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for &f in &s.around[v] {
        let face = corners(&s.faces[f as usize]);
        if let Some(k) = face.iter().position(|&w| w as usize == v) {
            sum += asked[f as usize][k];
            count += 1.0;
        }
    }
    let step = sum / count - p;
    if let [a, b] = s.lines[v][..] {
        let along = (s.positions[a as usize] - s.positions[b as usize]).normalize_or_zero();
        return target.line(p + along * step.dot(along) * 0.5, s.chain[v]);
    }
    let up = s.vertex_normal(v as u32);
    target.surface(p + (step - up * step.dot(up)) * 0.8, up)
}
