//! Booleans of the active object, as the control socket reports them.

use super::host::{Host, failed};
use super::jobs::JobPlace;
use super::{face_sets, layers};
use crate::boolean_jobs;
use crate::operations::{OperationError, Target};
use sculptd_control::RpcError;
use sculptd_control::edit;
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;

/// Runs a Boolean in its place.
pub(super) fn boolean(
    host: &Host,
    place: &JobPlace<'_>,
    work: impl FnOnce(Target<'_>, &Job) -> Result<boolean_jobs::Joined, OperationError>,
) -> Result<edit::BooleanReply, RpcError> {
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let (layers, sets) = (layers::count(host), face_sets::count(host));
    let joined = work(host.link().target(), &place.job).map_err(failed)?;
    Ok(edit::BooleanReply {
        layers_baked: if joined.local { 0 } else { layers },
        sets_dropped: if joined.local { 0 } else { sets },
        local: joined.local,
        pages_written: joined.pages_written as u64,
        pages_shared: joined.pages_shared as u64,
        tries: joined.tries as u64,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
    })
}
