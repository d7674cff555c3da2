//! What a brush may ask of the clay before it acts.

use std::sync::Arc;

use glam::{DVec3, Vec3, Vec4};

use super::alpha::Picture;
use super::dab::Dab;
use super::options::IMAGES;
use super::triples::Triples;
use super::weights::BLOCK;
use crate::brush::found_path::FoundPath;
use crate::brush::geodesic::{Geodesic, WalkedSurface};
use crate::brush::stroke_param::{StrokeParameters, StrokePlace};
use crate::{Clay, Page, Reach, Workers};
use sculptd_geometry::simd::wide::{Wide, WideWork, dispatch};

/// Memory kept from dab to dab.
#[derive(Debug, Default)]
pub struct Scratch {
    walks: Vec<Geodesic>,
    unrolls: Vec<StrokeParameters>,
    /// The alpha that was loaded.
    pub picture: Option<Arc<Picture>>,
    /// The stroke whose last dab of this image met nothing that turned away.
    pub(super) flat: [Option<u32>; IMAGES],
    /// The pages that a plane is found from, and what each adds to its sums.
    plane: (Vec<u32>, Vec<PageSums>),
}

impl Scratch {
    /// Returns true if the vertex is in the connected part of an image.
    pub fn is_marked(&self, image: usize, page: u32, v: usize) -> bool {
        self.walks.get(image).is_some_and(|w| w.distance(page, v).is_some())
    }

    /// The alpha that was loaded.
    pub fn picture(&self) -> Option<&Picture> {
        self.picture.as_deref()
    }

    /// The coordinates along the stroke of an image.
    pub fn unrolled(&self, image: usize) -> Option<&StrokeParameters> {
        self.unrolls.get(image)
    }

    /// The distances along the surface of an image.
    pub fn walk(&self, image: usize) -> Option<&Geodesic> {
        self.walks.get(image)
    }

    /// Returns the walk of an image, so that the caller can restart it.
    pub fn walk_mut(&mut self, image: usize) -> &mut Geodesic {
        let image = image.min(IMAGES - 1);
        while self.walks.len() <= image {
            self.walks.push(Geodesic::default());
        }
        &mut self.walks[image]
    }
}

/// Pages below which one thread finds a plane alone.
const PARALLEL: usize = 4;
/// Pages of a plane that are added up together: room for more is never asked for.
const AT_ONCE: usize = 64;
/// Sums kept apart while a page is added up.
const LANES: usize = 4;

/// The sums of one page for a mean plane, by lane: the weighted offsets from the centre, the
/// weighted normals, and the weights.
type PageSums = [[f64; LANES]; 7];

/// The clay before a dab.
#[derive(Debug)]
pub struct SurfaceQuery<'a> {
    /// The clay as it is.
    pub mesh: &'a Clay,
    /// The threads that help.
    pub workers: &'a Workers,
    /// Memory kept from dab to dab.
    pub scratch: &'a mut Scratch,
    /// The index of this image in its group of images that act together.
    pub image: usize,
}

/// A plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of it, mesh units.
    pub point: Vec3,
    /// Unit length.
    pub normal: Vec3,
    /// Vertices farther away than this are ignored.
    pub trim: f32,
}

impl Plane {
    /// Above the plane it is positive; 0 also for what is beyond the trim.
    #[inline(always)]
    pub fn height(&self, p: Vec3) -> f32 {
        let h = (p - self.point).dot(self.normal);
        if h.abs() > self.trim { 0.0 } else { h }
    }
}

/// Selects the vertices that count for a mean plane.
struct MeanPlane {
    centre: Vec3,
    /// Vertices that face away from this normal do not count.
    normal: Vec3,
    radius: f32,
}

/// Sums over a page's owned vertices, compiled for this processor.
struct AddPage<'a> {
    mean: &'a MeanPlane,
    page: &'a Page,
}

