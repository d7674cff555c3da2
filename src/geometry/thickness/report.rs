//! The report: one page that needs nothing else, on a screen, on paper, and read aloud.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use glam::Vec3;

use super::check::{CheckedPart, ThicknessAnswer, Verdict};
use super::colour::{NONE, colour};
use super::{Correction, ThicknessMethod};
use crate::CentredMesh;
use crate::picture::{Camera, Picture, draw};

/// The data that the page cannot derive.
#[derive(Debug, Clone, Copy)]
pub struct ReportOrigin<'a> {
    /// FNV-1a, 64 bits, of the file's bytes.
    pub hash: u64,
    /// The file's length.
    pub bytes: u64,
    /// The program's name and version.
    pub program: &'a str,
}

/// FNV-1a, 64 bits.
pub fn fnv(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// The whole page.
pub fn html(
    part: &CentredMesh,
    checked: &CheckedPart,
    origin: ReportOrigin<'_>,
) -> Result<String, image::ImageError> {
    let a = &checked.answer;
    let scale = checked.thickness.scale();
    let colours = checked.thickness.colours(scale);
    let name = name_of(a);
    let mut out = head(&format!("Wall thickness of {name}"));
    let _ = write!(out, "<h1>Wall thickness</h1><p class=file>{}</p>", escape(&name));
    verdict(&mut out, a);
    out.push_str("<h2>The part</h2><div class=views>");
    for (side, name) in [
        (Vec3::new(0.55, -0.75, 0.5), "from the front, above"),
        (Vec3::new(-0.55, 0.75, -0.5), "from behind, below"),
    ] {
        let camera = Camera::from_side(&part.mesh, side, 4.0 / 3.0);
        let picture = draw(&part.mesh, Some(&colours), &camera, 560, 420);
        figure(&mut out, &picture, &format!("The part {name}, coloured by thickness"), name)?;
    }
    out.push_str("</div>");
    legend(&mut out, scale);
    statistics(&mut out, a);
    histogram(&mut out, a);
    worst(&mut out, part, checked, &colours)?;
    method(&mut out, a, origin);
    out.push_str("</main></body></html>\n");
    Ok(out)
}

/// The page's beginning with its style; shared with the batch's summary.
pub fn head(title: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport \
            content=\"width=device-width,\
         initial-scale=1\"><title>{}</title><style>{STYLE}</style></head><body><main>",
        escape(title)
    )
}

const STYLE: &str = "body{font:16px/1.45 \
    system-ui,sans-serif;color:#1a1a1a;background:#fff;margin:0}\
main{max-width:60rem;margin:0 auto;padding:1.5rem}h1{margin:0}h2{margin:1.8rem 0 \
.5rem;font-size:1.25rem}\
.file{margin:.2rem 0 1rem;color:#444;overflow-wrap:anywhere}.verdict{padding:.7rem 1rem;border:3px \
solid;border-radius:6px;\
font-size:1.1rem}.pass{border-color:#1b6e2e}.warn{border-color:#8a5a00}\
.fail{border-color:#a8001c}.unjudged{border-color:#555}\
table{border-collapse:collapse;width:100%}th,td{text-align:left;padding:.3rem \
.6rem;border-bottom:1px solid #ccc;\
vertical-align:top}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}\
caption{text-align:left;color:#444;\
padding:.2rem \
0}figure{margin:0}figcaption{color:#444;font-size:.9rem}img{max-width:100%;height:auto;border:1px \
solid #bbb}\
.views{display:grid;grid-template-columns:repeat(auto-fit,minmax(15rem,1fr));gap:1rem}\
svg{max-width:100%;height:auto}\
details{margin:.5rem 0}@media \
print{main{padding:0;max-width:none}h2{break-after:avoid}figure,tr,svg{break-inside:avoid}\
details>summary{display:none}.verdict{print-color-adjust:exact}}";

/// Returns the file's name without its folder: the page is for others, and must not reveal local
/// paths.
pub(super) fn name_of(a: &ThicknessAnswer) -> Cow<'_, str> {
    Path::new(&a.file).file_name().map_or(a.file.as_str().into(), |n| n.to_string_lossy())
}

