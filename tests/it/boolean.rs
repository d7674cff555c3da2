//! Booleans: the scenes of touching and coplanar faces, as they stand and turned by an arbitrary
//! angle.

mod live;
mod local;
mod oracle;
mod pairs;
mod random;
mod scenes;
mod socket;
mod solids;
mod truth;

use glam::{DMat3, DVec3};
use scenes::{Scene, scenes, turn};
use sculptd_geometry::boolean::{
    BooleanOptions, BooleanReport, BooleanSolid as Made, Operation, compute,
};
use sculptd_geometry::check;
use sculptd_geometry::job::Job;
use solids::Solid;

fn all(
    a: &Solid,
    b: &Solid,
    options: &BooleanOptions,
) -> Result<(Vec<Made>, BooleanReport), String> {
    compute([&a.mesh, &b.mesh], &Operation::ALL, options, &Job::default(), || 0.0)
        .map_err(|e| e.to_string())
}

/// Everything that is wrong with a scene's results.
fn faults(s: &Scene, want: &[(f64, f64); 4], placement: &str) -> Vec<String> {
    let mut out = Vec::new();
    let (made, report) = match all(&s.a, &s.b, &BooleanOptions::default()) {
        Ok(x) => x,
        Err(e) => return vec![format!("{} ({placement}): {e}", s.name)],
    };
    // Pieces that touch in full faces are solved by winding, and that is said.
    let told = |w: &&String| !(s.name.contains("goblet") && w.contains("solved by winding"));
    let warnings = report.warnings.iter().filter(told);
    out.extend(warnings.map(|w| format!("{} ({placement}): warning: {w}", s.name)));
    for (k, m) in made.iter().enumerate() {
        let mut fault = |what: String| {
            out.push(format!("{} ({placement}), {}: {what}", s.name, m.operation.name()))
        };
        let facts = check::report(&m.mesh, true, &Job::default()).expect("not cancelled");
        let (volume, area) = want[k];
        let scale = want[0].0;
        if (m.facts.volume - volume).abs() > 1e-9 * scale.max(volume) {
            fault(format!("volume {} instead of {volume}", m.facts.volume));
        }
        if (m.facts.area - area).abs() > 1e-9 * want[0].1 {
            fault(format!("area {} instead of {area}", m.facts.area));
        }
        if m.mesh.face_count() > 0 && !(facts.closed && facts.manifold && facts.oriented) {
            fault(format!("closed {}, manifold {}", facts.closed, facts.manifold));
        }
        if facts.components != s.components[k] {
            fault(format!("{} components instead of {}", facts.components, s.components[k]));
        }
        // Corners that rounding leaves beside a turned plane count as crossing. The area shows that
        // there is no further error.
        let turned = placement != "as it stands";
        if facts.degenerate_faces > 0 || (facts.crossed_triangles != Some(0) && !turned) {
            fault(format!(
                "{} degenerate, {:?} crossed",
                facts.degenerate_faces, facts.crossed_triangles
            ));
        }
        if let Some(faces) = s.faces
            && m.mesh.face_count() != faces[k]
        {
            fault(format!("{} faces instead of {}", m.mesh.face_count(), faces[k]));
        }
    }
    out
}

#[test]
fn the_scenes_as_they_stand_and_turned() {
    let mut wrong = Vec::new();
    for mut s in scenes() {
        let want = s.wanted();
        wrong.extend(faults(&s, &want, "as it stands"));
        let (a, b) = (s.a.clone(), s.b.clone());
        for (angle, shift) in [
            (0.7, [0.1, 0.2, 0.3]),
            (2.1, [10.3, -7.7, 0.01]),
            (std::f64::consts::FRAC_PI_4, [0.; 3]),
        ] {
            s.a = a.clone().placed(turn(angle), shift.into());
            // The second operand is placed in two moves, so that its rounding is independent.
            let off = DVec3::new(3.7, 1.9, -2.3);
            s.b = b
                .clone()
                .placed(DMat3::IDENTITY, -off)
                .placed(turn(angle), turn(angle) * off + DVec3::from(shift));
            wrong.extend(faults(&s, &want, &format!("turned by {angle:.2}")));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}
