//! The results of one pair of operands, by the arrangement or by the global engine.

use glam::DVec3;
use rayon::prelude::*;

use super::arrange::Arrangement;
use super::box_tree::Span;
use super::chosen::{ChosenFaces, chosen};
use super::global::{Engine, GlobalEngine};
use super::points::Contact;
use super::{
    BooleanError, BooleanOptions, BooleanReport, BooleanSolid, Operation, Precision, attributes,
    common, emit, one_surface, verify,
};
use crate::PolyMesh;
use crate::job::Job;

/// A request, once the operands passed their checks.
pub(super) struct BooleanTask<'a, N> {
    pub operands: [&'a PolyMesh; 2],
    pub volumes: [f64; 2],
    pub operations: &'a [Operation],
    pub options: &'a BooleanOptions,
    /// The tolerance to begin with.
    pub wanted: f64,
    /// The least tolerance: what rounding of computed points needs.
    pub floor: f64,
    pub job: &'a Job,
    pub now: &'a N,
}

impl<N: Fn() -> f64> BooleanTask<'_, N> {
    /// The tolerances to try after the wanted one, in units of it. One that the caller gave is a
    /// bound.
    pub fn others(&self) -> &'static [f64] {
        let given = self.options.tolerance.is_some();
        if given { &[0.125, 1.0 / 64.0, 0.0] } else { &[0.125, 16.0, 1.0 / 64.0] }
    }

    /// The results with the first of the tolerances, in units of the wanted one, that gives some.
    /// The inner error says why the first one does not.
    pub fn within(
        &self,
        factors: &[f64],
        precision: Precision,
        report: &mut BooleanReport,
    ) -> Result<Result<Vec<BooleanSolid>, String>, BooleanError> {
        let mut why = String::new();
        for factor in factors {
            let eps = (self.wanted * factor).max(self.floor);
            let solids = match self.attempt(eps, report)? {
                Ok(solids) => solids,
                Err(reason) => {
                    if why.is_empty() {
                        why = reason;
                    }
                    continue;
                }
            };
            report.tolerance = eps;
            note_contact(report, report.contact, self.floor, precision);
            return Ok(Ok(solids));
        }
        Ok(Err(why))
    }

    /// The results by an engine that knows no tolerance, compared with each other as those of the
    /// arrangement are. The inner error says why they are not consistent.
    pub fn by_engine(
        &self,
        engine: Engine,
        report: &mut BooleanReport,
    ) -> Result<Result<Vec<BooleanSolid>, String>, BooleanError> {
        let BooleanTask { operands, volumes, operations, options, floor, job, now, .. } = *self;
        let start = now();
        let made = match GlobalEngine::new(operands, engine, floor, job)? {
            Ok(made) => made,
            Err(why) => return Ok(Err(why)),
        };
        let mut solids = Vec::new();
        // Union and intersection too where they were not asked for: the volumes are to add up.
        let needed = |o: &Operation| {
            operations.contains(o) || matches!(o, Operation::Union | Operation::Intersection)
        };
        for operation in Operation::ALL.into_iter().filter(needed) {
            let triangles = options.faces.triangles(operands);
            let (mut mesh, mut origins, mut facts) = match made.run(operation, triangles, job)? {
                Ok(made) => made,
                Err(why) => return Ok(Err(why)),
            };
            if !facts.closed {
                return Ok(Err(format!("the {} is not closed", operation.name())));
            }
            // What rounding the exact places leaves of slivers.
            let thin = engine == Engine::Rational && facts.components > 1;
            if thin && emit::drop_thin_shells(&mut mesh, &mut origins, 8.0 * floor) > 0 {
                facts = emit::facts(&mesh, job)?;
            }
            attributes::carry(&mut mesh, &origins, operands);
            solids.push(BooleanSolid { operation, mesh, origins, facts });
        }
        report.phases.push(("global", now() - start));
        let start = now();
        let wrong = match doubt(&solids, volumes, 8.0 * floor, &operands[0].positions, report) {
            // That engine merges places nearer than its precision of 1e-12.
            None => verify::results(operands, &solids, 512.0 * floor, job)?,
            why => why,
        };
        report.phases.push(("verify", now() - start));
        if let Some(why) = wrong {
            return Ok(Err(why));
        }
        let asked = |o: &Operation| solids.iter().position(|s| s.operation == *o);
        let order: Vec<usize> = operations.iter().filter_map(asked).collect();
        Ok(Ok(order.into_iter().map(|i| solids[i].clone()).collect()))
    }

    /// With one tolerance. The inner error says why the arrangement is not consistent.
    fn attempt(
        &self,
        eps: f64,
        report: &mut BooleanReport,
    ) -> Result<Result<Vec<BooleanSolid>, String>, BooleanError> {
        let BooleanTask { operands, volumes, operations, options, floor, job, now, .. } = *self;
        let mut clock = now();
        let mut lap = |name| {
            let t = now();
            report.phases.push((name, t - clock));
            clock = t;
        };
        let mut common = common::common(operands, eps, job, &mut lap)?;
        if common.same_surface {
            let solids = one_surface::results(
                operands[0],
                operations,
                options.faces.triangles(operands),
                job,
            )?;
            if let Some(solids) = solids {
                lap("emit");
                report.contact = common.points.contact;
                let slack = floor.max(8.0 * report.contact.farthest);
                let why = doubt(&solids, volumes, slack, &common.points.at, report);
                report.same_surface = true;
                return Ok(why.map_or(Ok(solids), Err));
            }
            common.pair_again(job)?;
        }
        let a = Arrangement::of(common, eps, floor, None, job, &mut lap)?;
        if let Some(why) = &a.doubt {
            return Ok(Err(why.clone()));
        }
        let (mut solids, mut thin) = (Vec::new(), Vec::new());
        for &operation in operations {
            let triangles = options.faces.triangles(operands);
            let ChosenFaces { mut mesh, mut origins } =
                chosen(&a, operands, operation, options, triangles, floor, job)?;
            let mut facts = emit::finish(&mut mesh, &a.points.at, job)?;
            let contact = a.points.contact.farthest;
            let sheets = options.keep_contact && operation == Operation::Intersection;
            if !sheets && facts.closed && facts.components > 1 && contact > 8.0 * floor {
                let gone = emit::drop_thin_shells(&mut mesh, &mut origins, 2.0 * contact);
                if gone > 0 {
                    facts = emit::facts(&mesh, job)?;
                    thin.push(format!(
                        "{gone} shells of the {} that are thinner than the contact were left out",
                        operation.name()
                    ));
                }
            }
            if !facts.closed {
                return Ok(Err(format!("the {} is not closed", operation.name())));
            }
            attributes::carry(&mut mesh, &origins, operands);
            solids.push(BooleanSolid { operation, mesh, origins, facts });
        }
        lap("emit");
        // Surfaces moved by rounding, and by as much as places in contact were apart.
        let slack = floor.max(8.0 * a.points.contact.farthest);
        if let Some(why) = doubt(&solids, volumes, slack, &a.points.at, report) {
            return Ok(Err(why));
        }
        report.contact = a.points.contact;
        report.warnings.extend(thin);
        report.cut = a.curve();
        job.progress(1.0);
        Ok(Ok(solids))
    }
}