pub(super) fn verdict(out: &mut String, a: &ThicknessAnswer) {
    let (class, word) = match a.verdict {
        Verdict::Pass => ("pass", "Pass"),
        Verdict::Warn => ("warn", "Warning"),
        Verdict::Fail => ("fail", "Fail"),
        Verdict::Unjudged => ("unjudged", "Not judged"),
        Verdict::Undecided => ("warn", "Undecided"),
    };
    let _ = write!(out, "<p class=\"verdict {class}\" role=status><strong>{word}.</strong> ");
    match (a.summary.min, a.summary.max) {
        (Some(min), Some(max)) => {
            let _ = write!(out, "The walls measure from {min:.3} to {max:.3} mm.");
        }
        _ => out.push_str("No wall could be measured."),
    }
    let _ = write!(out, " Least wall: {}.", escape(&a.statement));
    for (beyond, word) in [(&a.below, "below"), (&a.above, "above")] {
        if let Some(b) = beyond {
            let _ = write!(
                out,
                " {:.3} ± {:.3} % of the area is {word} {} mm.",
                b.area_percent, b.error_percent, b.limit
            );
        }
    }
    if a.verdict == Verdict::Unjudged {
        out.push_str(" No limit was given.");
    }
    out.push_str("</p>");
    if !a.warnings.is_empty() {
        out.push_str("<h2>What is wrong with the file</h2><ul>");
        for w in &a.warnings {
            let _ = write!(out, "<li>{}</li>", escape(w));
        }
        out.push_str("</ul>");
    }
}

/// Adds a picture with its words for those who do not see it, and its caption; shared with other
/// reports.
pub fn figure(
    out: &mut String,
    picture: &Picture,
    alt: &str,
    caption: &str,
) -> Result<(), image::ImageError> {
    let data = base64(&picture.png()?);
    let _ = write!(
        out,
        "<figure><img width={} height={} \
            alt=\"{}\" src=\"data:image/png;base64,{data}\"><figcaption>{}</figcaption></figure>",
        picture.width,
        picture.height,
        escape(alt),
        escape(caption)
    );
    Ok(())
}

fn legend(out: &mut String, (low, high): (f32, f32)) {
    const STEPS: usize = 40;
    let _ = write!(
        out,
        "<svg role=img width=520 height=58 viewBox=\"0 0 520 58\" aria-label=\"Colours: dark red \
         is {low:.3} mm, pale yellow {high:.3} mm and more, blue is no value\">"
    );
    for i in 0..STEPS {
        let value = low + (high - low) * i as f32 / (STEPS - 1) as f32;
        let _ = write!(
            out,
            "<rect x={} y=4 width=10.5 height=24 fill=\"{}\"/>",
            i * 10,
            hex(colour(value, low, high))
        );
    }
    let _ = write!(
        out,
        "<rect x=440 y=4 width=24 height=24 fill=\"{}\"/><g font-size=14 \
            font-family=sans-serif><text x=0 y=48>{low:.3} mm</text>\
         <text x=200 y=48 text-anchor=middle>{:.3}</text>\
         <text x=400 y=48 text-anchor=end>{high:.3} mm</text>\
         <text x=470 y=22>none</text></g></svg>",
        hex(NONE),
        (low + high) * 0.5
    );
}

fn statistics(out: &mut String, a: &ThicknessAnswer) {
    let s = &a.summary;
    let n = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.4} mm"));
    let [x, y, z] = a.dimensions;
    let rows = [
        ("Minimum", n(s.min)),
        ("Median by area", n(s.median)),
        ("Mean by area", n(s.mean)),
        ("Maximum", n(s.max)),
        ("Places with a value", format!("{:.2} % of {}", s.valid * 100.0, a.places)),
        ("Most frequent class", n(s.most_frequent)),
        ("Error bound of the map", format!("{:.4} mm", s.error_bound)),
        ("Volume", format!("{:.3} mm³", a.volume)),
        ("Surface area", format!("{:.3} mm²", a.area)),
        ("Dimensions", format!("{x:.3} × {y:.3} × {z:.3} mm")),
        ("Vertices and triangles in the file", format!("{} and {}", a.vertices, a.triangles)),
    ];
    out.push_str("<h2>Statistics</h2><table><tbody>");
    for (name, value) in rows {
        let _ = write!(out, "<tr><th scope=row>{name}<td class=n>{value}");
    }
    out.push_str("</tbody></table>");
}

