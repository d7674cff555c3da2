//! `--compare`: two versions of a part, and where walls became thinner or thicker.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::{ThicknessArgs, judge, load, origin, ply, verdict};
use crate::{Fail, Outcome, answer};
use sculptd_devices::Clock;
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::Job;
use sculptd_geometry::picture::Camera;
use sculptd_geometry::thickness::change_report;
use sculptd_geometry::thickness::changes::WallChanges;
use sculptd_geometry::thickness::check::{ThicknessAnswer, ThicknessLimits};
use sculptd_geometry::thickness::colour::change_colour;

/// The answer of `--compare`.
#[derive(Debug, Serialize)]
struct ComparedAnswer<'a> {
    before: &'a ThicknessAnswer,
    after: &'a ThicknessAnswer,
    changes: &'a WallChanges,
}

/// Compares the version in `old` with the later one in `new`, which the limits judge.
pub(super) fn run(
    old: &Path,
    new: &Path,
    args: &ThicknessArgs,
    limits: ThicknessLimits,
    json: bool,
) -> Outcome {
    let job = Job::default();
    let settings = args.how.settings();
    let usage = |e: &dyn std::fmt::Display| Fail::Usage(e.to_string());
    let clock = Clock::monotonic();
    let seconds = || clock.now_us() as f64 * 1e-6;
    let versions = [old, new].map(|path| {
        let (part, notes) = load(path, &args.how, &job)?;
        let name = path.display().to_string();
        let mut checked =
            part.judge(&name, &settings, limits, &job, seconds).map_err(|e| usage(&e))?;
        checked.answer.warnings.splice(0..0, notes);
        for w in &checked.answer.warnings {
            eprintln!("sculptd: warning: {name}: {w}");
        }
        Ok::<_, Fail>((part, checked))
    });
    let [before, after] = versions;
    let ((earlier, before), (part, after)) = (before?, after?);
    let changes = WallChanges::new(&earlier, &part, &after, &settings, &job);
    let changes = changes.map_err(|e| usage(&e))?;
    let mesh = &part.mesh;
    if let Some(out) = &args.ply {
        write_beside(out, |w| ply::write_changes(w, mesh, &changes))
            .map_err(|e| Fail::io(out, &e))?;
    }
    let drawn =
        |out: &Path, e: &dyn std::fmt::Display| Fail::Input(format!("{}: {e}", out.display()));
    if let Some(out) = &args.png {
        let (width, height) = args.size;
        let camera = Camera::from_corner(&mesh.mesh, width as f32 / height as f32);
        let size = [width as usize, height as usize];
        let mut picture = change_report::picture(&mesh.mesh, &changes, &camera, size);
        let top = changes.histogram_top;
        picture.legend(-top, top, |v| change_colour(v, top));
        let png = picture.png().map_err(|e| drawn(out, &e))?;
        write_beside(out, |w| w.write_all(&png)).map_err(|e| Fail::io(out, &e))?;
    }
    if let Some(out) = &args.report {
        let bytes = |path: &Path| std::fs::read(path).map_err(|e| Fail::io(path, &e));
        let (old, new) = (bytes(old)?, bytes(new)?);
        let origins = [origin(&old), origin(&new)];
        let page = change_report::html(&before.answer, mesh, &after, &changes, origins);
        let page = page.map_err(|e| drawn(out, &e))?;
        write_beside(out, |w| w.write_all(page.as_bytes())).map_err(|e| Fail::io(out, &e))?;
    }
    let (before, after) = (&before.answer, &after.answer);
    let whole = ComparedAnswer { before, after, changes: &changes };
    answer(json, &whole, |w| text(w, &whole));
    judge(after)
}

fn text(w: &mut dyn Write, answer: &ComparedAnswer<'_>) -> std::io::Result<()> {
    let ComparedAnswer { before, after, changes } = answer;
    let n = |v: Option<f32>| v.map_or("none".into(), |v| format!("{v:.4}"));
    for (name, a) in [("before", before), ("after", after)] {
        let s = &a.summary;
        writeln!(w, "{name:6} {}", a.file)?;
        let (min, median, mean) = (n(s.min), n(s.median), n(s.mean));
        writeln!(w, "  thickness  min {min}  median {median}  mean {mean} mm")?;
        writeln!(w, "  least      {}", a.statement)?;
        if let Some(b) = a.below {
            let (share, error, limit) = (b.area_percent, b.error_percent, b.limit);
            writeln!(w, "  below      {share:.3} +- {error:.3} % of the area is below {limit} mm")?;
        }
    }
    let most = |v: Option<f32>| v.map_or(String::new(), |v| format!(", by up to {v:+.4} mm"));
    let c = changes;
    writeln!(w, "changes")?;
    let (thinned, thickened) = (most(c.most_thinned), most(c.most_thickened));
    writeln!(w, "  thinner    {:.3} mm2{thinned}", c.thinner_area)?;
    writeln!(w, "  thicker    {:.3} mm2{thickened}", c.thicker_area)?;
    writeln!(w, "  compared   {:.3} mm2; {:.3} mm2 is new", c.compared_area, c.new_area)?;
    if let Some(area) = c.newly_below_area {
        writeln!(w, "  came below {area:.3} mm2")?;
    }
    for (i, s) in c.spots.iter().enumerate() {
        let [x, y, z] = s.position;
        let (i, before, after, area) = (i + 1, s.before, s.after, s.area);
        write!(w, "  spot {i:2}    {before:.4} to {after:.4} mm at ({x:.3}, {y:.3}, {z:.3}), ")?;
        writeln!(w, "{area:.3} mm2")?;
    }
    writeln!(w, "  verdict    {}", verdict(after.verdict))
}
