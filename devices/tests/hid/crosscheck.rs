//! Every family's parser against every descriptor: generated reports, each contradiction decided.

use std::collections::BTreeMap;

use sculptd_devices::catalogue::{Catalogue, Identification};
use sculptd_devices::hid::crosscheck::{cross_check, decision};
use sculptd_devices::recording::hid_recorder;

#[test]
fn every_parser_agrees_with_every_descriptor() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let (mut sets, mut interfaces, mut compared) = (0, 0, 0);
    let (mut decided, mut undecided) = (BTreeMap::<&str, usize>::new(), Vec::new());
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
                    let line = format!("{name}: {}: {}", found.tablet.name, c.in_words());
                    match decision(&found, &c) {
                        Some(why) => *decided.entry(why).or_default() += 1,
                        None => undecided.push(line),
                    }
                }
            }
        }
    }
    println!("{sets} sets, {interfaces} parsers of interfaces, {compared} statements compared");
    for (why, n) in &decided {
        println!("{n} contradictions decided: {why}");
    }
    assert!(undecided.is_empty(), "{undecided:#?}");
    assert!(sets >= 100 && interfaces >= 70 && compared >= 600, "{interfaces}, {compared}");
}
