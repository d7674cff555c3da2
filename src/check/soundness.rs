//! Whether a mesh is one solid: closed, outwards, without crossings, without shells that count
//! twice, without slivers. Every question is put to `sculptd_geometry`.

use std::borrow::Cow;

use glam::DVec3;
use sculptd_geometry::boolean::solve;
use sculptd_geometry::check::{MeshReport, report};
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::edges::EdgeTable;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::repair::{flip, orient_shells};
use sculptd_geometry::{PolyMesh, self_intersection};

use crate::finding::{Finding, FindingKind};
use crate::part::PreparedPart;

/// The distance from a face at which the winding number is looked at, as a share of the size.
const BESIDE: f64 = 1e-5;

/// The outcome of the checks of the mesh itself.
#[derive(Debug)]
pub struct Soundness<'a> {
    /// The findings, in millimetres.
    pub findings: Vec<Finding>,
    /// Sentences on what was done to go on.
    pub warnings: Vec<String>,
    /// The facts of the file.
    pub facts: MeshReport,
    /// The solid that all other checks look at: turned outwards, and united where it crosses
    /// itself. The reason why there is none.
    pub solid: Result<Cow<'a, PolyMesh>, String>,
}

/// Looks at a mesh of `scale` millimetres a unit.
pub fn soundness<'a>(
    mesh: &'a PolyMesh,
    scale: f64,
    sliver: Option<f64>,
    job: &Job,
) -> Result<Soundness<'a>, Cancelled> {
    let mut findings = Vec::new();
    let mut warnings = Vec::new();
    let facts = report(mesh, false, job)?;
    let done = |findings, warnings, facts, why: &str| {
        Ok(Soundness { findings, warnings, facts, solid: Err(why.into()) })
    };
    if mesh.corners.iter().any(|&c| !mesh.positions[c as usize].is_finite()) {
        let what = Finding::new(
            FindingKind::Open,
            "a corner is not at a finite place; export the part again".to_string(),
        );
        findings.push(what);
        return done(findings, warnings, facts, "a corner of the mesh is not at a finite place");
    }
    if facts.faces == 0 {
        return done(findings, warnings, facts, "the mesh has no faces");
    }
    let (mut triangles, _) = mesh.triangles();
    if let Some(limit) = sliver {
        findings.extend(slivers(mesh, &triangles, scale, limit));
    }
    let broken = facts.boundary_edges + facts.nonmanifold_edges;
    if broken > 0 {
        let place = bad_edge(mesh, |n| n != 2).unwrap_or(facts.bounds.centre()) * scale;
        let message = format!(
            "the surface is not closed: {} edges have one face and {} have more than two; close \
             the holes with sculptd convert --mend, or remesh",
            facts.boundary_edges, facts.nonmanifold_edges
        );
        let open = Finding::new(FindingKind::Open, message);
        findings.push(open.at(place).measured(broken as f64, 0.0, "edges"));
    }
    let mut solid = Cow::Borrowed(mesh);
    if facts.misoriented_edges > 0 {
        let turned = orient_shells(solid.to_mut()).turned;
        (triangles, _) = solid.triangles();
        let place = misoriented(mesh).unwrap_or(facts.bounds.centre()) * scale;
        let message = format!(
            "the faces disagree on the outside at {} edges; turn them with sculptd convert --mend",
            facts.misoriented_edges
        );
        let wrong = Finding::new(FindingKind::Orientation, message).at(place);
        findings.push(wrong.measured(facts.misoriented_edges as f64, 0.0, "edges"));
        warnings.push(format!("{turned} faces were turned outwards for the other checks"));
    }
    if broken > 0 && !balanced(&solid) {
        return done(findings, warnings, facts, "the surface is not closed");
    }
    let volume = signed_volume(&solid, &triangles);
    if volume < 0.0 {
        if facts.misoriented_edges == 0 {
            let message = "the part is inside out; turn its faces with sculptd convert --mend";
            let wrong = Finding::new(FindingKind::Orientation, message);
            let value = volume * scale.powi(3);
            findings.push(wrong.at(facts.bounds.centre() * scale).measured(value, 0.0, "mm3"));
            warnings.push("the faces were turned outwards for the other checks".into());
        }
        flip(solid.to_mut());
        (triangles, _) = solid.triangles();
    }
    job.check()?;
    let crossed = self_intersection::pairs(&solid.positions, &triangles, job)?;
    if let Some(&(first, _)) = crossed.first() {
        let place = middle(&solid, &triangles[first as usize]) * scale;
        let message = format!(
            "{} pairs of triangles cross; unite the part with sculptd boolean union --solve \
             winding",
            crossed.len()
        );
        let found = Finding::new(FindingKind::SelfIntersection, message).at(place);
        findings.push(found.measured(crossed.len() as f64, 0.0, "pairs"));
    }
    let nested = if facts.components > 1 {
        nested_shells(&solid, scale, &crossed, job)?
    } else {
        Vec::new()
    };
    let doubled = nested.iter().any(|f| f.kind == FindingKind::NestedShell);
    findings.extend(nested);
    if !crossed.is_empty() || doubled {
        match solve(&solid, job) {
            Ok(united) => {
                warnings.push("the part was united for the other checks".into());
                solid = Cow::Owned(united);
            }
            Err(e) => {
                job.check()?;
                let why = format!("the part crosses itself, and its union failed ({e})");
                return done(findings, warnings, facts, &why);
            }
        }
    }
    Ok(Soundness { findings, warnings, facts, solid: Ok(solid) })
}

