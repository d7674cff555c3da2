//! The `use` graph of a crate: which file names which, read from the source text.
//!
//! A module's file is a node. An edge leads from a file to the file that defines what it names,
//! through re-exports. Inline `mod tests` at the end of a file are left out: a test may name what
//! it likes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module's path inside its crate; the crate's root is the empty path.
pub type ModulePath = Vec<String>;

/// The files of one crate and who names whom.
pub struct UseGraph {
    /// Module to file.
    pub files: BTreeMap<ModulePath, PathBuf>,
    /// Module to the modules that it names.
    pub edges: BTreeMap<ModulePath, BTreeSet<ModulePath>>,
}

impl UseGraph {
    /// Reads every Rust file under `root`, a folder with a `lib.rs`, but for the folders named in
    /// `without`.
    pub fn read(root: &Path, without: &[&str]) -> UseGraph {
        let mut files = BTreeMap::new();
        collect(root, &mut Vec::new(), without, &mut files);
        let texts: BTreeMap<&ModulePath, String> = files
            .iter()
            .map(|(module, path)| {
                let text = std::fs::read_to_string(path).expect("a source file is UTF-8");
                (module, code_of(&text))
            })
            .collect();
        let mut exports: BTreeMap<(ModulePath, String), ModulePath> = BTreeMap::new();
        for (module, text) in &texts {
            for (path, public) in uses(text) {
                if public && let Some((target, Some(name))) = resolve(&files, module, &path) {
                    exports.insert(((*module).clone(), name), target);
                }
            }
        }
        let mut edges = BTreeMap::new();
        for (module, text) in &texts {
            let facade = files[*module].ends_with("mod.rs") || module.is_empty();
            let mut named: BTreeSet<ModulePath> = BTreeSet::new();
            let mut paths: Vec<Vec<String>> = uses(text)
                .into_iter()
                .filter(|(_, public)| !(facade && *public))
                .map(|(path, _)| path)
                .collect();
            paths.extend(inline_paths(text));
            for path in paths {
                if let Some((mut target, mut name)) = resolve(&files, module, &path) {
                    while let Some(wanted) = name.take() {
                        match exports.get(&(target.clone(), wanted.clone())) {
                            Some(there) if *there != target => {
                                target = there.clone();
                                name = Some(wanted);
                            }
                            _ => break,
                        }
                    }
                    if target != **module {
                        named.insert(target);
                    }
                }
            }
            edges.insert((*module).clone(), named);
        }
        UseGraph { files, edges }
    }

    /// Circles among the children of every folder: each entry lists the modules of one circle.
    /// Files of the crate's root folder are nodes of their own; a folder below it is one node to
    /// its siblings.
    pub fn circles_between_siblings(&self) -> Vec<Vec<String>> {
        let folders: BTreeSet<ModulePath> = self
            .files
            .keys()
            .filter(|m| !m.is_empty())
            .map(|m| m[..m.len() - 1].to_vec())
            .collect();
        let mut found = Vec::new();
        for folder in folders {
            let depth = folder.len();
            let node = |m: &ModulePath| {
                (m.len() > depth && m.starts_with(&folder)).then(|| m[depth].clone())
            };
            let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
            for (from, targets) in &self.edges {
                let Some(a) = node(from) else { continue };
                let out = graph.entry(a.clone()).or_default();
                out.extend(targets.iter().filter_map(node).filter(|b| *b != a));
            }
            for circle in components(&graph) {
                let place = folder.join("/");
                found.push(circle.iter().map(|m| format!("{place}/{m}")).collect());
            }
        }
        found
    }
}

fn collect(
    dir: &Path,
    at: &mut ModulePath,
    without: &[&str],
    out: &mut BTreeMap<ModulePath, PathBuf>,
) {
    let Ok(entries) = std::fs::read_dir(dir) else { return };
    for path in entries.flatten().map(|e| e.path()) {
        let name = path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            let skipped = without.contains(&name.as_str());
            if !skipped && !["tests", "examples", "benches", "fuzz", "target"].contains(&&*name) {
                at.push(name);
                collect(&path, at, without, out);
                at.pop();
            }
        } else if path.extension().is_some_and(|e| e == "rs") && name != "main" {
            let is_test = name == "tests" || name.ends_with("_tests");
            let mut module = at.clone();
            if name != "mod" && name != "lib" {
                module.push(name);
            }
            if !is_test {
                out.insert(module, path);
            }
        }
    }
}

