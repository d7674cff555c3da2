//! `sculptd slice`: sections of a part by parallel planes: contours, area, perimeter, drawing.

use std::path::PathBuf;

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::distance::warn;
use super::info::interrupted;
use super::measure::direction;
use super::{Fail, Outcome, answer};
use sculptd_geometry::check::report;
use sculptd_geometry::io::{read_mesh, write_beside};
use sculptd_geometry::job::Job;
use sculptd_geometry::projection::{PlaneRegion, ProjectionPlane, svg};
use sculptd_geometry::repair::orient;
use sculptd_geometry::section::{Section, Slicer};

/// Most layers of one call.
const MOST_LAYERS: f64 = 1e6;

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("where").required(true).args(["height", "layers"])))]
pub struct SliceArgs {
    /// The mesh file.
    pub mesh: PathBuf,
    /// Cut once, at this height: the distance of the plane from the origin along the direction.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub height: Option<f64>,
    /// Cut the part into layers of this thickness, from its lowest point to its highest. Each layer
    /// is cut at half of its thickness; the last layer may be thinner.
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub layers: Option<f64>,
    /// The direction in which heights are measured; the planes are perpendicular to it.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, default_value = "0,0,1")]
    #[arg(value_parser = direction)]
    pub direction: DVec3,
    /// Write the sections as a drawing to scale; several layers side by side, the lowest first.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Layer {
    height: f64,
    area: f64,
    perimeter: f64,
    /// The length of lines along which contours run out and back; not part of the perimeter.
    folded: f64,
    /// The length of contours along faces that are turned; above 0, the area is that of the
    /// even-odd rule.
    turned: f64,
    /// The number of contours, holes included.
    contours: usize,
    /// The number of contours that the mesh leaves open.
    open: usize,
    centroid: Option<[f64; 3]>,
}

#[derive(Debug, Serialize)]
struct SliceAnswer {
    layers: Vec<Layer>,
    /// The volume of the mesh, where it is closed.
    volume: Option<f64>,
    /// The sum of each layer's area times its thickness; for `--layers`.
    layer_volume: Option<f64>,
    warnings: Vec<String>,
}

/// The height and the thickness of each layer.
fn planned(args: &SliceArgs, low: f64, high: f64) -> Result<Vec<(f64, f64)>, Fail> {
    if let Some(height) = args.height {
        return match height.is_finite() {
            true => Ok(vec![(height, 0.0)]),
            false => Err(Fail::Usage("--height: expected a finite height".into())),
        };
    }
    let thickness = args.layers.unwrap_or_default();
    if !(thickness > 0.0 && thickness.is_finite()) {
        return Err(Fail::Usage("--layers: expected a thickness above 0".into()));
    }
    // A last layer that is only rounding is none.
    let count = ((high - low) / thickness - 1e-9).ceil().max(1.0);
    if count > MOST_LAYERS {
        return Err(Fail::Usage(format!(
            "--layers: expected at most {MOST_LAYERS} layers, found {count}: the part is {} high",
            high - low
        )));
    }
    let layer = |i: usize| {
        let bottom = low + i as f64 * thickness;
        let top = if i as f64 + 1.0 < count { low + (i + 1) as f64 * thickness } else { high };
        ((bottom + top) * 0.5, top - bottom)
    };
    Ok((0..count as usize).map(layer).collect())
}

