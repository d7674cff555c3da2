//! Sizes of the newest clay, off to the side: the distance of each vertex to another form, measures
//! and shadows.

use std::sync::Arc;

use crossbeam_channel as cc;
use glam::{DVec3, Vec3};

use super::pages::MapValues;
use super::work::Done;
use crate::panels::measure::{Distances, Measured};
use sculptd_clay::Snapshot;
use sculptd_engine::hand::{HeldObject, Similarity};
use sculptd_geometry::distance::{DistanceSolid, Topology};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::measure::{measures, projected_area};
use sculptd_geometry::projection::{ProjectionPlane, area, outline};

/// What distances are measured to.
#[derive(Debug, Clone)]
pub enum Reference {
    Before(Snapshot),
    HeldObject(HeldObject),
}

impl Reference {
    /// The same form, wherever it is.
    fn same(&self, other: &Reference) -> bool {
        match (self, other) {
            (Reference::Before(a), Reference::Before(b)) => a.revision() == b.revision(),
            (Reference::HeldObject(a), Reference::HeldObject(b)) => Arc::ptr_eq(&a.plain, &b.plain),
            _ => false,
        }
    }

    fn place(&self) -> Similarity {
        match self {
            Reference::Before(_) => Similarity::NONE,
            Reference::HeldObject(thing) => thing.place,
        }
    }
}

#[derive(Debug, Clone)]
pub struct Wanted {
    pub mesh: Snapshot,
    pub to: Reference,
}

/// Pages between two pictures of the map.
const BATCH: usize = 64;

/// The distance map as far as it is known.
#[derive(Debug, Default)]
pub struct Field {
    to: Option<(Reference, DistanceSolid)>,
    place: Option<Similarity>,
    mesh: Option<Snapshot>,
    /// One a page; `None`: not known.
    pages: Vec<Option<Arc<[f32]>>>,
}

impl Field {
    /// Brings the map up to what is wanted, a batch at a time; `false` when nobody listens any
    /// more.
    pub fn follow(&mut self, wanted: Wanted, job: &Job, say: &cc::Sender<Done>) -> bool {
        self.bring(wanted, job, say).unwrap_or(true)
    }

    fn bring(
        &mut self,
        wanted: Wanted,
        job: &Job,
        say: &cc::Sender<Done>,
    ) -> Result<bool, Cancelled> {
        let Wanted { mesh, to } = wanted;
        if !self.to.as_ref().is_some_and(|(old, _)| old.same(&to)) {
            self.pages.clear();
            let plain = match &to {
                Reference::Before(before) => Arc::new(before.to_tri()),
                Reference::HeldObject(thing) => thing.plain.clone(),
            };
            let solid = DistanceSolid::build(&plain, job)?;
            self.to = Some((to.clone(), solid));
        }
        let place = to.place();
        if self.place != Some(place) {
            self.pages.clear();
            self.place = Some(place);
        }
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
        let own = |p: Vec3| (back * (p - place.shift) / place.scale).as_dvec3();
        let missing: Vec<u32> =
            (0..mesh.page_count() as u32).filter(|&i| self.pages[i as usize].is_none()).collect();
        for batch in missing.chunks(BATCH) {
            for &i in batch {
                let page = mesh.page(i);
                let points: Vec<DVec3> = (0..page.own()).map(|v| own(page.point(v))).collect();
                let found = solid.signed_distances(&points, job)?;
                let values = found.iter().map(|d| (*d * f64::from(place.scale)) as f32).collect();
                self.pages[i as usize] = Some(values);
            }
            if say.send(self.said(&mesh)).is_err() {
                return Ok(false);
            }
        }
        Ok(!missing.is_empty() || say.send(self.said(&mesh)).is_ok())
    }

    fn said(&self, mesh: &Snapshot) -> Done {
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
        let about = Distances {
            min: if known > 0 { min } else { 0.0 },
            max: if known > 0 { max } else { 0.0 },
            rms: (squares / known.max(1) as f64).sqrt() as f32,
            known: (known, mesh.vertex_count()),
        };
        Done::Distances(MapValues { pages }, about)
    }
}

/// Measures of the work and its shadow along a direction.
pub fn measure(mesh: &Snapshot, direction: DVec3, job: &Job) -> Result<Measured, Cancelled> {
    let plain = mesh.to_tri();
    job.check()?;
    let found = measures(&plain);
    let mut projected = [0.0; 3];
    for (out, axis) in projected.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        *out = projected_area(&plain, axis, job)?;
    }
    let outline = match ProjectionPlane::along(direction, 0.0) {
        Some(plane) => outline(&Topology::build(&plain), &plane),
        None => Vec::new(),
    };
    Ok(Measured {
        revision: mesh.revision(),
        volume: found.volume,
        area: found.area,
        dimensions: found.dimensions,
        projected,
        direction,
        shadow: area(&outline),
        outline,
    })
}
