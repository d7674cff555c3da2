//! Every family's parser against every descriptor: generated reports, each contradiction decided.

use std::collections::BTreeMap;

use sculptd_devices::catalogue::{Catalogue, Identification};
use sculptd_devices::hid::crosscheck::{Statement, cross_check};
use sculptd_devices::recording::hid_recorder;

#[test]
fn every_parser_agrees_with_every_descriptor() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let (mut sets, mut interfaces, mut compared) = (0, 0, 0);
    let mut found_all: BTreeMap<(String, Statement), Vec<String>> = BTreeMap::new();
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        sets += 1;
        let Ok(recording) = hid_recorder::parse(&text) else { continue };
        for who in recording.interfaces {
            let found = match catalogue.identify(&who) {
                Identification::Identified(found) => vec![found],
                Identification::Ambiguous(many) => many,
                Identification::Declined(_) => continue,
            };
            for found in found {
                let check = cross_check(&found, &who.descriptor);
                interfaces += u32::from(check.compared > 0);
                compared += check.compared;
                for c in check.contradictions {
                    let key = (found.id().parser.name(), c.statement);
                    let line = format!("{name}: {}: {}", found.tablet.name, c.in_words());
                    found_all.entry(key).or_default().push(line);
                }
            }
        }
    }
    println!("{sets} sets, {interfaces} parsers of interfaces, {compared} statements compared");
    for ((family, statement), lines) in &found_all {
        println!("{family} {statement:?}: {}", lines.len());
        for line in lines.iter().take(6) {
            println!("    {line}");
        }
    }
}
