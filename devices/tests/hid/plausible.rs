//! Every real recording with pressure: only what the person pressed is saturated, and no size
//! contradicts the descriptor or the catalogue.
//!
//! The criteria for a hard press and a wrong maximum: [`sculptd_devices::pressure_use`].

use std::collections::BTreeSet;
use std::path::Path;

use sculptd_devices::catalogue::{Catalogue, Identification};
use sculptd_devices::descriptor::Descriptor;
use sculptd_devices::pressure_use::{PressureUse, Saturation};
use sculptd_devices::recording::{Player, hid_recorder};
use sculptd_devices::tablet::Tablet;
use sculptd_devices::{Body, DeviceId};

#[test]
fn nothing_is_saturated_but_what_the_person_pressed() {
    let Some(corpus) = super::devices() else { return };
    let catalogue = Catalogue::builtin().unwrap();
    let mut wrong = Vec::new();
    let (mut compared, mut hard, mut contradicted) = (0, 0, 0);
    for path in super::files(&corpus.join("hid"), ".hid") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(mut player) = Player::open(&path, DeviceId(0), &catalogue) else { continue };
        player.advance(u64::MAX / 2, &mut |_| {});
        let used = player.pressure_use();
        let Some(words) = used.in_words() else { continue };
        compared += 1;
        hard += u32::from(used.saturation() == Saturation::Pressed);
        println!("{name:45} {words}");
        if !matches!(used.saturation(), Saturation::Usual | Saturation::Pressed) {
            wrong.push(format!("{name}: {words}"));
        }
        // Read with half of the maximum, the same counts contradict it.
        if used.highest > used.maximum / 2 + used.maximum / 4 {
            let halved = halved(&path, &catalogue, used.maximum / 2);
            assert_eq!(halved.saturation(), Saturation::MaximumTooLow, "{name}: {halved:?}");
            contradicted += 1;
        }
    }
    println!("{compared} recordings with contacts and pressure, {hard} pressed as hard as can be");
    println!("{contradicted} of them contradict half of their maximum");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(compared >= 25 && contradicted >= 15);
}

/// The same reports against another maximum.
fn halved(path: &Path, catalogue: &Catalogue, maximum: u32) -> PressureUse {
    let mut player = Player::open(path, DeviceId(0), catalogue).unwrap();
    let full = {
        player.advance(u64::MAX / 2, &mut |_| {});
        player.pressure_use().maximum
    };
    let mut again = Player::open(path, DeviceId(0), catalogue).unwrap();
    let mut used = PressureUse::default();
    again.advance(u64::MAX / 2, &mut |s| {
        if let Body::Pen(p) = s.body {
            let counts = p.pressure.map(|p| (f64::from(p) * f64::from(full)).round() as u32);
            used.take(counts, p.tip, maximum);
        }
    });
    used
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
