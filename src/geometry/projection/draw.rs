//! A shadow as a drawing.

use std::fmt::Write;

use glam::DVec2;
use image::{ImageError, Rgb, RgbImage};

use super::{PlaneRegion, ProjectionSamples};

fn frame(polygons: &[PlaneRegion]) -> (DVec2, DVec2) {
    let (lo, hi) = polygons
        .iter()
        .flat_map(PlaneRegion::rings)
        .flatten()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    if lo.x > hi.x { (DVec2::ZERO, DVec2::ONE) } else { (lo, hi) }
}

/// A drawing to scale, in millimetres, one path a polygon, holes by the even-odd rule.
pub fn svg(polygons: &[PlaneRegion]) -> String {
    let (lo, hi) = frame(polygons);
    let margin = (hi - lo).max_element() * 0.02;
    let (lo, size) = (lo - margin, hi - lo + 2.0 * margin);
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.6}mm\" height=\"{:.6}mm\" \
         viewBox=\"0 0 {:.6} {:.6}\">",
        size.x, size.y, size.x, size.y
    );
    for polygon in polygons {
        out.push_str(
            "<path fill=\"#c8ced6\" stroke=\"#20242a\" vector-effect=\"non-scaling-stroke\" \
             fill-rule=\"evenodd\" d=\"",
        );
        for ring in polygon.rings() {
            for (i, p) in ring.iter().enumerate() {
                let q = DVec2::new(p.x - lo.x, lo.y + size.y - p.y);
                let _ = write!(out, "{}{:.6},{:.6}", if i == 0 { "M" } else { "L" }, q.x, q.y);
            }
            out.push('Z');
        }
        out.push_str("\"/>\n");
    }
    out.push_str("</svg>\n");
    out
}

/// A picture, the longer side `longest` pixels (16 to 16,384), as a PNG file's bytes. `samples` are
/// shown as dots, green inside and red outside.
pub fn png(
    polygons: &[PlaneRegion],
    samples: Option<&ProjectionSamples>,
    longest: u32,
) -> Result<Vec<u8>, ImageError> {
    let longest = longest.clamp(16, 16_384);
    let (lo, hi) = samples.map_or_else(|| frame(polygons), |s| (s.lo, s.hi));
    let margin = (hi - lo).max_element() * 0.02;
    let (lo, size) = (lo - margin, hi - lo + 2.0 * margin);
    let pixel = size.max_element() / longest as f64;
    let (w, h) = ((size.x / pixel).ceil().max(1.0) as u32, (size.y / pixel).ceil().max(1.0) as u32);
    let mut picture = RgbImage::from_pixel(w, h, Rgb([255; 3]));
    let mut crossings = Vec::new();
    for y in 0..h {
        let at = lo.y + size.y - (y as f64 + 0.5) * pixel;
        crossings.clear();
        for edge in polygons.iter().flat_map(PlaneRegion::rings).flat_map(|r| r.windows(2)) {
            let (a, b) = (edge[0], edge[1]);
            if (a.y <= at) != (b.y <= at) {
                crossings.push(a.x + (b.x - a.x) * ((at - a.y) / (b.y - a.y)));
            }
        }
        crossings.sort_by(f64::total_cmp);
        for span in crossings.chunks_exact(2) {
            let column = |x: f64| (((x - lo.x) / pixel + 0.5).floor().max(0.0) as u32).min(w);
            for x in column(span[0])..column(span[1]) {
                picture.put_pixel(x, y, Rgb([70, 84, 102]));
            }
        }
    }
    if let Some(s) = samples {
        for (points, colour) in [(&s.inside, [60, 200, 90]), (&s.outside, [210, 60, 50])] {
            for p in points {
                let (x, y) = ((p.x - lo.x) / pixel, (lo.y + size.y - p.y) / pixel);
                if x >= 0.0 && y >= 0.0 && (x as u32) < w && (y as u32) < h {
                    picture.put_pixel(x as u32, y as u32, Rgb(colour));
                }
            }
        }
    }
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
