//! 3MF, out.

use std::io::{self, Cursor, Write};

use glam::{DMat3, DVec3};
use zip::write::SimpleFileOptions;

use super::beside::CancellableWriter;
use super::threemf::painting::filament_code;
use crate::PolyMesh;
use crate::filaments::Filaments;
use crate::job::Job;

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" \
    ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" \
    ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/// A mesh on its way to a 3MF file: a component of one object.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThreeMfPart<'a> {
    pub mesh: &'a PolyMesh,
    pub name: &'a str,
    /// Turn and scale.
    pub rows: DMat3,
    pub shift: DVec3,
}

/// One object, in millimetres, double precision.
pub(super) fn threemf(
    mesh: &PolyMesh,
    filaments: Option<&Filaments>,
    out: &mut dyn Write,
    job: &Job,
) -> io::Result<()> {
    threemf_model(out, job, filaments.is_some(), |text| {
        // Base materials beside the colours list the filaments by number.
        if let Some(filaments) = filaments {
            writeln!(text, "<basematerials id=\"1\">")?;
            for ([r, g, b], number) in filaments.colours.iter().zip(1..) {
                writeln!(
                    text,
                    "<base name=\"Filament {number}\" displaycolor=\"#{r:02X}{g:02X}{b:02X}\"/>"
                )?;
            }
            writeln!(text, "</basematerials>")?;
        }
        let first = if filaments.is_some() { 2 } else { 1 };
        let painting = filaments.map_or(&[][..], |f| &f.triangles);
        let id = threemf_mesh(first, "", mesh, painting, text)?;
        writeln!(text, "</resources><build><item objectid=\"{id}\"/></build></model>")
    })
}

/// One object whose components are the parts, each with its name and its transform.
pub(super) fn threemf_parts(
    parts: &[ThreeMfPart<'_>],
    out: &mut dyn Write,
    job: &Job,
) -> io::Result<()> {
    threemf_model(out, job, false, |text| {
        let mut ids = Vec::new();
        for part in parts {
            let name = format!(" name=\"{}\"", xml(part.name));
            let first = ids.last().map_or(1, |last| last + 1);
            ids.push(threemf_mesh(first, &name, part.mesh, &[], text)?);
        }
        let all = ids.last().map_or(1, |last| last + 1);
        writeln!(text, "<object id=\"{all}\" type=\"model\"><components>")?;
        for (part, id) in parts.iter().zip(&ids) {
            // Row vectors: the axes one after the other, then the shift.
            let numbers = part.rows.to_cols_array().into_iter().chain(part.shift.to_array());
            let numbers: Vec<String> = numbers.map(|n| n.to_string()).collect();
            let at = numbers.join(" ");
            writeln!(text, "<component objectid=\"{id}\" transform=\"{at}\"/>")?;
        }
        writeln!(
            text,
            "</components></object></resources><build><item objectid=\"{all}\"/></build></model>"
        )
    })
}

/// A text as the value of an attribute.
fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// The package around a model whose resources and build `rest` writes. `painted`: with triangles
/// that PrusaSlicer paints, which asks for the version of the painting.
fn threemf_model(
    out: &mut dyn Write,
    job: &Job,
    painted: bool,
    rest: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    // No clock in it: the same mesh gives the same bytes.
    let options =
        SimpleFileOptions::default().last_modified_time(zip::DateTime::default()).large_file(true);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options)?;
    let mut text = io::BufWriter::with_capacity(1 << 16, CancellableWriter { out: &mut zip, job });
    writeln!(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    let slicer = match painted {
        true => " xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\"",
        false => "",
    };
    writeln!(
        text,
        "<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"{slicer}>"
    )?;
    if painted {
        for name in ["Version3mf", "MmPaintingVersion"] {
            writeln!(text, "<metadata name=\"slic3rpe:{name}\">1</metadata>")?;
        }
    }
    writeln!(text, "<resources>")?;
    rest(&mut text)?;
    text.flush()?;
    drop(text);
    out.write_all(&zip.finish()?.into_inner())
}

/// Writes a mesh as an object, after its group of colours if it has any. `id`: the first free
/// number of a resource; `painting`: the filament of each triangle, from 0, or of none. Returns the
/// object's.
fn threemf_mesh(
    id: usize,
    name: &str,
    mesh: &PolyMesh,
    painting: &[u8],
    text: &mut dyn Write,
) -> io::Result<usize> {
    let mut places = Vec::new();
    if let Some(colours) = &mesh.colours {
        // Each colour once, in the order in which vertices have them.
        let mut known = std::collections::BTreeMap::new();
        writeln!(text, "<m:colorgroup id=\"{id}\">")?;
        for colour in colours {
            let next = known.len();
            let place = *known.entry(*colour).or_insert(next);
            if place == next {
                let [r, g, b, a] = *colour;
                writeln!(text, "<m:color color=\"#{r:02X}{g:02X}{b:02X}{a:02X}\"/>")?;
            }
            places.push(place);
        }
        writeln!(text, "</m:colorgroup>")?;
    }
    let object = if places.is_empty() { id } else { id + 1 };
    let property = match places.is_empty() {
        true => String::new(),
        false => format!(" pid=\"{id}\" pindex=\"0\""),
    };
    writeln!(text, "<object id=\"{object}\" type=\"model\"{name}{property}><mesh><vertices>")?;
    for p in &mesh.positions {
        writeln!(text, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z)?;
    }
    writeln!(text, "</vertices><triangles>")?;
    for (t, corners) in mesh.triangles().0.into_iter().enumerate() {
        let [a, b, c] = corners;
        write!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        if !places.is_empty() {
            let [p, q, r] = corners.map(|v| places[v as usize]);
            write!(text, " pid=\"{id}\" p1=\"{p}\" p2=\"{q}\" p3=\"{r}\"")?;
        }
        if let Some(code) = painting.get(t).and_then(|filament| filament_code(filament + 1)) {
            write!(text, " slic3rpe:mmu_segmentation=\"{code}\" paint_color=\"{code}\"")?;
        }
        writeln!(text, "/>")?;
    }
    writeln!(text, "</triangles></mesh></object>")?;
    Ok(object)
}
