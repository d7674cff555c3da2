//! The relationships between the parts of a package (Open Packaging Conventions, ECMA-376 part 2),
//! and what the 3MF core specification, chapter 2, asks of them.

use std::collections::{BTreeMap, BTreeSet};

use quick_xml::Reader;
use quick_xml::events::Event;

use super::{ParseError, bad, get};
use crate::io::problem::FilePlace;

/// The parts of a package by their names in lower case: names differ by more than case.
#[derive(Debug)]
pub(super) struct PartNames(BTreeMap<String, String>);

impl PartNames {
    pub(super) fn new<'a>(names: impl Iterator<Item = &'a str>) -> PartNames {
        let plain = |name: &str| (name.trim_start_matches('/').to_lowercase(), name.to_owned());
        PartNames(names.map(plain).collect())
    }

    /// Returns the name of a part as the package has it.
    pub(super) fn find(&self, name: &str) -> Option<&str> {
        let plain = name.trim_start_matches('/').to_lowercase();
        let found = self.0.get(&plain).or_else(|| self.0.get(&unescaped(&plain)));
        found.map(String::as_str)
    }
}

/// A name without percent signs (RFC 3986).
fn unescaped(name: &str) -> String {
    let (mut out, mut rest) = (Vec::new(), name.as_bytes());
    while let [first, after @ ..] = rest {
        let digits = after.get(..2).and_then(|d| std::str::from_utf8(d).ok());
        match digits.filter(|_| *first == b'%').and_then(|d| u8::from_str_radix(d, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                rest = &after[2..];
            }
            None => {
                out.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// The end of a relationship's type, and its target.
#[derive(Debug)]
struct Relationship {
    kind: String,
    target: String,
}

/// Kinds whose target the package must hold.
const HELD: [&str; 4] = ["3dmodel", "printticket", "thumbnail", "3dtexture"];

fn read(text: &[u8], file: &str) -> Result<Vec<Relationship>, ParseError> {
    let text = String::from_utf8_lossy(text);
    let mut reader = Reader::from_str(&text);
    let (mut all, mut ids) = (Vec::new(), BTreeSet::new());
    loop {
        let event = reader.read_event().map_err(|e| {
            bad(FilePlace::File, format!("well-formed XML in {file}"), e.to_string())
        })?;
        let e = match event {
            Event::Empty(e) | Event::Start(e) if e.local_name().as_ref() == "Relationship" => e,
            Event::Eof => return Ok(all),
            _ => continue,
        };
        if let Some(id) = get(&e, "Id")
            && !ids.insert(id.clone())
        {
            return Err(bad(FilePlace::File, format!("each Id once in {file}"), id));
        }
        let kind = get(&e, "Type").unwrap_or_default();
        let kind = kind.rsplit('/').next().unwrap_or_default().to_owned();
        if let Some(target) = get(&e, "Target") {
            all.push(Relationship { kind, target });
        }
    }
}

/// Checks the relationships of a part in the folder `folder` of the package (`""`: the package's
/// own), and returns the name of the model that they name.
///
/// # Errors
/// Names the file and the target.
pub(super) fn check(
    text: &[u8],
    (file, folder): (&str, &str),
    parts: &PartNames,
) -> Result<Option<String>, ParseError> {
    let all = read(text, file)?;
    // A part of the production extension names many models.
    let single: &[&str] =
        if folder.is_empty() { &["3dmodel", "printticket"] } else { &["printticket"] };
    for kind in single {
        let found = all.iter().filter(|r| r.kind == *kind).count();
        if found > 1 {
            let expected = format!("at most one relationship to a {kind} in {file}");
            return Err(bad(FilePlace::File, expected, found.to_string()));
        }
    }
    let mut model = None;
    for relationship in all.iter().filter(|r| HELD.contains(&r.kind.as_str())) {
        let target = &relationship.target;
        let absolute = match target.starts_with('/') || folder.is_empty() {
            true => target.clone(),
            false => format!("{folder}/{target}"),
        };
        let part = parts.find(&absolute).ok_or_else(|| {
            let expected = format!("the targets in {file} among the package's parts");
            bad(FilePlace::File, expected, format!("no part {target}"))
        })?;
        if relationship.kind == "3dmodel" {
            model = Some(part.to_owned());
        }
    }
    Ok(model)
}
