//! Finds tablets, sets them up, reads each on a separate thread, and finds them again after a
//! replug.
//!
//! On Linux the report descriptor of a closed interface is read from sysfs. Windows and macOS do
//! not provide it: there an interface that may be a pen is opened first, asked for its descriptor
//! through hidapi, and then identified. That path was tested with simulated devices only: it has
//! never run on Windows or macOS. There the system may hold the pen's interface, so that it cannot
//! be opened; the status then reports this.
//!
//! hidapi has no hot-plug call. The devices are listed again when the device folder changed or a
//! reader ended: every 200 ms at first, and less often while nothing changes, at least every two
//! seconds.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::bus::{Bus, HidApiBus, Node, read_more};
use super::crosscheck::note_undecided;
use super::reader;
use crate::calibration::{self, Calibration, Calibrations};
use crate::catalogue::{Catalogue, Found, Identification, Identity};
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread, StopToken};
use crate::queue::SenderFactory;
use crate::sample::DeviceId;
use crate::tablet::hex_bytes;

/// First and longest wait between two listings.
const LOOK: (Duration, Duration) = (Duration::from_millis(200), Duration::from_millis(1600));
/// A tablet that was only just plugged in may refuse its first messages.
const TRIES: u32 = 20;

/// The user's configuration for tablets.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HidConfig {
    /// The answer to "which model is this?", by `vid:pid` or `vid:pid:serial` (hexadecimal ids).
    pub models: BTreeMap<String, String>,
    /// Devices that are not opened, by `vid:pid` or `vid:pid:serial`.
    pub ignore: Vec<String>,
    /// The user's calibrations, by `vid:pid:serial`, `vid:pid` or the model's name.
    pub calibration: Calibrations,
    /// The first id given to a tablet's interface.
    #[serde(skip)]
    pub first_device: DeviceId,
}

/// The state of one interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NodeStatus {
    /// Path of the interface, such as `/dev/hidraw0`.
    pub path: String,
    /// Vendor id.
    pub vid: u16,
    /// Product id.
    pub pid: u16,
    /// Serial number; empty where the device has none.
    pub serial: String,
    /// USB interface number.
    pub interface: Option<u8>,
    /// Product name; empty where the device has none.
    pub name: String,
    /// A reader thread reads it.
    pub usable: bool,
    /// Number under which its samples go out.
    pub device: Option<u16>,
    /// Name of the model that it is read as.
    pub model: Option<String>,
    /// Name of the parser that reads it.
    pub parser: Option<String>,
    /// Width and height of the active area in mm.
    pub area_mm: Option<[f32; 2]>,
    /// Why it is not read, or what is uncertain about it.
    pub reason: Option<String>,
    /// Names of the models that match equally well: the user is asked to choose.
    pub candidates: Vec<String>,
    /// Reports that were read.
    pub reports: u64,
    /// Reports that were cut short or contradicted themselves.
    pub broken: u64,
    /// Samples that were made of them.
    pub samples: u64,
    /// Times that it was opened.
    pub connections: u32,
}

/// Running readers; dropping it ends all their threads.
#[derive(Debug)]
pub struct HidHandle {
    shared: Arc<Mutex<WatchShared>>,
    _thread: DeviceThread,
}

impl HidHandle {
    /// Every interface that is plugged in, usable or not.
    pub fn status(&self) -> Vec<NodeStatus> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).now()
    }

    /// The model that a device is read as. `None` for a device that is not read, and where the
    /// answer would have to be waited for: it may be asked on a thread that never waits.
    pub fn model_of(&self, device: DeviceId) -> Option<String> {
        let shared = self.shared.try_lock().ok()?;
        let open = shared.open.iter().find(|o| o.status.device == Some(device.0))?;
        open.status.model.clone()
    }
}

#[derive(Debug, Default)]
struct WatchShared {
    open: Vec<OpenInterface>,
    closed: Vec<NodeStatus>,
}

impl WatchShared {
    fn now(&self) -> Vec<NodeStatus> {
        let read = self.open.iter().map(|o| {
            let s = o.handle.status();
            NodeStatus {
                usable: s.connected,
                reports: s.reports,
                broken: s.broken,
                samples: s.samples,
                ..o.status.clone()
            }
        });
        let mut all: Vec<NodeStatus> = read.chain(self.closed.iter().cloned()).collect();
        all.sort_by(|a, b| a.path.cmp(&b.path));
        all
    }
}

