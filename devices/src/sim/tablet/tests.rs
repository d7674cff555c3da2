use std::time::Duration;

use crate::catalogue::{Catalogue, Found, Identification};
use crate::clock::Clock;
use crate::hid::reader;
use crate::queue::{Receiver, channel};
use crate::sample::{Body, DeviceId, Pen, Sample, Tool};
use crate::sim::{Faults, PenScript, SimTablet, TabletConfig, journal};
use crate::tablet::Family;

const SOON: Duration = Duration::from_secs(5);

struct TabletSetup {
    tablet: SimTablet,
    handle: reader::ReaderHandle,
    rx: Receiver,
    clock: Clock,
    got: Vec<Sample>,
}

fn setup(found: &Found, config: TabletConfig) -> TabletSetup {
    let (tablet, end) = SimTablet::new(found, script(found), config);
    let (factory, rx) = channel(4096);
    let clock = Clock::manual();
    let handle = reader::start(
        Box::new(end),
        found,
        super::descriptor(found),
        DeviceId(1),
        clock.clone(),
        factory.sender(),
    )
    .unwrap();
    TabletSetup { tablet, handle, rx, clock, got: Vec::new() }
}

fn script(found: &Found) -> PenScript {
    let (journal, a) = (journal(), found.tablet.area);
    journal.pen.fitted(journal.area_mm, glam::vec2(a.width_mm as f32, a.height_mm as f32))
}

impl TabletSetup {
    fn step(&mut self, us: u64) {
        self.clock.set_us(us);
        for _ in 0..self.tablet.advance(us) {
            self.got.push(self.rx.next_within(SOON).expect("the promised sample"));
        }
    }
}

fn pen(s: &Sample) -> Pen {
    let Body::Pen(p) = s.body else { panic!("{s:?}") };
    p
}

