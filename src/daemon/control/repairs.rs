//! What `repair` does.

use glam::DVec3;

use super::host::{Host, failed};
use crate::repair_jobs::{RepairRequest, WantedRepair, carry_out};
use sculptd_check::layers::sweep::SealedVoid;
use sculptd_check::repair::holes::SealedKind;
use sculptd_check::repair::lettering::Lettering;
use sculptd_check::repair::split::{PegSettings, SplitPlane};
use sculptd_control::RpcError;
use sculptd_control::repair::{
    DrilledHole, HoleRepair, RepairKind, RepairParams, RepairReply, RepairedObject, SealedPlace,
};
use sculptd_devices::Clock;

/// Limit for the volume of cups if a request names none, in cubic units: that of the process sla.
const CUP: f64 = 100.0;

pub(super) fn repair(host: &Host, params: &RepairParams) -> Result<RepairReply, RpcError> {
    let holes = |kind, of: HoleRepair| WantedRepair::Holes {
        kind,
        diameter: of.diameter,
        inlet: of.inlet,
        least: of.least.unwrap_or(if kind == SealedKind::Cup { CUP } else { 0.0 }),
        near: of.at.map(DVec3::from),
    };
    let repair = match &params.repair {
        RepairKind::Base(height) => WantedRepair::Base(*height),
        RepairKind::Split(of) => {
            let plane = SplitPlane { point: of.point.into(), normal: of.normal.into() };
            let (radius, length, clearance) = (of.radius, of.length, of.clearance);
            let most = of.pegs as usize;
            WantedRepair::Split(plane, PegSettings { radius, length, clearance, most })
        }
        RepairKind::Draft(angle) => WantedRepair::Draft(*angle),
        RepairKind::Thicken(wall) => WantedRepair::Thicken(*wall),
        RepairKind::Text(of) => WantedRepair::Text(Lettering {
            text: of.text.clone(),
            at: of.at.into(),
            along: of.along.map(DVec3::from),
            upright: of.upright.unwrap_or(params.up).into(),
            height: of.height,
            relief: of.relief,
        }),
        RepairKind::Drain(of) => holes(SealedKind::Trapped, *of),
        RepairKind::Vent(of) => holes(SealedKind::Cup, *of),
    };
    let request = RepairRequest { repair, up: params.up.into(), plate: params.plate };
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let done = carry_out(host.link().target(), &request, &place.job).map_err(failed)?;
    let sealed = |all: &[SealedVoid]| {
        let place = |v: &SealedVoid| SealedPlace { at: v.position.to_array(), volume: v.volume };
        all.iter().map(place).collect()
    };
    let objects = done.objects.iter().map(|(id, left)| RepairedObject {
        id: id.0,
        closed: left.closed,
        manifold: left.manifold,
        self_intersections: left.crossings as u64,
        volume: left.volume,
        base_area: left.base_area,
        trapped: sealed(&left.trapped),
        cups: sealed(&left.cups),
    });
    let holes = done.holes.iter().map(|h| DrilledHole {
        from: h.from.to_array(),
        to: h.to.to_array(),
        inlet: h.inlet,
        sealed_by_plate: h.sealed,
    });
    Ok(RepairReply {
        repaired: done.repaired,
        objects: objects.collect(),
        holes: holes.collect(),
        pegs: done.pegs.iter().map(|p| p.to_array()).collect(),
        notes: done.notes,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
    })
}
