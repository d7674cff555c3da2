//! The colours of a mesh reduced to a few filaments, for printers that change filament.
//!
//! A triangle has the mean of its corners' colours, in linear light. Where the vertices have no
//! more colours than there are filaments, these are the filaments. Otherwise k-means by area in
//! Oklab (Ottosson, "A perceptual color space for image processing", 2020) finds them, from the
//! largest colour and then the ones farthest from all others. The same mesh gives the same result.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::PolyMesh;
use crate::portable::PortableMath;

/// The most filaments: slicers store the number of a filament in four bits beyond the second.
pub const MAX_FILAMENTS: usize = 16;
/// Rounds of k-means; it settles long before.
const ROUNDS: usize = 24;

/// The filament of each triangle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Filaments {
    /// The colours, sRGB, the one of the largest area first.
    pub colours: Vec<[u8; 3]>,
    /// An index into `colours` for each triangle of [`PolyMesh::triangles`].
    pub triangles: Vec<u8>,
}

/// A colour with the area that has it.
#[derive(Debug, Clone, Copy)]
struct ColourPatch {
    lab: DVec3,
    light: DVec3,
    area: f64,
}

impl Filaments {
    /// Reduces the colours of `mesh` to at most `count` filaments, at most [`MAX_FILAMENTS`].
    /// `None` for a mesh without colours or triangles.
    pub fn of(mesh: &PolyMesh, count: usize) -> Option<Filaments> {
        let colours = mesh.colours.as_ref()?;
        let count = count.clamp(1, MAX_FILAMENTS);
        let (triangles, _) = mesh.triangles();
        if triangles.is_empty() {
            return None;
        }
        let rgb = |v: u32| {
            let [r, g, b, _] = colours[v as usize];
            [r, g, b]
        };
        let mean = |t: &[u32; 3]| {
            let [a, b, c] = t.map(rgb);
            if a == b && b == c {
                return a;
            }
            from_light((light(a) + light(b) + light(c)) / 3.0)
        };
        let own: Vec<[u8; 3]> = triangles.iter().map(mean).collect();
        let mut areas: BTreeMap<[u8; 3], f64> = BTreeMap::new();
        for (t, colour) in triangles.iter().zip(&own) {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            *areas.entry(*colour).or_default() += (b - a).cross(c - a).length() * 0.5;
        }
        let patches: Vec<ColourPatch> = areas
            .iter()
            .map(|(c, &area)| ColourPatch { lab: oklab(light(*c)), light: light(*c), area })
            .collect();
        // Of vertices in use: others are no part of the surface.
        let mut exact: Vec<[u8; 3]> = Vec::new();
        for colour in triangles.iter().flatten().map(|&v| rgb(v)) {
            if exact.len() > count {
                break;
            }
            if !exact.contains(&colour) {
                exact.push(colour);
            }
        }
        let mut chosen = if exact.len() <= count { exact } else { by_means(&patches, count) };
        chosen.sort_unstable();
        chosen.dedup();
        // The largest first, those of no triangle left out.
        let labs: Vec<DVec3> = chosen.iter().map(|c| oklab(light(*c))).collect();
        let nearest_of: Vec<usize> = patches.iter().map(|p| nearest(&labs, p.lab)).collect();
        let mut used = vec![(0.0, false); chosen.len()];
        for (p, &k) in patches.iter().zip(&nearest_of) {
            used[k] = (used[k].0 + p.area, true);
        }
        let mut order: Vec<usize> = (0..chosen.len()).filter(|&k| used[k].1).collect();
        order.sort_by(|&a, &b| used[b].0.total_cmp(&used[a].0).then(a.cmp(&b)));
        let mut place = vec![0u8; chosen.len()];
        order.iter().enumerate().for_each(|(i, &k)| place[k] = i as u8);
        let of: BTreeMap<[u8; 3], u8> =
            areas.keys().zip(&nearest_of).map(|(c, &k)| (*c, place[k])).collect();
        Some(Filaments {
            colours: order.iter().map(|&k| chosen[k]).collect(),
            triangles: own.iter().map(|c| of[c]).collect(),
        })
    }
}

/// The index of the nearest colour; the first of equal ones.
fn nearest(labs: &[DVec3], to: DVec3) -> usize {
    let far = |i: &usize| labs[*i].distance_squared(to);
    (0..labs.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
}

fn by_means(patches: &[ColourPatch], count: usize) -> Vec<[u8; 3]> {
    let first = patches.iter().max_by(|a, b| a.area.total_cmp(&b.area));
    let mut centres: Vec<DVec3> = first.iter().map(|p| p.lab).collect();
    while centres.len() < count {
        // A colour of a small area is no filament because it is far from all others.
        let gain =
            |p: &ColourPatch| p.area * p.lab.distance_squared(centres[nearest(&centres, p.lab)]);
        let Some(next) = patches.iter().max_by(|a, b| gain(a).total_cmp(&gain(b))) else { break };
        if gain(next) <= 0.0 {
            break;
        }
        centres.push(next.lab);
    }
    let mut means = vec![DVec3::ZERO; centres.len()];
    for _ in 0..ROUNDS {
        let mut sums = vec![(DVec3::ZERO, DVec3::ZERO, 0.0); centres.len()];
        for p in patches {
            let sum = &mut sums[nearest(&centres, p.lab)];
            *sum = (sum.0 + p.lab * p.area, sum.1 + p.light * p.area, sum.2 + p.area);
        }
        let before = centres.clone();
        for ((centre, mean), (lab, light, area)) in centres.iter_mut().zip(&mut means).zip(sums) {
            if area > 0.0 {
                (*centre, *mean) = (lab / area, light / area);
            }
        }
        if centres == before {
            break;
        }
    }
    means.into_iter().map(from_light).collect()
}

/// sRGB as linear light (IEC 61966-2-1).
fn light(c: [u8; 3]) -> DVec3 {
    DVec3::from(c.map(|v| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).portable_powf(2.4) }
    }))
}

