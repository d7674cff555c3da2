//! Many parts: a row and a report each, one table of all, resumed where it was interrupted, and
//! split over machines. Rows are files of their own, written at once or not at all, so that shards
//! may share a folder.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use sculptd_check::{CheckAnswer, CheckSettings, Severity};
use sculptd_geometry::io::write_beside;
use sculptd_geometry::thickness::report::{escape, fnv, head};
use serde::{Deserialize, Serialize};

use super::{CheckArgs, one, why, write_report};
use crate::many_files::{TestCase, TestOutcome, junit, link, names};
use crate::{Fail, Outcome, answer};

/// Endings of mesh files that are taken from a folder.
const ENDINGS: [&str; 7] = ["3mf", "glb", "gltf", "obj", "off", "ply", "stl"];
/// The ending of a row's file.
const ROW: &str = "row.json";

/// One part's outcome, kept as `NAME.row.json` in the folder.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct PartRow {
    /// Changes with the file's bytes, the settings and the program: an older row with the same key
    /// is kept.
    key: String,
    file: String,
    /// The report's file name, in the same folder.
    report: Option<String>,
    /// `pass`, `warn`, `fail` or `unreadable`.
    verdict: String,
    errors: usize,
    warnings: usize,
    volume: Option<f64>,
    weight: Option<f64>,
    support: Option<f64>,
    height: Option<f64>,
    seconds: f64,
    /// The reason why it failed, or could not be read.
    why: String,
}

#[derive(Debug, Serialize)]
struct BatchAnswer<'a> {
    ok: bool,
    parts: &'a [PartRow],
    reused: usize,
}

pub(super) fn run(args: &CheckArgs, settings: &CheckSettings, json: bool) -> Outcome {
    let Some(folder) = args.out.as_deref() else { return Ok(()) };
    if args.report.is_some() || args.orient.is_some() {
        return Err(Fail::Usage(
            "--report and --orient are for a single part; a batch writes into --out".into(),
        ));
    }
    std::fs::create_dir_all(folder).map_err(|e| Fail::io(folder, &e))?;
    let mut reused = 0;
    if !args.merge {
        let files = listed(&args.parts)?;
        let names = names(&files);
        let (first, step) = args.shard.unwrap_or((1, 1));
        let own: Vec<(&PathBuf, &String)> =
            files.iter().zip(&names).skip(first - 1).step_by(step).collect();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(args.jobs.unwrap_or(0))
            .build()
            .map_err(|e| Fail::Usage(format!("--jobs: {e}")))?;
        let kept: Vec<bool> = pool.install(|| {
            own.par_iter()
                .map(|(path, name)| row(path, name, folder, args, settings))
                .collect::<Result<_, Fail>>()
        })?;
        reused = kept.into_iter().filter(|k| *k).count();
    }
    let rows = all_rows(folder)?;
    write_tables(folder, &rows)?;
    if let Some(out) = &args.junit {
        let page = junit_page(&rows);
        write_beside(out, |w| w.write_all(page.as_bytes())).map_err(|e| Fail::io(out, &e))?;
    }
    let count = |v: &str| rows.iter().filter(|r| r.verdict == v).count();
    let (failed, unreadable) = (count("fail"), count("unreadable"));
    let out = BatchAnswer { ok: failed + unreadable == 0, parts: &rows, reused };
    answer(json, &out, |w| {
        for r in &rows {
            writeln!(w, "{:10}  {}  {}", r.verdict, r.file, r.why)?;
        }
        let page = folder.join("index.html");
        writeln!(w, "{} parts, {reused} taken from the last run; {}", rows.len(), page.display())
    });
    match (failed, unreadable) {
        (0, 0) => Ok(()),
        (0, n) => Err(Fail::Input(format!("{n} of {} parts could not be read", rows.len()))),
        (n, _) => Err(Fail::Check(format!("{n} of {} parts are not ready", rows.len()))),
    }
}

