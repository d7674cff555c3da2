//! The report: one page that needs nothing else, in the style of the report on wall thickness.

use std::fmt::Write;
use std::path::Path;

use glam::{DVec3, Vec3};
use sculptd_geometry::TriMesh;
use sculptd_geometry::picture::{Camera, draw};
use sculptd_geometry::thickness::report::{ReportOrigin, escape, figure, head};

use crate::answer::{CheckAnswer, CheckedSolid};
use crate::finding::{Finding, Severity};
use crate::layers::overhangs::overhang_angle;
use crate::moulding::draft_angle;
use crate::orientation::turn_upright;
use crate::part::PreparedPart;
use crate::preset::BuildMethod;
use crate::settings::CheckSettings;

/// Findings that are shown with a picture.
const PICTURES: usize = 24;
const GREY: [u8; 3] = [200, 196, 190];
const RED: [u8; 3] = [200, 60, 40];

/// A picture could not be encoded.
#[derive(Debug, thiserror::Error)]
#[error("a picture of the report could not be encoded: {0}")]
pub struct ReportError(String);

/// The whole page.
///
/// # Errors
/// Returns an error if a picture cannot be encoded.
pub fn html(
    checked: &CheckedSolid,
    settings: &CheckSettings,
    origin: ReportOrigin<'_>,
) -> Result<String, ReportError> {
    let a = &checked.answer;
    let name =
        Path::new(&a.file).file_name().map_or(a.file.as_str().into(), |n| n.to_string_lossy());
    let mut out = head(&format!("Check of {name}"));
    let _ = write!(
        out,
        "<h1>Check for {}</h1><p class=file>{}</p>",
        escape(&settings.process.title),
        escape(&name)
    );
    verdict(&mut out, a);
    if let Some(part) = &checked.part {
        views(&mut out, part, settings, &name)?;
    }
    findings(&mut out, a, checked.part.as_ref())?;
    facts(&mut out, a);
    orientations(&mut out, a);
    method(&mut out, a, settings, origin, &name);
    out.push_str("</main></body></html>\n");
    Ok(out)
}

fn count(a: &CheckAnswer, severity: Severity) -> usize {
    a.findings.iter().filter(|f| f.severity == severity).count()
}

fn verdict(out: &mut String, a: &CheckAnswer) {
    let (errors, warnings) = (count(a, Severity::Error), count(a, Severity::Warning));
    let (class, word) = match (a.ok, warnings) {
        (false, _) => ("fail", "Fail"),
        (true, 0) => ("pass", "Pass"),
        (true, _) => ("warn", "Pass with warnings"),
    };
    let ran = a.checks.iter().filter(|c| c.ran).count();
    let _ = write!(
        out,
        "<p class=\"verdict {class}\" role=status><strong>{word}.</strong> {errors} errors and \
         {warnings} warnings; {ran} of {} checks ran.</p>",
        a.checks.len()
    );
    if !a.warnings.is_empty() {
        out.push_str("<h2>About the file</h2><ul>");
        for w in &a.warnings {
            let _ = write!(out, "<li>{}</li>", escape(w));
        }
        out.push_str("</ul>");
    }
}

/// The part as it stands, each face with its own vertices, coloured by what its direction breaks.
fn coloured(part: &PreparedPart, settings: &CheckSettings) -> (TriMesh, Vec<[u8; 3]>) {
    let turn = turn_upright(settings.up);
    let stand = part.standing(settings.up, settings.layer());
    let p = &settings.process;
    let bad = |t: u32| {
        let normal = part.normals[t as usize];
        match p.method {
            BuildMethod::Mould => {
                p.draft.is_some_and(|l| draft_angle(normal, settings.up) < l - 0.01)
            }
            BuildMethod::Layers => {
                let plate = stand
                    .as_ref()
                    .is_some_and(|s| s.on_plate(&part.topology().triangles[t as usize]));
                !plate && p.overhang.is_some_and(|l| overhang_angle(normal, settings.up) > l + 0.01)
            }
            BuildMethod::Powder => false,
        }
    };
    let (mut mesh, mut colours) = (TriMesh::default(), Vec::new());
    for t in 0..part.triangles() as u32 {
        let Some(corners) = part.corners(t) else { continue };
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|c| (turn * c).as_vec3()));
        mesh.triangles.push([first, first + 1, first + 2]);
        colours.extend([if bad(t) { RED } else { GREY }; 3]);
    }
    (mesh, colours)
}

