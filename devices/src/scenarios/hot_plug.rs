//! Hot-plug on a bus of simulated tablets.

use std::io;
use std::sync::{Arc, Mutex};

use super::until;
use crate::catalogue::Identification;
use crate::catalogue::{Catalogue, Identity};
use crate::clock::Clock;
use crate::hid::bus::{Bus, Node};
use crate::hid::transport::Transport;
use crate::hid::watch::{HidConfig, HidHandle, choose, start_on};
use crate::queue::channel;
use crate::sample::{Body, Sample};
use crate::sim::{SimTablet, TabletConfig, TabletEnd, journal, tablet};

type Sockets = Arc<Mutex<Vec<(Node, Option<io::Result<TabletEnd>>)>>>;

/// Sockets that a test plugs things into.
#[derive(Default, Clone)]
struct Sim(Sockets);

impl Bus for Sim {
    fn nodes(&mut self) -> io::Result<Vec<Node>> {
        Ok(self.0.lock().unwrap().iter().map(|s| s.0.clone()).collect())
    }

    fn open(&mut self, node: &Node) -> io::Result<Box<dyn Transport>> {
        let mut sockets = self.0.lock().unwrap();
        let socket = sockets.iter_mut().find(|s| s.0.path == node.path);
        match socket.and_then(|s| s.1.take()) {
            Some(end) => Ok(Box::new(end?)),
            None => Err(io::ErrorKind::PermissionDenied.into()),
        }
    }
}

impl Sim {
    fn plug(&self, path: &str, model: &str, serial: &str) -> SimTablet {
        let catalogue = Catalogue::builtin().unwrap();
        let who = tablet::identity(&catalogue, model).unwrap();
        let Identification::Identified(found) = catalogue.identify(&who) else { panic!("{model}") };
        let (journal, a) = (journal(), found.tablet.area);
        let script =
            journal.pen.fitted(journal.area_mm, glam::vec2(a.width_mm as f32, a.height_mm as f32));
        let (tablet, end) = SimTablet::new(&found, script, TabletConfig::default());
        let node = Node { path: path.into(), serial: serial.into(), who, may_be_pen: true };
        self.0.lock().unwrap().push((node, Some(Ok(end))));
        tablet
    }

    fn pull(&self, path: &str) {
        self.0.lock().unwrap().retain(|s| s.0.path != path);
    }
}

fn watching(bus: &Sim, config: HidConfig) -> (HidHandle, crate::queue::Receiver) {
    let (factory, rx) = channel(4096);
    let catalogue = Catalogue::builtin().unwrap();
    (start_on(Box::new(bus.clone()), config, catalogue, Clock::manual(), factory).unwrap(), rx)
}

fn drain(rx: &mut crate::queue::Receiver) -> Vec<Sample> {
    let mut out = Vec::new();
    while rx.drain(1024, &mut out) > 0 {}
    out
}

#[test]
fn a_replug_needs_nothing_and_ends_what_was_pressed() {
    let bus = Sim::default();
    let (handle, mut rx) = watching(&bus, HidConfig::default());
    let mut first = bus.plug("/dev/hidraw0", "Wacom PTK-440", "A1");
    until("it is read", || handle.status().first().is_some_and(|s| s.usable));
    let pressed_at = journal().pen.strokes()[0].from_us + 300_000;
    first.advance(pressed_at);
    until("its samples come", || handle.status()[0].samples > 0 && rx.waiting() > 10);
    bus.pull("/dev/hidraw0");
    drop(first);
    until("it is gone", || handle.status().is_empty());
    let seen = drain(&mut rx);
    let Body::Pen(last) = seen.last().unwrap().body else { panic!() };
    assert!(!last.in_range && !last.tip, "an unplug lifts the pen");
    assert!(seen.iter().any(|s| matches!(s.body, Body::Pen(p) if p.tip)), "it was pressed");

    let mut again = bus.plug("/dev/hidraw3", "Wacom PTK-440", "A1");
    until("it is read again", || handle.status().first().is_some_and(|s| s.usable));
    let status = &handle.status()[0];
    assert_eq!((status.device, status.connections), (Some(0), 2), "the same tablet keeps its id");
    assert_eq!(again.asked().first().map(Vec::as_slice), Some(&[2u8, 2][..]), "it is set up again");
    again.advance(pressed_at);
    until("its samples come again", || rx.waiting() > 10);
}

