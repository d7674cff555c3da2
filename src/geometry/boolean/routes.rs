//! Which way leads to the results: the operands as they are, other tolerances, the global engine,
//! or the solid of all places that an operand which crosses itself goes around.

use super::global::Engine;
use super::operand::crosses_itself;
use super::points::Contact;
use super::task::BooleanTask;
use super::{
    BooleanError, BooleanReport, BooleanSolid, NAMES, OwnCrossings, Precision, emit, parts, solve,
};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};
use crate::self_intersection;

impl<N: Fn() -> f64> BooleanTask<'_, N> {
    /// The results by the first way that leads to consistent ones.
    ///
    /// # Errors
    /// Returns [`BooleanError::Inconsistent`] with what contradicts what on each way.
    pub(super) fn results(
        &self,
        precision: Precision,
        report: &mut BooleanReport,
    ) -> Result<Vec<BooleanSolid>, BooleanError> {
        let why = match self.within(&[1.0], precision, report)? {
            Ok(solids) => return self.without_crossings(solids, None, precision, report),
            Err(why) => why,
        };
        // Operands that cross themselves are hardly ever one tolerance away from a result.
        let crossing = self.self_crossing_operands(|_| true)?;
        let crosses = crossing.contains(&true);
        let mut tried = vec![why.clone()];
        if crosses {
            let engine = Engine::Perturbed;
            match self.by_engine(engine, report)? {
                Ok(solids) => {
                    note_global(report, &why, self.floor);
                    return self.without_crossings(solids, Some(crossing), precision, report);
                }
                Err(failed) => tried.push(format!("{}: {failed}", engine.name())),
            }
            if let Ok(solids) = self.as_solids(crossing, false, precision, report)? {
                return Ok(solids);
            }
        }
        // If the first tolerance falls between distances in contact and not in contact, another
        // does not.
        if let Ok(solids) = self.within(self.others(), precision, report)? {
            report.warnings.push(format!(
                "tolerance {:.3e} taken instead of {:.3e}: {why}",
                report.tolerance, self.wanted
            ));
            let known = crosses.then_some(crossing);
            return self.without_crossings(solids, known, precision, report);
        }
        if crosses {
            match self.as_solids(crossing, true, precision, report)? {
                Ok(solids) => return Ok(solids),
                Err(failed) => tried.push(format!("solved by winding: {failed}")),
            }
            return Err(BooleanError::Inconsistent(tried.join("; ")));
        }
        for engine in [Engine::Perturbed, Engine::Rational] {
            match self.by_engine(engine, report)? {
                Ok(solids) => {
                    note_global(report, &why, self.floor);
                    return Ok(solids);
                }
                Err(failed) => tried.push(format!("{}: {failed}", engine.name())),
            }
        }
        Err(BooleanError::Inconsistent(tried.join("; ")))
    }

    /// Returns which operands cross themselves, as the caller knows or as is found. An operand that
    /// is not `doubtful` is not examined.
    fn self_crossing_operands(
        &self,
        doubtful: fn(&PolyMesh) -> bool,
    ) -> Result<[bool; 2], Cancelled> {
        let BooleanTask { operands, options, job, .. } = *self;
        let one = |s: usize| match options.known_crossings[s] {
            Some(known) => Ok(known),
            None if doubtful(operands[s]) => crosses_itself(operands[s], job),
            None => Ok(false),
        };
        let (a, b) = rayon::join(|| one(0), || one(1));
        Ok([a?, b?])
    }

    /// The results where each operand that crosses itself is the solid of all places that it goes
    /// around. The inner error says why there is none. `deep`: the global engine is asked too, in
    /// rational numbers, which counts the windings of the operands as they are.
    pub(super) fn as_solids(
        &self,
        crossing: [bool; 2],
        deep: bool,
        precision: Precision,
        report: &mut BooleanReport,
    ) -> Result<Result<Vec<BooleanSolid>, String>, BooleanError> {
        let start = (self.now)();
        let mut solved = [None, None];
        for s in (0..2).filter(|&s| crossing[s]) {
            let made = match deep {
                false => solve::arranged(self.operands[s], self.job)?
                    .ok_or_else(|| "its arrangement with itself is inconsistent".to_owned()),
                true => match solve::solved(self.operands[s], self.job) {
                    Err(BooleanError::Inconsistent(why)) => Err(why),
                    made => Ok(made?),
                },
            };
            let made = match made {
                Ok(made) => made,
                Err(why) => return Ok(Err(format!("{}: {why}", NAMES[s]))),
            };
            solved[s] = Some(made);
        }
        report.phases.push(("solve", (self.now)() - start));
        let mesh = |s: usize| solved[s].as_ref().map_or(self.operands[s], |made| &made.0);
        let operands = [mesh(0), mesh(1)];
        let volume = |s: usize| match &solved[s] {
            Some(made) => emit::measure(&made.0).0,
            None => self.volumes[s],
        };
        let volumes = [volume(0), volume(1)];
        let task = BooleanTask { operands, volumes, ..*self };
        let mut made = BooleanReport { precision: report.precision, ..BooleanReport::default() };
        let mut solids = task.within(&[1.0], precision, &mut made)?;
        if solids.is_err() {
            solids = task.within(self.others(), precision, &mut made)?;
        }
        if let Ok(solids) = &mut solids {
            rename(solids, &solved);
        } else if deep {
            // The solved operands have rounded places, the operands as given count their windings:
            // of the first the results cross themselves less, the second are exact.
            solids = task.by_engine(Engine::Rational, &mut made)?;
            if let Ok(solids) = &mut solids {
                rename(solids, &solved);
            } else {
                let task = BooleanTask { volumes, ..*self };
                solids = task.by_engine(Engine::Rational, &mut made)?;
            }
            made.tolerance = self.floor;
            made.depends_on_tolerance = true;
        }
        let solids = match solids {
            Ok(solids) => solids,
            Err(why) => return Ok(Err(why)),
        };
        for s in (0..2).filter(|&s| crossing[s]) {
            report.warnings.push(format!(
                "{} crosses itself: it was solved by winding, as the solid of all places that it \
                 goes around",
                NAMES[s]
            ));
        }
        report.phases.append(&mut made.phases);
        report.warnings.append(&mut made.warnings);
        let (phases, warnings) = (report.phases.split_off(0), report.warnings.split_off(0));
        *report = BooleanReport { phases, warnings, ..made };
        Ok(Ok(solids))
    }

    /// The results, or those of the operands' solids if they cross themselves less: an operand
    /// whose own pieces cross, or touch in full faces, gives results that do the same.
    fn without_crossings(
        &self,
        solids: Vec<BooleanSolid>,
        crossing: Option<[bool; 2]>,
        precision: Precision,
        report: &mut BooleanReport,
    ) -> Result<Vec<BooleanSolid>, BooleanError> {
        let BooleanTask { options, job, now, .. } = *self;
        // Kept contact is a sheet with two sides, which crosses itself by this measure.
        let keep = options.own_crossings == OwnCrossings::Keep || options.keep_contact;
        if keep || report.same_surface {
            return Ok(solids);
        }
        let start = now();
        let crossing = match crossing {
            Some(known) => known,
            None => self.self_crossing_operands(parts::shells_may_meet)?,
        };
        if crossing == [false; 2] {
            return Ok(solids);
        }
        let before = crossings(&solids, job)?;
        report.phases.push(("crossings", now() - start));
        if before == 0 {
            return Ok(solids);
        }
        let mut made = BooleanReport {
            precision: report.precision,
            phases: report.phases.clone(),
            ..BooleanReport::default()
        };
        let better = self.as_solids(crossing, true, precision, &mut made)?;
        if let Ok(better) = better
            && crossings(&better, job)? < before
        {
            *report = made;
            return Ok(better);
        }
        report.warnings.push(format!(
            "{before} pairs of triangles of the results cross, because an operand crosses itself"
        ));
        Ok(solids)
    }
}