#[derive(Debug)]
struct OpenInterface {
    path: String,
    handle: reader::ReaderHandle,
    status: NodeStatus,
}

/// Starts watching and reading the machine's tablets.
///
/// # Errors
/// The platform's HID service is not there, or no thread can be started.
pub fn start(
    config: HidConfig,
    catalogue: Catalogue,
    clock: Clock,
    factory: SenderFactory,
) -> io::Result<HidHandle> {
    start_on(Box::new(HidApiBus::new()?), config, catalogue, clock, factory)
}

/// The same on any bus.
///
/// # Errors
/// Only if no thread can be started.
pub fn start_on(
    bus: Box<dyn Bus>,
    config: HidConfig,
    catalogue: Catalogue,
    clock: Clock,
    factory: SenderFactory,
) -> io::Result<HidHandle> {
    let shared = Arc::new(Mutex::new(WatchShared::default()));
    let mut watcher = Watcher {
        bus,
        config,
        catalogue,
        clock,
        factory,
        shared: shared.clone(),
        ids: Vec::new(),
        failures: BTreeMap::new(),
        connections: BTreeMap::new(),
    };
    let thread = device_thread::spawn("hid-watch", move |stop| watcher.run(&stop))?;
    Ok(HidHandle { shared, _thread: thread })
}

/// Lists what is plugged in and what would be read. Nothing is set up and no thread is started.
///
/// # Errors
/// The bus cannot be listed.
pub fn list(
    bus: &mut dyn Bus,
    config: &HidConfig,
    catalogue: &Catalogue,
) -> io::Result<Vec<NodeStatus>> {
    let nodes = bus.nodes()?;
    let one = |node: &Node| {
        let mut status = NodeStatus::of(node);
        let mut who = node.who.clone();
        let mut opened = None;
        if who.descriptor.is_empty() && refusal(node, config).is_ok() {
            opened = Some(bus.open(node).map(|mut device| read_more(&mut who, device.as_mut())));
        }
        match choose(node, &who, config, catalogue) {
            Ok(found) => {
                status.found(&found.0, found.1);
                match opened.unwrap_or_else(|| bus.open(node).map(|_| ())) {
                    Ok(()) => status.usable = true,
                    Err(e) => status.reason = Some(in_words(&e)),
                }
            }
            Err(why) => {
                let unopened = opened.and_then(Result::err).map(|e| in_words(&e));
                status.reason = Some(unopened.unwrap_or(why));
            }
        }
        status
    };
    Ok(nodes.iter().map(one).collect())
}

struct Watcher {
    bus: Box<dyn Bus>,
    config: HidConfig,
    catalogue: Catalogue,
    clock: Clock,
    factory: SenderFactory,
    shared: Arc<Mutex<WatchShared>>,
    /// Id of each interface: the same one gets it again. The position is the id.
    ids: Vec<(String, Option<String>)>,
    /// Number of failures to open or set up each node.
    failures: BTreeMap<String, u32>,
    connections: BTreeMap<u16, u32>,
}

impl Watcher {
    fn run(&mut self, stop: &StopToken) {
        let (mut wait, mut seen) = (LOOK.0, None);
        loop {
            let ended = self.collect_ended();
            let stamp = self.bus.stamp();
            let changed = stamp.is_none() || stamp != seen;
            let retry = self.failures.values().any(|n| *n < TRIES);
            if changed || ended || retry {
                seen = stamp;
                let news = self.look();
                wait = if news || ended { LOOK.0 } else { (wait * 2).min(LOOK.1) };
            }
            // Reading the stamp takes microseconds; listing the bus takes milliseconds.
            let pause = if stamp.is_some() { LOOK.0 } else { wait };
            if stop.wait(pause) {
                break;
            }
        }
    }

    /// Drops readers whose device was unplugged.
    fn collect_ended(&mut self) -> bool {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let before = shared.open.len();
        shared.open.retain(|o| o.handle.status().connected);
        before != shared.open.len()
    }