fn middle(mesh: &PolyMesh, t: &[u32; 3]) -> DVec3 {
    t.iter().map(|&v| mesh.positions[v as usize]).sum::<DVec3>() / 3.0
}

fn signed_volume(mesh: &PolyMesh, triangles: &[[u32; 3]]) -> f64 {
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let six: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize] - origin);
            a.dot(b.cross(c))
        })
        .sum();
    six / 6.0
}

/// The middle of the first edge whose number of faces `is_bad`.
fn bad_edge(mesh: &PolyMesh, is_bad: impl Fn(usize) -> bool) -> Option<DVec3> {
    let table = EdgeTable::of(mesh);
    let (a, b) = table.each().find(|e| is_bad(e.len()))?[0].ends;
    Some((mesh.positions[a as usize] + mesh.positions[b as usize]) * 0.5)
}

/// The middle of the first edge along which both faces run in the same direction.
fn misoriented(mesh: &PolyMesh) -> Option<DVec3> {
    let table = EdgeTable::of(mesh);
    let same = |e: &&[sculptd_geometry::edges::HalfEdge]| {
        e.len() == 2 && mesh.corners[e[0].corner as usize] == mesh.corners[e[1].corner as usize]
    };
    let (a, b) = table.each().find(same)?[0].ends;
    Some((mesh.positions[a as usize] + mesh.positions[b as usize]) * 0.5)
}

/// Returns true if each edge is passed as often one way as the other: a solid, although some of its
/// edges have four faces.
fn balanced(mesh: &PolyMesh) -> bool {
    let table = EdgeTable::of(mesh);
    table.each().all(|e| {
        let forward = e.iter().filter(|h| mesh.corners[h.corner as usize] == h.ends.0).count();
        forward * 2 == e.len()
    })
}

/// Triangles whose height is below `limit` times their longest side, as one warning at the
/// narrowest.
fn slivers(mesh: &PolyMesh, triangles: &[[u32; 3]], scale: f64, limit: f64) -> Option<Finding> {
    let ratio = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let area = (b - a).cross(c - a).length();
        if longest > 0.0 { area / (longest * longest) } else { 0.0 }
    };
    let (mut count, mut worst) = (0usize, (f64::INFINITY, 0));
    for (i, t) in triangles.iter().enumerate() {
        let r = ratio(t);
        if r < limit {
            count += 1;
            if r < worst.0 {
                worst = (r, i);
            }
        }
    }
    let place = middle(mesh, triangles.get(worst.1)?) * scale;
    (count > 0).then(|| {
        let message = format!(
            "{count} triangles are nearly lines; remove them with sculptd convert --mend or remesh"
        );
        let found = Finding::new(FindingKind::Sliver, message).at(place);
        found.measured(worst.0, limit, "height over length").warning()
    })
}

/// Shells that face the same way as one around them, and shells that look inwards without one
/// around them.
fn nested_shells(
    mesh: &PolyMesh,
    scale: f64,
    crossed: &[(u32, u32)],
    job: &Job,
) -> Result<Vec<Finding>, Cancelled> {
    let part = PreparedPart::new(mesh, scale, job)?;
    let count = part.triangles();
    let mut sets = DisjointSets::new(count);
    for t in 0..count as u32 {
        for k in 0..3 {
            if let Some(u) = part.across(t, k) {
                sets.join(t, u);
            }
        }
    }
    let mut volume = vec![0.0; count];
    let mut largest = vec![u32::MAX; count];
    let mut crosses = vec![false; count];
    for t in 0..count as u32 {
        let Some([a, b, c]) = part.corners(t) else { continue };
        let root = sets.root(t) as usize;
        volume[root] += a.dot(b.cross(c)) / 6.0;
        let best = largest[root];
        if best == u32::MAX || part.areas[t as usize] > part.areas[best as usize] {
            largest[root] = t;
        }
    }
    for &(s, t) in crossed {
        crosses[sets.root(s) as usize] = true;
        crosses[sets.root(t) as usize] = true;
    }
    let size = DVec3::from(part.sizes.dimensions).length();
    let mut out = Vec::new();
    for root in (0..count).filter(|&r| largest[r] != u32::MAX && !crosses[r]) {
        let t = largest[root];
        let outside = part.middle(t) + part.normals[t as usize] * (size * BESIDE);
        let turns = part.solid.winding(outside);
        let place = part.to_file(part.middle(t));
        let own = volume[root];
        if own > 0.0 && turns > 0.5 {
            let message = "a shell is inside another and faces the same way, so that their \
                           common matter counts twice; delete it, or turn it to make a cavity";
            let found = Finding::new(FindingKind::NestedShell, message).at(place);
            out.push(found.measured(own, 0.0, "mm3"));
        } else if own < 0.0 && turns < -0.5 {
            let message = "a shell looks inwards and no other is around it; turn its faces with \
                           sculptd convert --mend";
            let found = Finding::new(FindingKind::Orientation, message).at(place);
            out.push(found.measured(own, 0.0, "mm3"));
        }
    }
    Ok(out)
}