fn from_light(l: DVec3) -> [u8; 3] {
    l.to_array().map(|v| {
        let v = v.clamp(0.0, 1.0);
        let v =
            if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.portable_powf(1.0 / 2.4) - 0.055 };
        (v * 255.0).round() as u8
    })
}

fn oklab(l: DVec3) -> DVec3 {
    let cone = |r: f64, g: f64, b: f64| {
        let v = (r * l.x + g * l.y + b * l.z).max(0.0);
        if v > 0.0 { v.portable_powf(1.0 / 3.0) } else { 0.0 }
    };
    let (a, b, c) = (
        cone(0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9),
        cone(0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6),
        cone(0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5),
    );
    DVec3::new(
        0.210_454_255_3 * a + 0.793_617_785 * b - 0.004_072_046_8 * c,
        1.977_998_495_1 * a - 2.428_592_205 * b + 0.450_593_709_9 * c,
        0.025_904_037_1 * a + 0.782_771_766_2 * b - 0.808_675_766 * c,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::icosphere;

    fn ball(colour: impl Fn(DVec3) -> [u8; 3]) -> PolyMesh {
        let mut mesh = icosphere(10.0, 12).to_poly();
        let of = |p: &DVec3| {
            let [r, g, b] = colour(p.normalize());
            [r, g, b, 255]
        };
        mesh.colours = Some(mesh.positions.iter().map(of).collect());
        mesh
    }

    #[test]
    fn few_colours_stay_what_they_are() {
        let (red, blue) = ([200, 10, 20], [0, 40, 220]);
        let mesh = ball(|p| if p.z > 0.3 { red } else { blue });
        for count in [2, 3, 16] {
            let found = Filaments::of(&mesh, count).expect("colours");
            assert_eq!(found.colours, [blue, red], "the larger first");
            let (triangles, _) = mesh.triangles();
            for (t, k) in triangles.iter().zip(&found.triangles) {
                let reds = t.iter().filter(|&&v| mesh.positions[v as usize].z > 3.0).count();
                if reds % 3 == 0 {
                    assert_eq!(usize::from(*k), reds / 3);
                }
            }
        }
        assert_eq!(Filaments::of(&mesh, 1).expect("colours").colours.len(), 1);
        assert!(Filaments::of(&PolyMesh { colours: None, ..mesh }, 4).is_none());
    }

    #[test]
    fn many_colours_become_near_ones_and_more_filaments_come_nearer() {
        let mesh = ball(|p| ((p * 0.5 + 0.5) * 255.0).to_array().map(|v| v as u8));
        let colours = mesh.colours.clone().expect("colours");
        let (triangles, _) = mesh.triangles();
        let error = |count: usize| -> f64 {
            let found = Filaments::of(&mesh, count).expect("colours");
            assert_eq!((found.colours.len(), found.triangles.len()), (count, triangles.len()));
            let of = |v: u32| {
                let [r, g, b, _] = colours[v as usize];
                oklab(light([r, g, b]))
            };
            let each = triangles.iter().zip(&found.triangles).map(|(t, &k)| {
                let own = (of(t[0]) + of(t[1]) + of(t[2])) / 3.0;
                own.distance(oklab(light(found.colours[usize::from(k)])))
            });
            each.sum::<f64>() / triangles.len() as f64
        };
        let errors = [1, 2, 4, 8, 16].map(error);
        assert!(errors.windows(2).all(|w| w[1] < 0.9 * w[0]), "{errors:?}");
        assert!(errors[4] < 0.08, "{errors:?}");
        assert_eq!(Filaments::of(&mesh, 8), Filaments::of(&mesh, 8));
    }

    #[test]
    fn oklab_is_that_of_its_paper() {
        // White is lightness 1 without colour; red as its author's table has it.
        assert!((oklab(DVec3::ONE) - DVec3::X).length() < 1e-6);
        let red = oklab(light([255, 0, 0]));
        assert!((red - DVec3::new(0.627_955, 0.224_863, 0.125_846)).length() < 1e-5, "{red}");
        for c in [[0, 0, 0], [1, 2, 3], [128, 64, 200], [255; 3]] {
            assert_eq!(from_light(light(c)), c);
        }
    }
}