pub fn run(args: &SliceArgs, json: bool) -> Outcome {
    let job = Job::default();
    let loaded = read_mesh(&args.mesh, &job)?;
    let (mut mesh, mut warnings) = (loaded.mesh, loaded.warnings);
    let mut facts = report(&mesh, false, &job).map_err(interrupted)?;
    if !facts.oriented || facts.volume.is_some_and(|v| v < 0.0) {
        let turned = orient(&mut mesh);
        warnings.push(format!("{turned} faces were turned so that they face outwards"));
        facts = report(&mesh, false, &job).map_err(interrupted)?;
    }
    let normal = args.direction.normalize();
    let slicer = Slicer::new(&mesh, normal)
        .ok_or_else(|| Fail::Usage("--direction: expected three finite numbers".into()))?;
    let (low, high) = slicer.range().ok_or_else(|| {
        Fail::Input(format!("{}: expected a mesh with faces, found none", args.mesh.display()))
    })?;
    let plan = planned(args, low, high)?;
    let heights: Vec<f64> = plan.iter().map(|p| p.0).collect();
    let sections = slicer.all(&heights, &job).map_err(interrupted)?;
    let open = sections.iter().filter(|s| s.open > 0).count();
    if open > 0 {
        warnings.push(format!(
            "{open} of {} sections have open contours because the mesh has holes: their areas \
             count as if a straight line closed each. Close the holes with sculptd convert --mend",
            sections.len()
        ));
    }
    let turned = sections.iter().filter(|s| s.turned > 0.0).count();
    if turned > 0 {
        warnings.push(format!(
            "{turned} of {} sections run along faces that disagree on the outside: their areas \
             are those of the even-odd rule. Turn the faces with sculptd convert --mend",
            sections.len()
        ));
    }
    if args.height.is_some_and(|h| h < low || h > high) {
        warnings.push(format!(
            "the plane does not meet the part: its heights run from {low} to {high}"
        ));
    }
    if let Some(file) = &args.svg {
        let plane = ProjectionPlane::along(-normal, 0.0)
            .ok_or_else(|| Fail::Usage("--direction: expected three finite numbers".into()))?;
        let drawing = svg(&drawn(&sections, &plane));
        write_beside(file, |w| w.write_all(drawing.as_bytes())).map_err(|e| Fail::io(file, &e))?;
    }
    let sum = || sections.iter().zip(&plan).map(|(s, p)| s.area * p.1).sum();
    let out = SliceAnswer {
        volume: facts.volume,
        layer_volume: args.layers.map(|_| sum()),
        layers: sections
            .iter()
            .zip(&heights)
            .map(|(s, &height)| Layer {
                height,
                area: s.area,
                perimeter: s.perimeter,
                folded: s.folded,
                turned: s.turned,
                contours: s.contours.len(),
                open: s.open,
                centroid: s.centroid.map(|c| c.to_array()),
            })
            .collect(),
        warnings,
    };
    warn(&args.mesh, &out.warnings);
    answer(json, &out, |w| {
        for l in &out.layers {
            writeln!(
                w,
                "height {:.6}  area {:.6} mm2  perimeter {:.6} mm  contours {}",
                l.height, l.area, l.perimeter, l.contours
            )?;
        }
        match (out.layer_volume, out.volume) {
            (Some(sum), Some(v)) => writeln!(w, "volume {sum:.6} mm3 by layers, {v:.6} by faces"),
            (Some(sum), None) => writeln!(w, "volume {sum:.6} mm3 by layers; the mesh is open"),
            (None, Some(v)) => writeln!(w, "volume {v:.6} mm3"),
            (None, None) => writeln!(w, "volume none: the mesh is open"),
        }
    });
    Ok(())
}

/// Each section as a region of the plane, in rows of equal cells.
fn drawn(sections: &[Section], plane: &ProjectionPlane) -> Vec<PlaneRegion> {
    let mut regions: Vec<PlaneRegion> = Vec::new();
    let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for s in sections {
        let flat = |p: &DVec3| plane.flat(*p);
        let mut rings: Vec<Vec<DVec2>> =
            s.contours.iter().map(|c| c.points.iter().map(flat).collect()).collect();
        for p in rings.iter().flatten() {
            (lo, hi) = (lo.min(*p), hi.max(*p));
        }
        let holes = rings.split_off(rings.len().min(1));
        regions.push(PlaneRegion { outer: rings.pop().unwrap_or_default(), holes });
    }
    let across = (sections.len() as f64).sqrt().ceil() as usize;
    let cell = (hi - lo) * 1.1;
    for (i, region) in regions.iter_mut().enumerate() {
        let shift = DVec2::new((i % across) as f64, -((i / across) as f64)) * cell;
        for p in region.outer.iter_mut().chain(region.holes.iter_mut().flatten()) {
            *p += shift;
        }
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(height: Option<f64>, layers: Option<f64>) -> SliceArgs {
        SliceArgs { mesh: PathBuf::new(), height, layers, direction: DVec3::Z, svg: None }
    }

    #[test]
    fn layers_fill_the_part_and_the_last_one_may_be_thinner() {
        let plan = planned(&args(None, Some(0.2)), 1.0, 3.0).expect("layers");
        assert_eq!(plan.len(), 10);
        assert!((plan.iter().map(|p| p.1).sum::<f64>() - 2.0).abs() < 1e-12);
        let plan = planned(&args(None, Some(0.3)), 0.0, 1.0).expect("layers");
        assert_eq!(plan.len(), 4);
        assert!((plan[3].0 - 0.95).abs() < 1e-12 && (plan[3].1 - 0.1).abs() < 1e-12);
        assert_eq!(planned(&args(Some(-2.0), None), 0.0, 1.0).expect("one"), [(-2.0, 0.0)]);
        assert_eq!(planned(&args(None, Some(5.0)), 0.0, 1.0).expect("one"), [(0.5, 1.0)]);
    }

    #[test]
    fn a_height_that_is_none_is_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert_eq!(planned(&args(None, Some(bad)), 0.0, 1.0).map_err(|e| e.code()), Err(2));
        }
        assert_eq!(planned(&args(Some(f64::NAN), None), 0.0, 1.0).map_err(|e| e.code()), Err(2));
    }
}