impl WideWork for AddPage<'_> {
    type Output = PageSums;
    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> PageSums {
        let AddPage { mean, page } = self;
        let radius2 = mean.radius * mean.radius;
        let own = page.own();
        let blocks = page.point_rows()[..own].chunks(BLOCK);
        // Of each quantity sums that do not wait for each other.
        let mut sums = [[0.0; LANES]; 7];
        for (rows, normals) in blocks.zip(page.normal_rows()[..own].chunks(BLOCK)) {
            let mut d = Triples::ZERO;
            d.fill(rows, mean.centre);
            let mut d2 = d.each(|d| d.length_squared());
            d2[rows.len()..].fill(f32::INFINITY);
            if d2.iter().map(|d2| u32::from(*d2 <= radius2)).sum::<u32>() == 0 {
                continue;
            }
            let n = Triples::of(normals);
            let facing = n.each(|n| n.dot(mean.normal));
            let mut weights = [0.0f32; BLOCK];
            for ((facing, d2), weight) in facing.into_iter().zip(d2).zip(&mut weights) {
                let near = (1.0 - d2 / radius2).max(0.0);
                *weight = if (d2 <= radius2) & (facing > 0.0) { near } else { 0.0 };
            }
            let [[x, y, z], [nx, ny, nz]] = [d.coordinates(), n.coordinates()];
            let (weights, _) = weights.as_chunks::<LANES>();
            for (k, values) in [x, y, z, nx, ny, nz].into_iter().enumerate() {
                for (values, weights) in values.as_chunks::<LANES>().0.iter().zip(weights) {
                    for lane in 0..LANES {
                        sums[k][lane] += f64::from(values[lane]) * f64::from(weights[lane]);
                    }
                }
            }
            for weights in weights {
                for lane in 0..LANES {
                    sums[6][lane] += f64::from(weights[lane]);
                }
            }
        }
        sums
    }
}

