//! What the methods do that measure a mask.

use super::host::Host;
use crate::mask_jobs;
use sculptd_clay::measured_mask::MaskMeasure;
use sculptd_control::RpcError;
use sculptd_control::brush as asked;

/// Measures the active object on this thread and has the loop mask it.
pub(super) fn measured(
    host: &Host,
    p: asked::MaskMeasuredParams,
) -> Result<asked::MaskMeasuredReply, RpcError> {
    let shown = host.published.load_full();
    let by = match p.by {
        asked::MaskMeasure::Thin(below) if below > 0.0 && below.is_finite() => {
            mask_jobs::thin(&shown, below)
        }
        asked::MaskMeasure::Thin(below) => {
            return Err(RpcError::bad_params(format!("thin = {below}: expected more than 0")));
        }
        asked::MaskMeasure::Occlusion(share) if share > 0.0 && share <= 1.0 => {
            MaskMeasure::Occlusion(share)
        }
        asked::MaskMeasure::Occlusion(share) => {
            let expected = "expected more than 0 and at most 1";
            return Err(RpcError::bad_params(format!("occlusion = {share}: {expected}")));
        }
    };
    let place = host.jobs.begin();
    let done = host.operate(&place.job, |now| mask_jobs::measured(now, by, &place.job))?;
    Ok(asked::MaskMeasuredReply { protected: done.made })
}
