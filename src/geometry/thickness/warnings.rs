//! The faults of a mesh, and their effect on its thickness.

use super::MeshFaults;
use super::summary::ThicknessSummary;

/// One sentence for each fault: what was found, and what it means for the result. `size` is the
/// largest dimension, in the unit that the values are in, millimetres as a rule.
pub fn warnings(faults: &MeshFaults, summary: &ThicknessSummary, size: f32) -> Vec<String> {
    let mut out = Vec::new();
    let mut say = |n: usize, text: &dyn Fn(usize) -> String| {
        if n > 0 {
            out.push(text(n));
        }
    };
    say(faults.broken, &|n| {
        format!(
            "{n} triangles name a vertex that is not there or a coordinate that is no number: left \
                out"
        )
    });
    say(faults.degenerate, &|n| {
        format!("{n} triangles have no area: left out; no value changes by it")
    });
    say(faults.duplicate, &|n| {
        format!(
            "{n} triangles are there twice: the copies are left out, or they would hide the wall \
                behind them"
        )
    });
    say(faults.boundary_edges, &|n| {
        let lost = match summary.missing.nothing_ahead {
            0 => "every vertex still met some wall, beside an opening perhaps a further one".into(),
            lost => format!("{lost} vertices are without a value"),
        };
        format!(
            "the mesh is open ({n} edges have one face only): what lies behind an opening has no \
                thickness; {lost}"
        )
    });
    say(faults.inverted_edges, &|n| {
        format!(
            "at {n} edges a face is inverted against its neighbour: an inverted face measures the \
                gap in front of it \
             instead of the wall, and no ray stops at it; repair the orientation first"
        )
    });
    say(faults.crowded_edges, &|n| {
        format!(
            "{n} edges have more than two faces: the solid is not defined there, and values beside \
                them may be wrong"
        )
    });
    say(faults.inside_out as usize, &|_| {
        "the mesh is inside out (its volume is negative): measured as if every face were turned \
            round"
            .into()
    });
    say(faults.shells.saturating_sub(1), &|n| {
        let overlap = if faults.boundary_edges > 0 {
            "; as the mesh is open, they are not united, and where they overlap each counts as a \
             wall of its own"
        } else {
            ""
        };
        format!("{} separate shells: a cavity counts as a cavity{overlap}", n + 1)
    });
    say(summary.missing.no_normal as usize, &|n| {
        format!(
            "{n} vertices have faces that cancel each other, so no direction to measure in: no \
                value there"
        )
    });
    if size > 0.0 && size < 1.0 {
        out.push(format!(
            "the largest dimension is {size:.4} mm: a file in metres? then all lengths are 1000 \
                times too small; say --unit m"
        ));
    }
    if size > 10_000.0 {
        out.push(format!(
            "the largest dimension is {size:.0} mm: a file in micrometres or inches? say --unit \
                with the right one"
        ));
    }
    out
}
