//! The report of two versions of a part: one page that needs nothing else.

use std::fmt::Write;

use glam::Vec3;

use super::changes::WallChanges;
use super::check::{CheckedPart, ThicknessAnswer};
use super::colour::{NOT_COMPARED, change_colour};
use super::report::{ReportOrigin, escape, figure, head, hex, name_of, verdict};
use crate::picture::{Camera, Picture, draw};
use crate::{CentredMesh, TriMesh};

/// The whole page. `part` is the later version, `origins` are of the files of both.
pub fn html(
    before: &ThicknessAnswer,
    part: &CentredMesh,
    after: &CheckedPart,
    changes: &WallChanges,
    origins: [ReportOrigin<'_>; 2],
) -> Result<String, image::ImageError> {
    let answers = [before, &after.answer];
    let [old, new] = answers.map(|a| escape(&name_of(a)));
    let mut out = head(&format!("Walls of {} and {}", name_of(before), name_of(&after.answer)));
    let _ =
        write!(out, "<h1>Wall thickness, compared</h1><p class=file>{old} and, later, {new}</p>");
    verdict(&mut out, &after.answer);
    out.push_str("<h2>The later version</h2><div class=views>");
    for (side, name) in [
        (Vec3::new(0.55, -0.75, 0.5), "from the front, above"),
        (Vec3::new(-0.55, 0.75, -0.5), "from behind, below"),
    ] {
        let camera = Camera::from_side(&part.mesh, side, 4.0 / 3.0);
        let picture = picture(&part.mesh, changes, &camera, [560, 420]);
        let alt = format!("The part {new}, coloured by the change of its walls");
        figure(&mut out, &picture, &alt, name)?;
    }
    out.push_str("</div>");
    legend(&mut out, changes.histogram_top);
    statistics(&mut out, answers, changes);
    histogram(&mut out, changes);
    spots(&mut out, part, changes)?;
    let _ = write!(
        out,
        "<h2>Method</h2><p>A place of the later version is compared with the place of the earlier \
         one from which it came: the same place, or the one where the line along its normal meets \
         the surface of the earlier version through nothing but what was removed there, or added. \
         A place without one, such as on a side of a new pocket, is new and is not compared. \
         Neither are edges, which are no walls. Differences up to {:.6} mm are rounding.</p>\
         <table><thead><tr><th \
         scope=col>File<th scope=col>Size<th scope=col>Hash (FNV-1a, 64 bits)</thead><tbody>",
        changes.tolerance
    );
    for (name, origin) in [old, new].iter().zip(origins) {
        let (bytes, hash) = (origin.bytes, origin.hash);
        let _ =
            write!(out, "<tr><th scope=row>{name}<td>{bytes} bytes<td><code>{hash:016x}</code>");
    }
    let program = escape(origins[1].program);
    let _ = writeln!(out, "</tbody></table><p>{program}</p></main></body></html>");
    Ok(out)
}

/// Draws the later version with each triangle in the colour of its change.
pub fn picture(
    mesh: &TriMesh,
    changes: &WallChanges,
    camera: &Camera,
    [width, height]: [usize; 2],
) -> Picture {
    let mut apart = TriMesh::default();
    let mut colours = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, &change) in changes.of_triangles.iter().enumerate() {
        let first = apart.positions.len() as u32;
        apart.positions.extend(mesh.corners(t));
        apart.triangles.push([first, first + 1, first + 2]);
        colours.extend([change_colour(change, changes.histogram_top); 3]);
    }
    draw(&apart, Some(&colours), camera, width, height)
}

fn legend(out: &mut String, top: f32) {
    const STEPS: usize = 41;
    let _ = write!(
        out,
        "<svg role=img width=520 height=58 viewBox=\"0 0 520 58\" aria-label=\"Colours: dark red \
         is {top:.3} mm thinner and more, pale unchanged, dark blue {top:.3} mm thicker and more, \
         grey is not \
         compared\">"
    );
    for i in 0..STEPS {
        let change = top * (2.0 * i as f32 / (STEPS - 1) as f32 - 1.0);
        let fill = hex(change_colour(change, top));
        let _ = write!(out, "<rect x={} y=4 width=10.5 height=24 fill=\"{fill}\"/>", i * 10);
    }
    let _ = write!(
        out,
        "<rect x=440 y=4 width=24 height=24 fill=\"{}\"/><g font-size=14 \
         font-family=sans-serif><text x=0 y=48>−{top:.3} mm</text><text x=205 y=48 \
         text-anchor=middle>0</text><text x=410 y=48 text-anchor=end>+{top:.3} mm</text><text \
         x=470 y=22>new</text></g></svg>",
        hex(NOT_COMPARED)
    );
}

