//! All checks of one part, one after the other or beside each other.

use std::borrow::Cow;

use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::{Cancelled, Job};

use crate::answer::{CheckAnswer, CheckProgress, CheckRequest, CheckedSolid, PartFacts, RanCheck};
use crate::checks::{AskedCheck, CheckView, Stopped, asked};
use crate::estimates::{build_time, weight};
use crate::finding::{Finding, Severity, arrange};
use crate::layers::placement::extent;
use crate::orientation::{OrientationSearch, orientations};
use crate::part::{PreparedPart, Standing};
use crate::settings::CheckSettings;
use crate::soundness::soundness;

/// Returns the number of checks that [`check_part`] runs on a solid, for [`CheckProgress`].
pub fn check_count(settings: &CheckSettings, orient: bool) -> usize {
    1 + asked(settings).len() + usize::from(orient)
}

/// Checks one part. `scale` is millimetres a unit of the file; `seconds` reads a clock that the
/// caller started.
///
/// # Errors
/// Returns an error if `job` was cancelled.
pub fn check_part(
    file: &str,
    mesh: &PolyMesh,
    scale: f64,
    settings: &CheckSettings,
    request: CheckRequest<'_>,
    job: &Job,
    seconds: impl Fn() -> f64 + Sync,
) -> Result<CheckedSolid, Cancelled> {
    let began = seconds();
    // Nearly every mesh is a solid as it is: it is made ready while that is found out.
    let finite = mesh.positions.iter().all(|p| p.is_finite());
    let asked = asked(settings);
    let walls = asked.iter().any(|a| ["walls", "gaps"].contains(&a.0));
    let prepared = |mesh: &PolyMesh| PreparedPart::with_surface(mesh, scale, walls, job);
    let (sound, early) = rayon::join(
        || soundness(mesh, scale, settings.process.sliver, job),
        || finite.then(|| prepared(mesh)).transpose(),
    );
    let (sound, early) = (sound?, early?);
    let ended = || request.progress.into_iter().for_each(CheckProgress::add);
    ended();
    let mut findings = sound.findings;
    let mut warnings = sound.warnings;
    let mut checks = vec![RanCheck { name: "mesh", ran: true, seconds: seconds() - began }];
    let mut facts = PartFacts::default();
    let mut search = None;
    let mut kept = None;
    let ready = match &sound.solid {
        Ok(solid) => {
            let part = match (solid, early) {
                (Cow::Borrowed(_), Some(part)) => part,
                _ => prepared(solid)?,
            };
            let stand = part.standing(settings.up, settings.layer());
            let whole = part.within_reach();
            let found = stand.map(|s| (part, s)).filter(|_| whole);
            found.ok_or_else(|| "no face has an area, or the part is too large".to_string())
        }
        Err(why) => Err(why.clone()),
    };
    match ready {
        Err(why) => {
            for (name, what, _) in &asked {
                findings.push(Finding::not_checked(what, &why));
                checks.push(RanCheck { name, ran: false, seconds: 0.0 });
            }
        }
        Ok((part, stand)) => {
            general(&part, &stand, settings, &mut facts);
            let view = CheckView { part: &part, stand: &stand, settings, job };
            let one = |check: &AskedCheck| {
                let from = seconds();
                let done = (check.2)(&view);
                ended();
                (done, seconds() - from)
            };
            // Two at a time: the sweep has one thread only.
            let middle = asked.len() / 2;
            let (first, second) = rayon::join(
                || asked[..middle].iter().map(one).collect::<Vec<_>>(),
                || asked[middle..].iter().map(one).collect::<Vec<_>>(),
            );
            for ((name, what, _), (done, took)) in asked.iter().zip(first.into_iter().chain(second))
            {
                let ran = match done {
                    Ok((found, own)) => {
                        findings.extend(found);
                        merge(&mut facts, own);
                        true
                    }
                    Err(Stopped::Cancelled) => return Err(Cancelled),
                    Err(Stopped::Because(why)) => {
                        findings.push(Finding::not_checked(what, &why));
                        false
                    }
                };
                checks.push(RanCheck { name, ran, seconds: took });
            }
            if request.orient {
                let from = seconds();
                search = orientations(&part, settings, job)?;
                ended();
                checks.push(RanCheck {
                    name: "orientation",
                    ran: search.is_some(),
                    seconds: seconds() - from,
                });
            }
            kept = Some(part);
        }
    }
    warnings.extend(arrange(&mut findings));
    let (orientations, reasons) = match search {
        Some(OrientationSearch { orientations, reasons, .. }) => (orientations, reasons),
        None => Default::default(),
    };
    let answer = CheckAnswer {
        ok: findings.iter().all(|f| f.severity != Severity::Error) && checks.iter().all(|c| c.ran),
        file: file.into(),
        process: settings.process.name.clone(),
        printer: settings.printer.as_ref().map(|p| p.name.clone()),
        material: settings.material.name.clone(),
        up: settings.up.to_array(),
        findings,
        orientations,
        reasons,
        facts,
        checks,
        warnings,
        seconds: seconds() - began,
    };
    Ok(CheckedSolid { answer, part: kept })
}

/// Takes each fact that `own` knows.
fn merge(facts: &mut PartFacts, own: PartFacts) {
    macro_rules! take {
        ($($name:ident),+) => { $(facts.$name = own.$name.or(facts.$name);)+ };
    }
    take!(
        volume,
        area,
        size,
        weight,
        layers,
        contact_area,
        tip_angle,
        overhang_area,
        support_volume,
        support_error,
        projected_area,
        nominal_wall,
        thickest_wall,
        cooling_time,
        clamping_force,
        shot_volume,
        parting_direction,
        parting_undercut,
        undercut_area,
        build_time
    );
}

/// Facts that need no limit.
fn general(part: &PreparedPart, stand: &Standing, settings: &CheckSettings, facts: &mut PartFacts) {
    let volume = part.sizes.volume;
    facts.volume = Some(volume);
    facts.area = Some(part.areas.iter().sum());
    facts.size = Some(extent(part, stand));
    facts.weight = Some(weight(volume, &settings.material));
    if let Some(layer) = settings.process.layer_height {
        // A last layer that is only rounding is none.
        let count = ((stand.top - stand.plate) / layer - 1e-6).ceil().max(1.0) as usize;
        facts.layers = Some(count);
        facts.build_time = build_time(volume, count, &settings.process);
    }
}