fn views(
    out: &mut String,
    part: &PreparedPart,
    settings: &CheckSettings,
    name: &str,
) -> Result<(), ReportError> {
    let (mesh, colours) = coloured(part, settings);
    out.push_str("<h2>The part</h2><div class=views>");
    for (side, caption) in [
        (Vec3::new(0.55, -0.75, 0.5), "from the front, above"),
        (Vec3::new(-0.55, 0.75, -0.5), "from behind, below"),
    ] {
        let camera = Camera::from_side(&mesh, side, 4.0 / 3.0);
        let picture = draw(&mesh, Some(&colours), &camera, 560, 420);
        let alt = format!("The part {name}, {caption}");
        figure(out, &picture, &alt, caption).map_err(|e| ReportError(e.to_string()))?;
    }
    let what = match settings.process.method {
        BuildMethod::Mould => "Red: less draft than the limit.",
        BuildMethod::Layers => "Red: looks down more steeply than the limit.",
        BuildMethod::Powder => "",
    };
    let _ = write!(out, "</div><p class=file>{what}</p>");
    Ok(())
}

/// Text of the answer as a page writes it.
fn written(text: &str) -> String {
    escape(&text.replace("mm2", "mm²").replace("mm3", "mm³"))
}

/// A number with its unit.
fn number(value: Option<f64>, unit: &str) -> String {
    let unit = unit.replace("degrees", "°");
    value.map_or("–".into(), |v| format!("{v:.3} {}", written(&unit)))
}

fn findings(
    out: &mut String,
    a: &CheckAnswer,
    part: Option<&PreparedPart>,
) -> Result<(), ReportError> {
    out.push_str("<h2>Findings</h2>");
    if a.findings.is_empty() {
        out.push_str("<p>None.</p>");
        return Ok(());
    }
    out.push_str(
        "<table><thead><tr><th scope=col class=n>No.<th scope=col>What<th scope=col class=n>Value\
         <th scope=col class=n>Limit<th scope=col>At x, y, z, mm<th scope=col>What to do<th \
         scope=col>View</thead><tbody>",
    );
    for (i, f) in a.findings.iter().enumerate() {
        let word = if f.severity == Severity::Error { "error" } else { "warning" };
        let place = f.position.map_or("–".into(), |[x, y, z]| format!("{x:.2}, {y:.2}, {z:.2}"));
        let _ = write!(
            out,
            "<tr><td class=n>{}<th scope=row>{}<br>{word}<td class=n>{}<td class=n>{}<td>{place}\
             <td>{}<td>",
            i + 1,
            f.kind.name(),
            number(f.value, f.unit),
            number(f.limit, f.unit),
            written(&f.message)
        );
        if let (Some(part), true) = (part, i < PICTURES) {
            close_up(out, part, f, i + 1)?;
        }
    }
    out.push_str("</tbody></table>");
    Ok(())
}

/// The surface around a finding, seen along its normal there.
fn close_up(
    out: &mut String,
    part: &PreparedPart,
    f: &Finding,
    number: usize,
) -> Result<(), ReportError> {
    let Some(position) = f.position else { return Ok(()) };
    let at = DVec3::from(position) - part.centred.centre;
    let Some(near) = part.tree().nearest(at, f64::INFINITY) else { return Ok(()) };
    let whole = Camera::from_corner(&part.centred.mesh, 1.0).half_height;
    let camera = Camera {
        target: at.as_vec3(),
        towards_eye: part.normals[near.triangle as usize].as_vec3().normalize_or(Vec3::Z),
        up: Vec3::Z,
        half_height: (f.area.unwrap_or(0.0).max(0.0).sqrt() as f32 * 1.2)
            .clamp(whole * 0.15, whole),
    };
    let mut picture = draw(&part.centred.mesh, None, &camera, 200, 150);
    picture.ring((100.0, 75.0), 16.0);
    let alt = format!("Finding {number}: the place is in the ring in the middle");
    figure(out, &picture, &alt, "").map_err(|e| ReportError(e.to_string()))
}

