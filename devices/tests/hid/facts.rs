//! Every descriptor of the corpus, field by field, against what hid-tools reads in it
//! (`hid_tools_facts.py`).

use sculptd_devices::descriptor::Descriptor;
use sculptd_devices::recording::hid_recorder;

const FACTS: &str = include_str!("facts.txt");

/// A vendor's own usages are compared by their page: parsers differ in how they go on when a field
/// has more controls than names.
fn named(usage: u32) -> u32 {
    if usage >= 0xff00_0000 { usage & 0xffff_0000 } else { usage }
}

fn line(name: &str, place: usize, bytes: &[u8]) -> String {
    let Ok(d) = Descriptor::parse(bytes) else { return format!("{name} {place} declined") };
    let mut fields: Vec<(i64, u32, usize, usize, i64, i64)> = d
        .facts
        .iter()
        .map(|f| (f.report_id.map_or(-1, i64::from), named(f.usage), f.start, f.len, f.min, f.max))
        .collect();
    fields.sort_unstable();
    let text: Vec<String> =
        fields.iter().map(|(id, u, s, l, lo, hi)| format!("{id} {u} {s} {l} {lo} {hi}")).collect();
    if std::env::var_os("SCULPTD_FACTS").is_some() {
        text.iter().for_each(|t| println!("{name} {place} {t}"));
    }
    let mut crc = flate2::Crc::new();
    crc.update(text.join("\n").as_bytes());
    format!("{name} {place} {} {} {:08x}", d.input_lengths.len(), fields.len(), crc.sum())
}

#[test]
fn every_descriptor_reads_as_another_parser_reads_it() {
    let Some(corpus) = super::devices() else { return };
    let mut ours = Vec::new();
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        // In the order of the file, as the script goes.
        for (place, r) in text.lines().filter(|l| l.starts_with("R:")).enumerate() {
            let one = hid_recorder::parse(r).unwrap();
            ours.push(line(&name, place, &one.interfaces[0].descriptor));
        }
    }
    let theirs: Vec<&str> = FACTS.lines().collect();
    let known = |l: &String| theirs.contains(&l.as_str());
    let differ: Vec<&String> = ours.iter().filter(|l| !known(l)).collect();
    println!("{} descriptors, {} read alike", ours.len(), ours.len() - differ.len());
    assert!(differ.is_empty(), "{differ:#?}");
    assert!(ours.len() > 100, "the corpus holds more than {} descriptors", ours.len());
}
