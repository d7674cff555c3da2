//! The nearest hit: down the clay's tree to pages, down a page's tree to eight triangles, and the
//! watertight test of [`sculptd_geometry::simd::wide`] on those. Of two hits at the same distance
//! the lower page and triangle wins, so the answer does not depend on the walk.

use std::sync::Arc;

use super::boxtree::{BoxRay, BoxTree, LEAF};
use super::page::Page;
use super::page_sets::all_hidden;
use super::ray::{Hit, Ray};
use sculptd_geometry::simd::wide::{NO_TRIANGLE, Pack, Wide, WideWork, dispatch};

#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) t: f32,
    page: u32,
    triangle: u32,
    u: f32,
    v: f32,
}

/// Looks for a nearer hit in one page.
#[inline(always)]
fn search<W: Wide>(w: W, ray: &BoxRay, page: &Page, number: u32, best: &mut Option<Found>) {
    let far = best.map_or(f32::INFINITY, |b| b.t);
    let triangles = &page.topology.triangles;
    let hidden = page.hidden_rows();
    page.tree.walk_ray(ray, far, |leaf, mut far| {
        let first = leaf * LEAF;
        for half in (first..(first + LEAF).min(triangles.len())).step_by(4) {
            let mut pack = Pack { v: [[[f32::NAN; 4]; 3]; 3], id: [NO_TRIANGLE; 4] };
            for (lane, corners) in
                triangles[half..(half + 4).min(triangles.len())].iter().enumerate()
            {
                if hidden.is_some_and(|rows| all_hidden(rows, *corners)) {
                    continue;
                }
                for c in 0..3 {
                    let p = page.points[corners[c] as usize];
                    pack.v[c][0][lane] = p.x;
                    pack.v[c][1][lane] = p.y;
                    pack.v[c][2][lane] = p.z;
                }
            }
            let mut hits = w.triangles(&ray.ready, &pack, far);
            ray.ready.settle_all(&pack, far, |_| true, &mut hits);
            let mut mask = hits.mask;
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 3;
                mask &= mask - 1;
                let (t, triangle) = (hits.t[i], (half + i) as u32);
                if best.is_none_or(|b| {
                    t < b.t || (t == b.t && (number, triangle) < (b.page, b.triangle))
                }) {
                    *best = Some(Found { t, page: number, triangle, u: hits.u[i], v: hits.v[i] });
                    far = t;
                }
            }
        }
        far
    });
}

struct InPage<'a> {
    ray: &'a BoxRay,
    page: &'a Page,
    number: u32,
    best: &'a mut Option<Found>,
}

impl WideWork for InPage<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        search(w, self.ray, self.page, self.number, self.best);
    }
}

/// Looks for a nearer hit in one page.
pub(super) fn in_page(ray: &BoxRay, page: &Page, number: u32, best: &mut Option<Found>) {
    dispatch(false, InPage { ray, page, number, best });
}

struct Everywhere<'a> {
    ray: &'a BoxRay,
    top: &'a BoxTree,
    pages: &'a [Arc<Page>],
}

impl WideWork for Everywhere<'_> {
    type Output = Option<Found>;
    #[inline(always)]
    fn run<W: Wide>(self, w: W) -> Option<Found> {
        let mut best = None;
        self.top.walk_ray(self.ray, f32::INFINITY, |leaf, far| {
            search(w, self.ray, &self.pages[leaf], leaf as u32, &mut best);
            best.map_or(far, |b| b.t)
        });
        best
    }
}

/// The nearest hit over all pages under `top`.
pub(super) fn everywhere(top: &BoxTree, pages: &[Arc<Page>], ray: Ray) -> Option<Hit> {
    let (lo, hi) = top.bounds();
    let boxes = BoxRay::new(ray.origin, ray.dir, lo.abs().max(hi.abs()).max_element());
    let found = dispatch(false, Everywhere { ray: &boxes, top, pages })?;
    Some(finish(found, ray, |i| &pages[i as usize]))
}

/// A hit's position and interpolated normal.
pub(super) fn finish<'a>(found: Found, ray: Ray, page: impl Fn(u32) -> &'a Arc<Page>) -> Hit {
    let home = page(found.page);
    let weights = [1.0 - found.u - found.v, found.u, found.v];
    let corners = home.topology.triangles[found.triangle as usize].map(usize::from);
    let mix = |at: &dyn Fn(usize) -> glam::Vec3| {
        at(corners[0]) * weights[0] + at(corners[1]) * weights[1] + at(corners[2]) * weights[2]
    };
    let flat = || {
        let [a, b, c] = home.corners(found.triangle as usize);
        (b - a).cross(c - a).normalize_or(-ray.dir)
    };
    Hit {
        t: found.t,
        position: ray.origin + ray.dir * found.t,
        normal: mix(&|v| home.normal(v)).try_normalize().unwrap_or_else(flat),
        page: found.page,
        triangle: found.triangle,
        barycentric: weights,
    }
}
