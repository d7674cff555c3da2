//! Fewer triangles for pages that are far away, where many fall on one pixel: for drawing alone.
//!
//! Laws kept here:
//! * A page's rim, and whatever another page shares with it, keeps its vertices: between a coarse
//!   page and its neighbours there is no crack, whatever each is drawn with.
//! * The vertices are those of the clay, so a stroke on a far page is seen.

use std::ops::Range;

use crossbeam_channel as cc;
use glam::{Mat4, Vec3};

use super::page_place::place;
use sculptd_clay::{Page, Snapshot};

/// Triangles of a clay from which on far pages are coarse: below, a card draws all in no time.
pub const MANY: usize = 500_000;
/// A page is far that takes fewer pixels across: a page has about a thousand triangles.
const FAR_PIXELS: f32 = 40.0;
/// Own vertices that become one.
const MERGED: f32 = 6.0;
/// Bytes that are sent to the card a frame, about.
const A_FRAME: u64 = 4 << 20;

/// The coarse index sets of a clay. A thread makes them: a frame sends what has come meanwhile.
#[derive(Debug)]
pub struct CoarsePages {
    buffer: wgpu::Buffer,
    /// Of each page that is done, where one is worth it.
    ranges: Vec<Option<Range<u32>>>,
    /// Start of the next page's range: ranges are contiguous, so that neighbours are one call.
    next: u32,
    pages: usize,
    /// Page by page; empty: not worth it.
    made: cc::Receiver<Vec<u32>>,
}

impl CoarsePages {
    /// Begins to make them. `ranges`: the pages' own indices, which bound the coarse ones: what
    /// takes more than half as many is not worth it.
    pub fn new(
        device: &wgpu::Device,
        mesh: &Snapshot,
        ranges: &[Range<u32>],
        slot: usize,
    ) -> CoarsePages {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("coarse pages"),
            size: (mesh.triangle_count() / 2 * 3 * size_of::<u32>()).max(4) as u64,
            usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (send, made) = cc::unbounded();
        let (mesh, rooms) = (mesh.clone(), ranges.iter().map(|r| r.len() / 6 * 3));
        let rooms: Vec<usize> = rooms.collect();
        let make = move || {
            for (p, room) in rooms.into_iter().enumerate() {
                let page = mesh.page(p as u32);
                let triangles = coarse_triangles(page).into_iter();
                let indices = triangles.flat_map(|t| t.map(|v| place(page, p, slot, v)));
                let mut indices: Vec<u32> = indices.collect();
                if indices.len() > room {
                    indices.clear();
                }
                // Nobody wants them once the clay has other triangles.
                if send.send(indices).is_err() {
                    return;
                }
            }
        };
        // Without a thread every page is drawn as it is.
        let _ = std::thread::Builder::new().name("sculptd-coarse".into()).spawn(make);
        CoarsePages { buffer, ranges: Vec::new(), next: 0, pages: ranges.len(), made }
    }

    /// The indices of all pages.
    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Returns the number of pages that are not made and sent yet.
    pub fn waiting(&self) -> usize {
        self.pages - self.ranges.len()
    }

    /// The indices of a page; `None`: it is drawn as it is.
    pub fn range(&self, page: u32) -> Option<Range<u32>> {
        self.ranges.get(page as usize)?.clone()
    }

    /// Sends to the card what was made.
    pub fn advance(&mut self, queue: &wgpu::Queue) {
        let mut sent = 0;
        while sent < A_FRAME
            && let Ok(indices) = self.made.try_recv()
        {
            let end = self.next + indices.len() as u32;
            self.ranges.push((!indices.is_empty()).then_some(self.next..end));
            let bytes: &[u8] = bytemuck::cast_slice(&indices);
            queue.write_buffer(&self.buffer, u64::from(self.next) * size_of::<u32>() as u64, bytes);
            self.next = end;
            sent += bytes.len() as u64;
        }
    }
}

/// Returns true if a page is far: `matrix` maps the page's space to a screen of that height.
pub fn is_far(matrix: &Mat4, height: u32, page: &Page) -> bool {
    // Hiding works triangle by triangle.
    if page.sets().is_some() {
        return false;
    }
    let (lo, hi) = page.bounds();
    let across = (hi - lo).length();
    let size_in = |row: usize| matrix.row(row).truncate().length() * across;
    // Of its nearest part.
    let w = (*matrix * ((lo + hi) * 0.5).extend(1.0)).w - size_in(3);
    w > 0.0 && size_in(1) * 0.5 * height as f32 / w < FAR_PIXELS
}