/// The files that were named, and the mesh files in the folders that were, by name.
fn listed(parts: &[PathBuf]) -> Result<Vec<PathBuf>, Fail> {
    let mut out = Vec::new();
    for part in parts {
        if !part.is_dir() {
            out.push(part.clone());
            continue;
        }
        let entries = std::fs::read_dir(part).map_err(|e| Fail::io(part, &e))?;
        let mut own: Vec<PathBuf> = Vec::new();
        for entry in entries {
            let path = entry.map_err(|e| Fail::io(part, &e))?.path();
            let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
            if ending.is_some_and(|e| ENDINGS.contains(&e.as_str())) && path.is_file() {
                own.push(path);
            }
        }
        own.sort();
        out.extend(own);
    }
    if out.is_empty() {
        return Err(Fail::Input("no mesh file was found".into()));
    }
    Ok(out)
}

/// Checks one part, or keeps the row of an earlier run; returns whether it was kept. Only an output
/// that cannot be written ends the batch.
fn row(
    path: &Path,
    name: &str,
    folder: &Path,
    args: &CheckArgs,
    settings: &CheckSettings,
) -> Result<bool, Fail> {
    let file = path.display().to_string();
    let (at, report) = (folder.join(format!("{name}.{ROW}")), format!("{name}.html"));
    let write = |row: &PartRow| {
        write_beside(&at, |w| serde_json::to_writer_pretty(w, row).map_err(std::io::Error::from))
            .map_err(|e| Fail::io(&at, &e))
    };
    let unreadable = |why: String| PartRow {
        key: String::new(),
        file: file.clone(),
        report: None,
        verdict: "unreadable".into(),
        errors: 0,
        warnings: 0,
        volume: None,
        weight: None,
        support: None,
        height: None,
        seconds: 0.0,
        why,
    };
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(e) => return write(&unreadable(format!("{file}: {e}"))).map(|()| false),
    };
    let how = format!("{:?} {settings:?} {}", args.how.unit, env!("CARGO_PKG_VERSION"));
    let key = format!("{:016x}{:016x}", fnv(&bytes), fnv(how.as_bytes()));
    let old = std::fs::read(&at).ok().and_then(|b| serde_json::from_slice::<PartRow>(&b).ok());
    if old.is_some_and(|o| o.key == key && o.file == file && folder.join(&report).is_file()) {
        return Ok(true);
    }
    let done = match one(path, &args.how, settings, false) {
        Ok(done) => done,
        Err(Fail::Input(why) | Fail::Permission(why)) => {
            return write(&unreadable(why)).map(|()| false);
        }
        Err(e) => return Err(e),
    };
    write_report(&folder.join(&report), &done, settings)?;
    let a = &done.checked.answer;
    let count = |s: Severity| a.findings.iter().filter(|f| f.severity == s).count();
    write(&PartRow {
        key,
        file,
        report: Some(report),
        verdict: verdict(a).into(),
        errors: count(Severity::Error),
        warnings: count(Severity::Warning),
        volume: a.facts.volume,
        weight: a.facts.weight,
        support: a.facts.support_volume,
        height: a.facts.size.map(|s| s[2]),
        seconds: a.seconds,
        why: why(a),
    })?;
    Ok(false)
}

fn verdict(a: &CheckAnswer) -> &'static str {
    match (a.ok, a.findings.is_empty()) {
        (false, _) => "fail",
        (true, true) => "pass",
        (true, false) => "warn",
    }
}

/// All rows of a folder, by file.
fn all_rows(folder: &Path) -> Result<Vec<PartRow>, Fail> {
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| Fail::io(folder, &e))? {
        let path = entry.map_err(|e| Fail::io(folder, &e))?.path();
        if !path.to_string_lossy().ends_with(ROW) {
            continue;
        }
        let bytes = std::fs::read(&path).map_err(|e| Fail::io(&path, &e))?;
        let row: PartRow = serde_json::from_slice(&bytes)
            .map_err(|e| Fail::Input(format!("{}: {e}", path.display())))?;
        out.push(row);
    }
    if out.is_empty() {
        return Err(Fail::Input(format!("{}: no rows of a batch", folder.display())));
    }
    out.sort_by(|a, b| a.file.cmp(&b.file));
    Ok(out)
}