/// Gives each face of the results its origin in the operand as given.
fn rename(solids: &mut [BooleanSolid], solved: &[Option<solve::Solved>; 2]) {
    for origin in solids.iter_mut().flat_map(|s| &mut s.origins) {
        if let Some((_, from)) = &solved[origin.operand as usize] {
            origin.face = from[origin.face as usize].face;
        }
    }
}

/// Returns the number of pairs of triangles that cross within results.
fn crossings(solids: &[BooleanSolid], job: &Job) -> Result<usize, Cancelled> {
    let mut sum = 0;
    for mesh in solids.iter().map(|s| &s.mesh) {
        sum += self_intersection::pairs(&mesh.positions, &mesh.triangles().0, job)?.len();
    }
    Ok(sum)
}

/// The report on a result of the global engine, which takes the coordinates as they are.
fn note_global(report: &mut BooleanReport, why: &str, floor: f64) {
    report
        .warnings
        .push(format!("no consistent result within the tolerance ({why}): global engine taken"));
    report.tolerance = floor;
    report.depends_on_tolerance = true;
    report.contact = Contact::default();
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{BooleanOptions, Operation, compute};
    use crate::PolyMesh;
    use crate::job::Job;
    use crate::shapes::cuboid;

    /// All meshes as one, whatever they have to do with each other.
    fn together(meshes: &[PolyMesh]) -> PolyMesh {
        let mut out = PolyMesh::new();
        for mesh in meshes {
            let first = out.positions.len() as u32;
            out.positions.extend(&mesh.positions);
            mesh.faces()
                .for_each(|f| out.push_face(&f.iter().map(|v| v + first).collect::<Vec<_>>()));
        }
        out
    }

    fn block(lo: [f64; 3], hi: [f64; 3]) -> PolyMesh {
        cuboid(DVec3::from(lo), DVec3::from(hi))
    }

    #[test]
    fn an_operand_whose_pieces_touch_in_full_faces_gives_one_solid() {
        // A foot, a stem on it, a plate on that, with the stem's ends in the faces of the others.
        let stand = together(&[
            block([0., 0., 0.], [3., 3., 1.]),
            block([1., 1., 1.], [2., 2., 3.]),
            block([0., 0., 3.], [3., 3., 4.]),
        ]);
        let tool = block([2.5, 2.5, 0.5], [5., 5., 3.5]);
        let options = BooleanOptions::default();
        let (made, report) =
            compute([&stand, &tool], &Operation::ALL, &options, &Job::default(), || 0.0)
                .expect("results");
        assert!(
            report.warnings.iter().any(|w| w.starts_with("A crosses itself")),
            "{:?}",
            report.warnings
        );
        let inside = 2.0 * 0.5 * 0.5 * 0.5;
        let expected = [20.0 + 18.75 - inside, inside, 20.0 - inside, 18.75 - inside];
        let parts = [1, 2, 1, 1];
        for ((solid, volume), parts) in made.iter().zip(expected).zip(parts) {
            let name = solid.operation.name();
            assert!((solid.facts.volume - volume).abs() < 1e-12, "{name}: {}", solid.facts.volume);
            assert_eq!(solid.facts.components, parts, "{name}");
            let facts = crate::check::report(&solid.mesh, true, &Job::default()).expect("facts");
            assert!(facts.closed && facts.self_intersections == Some(0), "{name}: {facts:?}");
            assert!(solid.origins.iter().all(|o| {
                let operand = [&stand, &tool][o.operand as usize];
                (o.face as usize) < operand.face_count()
            }));
        }
    }

    #[test]
    fn crossing_models_give_results_whose_volumes_add_up() {
        let Some(corpus) = std::env::var_os("SCULPTD_CORPUS").map(std::path::PathBuf::from) else {
            return println!("skipped: SCULPTD_CORPUS is not set");
        };
        let job = Job::default();
        let folder = corpus.join("repro").join("solids");
        let mesh = |name: &str| {
            crate::io::read_mesh(&folder.join(name).with_extension("obj"), &job).expect(name).mesh
        };
        // The last one takes ten times as long as the others.
        let all = ["cross_27_a", "cross_27_b", "cross_43_b", "goblet", "book", "cross_43_a"];
        let long = std::env::var_os("SCULPTD_LONG").is_some();
        let names = &all[..if long { all.len() } else { 4 }];
        for (i, a) in names.iter().enumerate() {
            for b in &names[i + 1..] {
                let operands = [mesh(a), mesh(b)];
                let options = BooleanOptions::default();
                let (made, report) =
                    compute([&operands[0], &operands[1]], &Operation::ALL, &options, &job, || 0.0)
                        .unwrap_or_else(|e| panic!("{a} and {b}: {e}"));
                let v: Vec<f64> = made.iter().map(|s| s.facts.volume).collect();
                println!("{a} and {b}: {v:?}, {:?}", report.warnings);
                // Union = A without B + B without A + both.
                let off = (v[0] - v[1] - v[2] - v[3]).abs();
                assert!(off <= 2.0 * report.volume_bound, "{a} and {b}: off by {off:e}");
                assert!(made.iter().all(|s| s.facts.closed && s.facts.manifold), "{a} and {b}");
            }
        }
    }
}
