//! Datagrams over Zenoh: one key for each station, one for whoever hosts, one for all who may take
//! over. Stations on one LAN find each other by multicast; others are named by an endpoint, and
//! learn of each other from it (Zenoh's gossip), so that they stay connected when it is gone.
//!
//! ```text
//! sculptd/1/NAME/to/ADDRESS    for one station
//! sculptd/1/NAME/host          for whoever hosts
//! sculptd/1/NAME/heirs         for all who may take over
//! ```
//!
//! Everything is sealed before it comes here; Zenoh is trusted with nothing but its delivery.

use std::collections::BTreeMap;

use crossbeam_channel as cc;
use zenoh::Wait;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};

use crate::core::To;
use crate::transport::Transport;
use crate::wire::message::Address;

/// Datagrams that wait to be read; more are dropped, as a full network drops them.
const WAITING: usize = 8192;
/// Datagrams of a checkpoint that wait to be sent to one receiver; more are dropped. Two of what a
/// member asks for at once.
const BULK: usize = 512;
/// Stations whose publisher is kept.
const MAX_PUBLISHERS: usize = 256;

/// A connection is given up after so long without a word. Nothing waits for that: who is gone is
/// found by the stations. One that lives through a break is there again at once after it.
const LEASE_MS: u32 = 20_000;

/// Addresses of the network connection.
#[derive(Debug, Clone, Default)]
pub struct Endpoints {
    /// Addresses on which this process listens, as `tcp/0.0.0.0:7447`; none: any port.
    pub listen: Vec<String>,
    /// Whom it connects to, as `tcp/studio.local:7447`.
    pub connect: Vec<String>,
    /// Others on the LAN are looked for by multicast.
    pub multicast: bool,
}

/// Datagrams over Zenoh.
#[derive(Debug)]
pub struct ZenohLink {
    session: zenoh::Session,
    name: String,
    sender: cc::Sender<Vec<u8>>,
    incoming: cc::Receiver<Vec<u8>>,
    subscribers: Vec<Subscriber<()>>,
    host: Option<Subscriber<()>>,
    publishers: BTreeMap<String, Publisher<'static>>,
    /// Of each receiver of a checkpoint.
    bulk: BTreeMap<String, cc::Sender<Vec<u8>>>,
}

/// Opens a session. `lease_ms`: a silent connection is given up after so long.
///
/// # Errors
/// An endpoint cannot be used; the text says why.
pub(crate) fn open_session(endpoints: &Endpoints, lease_ms: u32) -> Result<zenoh::Session, String> {
    let mut config = zenoh::Config::default();
    let list = |all: &[String]| {
        let quoted: Vec<String> = all.iter().map(|e| format!("{e:?}")).collect();
        format!("[{}]", quoted.join(","))
    };
    let mut set = |key: &str, value: &str| {
        config.insert_json5(key, value).map_err(|e| format!("{key} = {value}: {e}"))
    };
    set("mode", "\"peer\"")?;
    set("scouting/multicast/enabled", if endpoints.multicast { "true" } else { "false" })?;
    if !endpoints.listen.is_empty() {
        set("listen/endpoints", &list(&endpoints.listen))?;
    }
    if !endpoints.connect.is_empty() {
        set("connect/endpoints", &list(&endpoints.connect))?;
        // Missing peers are retried for ever, in the background.
        set("connect/timeout_ms", "-1")?;
        set("connect/exit_on_failure", "false")?;
    }
    let retry = "{period_init_ms: 500, period_max_ms: 2000, period_increase_factor: 2}";
    set("connect/retry", retry)?;
    set("transport/unicast/open_timeout", "5000")?;
    // A checkpoint over a slow way: who is gone is known by the lease.
    set("transport/link/tx/queue/congestion_control/block/wait_before_close", "120000000")?;
    set("transport/link/tx/lease", &lease_ms.to_string())?;
    zenoh::open(config).wait().map_err(|e| e.to_string())
}

