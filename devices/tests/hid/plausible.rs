//! Every real recording with pressure: nothing is saturated but what the person pressed, and no
//! size contradicts the descriptor or the catalogue.
//!
//! **How a hard press is told from a wrong maximum.** A pen that is pressed as hard as it can be
//! sends its own highest count, again and again: the highest count of the recording is the maximum
//! that the decoder uses, and no count lies above it. A wrong maximum lies below counts that the
//! pen sends: [`Counts::outside`] counts those, and a full pressure at several different counts
//! shows it, too.
//!
//! [`Counts::outside`]: sculptd_devices::hid::decoder::Counts::outside

use std::collections::BTreeSet;

use sculptd_devices::catalogue::{Catalogue, Identification};
use sculptd_devices::descriptor::Descriptor;
use sculptd_devices::hid::decoder::Decoder;
use sculptd_devices::recording::{Player, hid_recorder};
use sculptd_devices::tablet::Tablet;
use sculptd_devices::{Body, DeviceId};

#[test]
fn nothing_is_saturated_but_what_the_person_pressed() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let mut compared = 0;
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(mut player) = Player::open(&path, DeviceId(0), &catalogue) else { continue };
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let recording = hid_recorder::parse(&text).unwrap();
        let (mut contacts, mut full) = (0u32, 0u32);
        player.advance(u64::MAX / 2, &mut |s| {
            if let Body::Pen(p) = s.body
                && p.tip
                && p.pressure.is_some()
            {
                contacts += 1;
                full += u32::from(p.pressure == Some(1.0));
            }
        });
        if contacts == 0 {
            continue;
        }
        compared += 1;
        // What the decoders met outside their ranges, by interface.
        let (mut outside, mut placed) = (0, 0);
        for (i, who) in recording.interfaces.iter().enumerate() {
            let found = match catalogue.identify(who) {
                Identification::Identified(found) => found,
                Identification::Ambiguous(many) => {
                    let by_name = many.iter().find(|f| f.tablet.name == player.device().name);
                    by_name.unwrap_or(&many[0]).clone()
                }
                Identification::Declined(_) => continue,
            };
            let mut decoder = Decoder::new(&found, &who.descriptor, DeviceId(0));
            for report in recording.reports.iter().filter(|r| r.interface == i) {
                decoder.feed(&report.bytes, report.t_us, &mut |_| {});
            }
            outside += decoder.counts().outside;
            placed += decoder.counts().placed;
        }
        println!(
            "{name:45} {contacts:5} contacts {full:5} at the pen's own maximum {outside:4} outside"
        );
        assert!(outside * 100 <= placed, "{name}: {outside} of {placed} outside its ranges");
    }
    println!("{compared} recordings with contacts and pressure");
    assert!(compared >= 25);
}

/// A tablet that is read by its descriptor may have the name of a model without being it.
fn same(known: &Tablet, found: &Tablet) -> bool {
    known.name == found.name && known.source == found.source
}

#[test]
fn no_size_is_nonsense_or_contradicts_the_catalogue() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let (mut sizes, mut seen) = (0, BTreeSet::new());
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        for who in hid_recorder::parse(&text).unwrap().interfaces {
            let Identification::Identified(found) = catalogue.identify(&who) else { continue };
            let a = found.tablet.area;
            let at =
                format!("{name}: {} is {} x {} mm", found.tablet.name, a.width_mm, a.height_mm);
            assert!(a.width_mm.hypot(a.height_mm) >= 60.0, "{at}");
            assert!(a.width_mm.max(a.height_mm) <= 720.0, "{at}");
            assert!((a.width_mm - a.height_mm).abs() > 1.0, "{at}: square");
            let aspect = a.width_mm / a.height_mm;
            // UC-Logic's counts are square wherever the axes have ranges of their own. A model's
            // file knows better: a G430 of 4 by 3 inches counts as one of 9 by 5.75 does.
            if matches!(who.vid, 0x5543 | 0x256c | 0x28bd)
                && found.tablet.source == "the device itself"
                && let Ok(d) = Descriptor::parse(&who.descriptor)
                && let Some(pen) = d.pens.iter().find(|p| !p.as_mouse && p.pressure.is_some())
                && let (Some(x), Some(y)) = (&pen.x, &pen.y)
                && x.max != y.max
                && x.max & (x.max + 1) != 0
            {
                let counts = f64::from(x.max - x.min) / f64::from(y.max - y.min);
                assert!((counts / aspect - 1.0).abs() < 0.13, "{at}: counts are {counts:.2} to 1");
            }
            let own = |t: &&std::sync::Arc<Tablet>| same(t, &found.tablet);
            let of_catalogue = catalogue.tablets().iter().find(own);
            if let Some(known) = of_catalogue.filter(|t| !t.area.nominal) {
                let off = |a: f64, b: f64| (a - b).abs() > 0.12 * b;
                let k = known.area;
                assert!(!off(a.width_mm, k.width_mm) && !off(a.height_mm, k.height_mm), "{at}");
            }
            seen.insert(found.tablet.name.clone());
            sizes += 1;
        }
    }
    println!("{sizes} interfaces of {} models have plausible sizes", seen.len());
}