fn histogram(out: &mut String, a: &ThicknessAnswer) {
    let counts = &a.summary.histogram;
    let most = counts.iter().copied().fold(0.0f64, f64::max);
    let most = if most > 0.0 { most } else { 1.0 };
    let max = a.summary.histogram_top.unwrap_or(0.0);
    let beyond = if a.summary.max > a.summary.histogram_top { " and above" } else { "" };
    let _ = write!(
        out,
        "<h2>Histogram</h2><svg role=img width=720 height=230 viewBox=\"0 0 720 \
            230\" aria-label=\"Area by thickness from 0 \
         to {max:.3} millimetres{beyond} in 100 classes; the same numbers are in the table below\">"
    );
    for (i, &c) in counts.iter().enumerate() {
        let h = 190.0 * c / most;
        let fill = if i == 0 { hex(NONE) } else { "#5b4a3f".into() };
        let _ = write!(
            out,
            "<rect x={} y={:.1} width=6 height={h:.1} fill=\"{fill}\"/>",
            5 + i * 7,
            200.0 - h
        );
    }
    if let Some(limit) =
        a.limits.fail_below.or(a.limits.warn_below).filter(|l| max > 0.0 && *l < max)
    {
        let x = 12.0 + 700.0 * limit / max;
        let _ = write!(
            out,
            "<line x1={x:.1} x2={x:.1} y1=0 y2=200 stroke=\"#a8001c\" stroke-width=2 \
                stroke-dasharray=\"5 3\"/>\
             <text x={:.1} y=12 font-size=13 font-family=sans-serif fill=\"#a8001c\">limit \
             {limit}</text>",
            x + 4.0
        );
    }
    let _ = write!(
        out,
        "<line x1=5 x2=712 y1=200 y2=200 stroke=\"#333\"/><g font-size=13 \
            font-family=sans-serif><text x=0 y=218>none, 0</text>\
         <text x=362 y=218 text-anchor=middle>{:.3}</text><text x=712 y=218 \
         text-anchor=end>{max:.3} mm{beyond}</text></g></svg>",
        max * 0.5
    );
    out.push_str(
        "<details><summary>The same as a table (classes that are not \
            empty)</summary><table><thead><tr>\
                  <th scope=col>Class<th scope=col class=n>Area, mm²</thead><tbody>",
    );
    for (i, &c) in counts.iter().enumerate().filter(|(_, c)| **c > 0.0) {
        let class = if i == 0 {
            "no value".into()
        } else {
            let beyond = if i + 1 == counts.len() { beyond } else { "" };
            let (from, to) = (max * (i - 1) as f32 / 100.0, max * i as f32 / 100.0);
            format!("{from:.3} to {to:.3} mm{beyond}")
        };
        let _ = write!(out, "<tr><th scope=row>{class}<td class=n>{c:.3}");
    }
    out.push_str("</tbody></table></details>");
}

fn worst(
    out: &mut String,
    part: &CentredMesh,
    checked: &CheckedPart,
    colours: &[[u8; 3]],
) -> Result<(), image::ImageError> {
    out.push_str("<h2>Worst spots</h2>");
    if checked.spots.is_empty() {
        out.push_str("<p>None: no wall is below the limit.</p>");
        return Ok(());
    }
    out.push_str(
        "<table><caption>Connected regions below the limit (without a limit: of the thinnest \
            hundredth), the thinnest \
         first</caption><thead><tr><th scope=col class=n>No.<th scope=col class=n>Thickness, mm<th \
         scope=col class=n>Area, mm²\
         <th scope=col>Thinnest at x, y, z, mm<th scope=col>View along the wall's \
         normal</thead><tbody>",
    );
    let whole = Camera::from_corner(&part.mesh, 1.0).half_height;
    for (i, (spot, told)) in checked.spots.iter().zip(&checked.answer.worst).enumerate() {
        let near =
            (spot.area.sqrt() as f32 * 1.5).max(spot.thickness * 6.0).clamp(whole * 0.05, whole);
        let at = Vec3::from(spot.position);
        let camera = Camera {
            target: at,
            towards_eye: Vec3::from(spot.normal),
            up: Vec3::Z,
            half_height: near,
        };
        let mut picture = draw(&part.mesh, Some(colours), &camera, 200, 150);
        picture.ring((100.0, 75.0), 16.0);
        let [x, y, z] = told.position;
        let _ = write!(
            out,
            "<tr><td class=n>{}<td class=n>{:.4}<td class=n>{:.3}<td>{x:.3}, {y:.3}, {z:.3}<td>",
            i + 1,
            told.thickness,
            told.area
        );
        let alt = format!("Spot {}: the thinnest place is in the ring in the middle", i + 1);
        figure(out, &picture, &alt, "")?;
    }
    out.push_str("</tbody></table>");
    Ok(())
}