/// The text without comments and without the inline test modules that end a file.
fn code_of(text: &str) -> String {
    let end = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
    text[..end].lines().map(|l| l.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// Every path of every `use` statement, and whether the statement is public.
fn uses(text: &str) -> Vec<(Vec<String>, bool)> {
    let mut out = Vec::new();
    let mut rest = text;
    let mut before = String::new();
    while let Some(at) = rest.find("use ") {
        before.push_str(&rest[..at]);
        let line = before.rsplit('\n').next().unwrap_or("").trim().to_string();
        rest = &rest[at + 4..];
        let begins = line.is_empty() || line.starts_with("pub");
        if !begins {
            before.push_str("use ");
            continue;
        }
        let Some(end) = rest.find(';') else { break };
        for path in expand(&rest[..end].split_whitespace().collect::<Vec<_>>().join(" ")) {
            out.push((path, line.starts_with("pub")));
        }
        before.clear();
        rest = &rest[end + 1..];
    }
    out
}

/// `a::{b, c::d}` as `a::b` and `a::c::d`; a rename is left out, `self` and `*` stand for the
/// module.
fn expand(tree: &str) -> Vec<Vec<String>> {
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or("").trim();
        let parts = path.split("::").map(str::trim).map(String::from);
        let mut parts: Vec<String> = parts.filter(|p| !p.is_empty()).collect();
        if parts.len() > 1 && parts.last().is_some_and(|p| p == "self" || p == "*") {
            parts.pop();
        }
        return vec![parts];
    };
    let close = tree.rfind('}').unwrap_or(tree.len());
    let (mut depth, mut begin, body) = (0, 0, &tree[open + 1..close]);
    let mut parts = Vec::new();
    for (i, c) in body.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&body[begin..i]);
                begin = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&body[begin..]);
    let prefix = &tree[..open];
    let branches = parts.into_iter().map(str::trim).filter(|p| !p.is_empty());
    branches.flat_map(|p| expand(&format!("{prefix}{p}"))).collect()
}

/// `crate::a::b`, `super::a` and `child::a` outside `use` statements.
fn inline_paths(text: &str) -> Vec<Vec<String>> {
    let mut out = Vec::new();
    for line in text.lines().filter(|l| !l.trim_start().starts_with("use ")) {
        let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        for token in line.split(|c| !word(c)).filter(|t| t.contains("::")) {
            let parts: Vec<String> = token.split("::").map(String::from).collect();
            if parts.len() > 1 && parts.iter().all(|p| !p.is_empty() && !p.contains(':')) {
                out.push(parts);
            }
        }
    }
    out
}

/// The module that a path leads to, and the name in it that is meant.
fn resolve(
    files: &BTreeMap<ModulePath, PathBuf>,
    from: &[String],
    path: &[String],
) -> Option<(ModulePath, Option<String>)> {
    let first = path.first()?;
    let absolute: ModulePath = match first.as_str() {
        "crate" => path[1..].to_vec(),
        "self" => [from, &path[1..]].concat(),
        "super" => {
            let up = path.iter().take_while(|p| *p == "super").count();
            [&from[..from.len().checked_sub(up)?], &path[up..]].concat()
        }
        child => {
            let mut module = from.to_vec();
            module.push(child.to_string());
            files.contains_key(&module).then(|| [from, path].concat())?
        }
    };
    let known = (0..=absolute.len()).rev().find(|n| files.contains_key(&absolute[..*n]))?;
    Some((absolute[..known].to_vec(), absolute.get(known).cloned()))
}

/// Strongly connected components of two nodes or more (Tarjan 1972).
fn components(graph: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    struct Search<'a> {
        graph: &'a BTreeMap<String, BTreeSet<String>>,
        index: BTreeMap<&'a str, usize>,
        low: BTreeMap<&'a str, usize>,
        stack: Vec<&'a str>,
        found: Vec<Vec<String>>,
    }
    impl<'a> Search<'a> {
        fn visit(&mut self, v: &'a str) {
            let number = self.index.len();
            self.index.insert(v, number);
            self.low.insert(v, number);
            self.stack.push(v);
            for w in self.graph.get(v).into_iter().flatten() {
                if !self.index.contains_key(w.as_str()) {
                    self.visit(w);
                    self.low.insert(v, self.low[v].min(self.low[w.as_str()]));
                } else if self.stack.contains(&w.as_str()) {
                    self.low.insert(v, self.low[v].min(self.index[w.as_str()]));
                }
            }
            if self.low[v] == self.index[v] {
                let at = self.stack.iter().position(|s| *s == v).expect("it was pushed");
                let circle: Vec<String> = self.stack.drain(at..).map(String::from).collect();
                if circle.len() > 1 {
                    self.found.push(circle);
                }
            }
        }
    }
    let mut search = Search {
        graph,
        index: BTreeMap::new(),
        low: BTreeMap::new(),
        stack: Vec::new(),
        found: Vec::new(),
    };
    for v in graph.keys() {
        if !search.index.contains_key(v.as_str()) {
            search.visit(v);
        }
    }
    search.found
}

#[test]
fn a_circle_is_found_and_a_chain_is_not() {
    let of = |pairs: &[(&str, &str)]| {
        let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (a, b) in pairs {
            graph.entry((*a).into()).or_default().insert((*b).into());
            graph.entry((*b).into()).or_default();
        }
        components(&graph)
    };
    assert!(of(&[("a", "b"), ("b", "c"), ("a", "c")]).is_empty());
    assert_eq!(of(&[("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")]).len(), 1);
    assert_eq!(expand("crate::a::{b, c::{d, self}}").len(), 3);
    assert_eq!(uses("pub use a::B;\nuse crate::c::{D, e as F};\n").len(), 3);
}