fn found(name: &str) -> Found {
    let catalogue = Catalogue::builtin().unwrap();
    let who = super::identity(&catalogue, name).unwrap();
    match catalogue.identify(&who) {
        Identification::Identified(found) => found,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn the_journal_comes_out_as_it_went_in_and_twice_the_same() {
    let run = || {
        let mut setup = setup(&found("Wacom PTK-440"), TabletConfig::default());
        (0..1200).for_each(|i| setup.step(i * 8_000));
        assert_eq!(setup.rx.waiting(), 0);
        let status = setup.handle.status();
        assert_eq!((status.broken, status.samples), (0, setup.got.len() as u64), "{status:?}");
        setup.got
    };
    let got = run();
    assert_eq!(got, run(), "the same bits");
    let script = script(&found("Wacom PTK-440"));
    let (mut worst, mut contacts, mut erased) = (0.0f32, 0, 0);
    for s in &got {
        let p = pen(s);
        if !p.in_range {
            continue;
        }
        contacts += usize::from(p.tip);
        erased += usize::from(p.tip && p.tool == Tool::Eraser);
        let near =
            (0..=8).map(|k| script.at(s.t_us.saturating_sub(1000 * k)).pos_mm.distance(p.pos_mm));
        worst = worst.max(near.fold(f32::INFINITY, f32::min));
    }
    assert!(worst < 0.5 && contacts > 700 && erased > 50, "{worst} {contacts} {erased}");
    let drawn = got.iter().map(pen).find(|p| p.tip && p.pressure > Some(0.6)).unwrap();
    assert!(drawn.tilt.unwrap().distance(glam::vec2(0.3, 0.2)) < 0.02, "{drawn:?}");
}

#[test]
fn an_unplug_ends_the_visit_and_a_bad_line_no_more_than_that() {
    let faults = Faults {
        seed: 2,
        drop: 0.05,
        duplicate: 0.05,
        reorder: 0.05,
        tear: 0.05,
        stall: 0.005,
        ..Faults::default()
    };
    let mut setup = setup(
        &found("Wacom PTK-440"),
        TabletConfig { faults, keeps: 4096, ..TabletConfig::default() },
    );
    (0..110).for_each(|i| setup.step(i * 10_000));
    let status = setup.handle.status();
    assert!(status.broken > 0, "{status:?}");
    assert!(setup.got.iter().map(pen).all(|p| p.in_range || !p.tip));
    assert!(pen(setup.got.last().unwrap()).tip);
    assert_eq!(setup.tablet.unplug(), 1);
    let gone = pen(&setup.rx.next_within(SOON).unwrap());
    assert!(!gone.tip && !gone.in_range);
    assert!(
        setup.rx.next_within(Duration::from_secs(1)).is_none(),
        "the reader has ended, and its sender with it"
    );
    assert!(!setup.handle.status().connected);
}

/// Every model that is known, in every way it shows itself: what its simulator writes, its parser
/// reads.
#[test]
fn every_model_reads_what_it_writes() {
    let catalogue = Catalogue::builtin().unwrap();
    let mut generic = match catalogue.identify(&super::generic_identity()) {
        Identification::Identified(found) => vec![found],
        other => panic!("{other:?}"),
    };
    for tablet in catalogue.tablets() {
        for at in 0..tablet.id.len() {
            // A model that is read by its report descriptor has no counts.
            if tablet.area.max_x > 0 {
                generic.push(Found::new(tablet.clone(), at));
            }
        }
    }
    let (mut families, mut bad) = (std::collections::BTreeMap::<_, u32>::new(), Vec::new());
    for found in &generic {
        let family = found.id().parser;
        *families.entry(family).or_default() += 1;
        if let Err(why) = reads_what_it_writes(found) {
            bad.push(format!("{} ({family:?}): {why}", found.tablet.name));
        }
    }
    println!("{} ways of {} families: {families:?}", generic.len(), families.len());
    assert!(bad.is_empty(), "{} of {}:\n{}", bad.len(), generic.len(), bad.join("\n"));
    assert!(families.len() >= 28);
}

fn reads_what_it_writes(found: &Found) -> Result<(), String> {
    let (script, tablet) = (script(found), &found.tablet);
    let mut encoder = super::Encoder::new(found);
    let mut decoder = super::Decoder::new(found, super::descriptor(found), DeviceId(0));
    let a = tablet.area;
    let count_mm = (a.width_mm / f64::from(a.max_x - a.min_x))
        .max(a.height_mm / f64::from(a.max_y - a.min_y)) as f32;
    let (mut last, mut contacts, mut erased, mut visits) = (None, 0, 0, 0);
    for t in (0..9_500_000).step_by(5_000) {
        let pose = script.at(t);
        let mut got = Vec::new();
        decoder.tick(t, &mut |s| got.push(s));
        for report in encoder.reports(&pose) {
            decoder.feed(&report, t, &mut |s| got.push(s));
        }
        visits += got.iter().filter(|s| !pen(s).in_range).count();
        let Some(s) = got.last() else { continue };
        let p = pen(s);
        last = Some(p);
        if !p.in_range || !pose.in_range {
            continue;
        }
        if p.pos_mm.distance(pose.pos_mm) > 2.0 * count_mm {
            return Err(format!("at {t}: {} for {}", p.pos_mm, pose.pos_mm));
        }
        let felt = p.pressure.unwrap_or(pose.pressure);
        let entering = t < 400_000 || p.tip != pose.tip;
        if !entering && (felt - pose.pressure).abs() > 0.02 && pose.pressure < 0.99 {
            return Err(format!("at {t}: pressure {felt} for {}", pose.pressure));
        }
        contacts += usize::from(p.tip && pose.tip);
        erased += usize::from(p.tip && p.tool == Tool::Eraser && pose.eraser);
        if p.tip && !pose.tip && !got.iter().any(|s| !pen(s).tip) {
            return Err(format!("at {t}: hover presses"));
        }
    }
    let ended = last.is_some_and(|p| !p.in_range && !p.tip);
    let one_ended = matches!(
        found.id().parser,
        Family::Veikk
            | Family::VeikkA15
            | Family::Acepen
            | Family::Kye
            | Family::KyePlain
            | Family::TenMoons
            | Family::Plain
            | Family::RobotPen
            | Family::WoodPad
            | Family::Signature
    );
    // A change of ends begins another visit.
    if contacts < 1000 || visits < if one_ended { 2 } else { 3 } || !ended {
        return Err(format!("{contacts} contacts, {visits} visits, ended {ended}"));
    }
    if erased < 100 && !one_ended {
        return Err(format!("{erased} erasures"));
    }
    Ok(())
}
