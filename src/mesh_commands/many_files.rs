//! What batches over many files share: names of their rows and reports, links, and the page for
//! build servers.

use std::path::PathBuf;

use sculptd_geometry::thickness::report::escape;

/// Returns a name for each file's row and report: the file's name, numbered if several share it.
pub(super) fn names(paths: &[PathBuf]) -> Vec<String> {
    let mut taken = std::collections::BTreeSet::new();
    paths
        .iter()
        .map(|p| {
            let stem =
                p.file_name().map_or_else(|| "mesh".into(), |s| s.to_string_lossy().into_owned());
            let mut name = stem.clone();
            let mut n = 2;
            while !taken.insert(name.to_lowercase()) {
                name = format!("{stem}-{n}");
                n += 1;
            }
            name
        })
        .collect()
}

/// A file name as a relative URL.
pub(super) fn link(name: &str) -> String {
    let mut out = String::from("./");
    for b in name.bytes() {
        if b.is_ascii_alphanumeric() || b"-._~".contains(&b) {
            out.push(b as char);
        } else {
            out.push_str(&format!("%{b:02X}"));
        }
    }
    out
}

/// One file for a build server.
#[derive(Debug, Clone, Copy)]
pub(super) struct TestCase<'a> {
    pub name: &'a str,
    pub seconds: f64,
    pub outcome: TestOutcome,
    /// Why it failed or could not be read.
    pub why: &'a str,
}

/// Fate of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TestOutcome {
    Passed,
    Failed,
    Unreadable,
}

/// JUnit's XML, as build servers read it: a file that fails is a failure, one that cannot be read
/// an error.
pub(super) fn junit(suite: &str, class: &str, cases: &[TestCase<'_>]) -> String {
    let count = |o: TestOutcome| cases.iter().filter(|c| c.outcome == o).count();
    let seconds: f64 = cases.iter().map(|c| c.seconds).sum();
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites><testsuite name=\"{}\" \
         tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{seconds:.3}\">\n",
        escape(suite),
        cases.len(),
        count(TestOutcome::Failed),
        count(TestOutcome::Unreadable)
    );
    for c in cases {
        out.push_str(&format!(
            "<testcase classname=\"{}\" name=\"{}\" time=\"{:.3}\">",
            escape(class),
            escape(c.name),
            c.seconds
        ));
        let why = escape(c.why);
        match c.outcome {
            TestOutcome::Failed => out.push_str(&format!("<failure message=\"{why}\"/>")),
            TestOutcome::Unreadable => out.push_str(&format!("<error message=\"{why}\"/>")),
            TestOutcome::Passed => {}
        }
        out.push_str("</testcase>\n");
    }
    out.push_str("</testsuite></testsuites>\n");
    out
}