fn method(out: &mut String, a: &ThicknessAnswer, origin: ReportOrigin<'_>) {
    let s = &a.settings;
    let how = match s.method {
        ThicknessMethod::Sphere => "Thickness (sphere) is the diameter of the largest ball that \
            touches the surface at the place and fits under the side opposite; sides turned by \
            more than 40 degrees do not hold it."
            .to_string(),
        ThicknessMethod::Ray => "Thickness (ray) is the length of one ray into the wall, \
            opposite the surface's normal. The least wall is proven over every point of every \
            facet: what it says does not depend on sampling."
            .into(),
        ThicknessMethod::Cone => {
            let corrected = match s.correction {
                Correction::None => {
                    "The rays' own lengths are averaged, which is up to 32 % too \
                    much at 120 degrees."
                }
                Correction::Angle => {
                    "Each length is corrected by the angle between the ray and the \
                    hit face."
                }
                Correction::Chord => {
                    "Each ray gives the wall's depth along the normal: a chord of the opposite \
                     wall stands at right angles to the sum of the wall's normals at its ends, \
                     which removes the bias of slanted and of bent walls."
                }
            };
            format!(
                "Thickness (cone) is the mean of {} rays in a cone of {} degrees into the wall. \
                {corrected}",
                s.rays, s.opening
            )
        }
    };
    let l = &a.limits;
    let limit = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v} mm"));
    let _ = write!(
        out,
        "<h2>Method</h2><p>{how} Faces that touch the place itself are not hit, nor walls that \
         face the same way.</p>\
         <p>An edge is no wall. The least wall is between sides that are within 40 degrees of \
         parallel, or above the bottom of a groove or pit; areas count what is above its sides \
         too. In the map, a place within 1.5 of its value from a sharp edge has no wall if its \
         opposite side is a side of an edge by this rule.</p>\
         <p>Error bound: every value of the map away from edges is within {:.4} mm of the surface \
         that the triangles stand for.</p>\
         <p>Limits: warn below {}, fail below {}, fail above {}; a wall fails when it is \
         beyond for sure; a tie passes.</p>\
         <table><tbody><tr><th scope=row>File<td>{}<tr><th scope=row>Size<td>{} bytes<tr><th \
         scope=row>Hash (FNV-1a, 64 bits)\
         <td><code>{:016x}</code><tr><th scope=row>Program<td>{}</table>",
        a.summary.error_bound,
        limit(l.warn_below),
        limit(l.fail_below),
        limit(l.fail_above),
        escape(&name_of(a)),
        origin.bytes,
        origin.hash,
        escape(origin.program)
    );
}

pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Safe in text and in quoted attributes, of HTML and of XML.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // XML 1.0 has no way to say other control characters.
            c if c.is_control() && !matches!(c, '\n' | '\t' | '\r') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let n = (0..3).fold(0u32, |n, i| n << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(n >> (18 - 6 * i)) as usize & 63] as char;
            out.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_as_rfc_4648_says() {
        for (text, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(text.as_bytes()), coded);
        }
    }

    #[test]
    fn nothing_of_a_file_name_becomes_markup() {
        assert_eq!(escape("<a href='x'>&\"\u{1}"), "&lt;a href=&#39;x&#39;&gt;&amp;&quot;\u{fffd}");
    }
}