fn statistics(out: &mut String, [before, after]: [&ThicknessAnswer; 2], c: &WallChanges) {
    let n = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.4}"));
    let of = |get: fn(&ThicknessAnswer) -> Option<f32>| [before, after].map(|a| n(get(a)));
    let below = [before, after].map(|a| a.below.map(|b| format!("{:.3}", b.area_percent)));
    let mut rows = vec![
        ("Least wall, mm", of(|a| a.summary.min)),
        ("Median by area, mm", of(|a| a.summary.median)),
        ("Mean by area, mm", of(|a| a.summary.mean)),
        ("Volume, mm³", [before, after].map(|a| format!("{:.3}", a.volume))),
    ];
    if let [Some(old), Some(new)] = below {
        rows.insert(1, ("Area below the limit, %", [old, new]));
    }
    out.push_str(
        "<h2>Statistics</h2><table><thead><tr><th scope=col><th scope=col class=n>Earlier<th \
         scope=col class=n>Later</thead><tbody>",
    );
    for (name, [old, new]) in rows {
        let _ = write!(out, "<tr><th scope=row>{name}<td class=n>{old}<td class=n>{new}");
    }
    out.push_str("</tbody></table><table><tbody>");
    let signed = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:+.4} mm"));
    let area = |v: f64| format!("{v:.3} mm²");
    let mut rows = vec![
        ("Became thinner", area(c.thinner_area)),
        ("Became thicker", area(c.thicker_area)),
        ("Compared", area(c.compared_area)),
        ("New, not compared", area(c.new_area)),
        ("Thinned the most by", signed(c.most_thinned)),
        ("Thickened the most by", signed(c.most_thickened)),
        ("Mean change", signed(c.mean)),
    ];
    if let Some(below) = c.newly_below_area {
        rows.insert(1, ("Came below the limit", area(below)));
    }
    for (name, value) in rows {
        let _ = write!(out, "<tr><th scope=row>{name}<td class=n>{value}");
    }
    out.push_str("</tbody></table>");
}

fn histogram(out: &mut String, c: &WallChanges) {
    let compared = &c.histogram[1..];
    let most = compared.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let top = c.histogram_top;
    let _ = write!(
        out,
        "<h2>Histogram</h2><svg role=img width=730 height=230 viewBox=\"0 0 730 230\" \
         aria-label=\"Area by change from {top:.3} millimetres thinner, and more, to as much \
         thicker, in 101 \
         classes; heights are square roots of areas\">"
    );
    for (i, &area) in compared.iter().enumerate() {
        // Most of a part is unchanged: by the roots of areas the rest is seen too.
        let h = 190.0 * (area / most).sqrt();
        let middle = top * (i as f32 / 50.0 - 1.0);
        let (x, y, fill) = (5 + i * 7, 200.0 - h, hex(change_colour(middle, top)));
        let _ = write!(
            out,
            "<rect x={x} y={y:.1} width=6 height={h:.1} fill=\"{fill}\" stroke=\"#777\" \
             stroke-width=.5 />"
        );
    }
    let _ = write!(
        out,
        "<line x1=5 x2=712 y1=200 y2=200 stroke=\"#333\"/><g font-size=13 \
         font-family=sans-serif><text x=0 y=218>−{top:.3} mm</text><text x=358 y=218 \
         text-anchor=middle>0</text><text x=712 y=218 text-anchor=end>+{top:.3} mm</text></g></svg>"
    );
}

fn spots(out: &mut String, part: &CentredMesh, c: &WallChanges) -> Result<(), image::ImageError> {
    let what = if c.newly_below_area.is_some() { "came below the limit" } else { "became thinner" };
    let _ = write!(out, "<h2>Places that {what}</h2>");
    if c.spots.is_empty() {
        out.push_str("<p>None.</p>");
        return Ok(());
    }
    out.push_str(
        "<table><thead><tr><th scope=col class=n>No.<th scope=col class=n>Before, mm<th scope=col \
         class=n>Now, mm<th scope=col class=n>Area, mm²<th scope=col>At x, y, z, mm<th \
         scope=col>View along the wall's normal</thead><tbody>",
    );
    let whole = Camera::from_corner(&part.mesh, 1.0).half_height;
    for (i, spot) in c.spots.iter().enumerate() {
        let place = glam::DVec3::from(spot.position) - part.centre;
        let near = (spot.area.sqrt() as f32 * 1.5).clamp(whole * 0.05, whole);
        let camera = Camera {
            target: place.as_vec3(),
            towards_eye: Vec3::from(spot.normal),
            up: Vec3::Z,
            half_height: near,
        };
        let mut picture = picture(&part.mesh, c, &camera, [200, 150]);
        picture.ring((100.0, 75.0), 16.0);
        let [x, y, z] = spot.position;
        let _ = write!(
            out,
            "<tr><td class=n>{}<td class=n>{:.4}<td class=n>{:.4}<td class=n>{:.3}<td>{x:.3}, \
             {y:.3}, {z:.3}<td>",
            i + 1,
            spot.before,
            spot.after,
            spot.area
        );
        figure(out, &picture, &format!("Spot {}: the place is in the ring", i + 1), "")?;
    }
    out.push_str("</tbody></table>");
    Ok(())
}
