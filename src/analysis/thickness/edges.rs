//! What vertices on sharp edges say.

use super::ray::{Caster, Site};
use super::{EdgePolicy, Method, Reason, Settings, Surface, Value};

/// Rings of neighbours that an edge vertex is extrapolated from at most.
const RINGS: usize = 3;

/// Applies the policy to the values marked [`Reason::Edge`].
pub(super) fn apply(caster: &Caster<'_>, surface: &Surface, settings: &Settings, values: &mut [Value]) {
    let marked: Vec<usize> = (0..values.len()).filter(|&v| values[v].reason == Reason::Edge).collect();
    match settings.edges {
        EdgePolicy::Raw => {}
        EdgePolicy::Neutral => marked.iter().for_each(|&v| values[v] = Value::missing(Reason::Edge)),
        EdgePolicy::Sphere if settings.method == Method::Sphere => {}
        EdgePolicy::Sphere => {
            for v in marked {
                let away = surface.normals[v] * caster.sign;
                let site = Site { point: surface.positions[v], away, own: surface.around(v) };
                if let Some(ball) = caster.ball(&site) {
                    values[v] = Value { value: ball.diameter, error: 0.0, reason: Reason::Edge };
                }
            }
        }
        EdgePolicy::Extrapolate => {
            let mut beside = Vec::new();
            let found: Vec<Value> = marked
                .iter()
                .map(|&v| {
                    from_neighbours(surface, values, v, &mut beside)
                        .or_else(|| under_faces(caster, surface, v))
                        .unwrap_or(values[v])
                })
                .collect();
            for (v, value) in marked.into_iter().zip(found) {
                values[v] = value;
            }
        }
    }
}

/// The median of the measured vertices in the first ring that has any.
fn from_neighbours(surface: &Surface, values: &[Value], v: usize, beside: &mut Vec<u32>) -> Option<Value> {
    let mut seen = vec![v as u32];
    let mut ring = vec![v as u32];
    for _ in 0..RINGS {
        let mut next = Vec::new();
        for &u in &ring {
            surface.neighbours(u as usize, beside);
            next.extend(beside.iter().copied().filter(|w| !seen.contains(w)));
        }
        next.sort_unstable();
        next.dedup();
        let mut known: Vec<(f32, f32)> = next
            .iter()
            .map(|&u| values[u as usize])
            .filter(|x| x.reason == Reason::Measured)
            .map(|x| (x.value, x.error))
            .collect();
        if !known.is_empty() {
            known.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (value, error) = known[known.len() / 2];
            return Some(Value { value, error, reason: Reason::Edge });
        }
        seen.extend(&next);
        ring = next;
    }
    None
}

/// The smallest of the walls under the faces around `v`, each measured along its own normal from a point one per cent of
/// the way into the face.
fn under_faces(caster: &Caster<'_>, surface: &Surface, v: usize) -> Option<Value> {
    let mut least = f32::INFINITY;
    for &t in surface.around(v) {
        let [a, b, c] = surface.corners(t as usize)?;
        let point = surface.positions[v].lerp((a + b + c) / 3.0, 0.01);
        let site =
            Site { point, away: surface.face_normals[t as usize] * caster.sign, own: surface.around(v) };
        let found = caster.hit(&site, -site.away).map(|h| h.t);
        least = least.min(found.unwrap_or(f32::INFINITY));
    }
    least.is_finite().then_some(Value { value: least, error: 0.0, reason: Reason::Edge })
}