/// Says in the report which places the tolerance decided, `report.tolerance`.
pub(super) fn note_contact(
    report: &mut BooleanReport,
    contact: Contact,
    floor: f64,
    precision: Precision,
) {
    let eps = report.tolerance;
    // Rounding alone moves a computed place by less.
    let decided = contact.farthest > 2.0 * floor;
    report.depends_on_tolerance = decided || contact.near_misses > 0;
    if decided {
        report.warnings.push(format!(
            "{} places up to {:.1e} apart were taken as in contact (tolerance {eps:.1e}, \
             coordinates in {}); a smaller tolerance may give another result",
            contact.places,
            contact.farthest,
            precision.name()
        ));
    }
    if contact.near_misses > 0 {
        report.warnings.push(format!(
            "{} places are apart by one to four times the tolerance of {eps:.1e}; a larger \
             tolerance may give another result",
            contact.near_misses
        ));
    }
}

/// Returns the contradiction between the results' volumes, if any; `eps` is the distance that a
/// surface may have moved.
fn doubt(
    solids: &[BooleanSolid],
    [a, b]: [f64; 2],
    eps: f64,
    at: &[DVec3],
    report: &mut BooleanReport,
) -> Option<String> {
    let of = |o| solids.iter().find(|s| s.operation == o).map(|s| s.facts.volume);
    let area: f64 = solids.iter().map(|s| s.facts.area).sum();
    let size = at
        .par_chunks(1 << 15)
        .map(|c| Span::of(c.iter().copied()))
        .reduce(|| Span::EMPTY, Span::join);
    let slack = (a + b) * 5e-13 + area * eps + (size.hi - size.lo).length().powi(3) * 1e-16;
    report.volume_bound = slack;
    let (u, i) = (of(Operation::Union), of(Operation::Intersection));
    let (d, r) = (of(Operation::Difference), of(Operation::ReverseDifference));
    let sums = [
        (u.zip(i).map(|(u, i)| u + i - a - b), "union and intersection"),
        (d.zip(i).map(|(d, i)| d + i - a), "difference and intersection"),
        (r.zip(i).map(|(r, i)| r + i - b), "reverse difference and intersection"),
    ];
    for (off, what) in sums {
        if off.is_some_and(|x| x.abs() > slack) {
            return Some(format!(
                "the volumes of {what} do not add up, by {:.3e}",
                off.unwrap_or(0.0)
            ));
        }
    }
    solids
        .iter()
        .find(|s| s.facts.volume < -slack)
        .map(|s| format!("the {} has the volume {:.3e}", s.operation.name(), s.facts.volume))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::{compute, solve};
    use crate::shapes::{cuboid, cylinder, icosphere};

    #[test]
    fn an_operand_that_crosses_itself_is_the_solid_that_it_goes_around() {
        let mut balls = icosphere(1.0, 6).to_poly();
        let other = icosphere(1.2, 5).to_poly();
        let first = balls.positions.len() as u32;
        balls.positions.extend(other.positions.iter().map(|p| *p + DVec3::new(0.7, 0.4, 0.1)));
        other.faces().for_each(|f| balls.push_face(&[f[0] + first, f[1] + first, f[2] + first]));
        let block = cuboid(DVec3::new(-0.5, 0.1, -3.0), DVec3::new(0.7, 3.0, 3.0));
        let job = Job::default();
        let solved = solve(&balls, &job).expect("a solid");
        let volume = |m: &PolyMesh| emit::measure(m).0;
        let floor = 4.0 * 2f64.powi(-49);
        let task = BooleanTask {
            operands: [&balls, &block],
            volumes: [volume(&balls), volume(&block)],
            operations: &Operation::ALL,
            options: &BooleanOptions::default(),
            wanted: floor,
            floor,
            job: &job,
            now: &|| 0.0,
        };
        let mut report = BooleanReport::default();
        let made = task.as_solids([true, false], false, Precision::Double, &mut report);
        let made = made.expect("runs").expect("results");
        assert!(report.warnings.iter().any(|w| w.starts_with("A crosses itself")));
        let of = |o| made.iter().find(|s| s.operation == o).map_or(f64::NAN, |s| s.facts.volume);
        let sum = of(Operation::Union) + of(Operation::Intersection);
        // Their own volume counts what both have twice.
        assert!(volume(&balls) > volume(&solved) + 0.1);
        assert!((sum - volume(&solved) - volume(&block)).abs() < 1e-11, "{sum}");
        for solid in &made {
            assert!(solid.facts.closed);
            for (face, origin) in solid.mesh.faces().zip(&solid.origins) {
                let source = [&balls, &block][origin.operand as usize];
                let from = source.face(origin.face as usize);
                let [a, b, c] = [0, 1, 2].map(|k| source.positions[from[k] as usize]);
                let normal = (b - a).cross(c - a).normalize();
                let off = |v: &u32| (solid.mesh.positions[*v as usize] - a).dot(normal).abs();
                assert!(face.iter().map(off).fold(0.0, f64::max) < 1e-13);
            }
        }
    }

    #[test]
    fn a_tolerance_between_the_sides_of_a_drill_and_its_radius_still_drills() {
        let block = cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0));
        let mut drill = cylinder(6.0, 60.0, 64);
        drill.positions.iter_mut().for_each(|p| *p += DVec3::new(20.0, 15.0, 20.0));
        let area = 32.0 * 36.0 * (std::f64::consts::TAU / 64.0).sin();
        for given in [0.1, 0.3, 1.0] {
            let options = BooleanOptions { tolerance: Some(given), ..Default::default() };
            let (made, report) = compute(
                [&block, &drill],
                &[Operation::Difference],
                &options,
                &Job::default(),
                || 0.0,
            )
            .expect("a result");
            assert!(report.tolerance <= given, "{} for {given}", report.tolerance);
            let gone = 24_000.0 - made[0].facts.volume;
            assert!((gone - 20.0 * area).abs() < 800.0 * given.min(0.3), "{gone} at {given}");
        }
    }

    #[test]
    fn no_larger_tolerance_than_the_given_one_is_used() {
        let mut seed = 7u64;
        let mut unit = || {
            seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let cases = if std::env::var_os("SCULPTD_LONG").is_some() { 1000 } else { 200 };
        let mut made = 0;
        for case in 0..cases {
            let a = cuboid(DVec3::ZERO, DVec3::new(9.0, 7.0, 5.0));
            let mut b = match case % 3 {
                0 => cylinder(1.0 + 2.0 * unit(), 12.0, 8 + (unit() * 40.0) as u32),
                1 => icosphere(1.0 + 2.0 * unit() as f32, 3).to_poly(),
                _ => cuboid(DVec3::splat(-2.0), DVec3::splat(1.0 + unit())),
            };
            let shift = DVec3::new(9.0 * unit(), 7.0 * unit(), (5.0 * unit()).round());
            b.positions.iter_mut().for_each(|p| *p += shift);
            let given = 10f64.powf(unit() * 6.0 - 5.0);
            let options = BooleanOptions { tolerance: Some(given), ..Default::default() };
            match compute([&a, &b], &Operation::ALL, &options, &Job::default(), || 0.0) {
                Ok((solids, report)) => {
                    made += 1;
                    assert!(report.tolerance <= given, "{case}: {} for {given}", report.tolerance);
                    assert!(solids.iter().all(|s| s.facts.closed), "{case} at {given}");
                }
                Err(e) => assert!(e.to_string().contains("smaller tolerance"), "{e}"),
            }
        }
        assert!(made * 100 >= cases * 95, "{made} of {cases}");
    }
}
