//! The picture of the map, drawn from the manifests and from the `use` statements: one box a crate,
//! its modules in it, one arrow a dependency, with the number of files that make it. Dependencies
//! that a chain of arrows implies are not drawn.
//!
//! `SCULPTD_BLESS=1 cargo test --test tidy picture` redraws it.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{CRATES, root, sources};

const FILE: &str = "tests/golden/map/crates.svg";
/// Pixels.
const WIDTH: usize = 900;
const BOX: usize = 700;
const LINE: usize = 20;

/// Returns the number of files of a crate that name another; implied arrows are left out.
fn arrows() -> BTreeMap<(usize, usize), usize> {
    let all = named();
    let implied = |(from, to): (usize, usize)| {
        let between =
            |middle: usize| all.contains_key(&(from, middle)) && all.contains_key(&(middle, to));
        (0..CRATES.len()).any(between)
    };
    all.iter().filter(|(arrow, _)| !implied(**arrow)).map(|(a, n)| (*a, *n)).collect()
}

fn named() -> BTreeMap<(usize, usize), usize> {
    let mut out = BTreeMap::new();
    for (from, (_, dir)) in CRATES.iter().enumerate() {
        for (_, text) in files_of(dir) {
            let code = text.lines().map(|l| l.split("//").next().unwrap_or("")).collect::<String>();
            for (to, (name, _)) in CRATES.iter().enumerate() {
                let named = format!("{}::", name.replace('-', "_"));
                if from != to && *name != "sculptd" && code.contains(&named) {
                    *out.entry((from, to)).or_default() += 1;
                }
            }
        }
    }
    out
}

/// Returns the sources of one crate without those of the members in its folder.
fn files_of(dir: &str) -> Vec<(String, String)> {
    let base = root().join(dir);
    let inner =
        |p: &std::path::Path| p.strip_prefix(&base).expect("under it").display().to_string();
    let member = |p: &str| {
        let first = p.split('/').next().unwrap_or("");
        dir == "src" && (base.join(first).join("Cargo.toml").is_file() || first == "bindings")
    };
    let all = sources(dir).into_iter().map(|(path, text)| (inner(&path), text));
    all.filter(|(p, _)| !member(p) && !p.starts_with("examples/")).collect()
}

/// Names and lines of the top-level modules of a crate.
fn modules(dir: &str) -> BTreeMap<String, usize> {
    let mut out = BTreeMap::new();
    for (path, text) in files_of(dir) {
        let first = path.split('/').next().unwrap_or("").trim_end_matches(".rs");
        if !["lib", "main", "tests", "benches"].contains(&first) {
            *out.entry(first.to_string()).or_default() += text.lines().count();
        }
    }
    out
}

fn draw() -> String {
    let arrows = arrows();
    let mut body = String::new();
    let mut y = 20;
    let mut middle = Vec::new();
    for (name, dir) in CRATES.iter().rev() {
        let modules = modules(dir);
        let words: Vec<&str> = modules.keys().map(String::as_str).collect();
        let mut lines = vec![String::new()];
        for word in words {
            if lines.last().is_some_and(|l| l.len() + word.len() > 88) {
                lines.push(String::new());
            }
            let line = lines.last_mut().expect("never empty");
            if !line.is_empty() {
                line.push_str(", ");
            }
            line.push_str(word);
        }
        let height = LINE * (lines.len() + 2);
        let total: usize = modules.values().sum();
        let thousands = total.div_ceil(1000);
        writeln!(
            body,
            "<rect x=\"20\" y=\"{y}\" width=\"{BOX}\" height=\"{height}\" rx=\"6\" \
             fill=\"#f4efe8\" stroke=\"#6b5b4b\"/>\n\
             <text x=\"34\" y=\"{}\" font-weight=\"bold\">{name}</text>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#6b5b4b\">{dir}, about \
             {thousands},000 \
             lines</text>",
            y + 22,
            BOX + 6,
            y + 22
        )
        .expect("a string takes all");
        for (i, line) in lines.iter().enumerate() {
            let at = y + 22 + LINE * (i + 1);
            writeln!(body, "<text x=\"34\" y=\"{at}\" fill=\"#333\">{line}</text>").expect("text");
        }
        middle.push(y + height / 2);
        y += height + 16;
    }
    middle.reverse();
    // One lane an arrow, so that none hides another; the long ones lie outside.
    let mut lanes: Vec<_> = arrows.iter().collect();
    lanes.sort_by_key(|((from, to), _)| (from.abs_diff(*to), *from));
    for (lane, ((from, to), files)) in lanes.into_iter().enumerate() {
        let x = BOX + 50 + lane * 20;
        let (a, b) = (middle[*from] + 4 * (lane % 5), middle[*to] - 4 * (lane % 5));
        writeln!(
            body,
            "<path d=\"M{} {a} H{x} V{b} H{}\" fill=\"none\" stroke=\"#8a4b2a\" \
             marker-end=\"url(#tip)\"><title>{} names {} in {files} files</title></path>",
            BOX + 20,
            BOX + 26,
            CRATES[*from].0,
            CRATES[*to].0
        )
        .expect("text");
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{y}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<defs><marker id=\"tip\" markerWidth=\"8\" \
         markerHeight=\"8\" refX=\"6\" refY=\"4\" orient=\"auto\"><path d=\"M0 0 L8 4 L0 8 z\" \
         fill=\"#8a4b2a\"/></marker></defs>\n<rect \
         width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         {body}</svg>\n"
    )
}

/// Returns the relevant parts of a picture: boxes, words and arrows, not the counts of lines and
/// files.
fn facts(svg: &str) -> Vec<String> {
    let told =
        |l: &&str| l.contains("<text") && !l.contains("lines</text>") || l.contains("<title>");
    let word = |l: &str| {
        let cut =
            l.split("<title>").nth(1).unwrap_or(l).split(" in ").next().unwrap_or("").to_string();
        cut.split("\">").last().unwrap_or("").to_string()
    };
    svg.lines().filter(told).map(word).collect()
}

#[test]
fn the_picture_of_the_map_is_current() {
    let path = root().join(FILE);
    let now = draw();
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        #[allow(clippy::disallowed_methods)] // Under version control: a torn file is seen.
        std::fs::write(&path, now).expect("written");
        return;
    }
    let then = std::fs::read_to_string(&path).expect("the picture is there");
    assert_eq!(
        facts(&now),
        facts(&then),
        "draw it anew: SCULPTD_BLESS=1 cargo test --test tidy picture"
    );
}
