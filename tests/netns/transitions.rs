//! Prints the contents of a session file by device: `transitions FILE`. One line of JSON: samples,
//! and samples that did more than move, by the device's number. A person of a shared sculpture has
//! the numbers from 256 times the person's number.

#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;

fn main() {
    let path = std::env::args().nth(1).expect("a session's file");
    let opened = sculptd_daemon::session::open(path.as_ref()).expect("a session");
    let mut last = BTreeMap::new();
    let mut counts: BTreeMap<u16, [u64; 2]> = BTreeMap::new();
    // As they are shared: what differs by less than a rounding is no transition.
    let rounded = |tick: &sculptd_daemon::session::format::TickInput| -> Vec<_> {
        tick.samples.iter().filter_map(sculptd_network::wire::samples::rounded).collect()
    };
    for sample in opened.input.iter().flat_map(rounded) {
        let moved = last.get(&sample.device).is_some_and(|l| sample.only_moved_since(l));
        let count = counts.entry(sample.device.0).or_default();
        count[0] += 1;
        count[1] += u64::from(!moved);
        last.insert(sample.device, sample);
    }
    let of = |(device, [samples, transitions]): (&u16, &[u64; 2])| {
        format!("\"{device}\":{{\"samples\":{samples},\"transitions\":{transitions}}}")
    };
    println!("{{{}}}", counts.iter().map(of).collect::<Vec<_>>().join(","));
}