/// The page's triangles with vertices near each other as one, but for its rim and its halo.
fn coarse_triangles(page: &Page) -> Vec<[u16; 3]> {
    let (own, triangles) = (page.own(), page.triangles());
    let mut edges: Vec<[u16; 2]> = Vec::with_capacity(triangles.len() * 3);
    for &[a, b, c] in triangles {
        edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
    }
    edges.sort_unstable();
    let mut rim = vec![false; own];
    for run in edges.chunk_by(|a, b| a == b).filter(|run| run.len() != 2) {
        for v in run[0].map(usize::from) {
            rim.get_mut(v).into_iter().for_each(|at| *at = true);
        }
    }
    let (lo, hi) = page.bounds();
    // A page is about as wide as it is long.
    let cells = (own as f32 / MERGED).sqrt().max(1.0);
    let cell = ((hi - lo).length() / std::f32::consts::SQRT_2 / cells).max(f32::MIN_POSITIVE);
    let key = |v: usize| -> [i32; 4] {
        let at = ((page.point(v) - lo) / cell).clamp(Vec3::ZERO, Vec3::splat(1e6)).as_ivec3();
        // Both sides of a thin wall stay two.
        let side = page.normal(v).cmpge(Vec3::ZERO).bitmask() as i32;
        [at.x, at.y, at.z, side]
    };
    let mut inner: Vec<([i32; 4], u16)> =
        (0..own).filter(|&v| !rim[v]).map(|v| (key(v), v as u16)).collect();
    inner.sort_unstable();
    let mut becomes: Vec<u16> = (0..own as u16).collect();
    for run in inner.chunk_by(|a, b| a.0 == b.0) {
        for (_, v) in run {
            becomes[usize::from(*v)] = run[run.len() / 2].1;
        }
    }
    let new = |v: u16| becomes.get(usize::from(v)).copied().unwrap_or(v);
    let kept = triangles.iter().map(|t| t.map(new));
    kept.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_clay::Clay;
    use sculptd_engine::camera::Camera;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;
    use std::collections::BTreeMap;

    /// Each edge of the whole, by places on the card, is there as often one way as the other.
    #[test]
    fn coarse_pages_beside_fine_ones_leave_no_crack() {
        let mut clay =
            Clay::build(&shapes::sphere_of_about(20_000), &Job::default()).expect("clay");
        let mesh = clay.snapshot();
        let slot = mesh.pages().map(|p| p.own()).max().expect("pages");
        for every in [1, 2, 3] {
            let (mut edges, mut count) = (BTreeMap::<(u32, u32), i32>::new(), 0);
            for (p, page) in mesh.pages().enumerate() {
                let fine = page.triangles().to_vec();
                let all = if p % every == 0 { coarse_triangles(page) } else { fine };
                count += all.len();
                for t in all {
                    let [a, b, c] = t.map(|v| place(page, p, slot, v));
                    for (from, to) in [(a, b), (b, c), (c, a)] {
                        *edges.entry((from, to)).or_default() += 1;
                        *edges.entry((to, from)).or_default() -= 1;
                    }
                }
            }
            assert!(edges.values().all(|n| *n == 0), "every {every}");
            assert!(every > 1 || count * 2 < mesh.triangle_count(), "{count} triangles");
        }
    }

    #[test]
    fn far_is_what_takes_few_pixels() {
        let mut clay = Clay::build(&shapes::sphere_of_about(2_000), &Job::default()).expect("clay");
        let mesh = clay.snapshot();
        let page = mesh.page(0);
        let camera = Camera::default();
        let screen = camera.view_projection(2.0);
        let sized = |scale: f32| screen * Mat4::from_scale(Vec3::splat(scale));
        assert!(!is_far(&sized(1.0), 900, page) && is_far(&sized(0.02), 900, page));
        let behind = Mat4::from_translation(camera.backward() * 1e3);
        assert!(!is_far(&(screen * behind), 900, page), "behind the eye");
    }
}