fn facts(out: &mut String, a: &CheckAnswer) {
    let f = &a.facts;
    let minutes = |s: Option<f64>| s.map(|s| s / 60.0);
    let rows = [
        ("Volume", number(f.volume, "mm3")),
        ("Surface area", number(f.area, "mm2")),
        ("Size", f.size.map_or("–".into(), |[x, y, z]| format!("{x:.3} × {y:.3} × {z:.3} mm"))),
        ("Weight", number(f.weight, "g")),
        ("Layers", f.layers.map_or("–".into(), |n| n.to_string())),
        ("First layer", number(f.contact_area, "mm2")),
        ("Falls when tilted by", number(f.tip_angle, "degrees")),
        ("Overhangs", number(f.overhang_area, "mm2")),
        ("Support", number(f.support_volume, "mm3")),
        ("Build time, roughly", number(minutes(f.build_time), "min")),
        ("Nominal wall", number(f.nominal_wall, "mm")),
        ("Thickest wall", number(f.thickest_wall, "mm")),
        ("Cooling time", number(f.cooling_time, "s")),
        ("Projected area", number(f.projected_area, "mm2")),
        ("Clamping force", number(f.clamping_force, "kN")),
        ("Undercuts", number(f.undercut_area, "mm2")),
        ("Undercuts along the best direction", number(f.parting_undercut, "mm2")),
    ];
    out.push_str("<h2>Facts</h2><table><tbody>");
    for (name, value) in rows.iter().filter(|r| r.1 != "–") {
        let _ = write!(out, "<tr><th scope=row>{name}<td class=n>{value}");
    }
    out.push_str("</tbody></table>");
}

fn orientations(out: &mut String, a: &CheckAnswer) {
    if a.orientations.is_empty() {
        return;
    }
    out.push_str("<h2>Orientations</h2>");
    if a.reasons.is_empty() {
        out.push_str("<p>No direction is better than the part as it is.</p>");
    } else {
        let _ = write!(out, "<p>The first is better: {}.</p>", written(&a.reasons.join("; ")));
    }
    out.push_str(
        "<table><thead><tr><th scope=col>Build direction<th scope=col class=n>Support, mm³<th \
         scope=col class=n>Overhangs, mm²<th scope=col class=n>Islands<th scope=col \
         class=n>Height, mm<th scope=col class=n>First layer, mm²</thead><tbody>",
    );
    for o in &a.orientations {
        let [x, y, z] = o.direction;
        let _ = write!(
            out,
            "<tr><th scope=row>{x:.3}, {y:.3}, {z:.3}<td class=n>{:.1}<td class=n>{:.1}<td \
             class=n>{}<td class=n>{:.2}<td class=n>{:.1}",
            o.support_volume, o.overhang_area, o.islands, o.height, o.contact_area
        );
    }
    out.push_str("</tbody></table>");
}

fn method(
    out: &mut String,
    a: &CheckAnswer,
    settings: &CheckSettings,
    origin: ReportOrigin<'_>,
    name: &str,
) {
    out.push_str("<h2>Method</h2><table><tbody>");
    for c in &a.checks {
        let ran = if c.ran { "ran" } else { "did not run" };
        let _ = write!(out, "<tr><th scope=row>{}<td>{ran}<td class=n>{:.3} s", c.name, c.seconds);
    }
    let [x, y, z] = a.up;
    let _ = write!(
        out,
        "</tbody></table><p>Build or pull direction: {x:.4}, {y:.4}, {z:.4}. A tie with a limit \
         passes. The area without draft, overhangs, cups and cavities are exact up to rounding; \
         support and undercuts are sampled, with a stated deviation. Cooling time: t = s² / (π² \
         a) \
         · ln(4/π · (Tm − Tw) / (Te − Tw)).</p><p>Limits: {}. Material: {}, {}.</p>\
         <table><tbody><tr><th scope=row>File<td>{}<tr><th scope=row>Size<td>{} bytes<tr><th \
         scope=row>Hash (FNV-1a, 64 bits)<td><code>{:016x}</code><tr><th \
         scope=row>Program<td>{}</tbody></table>",
        escape(&settings.process.source),
        escape(&settings.material.title),
        escape(&settings.material.source),
        escape(name),
        origin.bytes,
        origin.hash,
        escape(origin.program)
    );
}
