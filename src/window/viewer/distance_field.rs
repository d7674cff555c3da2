//! Sizes of the newest clay, off to the side: the distance of each vertex to another form, measures
//! and shadows.

use std::sync::Arc;

use crossbeam_channel as cc;
use glam::{DVec3, Vec3};

use super::distance_reference::DistanceReference;
use super::pages::MapValues;
use super::tasks::TaskReport;
use crate::panels::state::{DistanceSummary, Measured};
use sculptd_clay::Snapshot;
use sculptd_engine::hand::Similarity;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::distance::{DistanceSolid, Topology};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::measure::{measures, projected_area};
use sculptd_geometry::projection::{ProjectionPlane, area, outline};

#[derive(Debug, Clone)]
pub struct DistanceRequest {
    pub mesh: Snapshot,
    /// Transform from the clay to the world, in whose unit distances are given.
    pub transform: ObjectTransform,
    pub to: DistanceReference,
}

/// Pages between two pictures of the map.
const BATCH: usize = 64;

/// The distance map as far as it is known.
#[derive(Debug, Default)]
pub struct DistanceField {
    to: Option<(DistanceReference, DistanceSolid)>,
    place: Option<(Similarity, ObjectTransform)>,
    mesh: Option<Snapshot>,
    /// One a page; `None`: not known.
    pages: Vec<Option<Arc<[f32]>>>,
}

impl DistanceField {
    /// Brings the map up to what is wanted, a batch at a time; `false` when nobody listens any
    /// more.
    pub fn follow(
        &mut self,
        request: DistanceRequest,
        job: &Job,
        say: &cc::Sender<TaskReport>,
    ) -> bool {
        self.bring(request, job, say).unwrap_or(true)
    }

    fn bring(
        &mut self,
        request: DistanceRequest,
        job: &Job,
        say: &cc::Sender<TaskReport>,
    ) -> Result<bool, Cancelled> {
        let DistanceRequest { mesh, transform, to } = request;
        if !self.to.as_ref().is_some_and(|(old, _)| old.same(&to)) {
            self.pages.clear();
            let plain = to.in_own_frame();
            let solid = DistanceSolid::build(&plain, job)?;
            self.to = Some((to.clone(), solid));
        }
        let place = to.place();
        if self.place != Some((place, transform)) {
            self.pages.clear();
            self.place = Some((place, transform));
        }
        // The earlier object is in the clay's frame, a held object and a goal in the world.
        let (stand, unit) = match to {
            DistanceReference::Before(_) => (ObjectTransform::NONE, transform.scale),
            DistanceReference::HeldObject(_) | DistanceReference::Goal(_) => {
                (transform, f64::from(place.scale))
            }
        };
        match &self.mesh {
            Some(old) if self.pages.len() == mesh.page_count() => {
                let pages = &mut self.pages;
                mesh.each_changed(old, |i, _| pages[i as usize] = None);
            }
            _ => self.pages = vec![None; mesh.page_count()],
        }
        self.mesh = Some(mesh.clone());
        let Some((_, solid)) = &self.to else { return Ok(true) };
        let back = place.turn.inverse();
        let own = |p: Vec3| (back * (stand.point(p) - place.shift) / place.scale).as_dvec3();
        let missing: Vec<u32> =
            (0..mesh.page_count() as u32).filter(|&i| self.pages[i as usize].is_none()).collect();
        for batch in missing.chunks(BATCH) {
            for &i in batch {
                let page = mesh.page(i);
                let points: Vec<DVec3> = (0..page.own()).map(|v| own(page.point(v))).collect();
                let found = solid.signed_distances(&points, job)?;
                let values = found.iter().map(|d| (*d * unit) as f32).collect();
                self.pages[i as usize] = Some(values);
            }
            if say.send(self.said(&mesh)).is_err() {
                return Ok(false);
            }
        }
        Ok(!missing.is_empty() || say.send(self.said(&mesh)).is_ok())
    }

    fn said(&self, mesh: &Snapshot) -> TaskReport {
        let unknown = |i: usize| -> Arc<[f32]> { vec![f32::NAN; mesh.page(i as u32).own()].into() };
        let pages: Vec<Arc<[f32]>> = self
            .pages
            .iter()
            .enumerate()
            .map(|(i, p)| p.clone().unwrap_or_else(|| unknown(i)))
            .collect();
        let (mut min, mut max, mut squares, mut known) =
            (f32::INFINITY, f32::NEG_INFINITY, 0.0f64, 0usize);
        for &d in self.pages.iter().flatten().flat_map(|p| p.iter()).filter(|d| d.is_finite()) {
            (min, max) = (min.min(d), max.max(d));
            squares += f64::from(d) * f64::from(d);
            known += 1;
        }
        let about = DistanceSummary {
            min: if known > 0 { min } else { 0.0 },
            max: if known > 0 { max } else { 0.0 },
            rms: (squares / known.max(1) as f64).sqrt() as f32,
            known: (known, mesh.vertex_count()),
        };
        TaskReport::Distances(MapValues { pages }, about)
    }
}

/// Request for measures: the clay, its transform, and the direction of the shadow.
pub type SizesRequest = (Snapshot, ObjectTransform, DVec3);

/// Measures of the object and its shadow along a direction, in the world's unit.
pub fn measure(request: &SizesRequest, job: &Job) -> Result<Measured, Cancelled> {
    let (mesh, transform, direction) = request;
    let mut plain = mesh.to_tri();
    // No measure depends on the place, and far from the origin single precision would lose digits:
    // the mesh is turned where it is, and the numbers are scaled.
    let turned = ObjectTransform { turn: transform.turn, ..ObjectTransform::NONE };
    if !turned.is_none() {
        plain.positions.iter_mut().for_each(|p| *p = turned.point(*p));
    }
    let unit = transform.scale;
    let direction = *direction;
    job.check()?;
    let found = measures(&plain);
    let mut projected = [0.0; 3];
    for (out, axis) in projected.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        *out = projected_area(&plain, axis, job)?;
    }
    let mut outline = match ProjectionPlane::along(direction, 0.0) {
        Some(plane) => outline(&Topology::build(&plain), &plane),
        None => Vec::new(),
    };
    for region in &mut outline {
        let rings = std::iter::once(&mut region.outer).chain(&mut region.holes);
        rings.flatten().for_each(|p| *p *= unit);
    }
    Ok(Measured {
        revision: mesh.revision(),
        volume: found.volume * unit.powi(3),
        area: found.area * unit.powi(2),
        dimensions: found.dimensions.map(|d| d * unit),
        projected: projected.map(|a| a * unit.powi(2)),
        direction,
        shadow: area(&outline),
        outline,
    })
}