#[test]
fn two_alike_get_an_id_each_and_what_cannot_be_read_says_why() {
    let bus = Sim::default();
    let (handle, _rx) =
        watching(&bus, HidConfig { ignore: vec!["056a:0065".into()], ..HidConfig::default() });
    let _a = bus.plug("/dev/hidraw0", "Wacom PTK-440", "");
    let _b = bus.plug("/dev/hidraw1", "Wacom PTK-440", "");
    let _c = bus.plug("/dev/hidraw2", "Wacom MTE-450", "");
    let keyboard = Node { path: "/dev/hidraw3".into(), ..Node::default() };
    bus.0.lock().unwrap().push((keyboard, None));
    let mut locked = Node { path: "/dev/hidraw4".into(), may_be_pen: true, ..Node::default() };
    locked.who = tablet::identity(&Catalogue::builtin().unwrap(), "Wacom CTL-460").unwrap();
    bus.0.lock().unwrap().push((locked, None));
    until("all are seen", || handle.status().len() == 5);
    let status = handle.status();
    let ids: Vec<_> = status.iter().map(|s| s.device).collect();
    assert_eq!(ids, [Some(0), Some(1), None, None, None]);
    let reasons: Vec<_> = status[2..].iter().map(|s| s.reason.clone().unwrap()).collect();
    assert!(reasons[0].contains("ignored") && reasons[1].contains("not a tablet"), "{reasons:?}");
    assert!(reasons[2].contains("permission denied"), "{reasons:?}");
}

#[test]
fn namesakes_are_asked_about_once_and_the_answer_holds() {
    let catalogue = Catalogue::builtin().unwrap();
    let who = Identity { vid: 0x256c, pid: 0x006d, seen_lengths: vec![12], ..Identity::default() };
    let node = Node { path: "p".into(), serial: "S".into(), who: who.clone(), may_be_pen: true };
    let (_, names) = choose(&node, &who, &HidConfig::default(), &catalogue).unwrap();
    assert!(names.len() > 10 && names.contains(&"Huion H640P".to_owned()), "{names:?}");
    for key in ["256c:006d", "256c:006d:S"] {
        let models = [(key.to_owned(), "Huion H640P".to_owned())].into();
        let (found, names) =
            choose(&node, &who, &HidConfig { models, ..HidConfig::default() }, &catalogue).unwrap();
        assert_eq!((found.tablet.name.as_str(), names.len()), ("Huion H640P", 0));
    }
    let models = [("256c:006d".to_owned(), "No such".to_owned())].into();
    let e =
        choose(&node, &who, &HidConfig { models, ..HidConfig::default() }, &catalogue).unwrap_err();
    assert!(e.contains("No such"), "{e}");
}

/// What Windows and macOS do: the descriptor is known once the interface is open.
#[test]
fn a_tablet_whose_descriptor_is_hidden_is_opened_before_it_is_judged() {
    struct Hidden(Option<TabletEnd>);
    struct Opened(TabletEnd);
    impl Transport for Opened {
        fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize> {
            self.0.read(buf, timeout_ms)
        }
        fn write(&mut self, report: &[u8]) -> io::Result<()> {
            self.0.write(report)
        }
        fn send_feature(&mut self, report: &[u8]) -> io::Result<()> {
            self.0.send_feature(report)
        }
        fn descriptor(&mut self) -> Option<Vec<u8>> {
            Some(tablet::generic_identity().descriptor)
        }
    }
    impl Bus for Hidden {
        fn nodes(&mut self) -> io::Result<Vec<Node>> {
            let (descriptor, seen_lengths) = (Vec::new(), Vec::new());
            let who = Identity { descriptor, seen_lengths, ..tablet::generic_identity() };
            Ok(vec![Node { path: "hid#1".into(), serial: String::new(), who, may_be_pen: true }])
        }
        fn open(&mut self, _: &Node) -> io::Result<Box<dyn Transport>> {
            let end = self.0.take().ok_or(io::ErrorKind::NotFound)?;
            Ok(Box::new(Opened(end)))
        }
    }
    let catalogue = Catalogue::builtin().unwrap();
    let Identification::Identified(found) = catalogue.identify(&tablet::generic_identity()) else {
        panic!("it describes itself")
    };
    let (mut pen, end) = SimTablet::new(&found, journal().pen, TabletConfig::default());
    let (factory, rx) = channel(4096);
    let bus = Box::new(Hidden(Some(end)));
    let handle = start_on(bus, HidConfig::default(), catalogue, Clock::manual(), factory).unwrap();
    until("it is read", || handle.status().first().is_some_and(|s| s.usable));
    pen.advance(journal().pen.strokes()[0].from_us + 300_000);
    until("its samples come", || rx.waiting() > 10);
}
