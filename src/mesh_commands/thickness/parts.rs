//! `--parts` and `--skeleton`: the part divided by its walls, and the lines along its limbs.

use std::io::Write;
use std::path::Path;

use glam::DVec3;
use serde::Serialize;

use super::ThicknessArgs;
use crate::Fail;
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::Job;
use sculptd_geometry::picture::{Camera, Picture, draw};
use sculptd_geometry::thickness::medial_curve::MedialCurve;
use sculptd_geometry::thickness::partition::{PartitionSettings, WallPartition};
use sculptd_geometry::thickness::{
    MeasuredPlaces, Thickness, ThicknessMethod, ThicknessSettings, measure,
};
use sculptd_geometry::{CentredMesh, TriMesh};

/// What `--parts` and `--skeleton` find.
#[derive(Debug, Serialize)]
pub(super) struct Structure {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) partition: Option<WallPartition>,
    #[serde(skip_serializing_if = "Option::is_none")]
    skeleton: Option<MedialCurve>,
}

impl Structure {
    /// Divides the measured part, and finds its medial curve by the ball that fits.
    pub(super) fn find(
        args: &ThicknessArgs,
        part: &CentredMesh,
        measured: &Thickness,
        job: &Job,
    ) -> Result<Structure, Fail> {
        let usage = |e: &dyn std::fmt::Display| Fail::Usage(e.to_string());
        let how = PartitionSettings { levels: args.levels, smoothing: args.smoothing };
        let partition =
            args.parts.then(|| measured.partition(how, job)).transpose().map_err(|e| usage(&e))?;
        let partition = partition.map(|found| found.moved(part.centre));
        let mut skeleton = None;
        if args.skeleton.is_some() {
            let balls = ThicknessSettings {
                method: ThicknessMethod::Sphere,
                at: MeasuredPlaces::VerticesAndFaces,
                ..args.how.settings()
            };
            let measured = measure(&part.mesh, &balls, job).map_err(|e| usage(&e))?;
            let found = measured.medial_curve(job).map_err(|e| usage(&e))?;
            skeleton = Some(found.moved(part.centre));
        }
        Ok(Structure { partition, skeleton })
    }

    /// The rows that people read.
    pub(super) fn text(&self, w: &mut dyn Write) -> std::io::Result<()> {
        if let Some(WallPartition { levels, parts, .. }) = &self.partition {
            let levels: Vec<String> = levels.iter().map(|l| format!("{l:.3}")).collect();
            writeln!(w, "  parts      {}, of levels {} mm", parts.len(), levels.join(", "))?;
            for (i, part) in parts.iter().take(ROWS).enumerate() {
                let [x, y, z] = part.centre;
                let [least, most] = part.range;
                write!(w, "  part {i:3}   {:.4} mm ({least:.4} to {most:.4}), ", part.median)?;
                writeln!(w, "{:.3} mm2 about ({x:.3}, {y:.3}, {z:.3})", part.area)?;
            }
            if parts.len() > ROWS {
                writeln!(w, "             {} smaller ones: see --json", parts.len() - ROWS)?;
            }
        }
        let Some(MedialCurve { nodes, branches }) = &self.skeleton else { return Ok(()) };
        writeln!(w, "  skeleton   {} lines, {} points", branches.len(), nodes.len())?;
        for (i, b) in branches.iter().take(ROWS).enumerate() {
            let thinnest = &nodes[b.thinnest as usize];
            let [x, y, z] = thinnest.position;
            write!(w, "  line {i:3}   {:.3} mm long, {:.4} mm thick, ", b.length, b.mean)?;
            writeln!(w, "at least {:.4} at ({x:.3}, {y:.3}, {z:.3})", thinnest.thickness)?;
        }
        Ok(())
    }

    /// The lines as an OBJ file, in millimetres; the thickness of each point is in a comment.
    pub(super) fn write_lines(&self, w: &mut dyn Write) -> std::io::Result<()> {
        let Some(MedialCurve { nodes, branches }) = &self.skeleton else { return Ok(()) };
        for n in nodes {
            let [x, y, z] = n.position;
            writeln!(w, "# thickness {}\nv {x} {y} {z}", n.thickness)?;
        }
        for b in branches {
            let corners: Vec<String> = b.nodes.iter().map(|n| (n + 1).to_string()).collect();
            if corners.len() > 1 {
                writeln!(w, "l {}", corners.join(" "))?;
            }
        }
        Ok(())
    }

    /// Draws the part with a colour for each of its parts, and the lines over it.
    pub(super) fn draw(&self, part: &CentredMesh, camera: &Camera, picture: &mut Picture) {
        if let Some(found) = &self.partition {
            *picture = in_parts(&part.mesh, found, camera, [picture.width, picture.height]);
        }
        let Some(MedialCurve { nodes, branches }) = &self.skeleton else { return };
        let at = |n: u32| {
            let place = DVec3::from(nodes[n as usize].position) - part.centre;
            picture.place(camera, place.as_vec3())
        };
        let lines: Vec<_> = branches
            .iter()
            .flat_map(|b| b.nodes.windows(2))
            .map(|two| (at(two[0]), at(two[1])))
            .collect();
        for (from, to) in lines {
            picture.line(from, to, [20, 20, 20]);
        }
    }
}

/// Parts and lines that are listed for people.
const ROWS: usize = 12;

/// Colours of parts, in turn: neighbours in the list differ in hue and in lightness.
const COLOURS: [[u8; 3]; 12] = [
    [86, 140, 200],
    [232, 150, 60],
    [96, 170, 110],
    [200, 90, 100],
    [150, 120, 190],
    [214, 196, 90],
    [90, 180, 190],
    [160, 110, 80],
    [226, 150, 180],
    [120, 130, 140],
    [170, 200, 120],
    [70, 90, 150],
];

/// The mesh with the triangles in the colours of their parts; white is in none.
fn in_parts(
    mesh: &TriMesh,
    found: &WallPartition,
    camera: &Camera,
    [width, height]: [usize; 2],
) -> Picture {
    let mut apart = TriMesh::default();
    let mut colours = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, &part) in found.of.iter().enumerate() {
        let first = apart.positions.len() as u32;
        apart.positions.extend(mesh.corners(t));
        apart.triangles.push([first, first + 1, first + 2]);
        let own = if (part as usize) < found.parts.len() {
            COLOURS[part as usize % COLOURS.len()]
        } else {
            [255; 3]
        };
        colours.extend([own; 3]);
    }
    draw(&apart, Some(&colours), camera, width, height)
}

/// Writes the lines of `--skeleton` to `out`.
pub(super) fn write_skeleton(out: &Path, found: &Structure) -> Result<(), Fail> {
    write_beside(out, |w| found.write_lines(w)).map_err(|e| Fail::io(out, &e))
}
