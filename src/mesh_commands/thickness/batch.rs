//! Many files at once: a row, a report and a summary page; an interrupted batch is resumed.

use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{ThicknessArgs, judge, one, write_report};
use crate::many_files::{self, TestCase, TestOutcome, link, names};
use crate::{Fail, Outcome, answer};
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::check::{ThicknessLimits, Verdict};
use sculptd_geometry::thickness::report::{escape, fnv, head};

/// One file's outcome, kept as `NAME.json` in the folder.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Row {
    /// Changes with the file's bytes, the settings, the limits and the program: an older row with
    /// the same key is kept.
    key: String,
    pub(super) file: String,
    /// The report's file name, in the same folder.
    report: Option<String>,
    /// `pass`, `warn`, `fail`, `unjudged`, or `unreadable`.
    pub(super) verdict: String,
    min: Option<f32>,
    median: Option<f32>,
    max: Option<f32>,
    below_percent: Option<f64>,
    pub(super) seconds: f64,
    /// The reason why it failed, or could not be read.
    pub(super) why: Option<String>,
}

#[derive(Debug, Serialize)]
struct All<'a> {
    files: &'a [Row],
    reused: usize,
}

pub(super) fn run(args: &ThicknessArgs, limits: ThicknessLimits, json: bool) -> Outcome {
    let folder = args.out.as_deref().ok_or_else(|| {
        Fail::Usage("several files need a folder for their reports: say --out FOLDER".into())
    })?;
    let single = [&args.ply, &args.png, &args.report, &args.skeleton];
    if args.parts || single.iter().any(|o| o.is_some()) {
        return Err(Fail::Usage(
            "--ply, --png, --report, --parts and --skeleton are for a single file; a batch writes \
             into --out"
                .into(),
        ));
    }
    std::fs::create_dir_all(folder).map_err(|e| Fail::io(folder, &e))?;
    let names = names(&args.meshes);
    let rows: Vec<(Row, bool)> = args
        .meshes
        .par_iter()
        .zip(&names)
        .map(|(path, name)| row(path, name, folder, args, limits))
        .collect::<Result<_, Fail>>()?;
    let reused = rows.iter().filter(|r| r.1).count();
    let rows: Vec<Row> = rows.into_iter().map(|r| r.0).collect();
    let page = folder.join("index.html");
    write_beside(&page, |w| w.write_all(index(&rows).as_bytes()))
        .map_err(|e| Fail::io(&page, &e))?;
    if let Some(out) = &args.junit {
        write_beside(out, |w| w.write_all(junit(&rows).as_bytes()))
            .map_err(|e| Fail::io(out, &e))?;
    }
    answer(json, &All { files: &rows, reused }, |w| {
        for r in &rows {
            writeln!(w, "{:10}  {}  {}", r.verdict, r.file, r.why.as_deref().unwrap_or(""))?;
        }
        writeln!(w, "{} files, {reused} taken from the last run; {}", rows.len(), page.display())
    });
    let count = |v: &str| rows.iter().filter(|r| r.verdict == v).count();
    match (count("fail") + count("undecided"), count("unreadable")) {
        (0, 0) => Ok(()),
        (0, n) => Err(Fail::Input(format!("{n} of {} files could not be read", rows.len()))),
        (n, _) => Err(Fail::Check(format!("{n} of {} files fail", rows.len()))),
    }
}

