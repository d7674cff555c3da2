//! What vertices on sharp edges say.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::least::Solid;
use super::ray::{Caster, Site};
use super::walls::OwnWalls;
use super::{
    EdgePolicy, Opposite, Reason, SiteValue, ThicknessMethod, ThicknessSettings, WeldedSurface,
};
use crate::job::{Cancelled, Job};

/// The sides of a wedge of 40 degrees or more meet within 1.2 times its thickness; the way along
/// the mesh is longer.
const REACH: f32 = 1.5;

/// Applies the policy to the values marked [`Reason::Edge`].
pub(super) fn apply(
    caster: &Caster<'_>,
    solid: &Solid<'_>,
    surface: &WeldedSurface,
    own: &OwnWalls<'_>,
    settings: &ThicknessSettings,
    values: &mut [SiteValue],
    job: &Job,
) -> Result<(), Cancelled> {
    mark(solid, surface, values);
    let marked: Vec<usize> =
        (0..values.len()).filter(|&v| values[v].reason == Reason::Edge).collect();
    match settings.edges {
        EdgePolicy::Raw => {}
        EdgePolicy::Neutral => {
            marked.iter().for_each(|&v| values[v] = SiteValue::missing(Reason::Edge))
        }
        EdgePolicy::Sphere if settings.method == ThicknessMethod::Sphere => {}
        EdgePolicy::Sphere => {
            for v in marked {
                job.check()?;
                let away = surface.normals[v] * caster.sign;
                let (point, clear) = (surface.positions[v], own.clear(v));
                let along = surface.along(v);
                let site = Site { point, away, along, own: own.at(v), clear };
                if let Some(ball) = caster.ball(&site) {
                    values[v] = SiteValue {
                        value: ball.diameter,
                        error: 0.0,
                        reason: Reason::Edge,
                        opposite: Opposite::Parallel,
                    };
                }
            }
        }
        EdgePolicy::Extrapolate => {
            let mut alone = marked;
            spread(surface, values, &mut alone);
            for v in alone {
                job.check()?;
                if let Some(value) = under_faces(caster, surface, own, v) {
                    values[v] = value;
                }
            }
        }
    }
    Ok(())
}

/// Marks values that measure an edge and not a wall: the opposite side is one of an edge
/// ([`Solid::is_edge`]), and a sharp vertex is as near (along the mesh's edges) as the edge of a
/// wedge must be, within 1.5 times the value.
fn mark(solid: &Solid<'_>, surface: &WeldedSurface, values: &mut [SiteValue]) {
    let turned = |v: &SiteValue| v.opposite != Opposite::Parallel && v.reason == Reason::Measured;
    if !values.iter().any(turned) {
        return;
    }
    let longest = values
        .iter()
        .filter(|v| turned(v) && v.value.is_finite())
        .map(|v| v.value)
        .fold(0.0f32, f32::max);
    let mut far = vec![f32::INFINITY; values.len()];
    // Distances are not negative, so their bits are ordered as they are.
    let mut heap = BinaryHeap::new();
    for v in (0..values.len()).filter(|&v| surface.sharp[v]) {
        far[v] = 0.0;
        heap.push(Reverse((0u32, v as u32)));
    }
    let mut beside = Vec::new();
    while let Some(Reverse((bits, v))) = heap.pop() {
        let d = f32::from_bits(bits);
        if d > far[v as usize] || d > REACH * longest {
            continue;
        }
        surface.neighbours(v as usize, &mut beside);
        for &u in &beside {
            let next = d + surface.positions[u as usize].distance(surface.positions[v as usize]);
            if next < far[u as usize] {
                far[u as usize] = next;
                heap.push(Reverse((next.to_bits(), u)));
            }
        }
    }
    for (v, (value, far)) in values.iter_mut().zip(far).enumerate() {
        if turned(value) && far <= REACH * value.value && solid.of_edge(surface, v, value.opposite)
        {
            value.reason = Reason::Edge;
        }
    }
}

/// Each marked vertex takes the median of its neighbours that are measured or took theirs in an
/// earlier round.
fn spread(surface: &WeldedSurface, values: &mut [SiteValue], marked: &mut Vec<usize>) {
    let mut known: Vec<bool> = values.iter().map(|v| v.reason == Reason::Measured).collect();
    let (mut beside, mut near) = (Vec::new(), Vec::new());
    while !marked.is_empty() {
        let mut found = Vec::new();
        marked.retain(|&v| {
            surface.neighbours(v, &mut beside);
            near.clear();
            near.extend(beside.iter().filter(|&&u| known[u as usize]).map(|&u| {
                let value = values[u as usize];
                (value.value, value.error)
            }));
            if near.is_empty() {
                return true;
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (value, error) = near[near.len() / 2];
            found.push((v, value, error));
            false
        });
        if found.is_empty() {
            return;
        }
        for (v, value, error) in found {
            values[v] = SiteValue { value, error, ..values[v] };
            known[v] = true;
        }
    }
}

/// Returns the smallest of the walls under the faces around `v`, each measured along the face's
/// normal from a point one per cent of the way into the face.
fn under_faces(
    caster: &Caster<'_>,
    surface: &WeldedSurface,
    own: &OwnWalls<'_>,
    v: usize,
) -> Option<SiteValue> {
    let mut least = f32::INFINITY;
    for &t in surface.around(v) {
        let [a, b, c] = surface.corners(t as usize)?;
        let point = surface.positions[v].lerp((a + b + c) / 3.0, 0.01);
        let site = Site {
            point,
            away: surface.face_normals[t as usize] * caster.sign,
            along: b - a,
            own: own.at(v),
            clear: f32::INFINITY,
        };
        let found = caster.hit(&site, -site.away).map(|h| h.t);
        least = least.min(found.unwrap_or(f32::INFINITY));
    }
    least.is_finite().then_some(SiteValue {
        value: least,
        error: 0.0,
        reason: Reason::Edge,
        opposite: Opposite::Parallel,
    })
}
