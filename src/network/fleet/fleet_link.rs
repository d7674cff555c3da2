//! The messages of a fleet over Zenoh: the keys that [`super`] lists.
//!
//! A link that is silent is given up after [`LEASE_MS`].

use crossbeam_channel as cc;
use zenoh::Wait;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::CongestionControl;
use zenoh::sample::Sample;

use super::KEY_ROOT;
use super::state::fleet_name;
use crate::zenoh_link::{Endpoints, open_session};

/// Milliseconds after which a silent connection has ended.
const LEASE_MS: u32 = 4_000;
/// Messages that wait to be read; more are dropped, as a full network drops them.
const WAITING: usize = 8192;

/// Message received by staff.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StaffMessage {
    /// A published state, and its tag.
    State {
        /// The installation's name, from the key.
        name: String,
        /// The state.
        json: Vec<u8>,
        /// [`super::access::state_tag`].
        tag: Vec<u8>,
    },
    /// A sealed answer.
    Answer {
        /// The installation's name.
        name: String,
        /// As it came.
        sealed: Vec<u8>,
    },
}

fn key(fleet: &str, what: &str, name: &str) -> String {
    format!("{KEY_ROOT}/{fleet}/{what}/{name}")
}

/// An installation's end.
#[derive(Debug)]
pub struct InstallationLink {
    state: Publisher<'static>,
    answers: Publisher<'static>,
    /// Sealed requests.
    pub requests: cc::Receiver<Vec<u8>>,
    _requests: Subscriber<()>,
    _session: zenoh::Session,
}

impl InstallationLink {
    /// Opens a session.
    ///
    /// # Errors
    /// An endpoint cannot be used; the text says why.
    pub fn open(
        fleet: &str,
        name: &str,
        endpoints: &Endpoints,
    ) -> Result<InstallationLink, String> {
        let session = open_session(endpoints, LEASE_MS)?;
        let failed = |e: zenoh::Error| e.to_string();
        let (sender, requests) = cc::bounded(WAITING);
        let subscriber = session
            .declare_subscriber(key(fleet, "request", name))
            .callback(move |sample: Sample| {
                let _ = sender.try_send(sample.payload().to_bytes().into_owned());
            })
            .wait()
            .map_err(failed)?;
        let publisher = |what: &str| {
            let publisher = session.declare_publisher(key(fleet, what, name));
            publisher.congestion_control(CongestionControl::Drop).wait().map_err(failed)
        };
        let (state, answers) = (publisher("state")?, publisher("answer")?);
        Ok(InstallationLink { state, answers, requests, _requests: subscriber, _session: session })
    }

    /// Publishes a state with its tag.
    pub fn publish(&self, json: Vec<u8>, tag: &[u8]) {
        if let Err(e) = self.state.put(json).attachment(tag).wait() {
            tracing::debug!("a state was not published: {e}");
        }
    }

    /// Answers.
    pub fn answer(&self, sealed: Vec<u8>) {
        if let Err(e) = self.answers.put(sealed).wait() {
            tracing::debug!("an answer was not sent: {e}");
        }
    }
}

/// The staff's end.
#[derive(Debug)]
pub struct StaffLink {
    session: zenoh::Session,
    fleet: String,
    /// Received messages.
    pub incoming: cc::Receiver<StaffMessage>,
    _subscribers: [Subscriber<()>; 2],
}

impl StaffLink {
    /// Opens a session and listens to a fleet.
    ///
    /// # Errors
    /// An endpoint cannot be used; the text says why.
    pub fn open(fleet: &str, endpoints: &Endpoints) -> Result<StaffLink, String> {
        let session = open_session(endpoints, LEASE_MS)?;
        let failed = |e: zenoh::Error| e.to_string();
        let (sender, incoming) = cc::bounded(WAITING);
        let subscribe = |what: &str| {
            let sender = sender.clone();
            let subscriber = session.declare_subscriber(key(fleet, what, "*"));
            let callback = move |sample: Sample| {
                if let Some(message) = published(&sample) {
                    let _ = sender.try_send(message);
                }
            };
            subscriber.callback(callback).wait().map_err(failed)
        };
        let (states, answers) = (subscribe("state")?, subscribe("answer")?);
        let (fleet, _subscribers) = (fleet.to_owned(), [states, answers]);
        Ok(StaffLink { session, fleet, incoming, _subscribers })
    }

    /// Sends a sealed request.
    pub fn request(&self, installation: &str, sealed: Vec<u8>) {
        let put = self.session.put(key(&self.fleet, "request", installation), sealed);
        if let Err(e) = put.congestion_control(CongestionControl::Drop).wait() {
            tracing::debug!("a request was not sent: {e}");
        }
    }
}

fn parts(sample: &Sample) -> Vec<&str> {
    sample.key_expr().as_str().split('/').collect()
}

/// A state or an answer, with the name that its key says.
fn published(sample: &Sample) -> Option<StaffMessage> {
    let [.., what, name] = parts(sample)[..] else { return None };
    let name = fleet_name(name).ok()?;
    let bytes = sample.payload().to_bytes().into_owned();
    match what {
        "state" => {
            let tag = sample.attachment()?.to_bytes().into_owned();
            Some(StaffMessage::State { name, json: bytes, tag })
        }
        "answer" => Some(StaffMessage::Answer { name, sealed: bytes }),
        _ => None,
    }
}