/// Checks one file, or takes the row of an earlier run. Only an output that cannot be written ends
/// the batch.
fn row(
    path: &Path,
    name: &str,
    folder: &Path,
    args: &ThicknessArgs,
    limits: ThicknessLimits,
) -> Result<(Row, bool), Fail> {
    let file = path.display().to_string();
    let unreadable = |why: String| Row {
        key: String::new(),
        file: file.clone(),
        report: None,
        verdict: "unreadable".into(),
        min: None,
        median: None,
        max: None,
        below_percent: None,
        seconds: 0.0,
        why: Some(why),
    };
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(e) => return Ok((unreadable(format!("{file}: {e}")), false)),
    };
    let how = format!("{:?} {limits:?} {}", args.how, env!("CARGO_PKG_VERSION"));
    let key = format!("{:016x}{:016x}", fnv(&bytes), fnv(how.as_bytes()));
    let (kept, report) = (folder.join(format!("{name}.json")), format!("{name}.html"));
    let old = std::fs::read(&kept).ok().and_then(|b| serde_json::from_slice::<Row>(&b).ok());
    if let Some(old) = old.filter(|o| o.key == key && folder.join(&report).is_file()) {
        return Ok((Row { file, ..old }, true));
    }
    let (part, checked) = match one(path, args, limits, &Job::default()) {
        Ok(done) => done,
        Err(Fail::Input(why) | Fail::Permission(why)) => return Ok((unreadable(why), false)),
        Err(e) => return Err(e),
    };
    write_report(&folder.join(&report), path, &part, &checked)?;
    let a = &checked.answer;
    let row = Row {
        key,
        file,
        report: Some(report),
        verdict: match a.verdict {
            Verdict::Pass => "pass",
            Verdict::Warn => "warn",
            Verdict::Fail => "fail",
            Verdict::Unjudged => "unjudged",
            Verdict::Undecided => "undecided",
        }
        .into(),
        min: a.summary.min,
        median: a.summary.median,
        max: a.summary.max,
        below_percent: a.below.map(|b| b.area_percent),
        seconds: a.seconds,
        why: judge(a).err().map(|e| e.to_string()),
    };
    write_beside(&kept, |w| serde_json::to_writer_pretty(w, &row).map_err(std::io::Error::from))
        .map_err(|e| Fail::io(&kept, &e))?;
    Ok((row, false))
}

fn index(rows: &[Row]) -> String {
    let mut out = head("Wall thickness of many parts");
    let count = |v: &str| rows.iter().filter(|r| r.verdict == v).count();
    out.push_str(&format!(
        "<h1>Wall thickness</h1><p class=file>{} parts: {} pass, {} warn, {} fail, {} not judged, \
            {} unreadable</p>\
         <table><thead><tr><th scope=col>Part<th scope=col>Verdict<th scope=col class=n>Minimum, \
         mm<th scope=col class=n>Median, mm\
         <th scope=col class=n>Maximum, mm<th scope=col class=n>Area below, %<th \
         scope=col>Why</thead><tbody>",
        rows.len(),
        count("pass"),
        count("warn"),
        count("fail"),
        count("unjudged"),
        count("unreadable")
    ));
    let n = |v: Option<f32>| v.map_or("–".into(), |v| format!("{v:.4}"));
    for r in rows {
        let name = escape(&r.file);
        let link = r
            .report
            .as_ref()
            .map_or(name.clone(), |l| format!("<a href=\"{}\">{name}</a>", escape(&link(l))));
        out.push_str(&format!(
            "<tr><th scope=row>{link}<td>{}<td class=n>{}<td class=n>{}<td class=n>{}<td \
                class=n>{}<td>{}",
            r.verdict,
            n(r.min),
            n(r.median),
            n(r.max),
            r.below_percent.map_or("–".into(), |p| format!("{p:.3}")),
            escape(r.why.as_deref().unwrap_or(""))
        ));
    }
    out.push_str("</tbody></table></main></body></html>\n");
    out
}

/// The rows as a page for build servers.
pub(super) fn junit(rows: &[Row]) -> String {
    let cases: Vec<TestCase> = rows
        .iter()
        .map(|r| TestCase {
            name: &r.file,
            seconds: r.seconds,
            outcome: match r.verdict.as_str() {
                "fail" | "undecided" => TestOutcome::Failed,
                "unreadable" => TestOutcome::Unreadable,
                _ => TestOutcome::Passed,
            },
            why: r.why.as_deref().unwrap_or(""),
        })
        .collect();
    many_files::junit("wall thickness", "thickness", &cases)
}

impl Row {
    /// A row of a single file, for its JUnit page.
    pub(super) fn single(file: String, verdict: &str, seconds: f64, why: Option<String>) -> Row {
        Row {
            key: String::new(),
            file,
            report: None,
            verdict: verdict.into(),
            min: None,
            median: None,
            max: None,
            below_percent: None,
            seconds,
            why,
        }
    }
}