impl SurfaceQuery<'_> {
    /// Returns the plane through the surface under a dab: middle and mean normal of the vertices
    /// within `normal_radius`, moved by `offset` radii along its normal. Vertices near the rim
    /// count less, vertices that face away do not count. In double precision, so that images of one
    /// dab agree to the last bits.
    pub fn plane(&mut self, dab: &Dab<'_>, offset: f32) -> Plane {
        self.plane_of(dab, offset, dab.found)
    }

    /// The same through the surface as it was when the stroke began, wherever the dab is measured.
    pub fn plane_before(&mut self, dab: &Dab<'_>, offset: f32) -> Plane {
        self.plane_of(dab, offset, true)
    }

    fn plane_of(&mut self, dab: &Dab<'_>, offset: f32, before: bool) -> Plane {
        let radius = dab.radius * dab.settings.normal_radius;
        let mean = MeanPlane { centre: dab.centre, normal: dab.normal, radius };
        let reach = Reach::Sphere { centre: dab.centre, radius };
        let (mesh, workers) = (self.mesh, self.workers);
        let (pages, sums) = &mut self.scratch.plane;
        pages.clear();
        pages.reserve(AT_ONCE);
        sums.clear();
        sums.reserve(AT_ONCE);
        let mut all = [0.0; 7];
        let mut add = |pages: &mut Vec<u32>| {
            sums.clear();
            sums.resize(pages.len(), [[0.0; LANES]; 7]);
            // The threads are awake for the dab that follows, too.
            workers.each(pages.len() >= PARALLEL, pages, sums, |number, sums| {
                let page = if before { mesh.before(*number) } else { mesh.page(*number) };
                *sums = dispatch(false, AddPage { mean: &mean, page });
            });
            // In the order of the pages, whoever added them up.
            for page in sums.iter() {
                for (sum, lanes) in all.iter_mut().zip(page) {
                    lanes.iter().for_each(|lane| *sum += lane);
                }
            }
            pages.clear();
        };
        let mut visit = |number: u32| {
            pages.push(number);
            if pages.len() == AT_ONCE {
                add(pages);
            }
        };
        if before {
            mesh.each_page_before(&reach, |number, _| visit(number));
        } else {
            mesh.each_page(&reach, |number, _| visit(number));
        }
        add(pages);
        let [x, y, z, nx, ny, nz, sum] = all;
        let normal = DVec3::new(nx, ny, nz).as_vec3().try_normalize().unwrap_or(dab.normal);
        let point = DVec3::new(x, y, z);
        let point = if sum > 0.0 { dab.centre + (point / sum).as_vec3() } else { dab.centre };
        let trim = dab.settings.plane_trim;
        let trim = if trim > 0.0 { trim * dab.radius } else { f32::INFINITY };
        Plane { point: point + normal * (offset * dab.radius), normal, trim }
    }

    /// Marks what hangs together with the dab's centre within its radius.
    pub fn mark_connected(&mut self, dab: &Dab<'_>) {
        let image = self.image;
        self.scratch.walk_mut(image).flood(self.mesh, dab.centre, dab.normal, dab.radius);
    }

    /// Returns true if the surface within a dab turns away from it by more than a right angle. The
    /// straight-line distance then misrepresents the distance along the surface: the surface folds,
    /// or belongs to something else nearby.
    pub fn is_folded(&self, dab: &Dab<'_>) -> bool {
        folded(self.mesh, dab)
    }

    /// Measures each vertex's distance from the dab's centre along the current surface, by Dijkstra
    /// over the edges, up to the radius.
    pub fn measure(&mut self, dab: &Dab<'_>) {
        let image = self.image;
        let from = (dab.centre, dab.normal);
        self.scratch.walk_mut(image).measure(self.mesh, from, dab.radius, WalkedSurface::Now);
    }

    /// Measures along the surface, as it was when the stroke began, how far each vertex is from the
    /// dab's centre: by Dijkstra over the edges, no further than the radius.
    pub fn measure_before(&mut self, dab: &Dab<'_>) {
        let image = self.image;
        let from = (dab.centre, dab.normal);
        self.scratch.walk_mut(image).measure(self.mesh, from, dab.radius, WalkedSurface::Before);
    }

    /// Measures along the surface, as it was when the stroke began, how far each vertex is from the
    /// border of the surface near the dab, no further than the radius; its place is how far that
    /// border is along the border from the point of it that is nearest to the dab.
    pub fn measure_from_border(&mut self, dab: &Dab<'_>) {
        let image = self.image;
        self.scratch.walk_mut(image).measure_from_border(self.mesh, dab.centre, dab.radius);
    }

    /// Carries the stroke's own coordinates on to this dab. Answers which samples are new: the
    /// number of the newest, or 0.
    pub fn unroll(&mut self, dab: &Dab<'_>) -> u32 {
        let all = &mut self.scratch.unrolls;
        let image = self.image.min(IMAGES - 1);
        while all.len() <= image {
            all.push(StrokeParameters::default());
        }
        let one = &mut all[image];
        // A vertex that is a radius off the axis, halfway between two dabs, is farther from both.
        let radius = dab.radius * 1.05;
        if !dab.found {
            let place = StrokePlace::Now(dab.centre, dab.normal);
            return if one.step(self.mesh, dab.stroke, place, radius) { one.count() } else { 0 };
        }
        let path = FoundPath { mesh: self.mesh, dab };
        if path.follow(one, radius) { one.count() } else { 0 }
    }
}

/// See [`SurfaceQuery::is_folded`].
pub(super) fn folded(mesh: &Clay, dab: &Dab<'_>) -> bool {
    let mut any = false;
    mesh.each_page(&Reach::Sphere { centre: dab.centre, radius: dab.radius }, |_, page| {
        any = any || dispatch(false, FoldedPage { dab, page });
    });
    any
}

/// Finds an owned vertex of a page that is within a dab and faces away, compiled for this
/// processor.
struct FoldedPage<'a> {
    dab: &'a Dab<'a>,
    page: &'a Page,
}

impl WideWork for FoldedPage<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> bool {
        let (Dab { centre, normal, .. }, own) = (*self.dab, self.page.own());
        let radius2 = self.dab.radius * self.dab.radius;
        let rows = self.page.point_rows()[..own].chunks(BLOCK);
        rows.zip(self.page.normal_rows()[..own].chunks(BLOCK)).any(|(rows, normals)| {
            let near = |p: &Vec4| (p.truncate() - centre).length_squared() < radius2;
            let both = |(p, n): (&Vec4, &Vec4)| near(p) & (n.truncate().dot(normal) < 0.0);
            rows.iter().map(|p| u32::from(near(p))).sum::<u32>() > 0
                && rows.iter().zip(normals).map(|pair| u32::from(both(pair))).sum::<u32>() > 0
        })
    }
}