    /// Opens what is new. True when something changed.
    fn look(&mut self) -> bool {
        let nodes = match self.bus.nodes() {
            Ok(nodes) => nodes,
            Err(e) => {
                tracing::warn!("tablets cannot be listed: {e}");
                return false;
            }
        };
        let open: Vec<String> = self.with(|s| s.open.iter().map(|o| o.path.clone()).collect());
        self.failures.retain(|path, _| nodes.iter().any(|n| &n.path == path));
        let mut closed = Vec::new();
        let mut news = false;
        for node in nodes.iter().filter(|n| !open.contains(&n.path)) {
            let tried = self.failures.get(&node.path).copied().unwrap_or(0);
            if tried >= TRIES {
                // Not tried again until it is plugged in again; the reason stays in the status.
                let old = self.with(|s| s.closed.iter().find(|c| c.path == node.path).cloned());
                closed.extend(old);
                continue;
            }
            match self.take_up(node) {
                Ok(open) => {
                    self.failures.remove(&node.path);
                    self.with(|s| s.open.push(open));
                    news = true;
                }
                Err(refusal) => {
                    let mut status = NodeStatus::of(node);
                    // If the descriptor is available, the model is known without opening the
                    // interface.
                    let known = Some(node).filter(|n| !n.who.descriptor.is_empty());
                    if let Some(Ok((found, candidates))) =
                        known.map(|n| choose(n, &n.who, &self.config, &self.catalogue))
                    {
                        status.found(&found, candidates);
                    }
                    status.reason = Some(match refusal {
                        Refusal::Final(why) => why,
                        Refusal::Later(why) => {
                            self.failures.insert(node.path.clone(), tried + 1);
                            why
                        }
                    });
                    closed.push(status);
                }
            }
        }
        self.with(|s| {
            news |= s.closed != closed;
            s.closed = closed;
        });
        news
    }