/// `index.html`, `results.csv` and `results.jsonl`.
fn write_tables(folder: &Path, rows: &[PartRow]) -> Outcome {
    let mut lines = Vec::new();
    for r in rows {
        serde_json::to_writer(&mut lines, r).map_err(|e| Fail::Input(e.to_string()))?;
        lines.push(b'\n');
    }
    let tables = [
        ("index.html", page(rows).into_bytes()),
        ("results.csv", csv(rows).into_bytes()),
        ("results.jsonl", lines),
    ];
    for (name, bytes) in tables {
        let path = folder.join(name);
        write_beside(&path, |w| w.write_all(&bytes)).map_err(|e| Fail::io(&path, &e))?;
    }
    Ok(())
}

/// Sorts the table by the column that is clicked.
const SORT: &str = "<script>document.querySelectorAll('th[scope=col]').forEach((h,i)=>{let \
    up=1;h.style.cursor='pointer';h.onclick=()=>{const \
    b=h.closest('table').tBodies[0];[...b.rows].sort((x,y)=>{const \
    p=x.cells[i].dataset.v??x.cells[i].textContent,q=y.cells[i].dataset.v??\
    y.cells[i].textContent;return up*(isNaN(p)||isNaN(q)?p.localeCompare(q):p-q)}).forEach(r=>\
    b.append(r));up=-up}})</script>";

fn page(rows: &[PartRow]) -> String {
    let mut out = head("Check of many parts");
    let count = |v: &str| rows.iter().filter(|r| r.verdict == v).count();
    out.push_str(&format!(
        "<h1>Check</h1><p class=file>{} parts: {} pass, {} with warnings, {} fail, {} \
         unreadable. Click a heading to sort.</p><table><thead><tr><th scope=col>Part<th \
         scope=col>Verdict<th scope=col class=n>Errors<th scope=col class=n>Warnings<th scope=col \
         class=n>Volume, mm³<th scope=col class=n>Weight, g<th scope=col class=n>Support, mm³<th \
         scope=col class=n>Height, mm<th scope=col>Why</thead><tbody>",
        rows.len(),
        count("pass"),
        count("warn"),
        count("fail"),
        count("unreadable")
    ));
    let n = |v: Option<f64>| match v {
        Some(v) => format!("<td class=n data-v=\"{v}\">{v:.2}"),
        None => "<td class=n data-v=\"-1\">–".into(),
    };
    for r in rows {
        let name = escape(&r.file);
        let link = r
            .report
            .as_ref()
            .map_or(name.clone(), |l| format!("<a href=\"{}\">{name}</a>", escape(&link(l))));
        out.push_str(&format!(
            "<tr><th scope=row>{link}<td>{}<td class=n>{}<td class=n>{}{}{}{}{}<td>{}",
            escape(&r.verdict),
            r.errors,
            r.warnings,
            n(r.volume),
            n(r.weight),
            n(r.support),
            n(r.height),
            escape(&r.why)
        ));
    }
    out.push_str(&format!("</tbody></table></main>{SORT}</body></html>\n"));
    out
}

fn csv(rows: &[PartRow]) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let n = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
    let mut out = String::from(
        "file,verdict,errors,warnings,volume_mm3,weight_g,support_mm3,height_mm,why\n",
    );
    for r in rows {
        out.push_str(&format!(
            "{},{},{},{},{},{},{},{},{}\n",
            quoted(&r.file),
            r.verdict,
            r.errors,
            r.warnings,
            n(r.volume),
            n(r.weight),
            n(r.support),
            n(r.height),
            quoted(&r.why)
        ));
    }
    out
}

fn junit_page(rows: &[PartRow]) -> String {
    let cases: Vec<TestCase> = rows
        .iter()
        .map(|r| TestCase {
            name: &r.file,
            seconds: r.seconds,
            outcome: match r.verdict.as_str() {
                "fail" => TestOutcome::Failed,
                "unreadable" => TestOutcome::Unreadable,
                _ => TestOutcome::Passed,
            },
            why: &r.why,
        })
        .collect();
    junit("check", "check", &cases)
}
