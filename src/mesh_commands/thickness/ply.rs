//! The map as a PLY file.

use std::io::Write;

use sculptd_geometry::CentredMesh;
use sculptd_geometry::thickness::Thickness;
use sculptd_geometry::thickness::changes::WallChanges;
use sculptd_geometry::thickness::colour::change_colour;

/// Binary PLY: position (double, the file's own coordinates in mm), colour, thickness (NaN: none),
/// reason. `parts` is the number of each triangle's part, -1 in the file for none.
pub(super) fn write(
    w: &mut dyn Write,
    part: &CentredMesh,
    t: &Thickness,
    parts: Option<&[u32]>,
) -> std::io::Result<()> {
    let part_property = if parts.is_some() { "property int part\n" } else { "" };
    let (n, m) = (part.mesh.positions.len(), part.mesh.triangles.len());
    write!(
        w,
        "ply\nformat binary_little_endian 1.0\ncomment thickness in mm; nan: no value; reason 0 \
            measured, 1 edge, 2 nothing \
         ahead, 3 no normal, 4 no face\nelement vertex {n}\nproperty double x\nproperty double \
         y\nproperty double z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float \
         thickness\nproperty uchar reason\n\
         element face {m}\nproperty list uchar int vertex_indices\nproperty float \
         thickness\n{part_property}end_header\n"
    )?;
    let colours = t.colours(t.scale());
    let mut rows = Vec::with_capacity(n * 32 + m * 17);
    for v in 0..n {
        for x in (part.mesh.positions[v].as_dvec3() + part.centre).to_array() {
            rows.extend(x.to_le_bytes());
        }
        rows.extend(colours[v]);
        rows.extend(t.values[v].to_le_bytes());
        rows.push(t.reasons[v] as u8);
    }
    for (f, c) in part.mesh.triangles.iter().enumerate() {
        rows.push(3);
        c.iter().for_each(|v| rows.extend(v.to_le_bytes()));
        rows.extend(t.face_values.get(f).copied().unwrap_or(f32::NAN).to_le_bytes());
        if let Some(parts) = parts {
            let own = parts.get(f).and_then(|&p| i32::try_from(p).ok()).unwrap_or(-1);
            rows.extend(own.to_le_bytes());
        }
    }
    w.write_all(&rows)
}

/// Binary PLY of a later version: position as above, and of each face the `difference` of its wall
/// from the earlier version's (NaN: not compared) and its colour.
pub(super) fn write_changes(
    w: &mut dyn Write,
    part: &CentredMesh,
    changes: &WallChanges,
) -> std::io::Result<()> {
    let (n, m) = (part.mesh.positions.len(), part.mesh.triangles.len());
    write!(
        w,
        "ply\nformat binary_little_endian 1.0\ncomment difference of walls in mm; nan: not \
         compared\nelement vertex {n}\nproperty double x\nproperty double y\nproperty double \
         z\nelement face {m}\nproperty list uchar int vertex_indices\nproperty float \
         difference\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    )?;
    let mut rows = Vec::with_capacity(n * 24 + m * 20);
    for &p in &part.mesh.positions {
        for x in part.to_file(p).to_array() {
            rows.extend(x.to_le_bytes());
        }
    }
    for (corners, &change) in part.mesh.triangles.iter().zip(&changes.of_triangles) {
        rows.push(3);
        corners.iter().for_each(|v| rows.extend(v.to_le_bytes()));
        rows.extend(change.to_le_bytes());
        rows.extend(change_colour(change, changes.histogram_top));
    }
    w.write_all(&rows)
}