    fn with<T>(&self, f: impl FnOnce(&mut WatchShared) -> T) -> T {
        f(&mut self.shared.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Identifies, opens, sets up and reads one interface.
    fn take_up(&mut self, node: &Node) -> Result<OpenInterface, Refusal> {
        // If the system does not provide the descriptor of a closed interface, the interface is
        // opened before it is identified: a tablet is recognised by its descriptor as often as by
        // its ids.
        if node.who.descriptor.is_empty() {
            refusal(node, &self.config).map_err(Refusal::Final)?;
        } else {
            choose(node, &node.who, &self.config, &self.catalogue).map_err(Refusal::Final)?;
        }
        let mut device = self.bus.open(node).map_err(|e| Refusal::Later(in_words(&e)))?;
        let mut who = node.who.clone();
        read_more(&mut who, device.as_mut());
        let (mut found, candidates) =
            choose(node, &who, &self.config, &self.catalogue).map_err(Refusal::Final)?;
        note_undecided(&mut found, &who.descriptor);
        let id = found.id();
        for report in id.init_feature.iter().filter_map(|h| hex_bytes(h)) {
            note_failure(node, device.send_feature(&report));
        }
        for index in &id.init_strings {
            device.string(*index);
        }
        for report in id.init_output.iter().filter_map(|h| hex_bytes(h)) {
            note_failure(node, device.write(&report));
        }
        let number = self.number(node);
        let connections = self.connections.entry(number.0).or_insert(0);
        *connections += 1;
        let mut status = NodeStatus { connections: *connections, ..NodeStatus::of(node) };
        status.found(&found, candidates);
        (status.usable, status.device) = (true, Some(number.0));
        let mut sender = self.factory.sender();
        sender.calibrate(number, self.calibration(node, &found));
        let handle =
            reader::start(device, &found, &who.descriptor, number, self.clock.clone(), sender)
                .map_err(|e| Refusal::Later(e.to_string()))?;
        tracing::info!("{}: {}", node.path, found.in_words());
        Ok(OpenInterface { path: node.path.clone(), handle, status })
    }

    fn calibration(&self, node: &Node, found: &Found) -> Calibration {
        let (own, shared) = (key(node, true), key(node, false));
        calibration::find(&self.config.calibration, [&own, &shared, found.tablet.name.as_str()])
    }

    /// The id of an interface: the one it had, while nothing else holds it. Two tablets alike get
    /// one each.
    fn number(&mut self, node: &Node) -> DeviceId {
        let key = format!("{}:{:?}", key(node, true), node.who.interface);
        let held: Vec<u16> = self.with(|s| s.open.iter().filter_map(|o| o.status.device).collect());
        let first = self.config.first_device.0;
        let free = |i: &usize| !held.contains(&(first + *i as u16));
        let mut own = (0..self.ids.len()).filter(|i| self.ids[*i].0 == key).filter(free);
        let same_place = own.clone().find(|i| self.ids[*i].1.as_deref() == Some(&node.path));
        let at = same_place.or_else(|| own.next()).unwrap_or_else(|| {
            self.ids.push((key, None));
            self.ids.len() - 1
        });
        self.ids[at].1 = Some(node.path.clone());
        DeviceId(first + at as u16)
    }
}

enum Refusal {
    /// It will not change.
    Final(String),
    /// It is tried again at the next listing.
    Later(String),
}

/// Why a node is not even opened, where it is not.
fn refusal(node: &Node, config: &HidConfig) -> Result<(), String> {
    let keys = [key(node, true), key(node, false)];
    if keys.iter().any(|k| config.ignore.contains(k)) {
        return Err("ignored by the configuration".to_owned());
    }
    if !node.may_be_pen {
        return Err("not a tablet".to_owned());
    }
    Ok(())
}

/// Returns the model as which a node is read, and the names of all candidates if that is uncertain.
pub(crate) fn choose(
    node: &Node,
    who: &Identity,
    config: &HidConfig,
    catalogue: &Catalogue,
) -> Result<(Found, Vec<String>), String> {
    refusal(node, config)?;
    let keys = [key(node, true), key(node, false)];
    let told = keys.iter().find_map(|k| config.models.get(k));
    match (catalogue.identify(who), told) {
        (Identification::Declined(why), _) => Err(why),
        (Identification::Identified(found), None) => Ok((found, Vec::new())),
        (Identification::Identified(found), Some(name)) if &found.tablet.name == name => {
            Ok((found, Vec::new()))
        }
        (_, Some(name)) => match catalogue.named(name, who) {
            Some(found) => Ok((found, Vec::new())),
            None => {
                Err(format!("the configuration names it `{name}`, and no such model has these ids"))
            }
        },
        (Identification::Ambiguous(mut many), None) => {
            let mut names: Vec<String> = many.iter().map(|f| f.tablet.name.clone()).collect();
            names.sort();
            let mut found = many.swap_remove(0);
            found.note = Some(format!(
                "one of {} models alike: say which in the configuration",
                names.len()
            ));
            Ok((found, names))
        }
    }
}

/// `vid:pid`, with the serial number where asked and known.
fn key(node: &Node, serial: bool) -> String {
    let ids = format!("{:04x}:{:04x}", node.who.vid, node.who.pid);
    if serial && !node.serial.is_empty() { format!("{ids}:{}", node.serial) } else { ids }
}

fn in_words(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::PermissionDenied => {
            "permission denied: `sculptd doctor` prints the line that gives you access".to_owned()
        }
        _ => e.to_string(),
    }
}

/// A tablet that refuses its init report may still send reports.
fn note_failure(node: &Node, sent: io::Result<()>) {
    if let Err(e) = sent {
        tracing::warn!("{}: an init report was refused: {e}", node.path);
    }
}

impl NodeStatus {
    fn of(node: &Node) -> Self {
        NodeStatus {
            path: node.path.clone(),
            vid: node.who.vid,
            pid: node.who.pid,
            serial: node.serial.clone(),
            interface: node.who.interface,
            name: node.who.name.clone(),
            usable: false,
            device: None,
            model: None,
            parser: None,
            area_mm: None,
            reason: None,
            candidates: Vec::new(),
            reports: 0,
            broken: 0,
            samples: 0,
            connections: 0,
        }
    }

    fn found(&mut self, found: &Found, candidates: Vec<String>) {
        let a = found.tablet.area;
        self.model = Some(found.tablet.name.clone());
        self.parser = Some(found.id().parser.name());
        self.area_mm = Some([a.width_mm as f32, a.height_mm as f32]);
        self.reason.clone_from(&found.note);
        self.candidates = candidates;
    }
}