impl ZenohLink {
    /// Opens a session.
    ///
    /// # Errors
    /// An endpoint cannot be used; the text says why.
    pub fn open(name: &str, endpoints: &Endpoints) -> Result<ZenohLink, String> {
        let session = open_session(endpoints, LEASE_MS)?;
        let (sender, incoming) = cc::bounded(WAITING);
        Ok(ZenohLink {
            session,
            name: name.into(),
            sender,
            incoming,
            subscribers: Vec::new(),
            host: None,
            publishers: BTreeMap::new(),
            bulk: BTreeMap::new(),
        })
    }

    fn key(&self, to: To) -> String {
        let name = &self.name;
        match to {
            To::Host => format!("sculptd/1/{name}/host"),
            To::Heirs => format!("sculptd/1/{name}/heirs"),
            To::Peer(address) | To::Bulk(address) => format!("sculptd/1/{name}/to/{address:016x}"),
        }
    }

    fn subscribe(&self, to: To) -> Result<Subscriber<()>, String> {
        let sender = self.sender.clone();
        let subscriber = self.session.declare_subscriber(self.key(to)).callback(move |sample| {
            let _ = sender.try_send(sample.payload().to_bytes().into_owned());
        });
        subscriber.wait().map_err(|e| e.to_string())
    }

    fn put(&mut self, to: To, bytes: Vec<u8>) -> Result<(), zenoh::Error> {
        let key = self.key(to);
        if !self.publishers.contains_key(&key) {
            if self.publishers.len() >= MAX_PUBLISHERS {
                self.publishers.clear();
            }
            let publisher = self.session.declare_publisher(key.clone());
            let publisher = publisher.congestion_control(CongestionControl::Drop).wait()?;
            self.publishers.insert(key.clone(), publisher);
        }
        match self.publishers.get(&key) {
            Some(publisher) => publisher.put(bytes).wait(),
            None => Ok(()),
        }
    }
}

impl ZenohLink {
    /// A thread for each receiver: one whose connection stands still holds up nobody else.
    fn send_bulk(&mut self, to: Address, bytes: Vec<u8>) {
        let key = self.key(To::Bulk(to));
        if !self.bulk.contains_key(&key) {
            self.bulk.retain(|_, sender| !sender.is_empty());
            let (sender, waiting) = cc::bounded(BULK);
            let (session, of) = (self.session.clone(), key.clone());
            let thread = std::thread::Builder::new().name("sculptd-bulk".into());
            if let Err(e) = thread.spawn(move || send_bulk(&session, of, &waiting)) {
                return tracing::warn!("a checkpoint is not sent: no thread: {e}");
            }
            self.bulk.insert(key.clone(), sender);
        }
        // Data that does not fit is requested again.
        let sender = self.bulk.get(&key);
        let _ = sender.map(|sender| sender.try_send(bytes));
    }
}

impl Transport for ZenohLink {
    fn hosts(&mut self, on: bool) {
        self.host = match on {
            true => self
                .subscribe(To::Host)
                .inspect_err(|e| tracing::warn!("nobody can join: {e}"))
                .ok(),
            false => None,
        };
    }

    fn listen(&mut self, address: Address) -> Result<(), String> {
        self.subscribers = vec![self.subscribe(To::Peer(address))?, self.subscribe(To::Heirs)?];
        Ok(())
    }

    fn send(&mut self, to: To, bytes: Vec<u8>) {
        if let To::Bulk(to) = to {
            return self.send_bulk(to, bytes);
        }
        if let Err(e) = self.put(to, bytes) {
            tracing::debug!("a datagram was not sent: {e}");
        }
    }

    fn incoming(&self) -> cc::Receiver<Vec<u8>> {
        self.incoming.clone()
    }
}

/// Sends a checkpoint: behind all else, and as fast as the receiver takes it. It may wait for a
/// receiver that is gone until its connection is given up.
fn send_bulk(session: &zenoh::Session, key: String, waiting: &cc::Receiver<Vec<u8>>) {
    let publisher = session
        .declare_publisher(key)
        .congestion_control(CongestionControl::Block)
        .priority(Priority::DataLow)
        .wait();
    let publisher = match publisher {
        Ok(publisher) => publisher,
        Err(e) => return tracing::warn!("a checkpoint is not sent: {e}"),
    };
    for bytes in waiting {
        if let Err(e) = publisher.put(bytes).wait() {
            tracing::debug!("a part of a checkpoint was not sent: {e}");
        }
    }
}
