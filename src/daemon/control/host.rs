//! What a request may touch.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use arc_swap::ArcSwap;

use super::jobs::Jobs;
use super::loop_link::LoopLink;
use super::stroke::VirtualPen;
use crate::Published;
use crate::command_queue::{CommandSender, QueuedCommand};
use crate::operations::{self, Computed, Installed, OperationError};
use crate::session::Health;
use crate::session::history::Handle;
use crate::web::Web;
use crate::window_link::WindowLink;
use sculptd_clay::brush::Presets;
use sculptd_control::RpcError;
use sculptd_control::edit::{ThicknessParams, ThicknessReply};
use sculptd_engine::answer::Answer;
use sculptd_geometry::job::Job;

/// The last answer about wall thickness, and what it was the answer to.
#[derive(Debug)]
pub struct KeptThickness {
    pub(super) params: ThicknessParams,
    /// Of the object's transform.
    pub(super) scale: f64,
    pub(super) reply: ThicknessReply,
}

/// Everything that a request may access. A clone is another handle to the same state.
#[derive(Debug, Clone)]
pub struct Host {
    pub commands: CommandSender,
    pub published: Arc<ArcSwap<Published>>,
    /// Presets of each brush.
    pub presets: Presets,
    /// The wall thickness of the object, as last asked for.
    pub thickness: Arc<Mutex<Option<KeptThickness>>>,
    /// What requests are working on.
    pub jobs: Arc<Jobs>,
    /// Health of the session file; `None` if the run is not recorded.
    pub journal: Option<Health>,
    /// The history of the session, if one is kept.
    pub history: Option<Handle>,
    /// The pen of `stroke`; `None` if nothing receives its samples.
    pub pen: Option<Arc<Mutex<VirtualPen>>>,
    /// The page on which others join; `None` if it is not served.
    pub web: Option<Arc<Web>>,
    /// State of the window, and the request for a new one.
    pub window: WindowLink,
    /// Set by `shutdown` and `window`.
    pub stop: Arc<AtomicBool>,
}

impl Host {
    /// Creates a host without session and pen, with a new `stop` flag.
    pub fn new(
        commands: CommandSender,
        published: Arc<ArcSwap<Published>>,
        presets: Presets,
    ) -> Self {
        Host {
            commands,
            published,
            presets,
            thickness: Arc::default(),
            jobs: Arc::default(),
            journal: None,
            history: None,
            pen: None,
            web: None,
            window: WindowLink::default(),
            stop: Arc::default(),
        }
    }

    /// Hands a command to the loop and waits for what came of it, see [`LoopLink::carry_out`].
    pub(super) fn carry_out(&self, command: impl Into<QueuedCommand>) -> Result<Answer, RpcError> {
        self.link().carry_out(command)
    }

    /// Computes a result from the published state and has the loop install it.
    pub(super) fn operate<T>(
        &self,
        job: &Job,
        compute: impl Fn(&Published) -> Result<Computed<T>, OperationError>,
    ) -> Result<Installed<T>, RpcError> {
        operations::carry_out(self.link().target(), job, compute).map_err(failed)
    }

    /// The loop alone.
    pub(super) fn link(&self) -> LoopLink<'_> {
        LoopLink { commands: &self.commands, published: &self.published, stop: &self.stop }
    }

    /// Returns a handle for one client, with a separate record of that client's effects.
    pub fn for_client(&self) -> Host {
        Host { commands: self.commands.of_client(), ..self.clone() }
    }
}

/// The value behind a lock, whether or not a thread that held it has panicked: every value here is
/// replaced as a whole.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Longest mesh file that a request may load, bytes: its mesh must fit into memory beside the one
/// in place.
pub const MAX_MESH_FILE: u64 = 1 << 30;

/// The refusal of a request that could not be carried out.
pub(super) fn failed(e: impl std::fmt::Display) -> RpcError {
    RpcError::failed(e.to_string())
}
