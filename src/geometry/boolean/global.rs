//! The fallback: the crate `manifold-rust`, whose symbolic perturbation (Smith 2009) always
//! gives a closed manifold. It knows no tolerance and leaves sheets where faces only nearly touch,
//! so it is used only where the arrangement gives no consistent answer. Its *Exact* engine alone
//! keeps what is not cut; its status is read, for it drops bad operands silently, and a panic
//! within it (an index out of its arrays, on operands that cross themselves) is an error like any
//! other. A result of no faces is a value.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::{RecvTimeoutError, bounded};

use glam::DVec3;
use manifold_rust::cancel::CancelToken;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error as Status, MeshGL64, OpType, WindingRule};

use super::emit::{BooleanFacts, FaceOrigin, finish, separate};
use super::merge::is_flat;
use super::points::Map;
use super::ring_joining::joined_rings;
use super::{Operation, attributes};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};

/// A result: its mesh, the origin of each face, its facts.
pub type Made = (PolyMesh, Vec<FaceOrigin>, BooleanFacts);

/// Runs `what`, and returns its result or the message of its panic. Its input is not used again
/// after a panic.
fn guarded<T>(what: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(what)).unwrap_or_else(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said =
            said.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
        Err(format!("the global engine panicked: {said}"))
    })
}

fn sound(m: Manifold) -> Result<Manifold, String> {
    match m.status() {
        Status::NoError => Ok(m),
        bad => Err(format!("the global engine rejects the mesh: {bad}")),
    }
}

/// The interval at which the waiting thread checks for cancellation.
const LOOK: Duration = Duration::from_millis(5);

/// Runs `what` on a separate thread: the crate checks for cancellation only now and then, and this
/// wait ends at once. The abandoned thread ends when it next checks its token or its job.
fn aside<T: Send + 'static>(
    job: &Job,
    what: impl FnOnce(&CancelToken, &Job) -> Result<T, String> + Send + 'static,
) -> Result<Result<T, String>, Cancelled> {
    job.check()?;
    let (token, inner) = (CancelToken::new(), Arc::new(Job::default()));
    let (say, hear) = bounded(1);
    let (own, ours) = (token.clone(), inner.clone());
    let begun = std::thread::Builder::new().name("sculptd-global".into()).spawn(move || {
        let _ = say.send(guarded(|| what(&own, &ours)));
    });
    if let Err(e) = begun {
        return Ok(Err(format!("no thread for the global engine: {e}")));
    }
    loop {
        match hear.recv_timeout(LOOK) {
            Ok(done) => return job.check().map(|()| done),
            Err(RecvTimeoutError::Disconnected) => {
                return Ok(Err("the global engine's thread ended".into()));
            }
            Err(RecvTimeoutError::Timeout) if job.cancelled() => {
                token.cancel();
                inner.cancel();
                return Err(Cancelled);
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// One of the crate's two engines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Doubles with symbolic perturbation. Its import and its results are cleaned: where triangles
    /// are thinner than rounding, diagonals are swapped, which can move the surface by far more
    /// than its precision.
    Perturbed,
    /// Rational numbers (Barki, Guennebaud and Foufou, "Exact, robust, and efficient regularized
    /// Booleans on general 3D meshes", 2015), up to a thousand times slower. Takes triangles
    /// without their neighbours, so that nothing is cleaned before it begins.
    Rational,
}

impl Engine {
    /// The engine's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Engine::Perturbed => "perturbed engine",
            Engine::Rational => "rational engine",
        }
    }
}

/// Both operands as the crate holds them.
pub struct GlobalEngine {
    held: Arc<HeldOperands>,
}

struct HeldOperands {
    operands: [Manifold; 2],
    ids: [u32; 2],
    meshes: [PolyMesh; 2],
    eps: f64,
    engine: Engine,
}

impl GlobalEngine {
    /// Takes closed operands; the inner error says why the crate refuses one.
    pub fn new(
        operands: [&PolyMesh; 2],
        engine: Engine,
        eps: f64,
        job: &Job,
    ) -> Result<Result<GlobalEngine, String>, Cancelled> {
        let meshes = operands.map(PolyMesh::clone);
        let made = aside(job, move |_, job| {
            let ids = [Manifold::reserve_ids(1), Manifold::reserve_ids(1)];
            let one = |s: usize| {
                let given = solver_mesh(&meshes[s], ids[s], job).map_err(|e| e.to_string())?;
                sound(match engine {
                    Engine::Perturbed => Manifold::from_mesh_gl64(&given),
                    Engine::Rational => Manifold::from_mesh_gl64_robust(&unwelded(given)),
                })
            };
            let operands = [one(0)?, one(1)?];
            Ok(HeldOperands { operands, ids, meshes, eps, engine })
        })?;
        Ok(made.map(|held| GlobalEngine { held: Arc::new(held) }))
    }

    /// One of the four results, in triangles or in as few polygons as join.
    pub fn run(
        &self,
        operation: Operation,
        triangles: bool,
        job: &Job,
    ) -> Result<Result<Made, String>, Cancelled> {
        let held = self.held.clone();
        aside(job, move |token, job| {
            let [a, b] = &held.operands;
            let (first, second, kind) = match operation {
                Operation::Union => (a, b, OpType::Add),
                Operation::Intersection => (a, b, OpType::Intersect),
                Operation::Difference => (a, b, OpType::Subtract),
                Operation::ReverseDifference => (b, a, OpType::Subtract),
            };
            let engine = match held.engine {
                Engine::Perturbed => BooleanEngine::Exact,
                Engine::Rational => BooleanEngine::Robust,
            };
            let out =
                sound(first.boolean_with_engine_and_token(second, kind, engine, Some(token)))?;
            held.polygons(&out.get_mesh_gl64(-1), triangles, job).map_err(|e| e.to_string())
        })
    }
}

impl HeldOperands {
    /// Triangles of one input face as that face again, or in as few polygons as join.
    fn polygons(&self, gl: &MeshGL64, triangles: bool, job: &Job) -> Result<Made, Cancelled> {
        let at = points(gl);
        let mut names: Vec<u32> = (0..at.len() as u32).collect();
        for (&from, &to) in gl.merge_from_vert.iter().zip(&gl.merge_to_vert) {
            names[from as usize] = to as u32;
        }
        let mut groups: BTreeMap<(u8, u32, bool), Vec<Vec<u32>>> = BTreeMap::new();
        for run in 0..gl.run_original_id.len() {
            let operand = u8::from(gl.run_original_id[run] != self.ids[0]);
            let turned = gl.run_flags.get(run).is_some_and(|&f| f & 1 == 1);
            for t in gl.run_index[run] as usize / 3..gl.run_index[run + 1] as usize / 3 {
                let face = gl.face_id.get(t).map_or(0, |&f| f as u32);
                let corners = (0..3).map(|k| names[gl.tri_verts[3 * t + k] as usize]).collect();
                groups.entry((operand, face, turned)).or_default().push(corners);
            }
        }
        let (mut mesh, mut origins) = (PolyMesh::new(), Vec::new());
        for ((operand, face, _), rings) in groups {
            let source = &self.meshes[operand as usize];
            let flat = !triangles
                && rings.len() > 1
                && is_flat(source, face as usize, &source.positions, self.eps);
            let rings = if flat { joined_rings(&rings, &at) } else { rings };
            for r in rings {
                mesh.push_face(&r);
                origins.push(FaceOrigin { operand, face });
            }
        }
        let facts = finish(&mut mesh, &at, job)?;
        Ok((mesh, origins, facts))
    }
}

fn points(gl: &MeshGL64) -> Vec<DVec3> {
    let n = gl.num_prop as usize;
    gl.vert_properties.chunks_exact(n.max(3)).map(|c| DVec3::new(c[0], c[1], c[2])).collect()
}

/// As the crate takes it: manifold triangles, each with its face's number.
fn solver_mesh(mesh: &PolyMesh, id: u32, job: &Job) -> Result<MeshGL64, Cancelled> {
    let mut own = PolyMesh {
        face_starts: mesh.face_starts.clone(),
        corners: mesh.corners.clone(),
        ..PolyMesh::new()
    };
    separate(&mut own, &mesh.positions, job)?;
    let (triangles, of) = own.triangles();
    Ok(MeshGL64 {
        num_prop: 3,
        vert_properties: own.positions.iter().flat_map(|p| p.to_array()).collect(),
        tri_verts: triangles.iter().flatten().map(|&v| u64::from(v)).collect(),
        run_index: vec![0, 3 * triangles.len() as u64],
        run_original_id: vec![id],
        face_id: of.iter().map(|&f| u64::from(f)).collect(),
        ..MeshGL64::default()
    })
}

/// The same triangles, each with three corners of its own. The crate then keeps them as they are.
fn unwelded(given: MeshGL64) -> MeshGL64 {
    let corner = |&v: &u64| &given.vert_properties[3 * v as usize..3 * v as usize + 3];
    let vert_properties = given.tri_verts.iter().flat_map(corner).copied().collect();
    let tri_verts = (0..given.tri_verts.len() as u64).collect();
    MeshGL64 { vert_properties, tri_verts, ..given }
}

/// A surface that crosses itself as the solid of all places that it goes around (positively), in
/// triangles, and the face of each.
pub fn solve(
    mesh: &PolyMesh,
    engine: Engine,
    job: &Job,
) -> Result<Result<(PolyMesh, Vec<FaceOrigin>), String>, Cancelled> {
    let mesh = mesh.clone();
    aside(job, move |token, job| {
        let said = |e: Cancelled| e.to_string();
        let mut given = solver_mesh(&mesh, Manifold::reserve_ids(1), job).map_err(said)?;
        if engine == Engine::Rational {
            given = unwelded(given);
        }
        let raw = sound(Manifold::from_mesh_gl64_robust(&given))?;
        let gl = sound(raw.rebuild_solid_with_token(WindingRule::Positive, Some(token)))?
            .get_mesh_gl64(-1);
        let at = points(&gl);
        let mut merged: Map<u32, u32> = Map::default();
        merged.extend(
            gl.merge_from_vert.iter().zip(&gl.merge_to_vert).map(|(&f, &t)| (f as u32, t as u32)),
        );
        let (mut out, mut origins) = (PolyMesh::new(), Vec::new());
        for (n, t) in gl.tri_verts.chunks_exact(3).enumerate() {
            let t = [0, 1, 2].map(|k| merged.get(&(t[k] as u32)).copied().unwrap_or(t[k] as u32));
            out.push_face(&t);
            let face = gl.face_id.get(n).map_or(0, |&f| f as u32);
            origins.push(FaceOrigin { operand: 0, face });
        }
        let closed = separate(&mut out, &at, job).map_err(said)?;
        if !closed {
            return Err("the solved surface is not closed".into());
        }
        attributes::carry(&mut out, &origins, [&mesh, &mesh]);
        Ok((out, origins))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_says_why() {
        let broken: Vec<u32> = Vec::new();
        let said = guarded(|| Ok(broken[broken.len()])).expect_err("it panicked");
        assert!(said.contains("index out of bounds"), "{said}");
        assert_eq!(guarded(|| Ok(7)), Ok(7));
    }

    #[test]
    fn a_wait_ends_at_once() {
        let job = Arc::new(Job::default());
        let (begun, started) = bounded(1);
        let (release, held) = bounded::<()>(1);
        let other = job.clone();
        let ender = std::thread::spawn(move || {
            started.recv().expect("begun");
            other.cancel();
        });
        let ended = aside(&job, move |token, inner| {
            begun.send(()).expect("heard");
            let _ = held.recv();
            assert!(token.is_cancelled() && inner.cancelled());
            Ok(())
        });
        assert_eq!(ended, Err(Cancelled));
        ender.join().expect("ends");
        drop(release);
    }

    #[test]
    fn nothing_left_is_a_value() {
        let job = Job::default();
        let cube = crate::shapes::cuboid(DVec3::ZERO, DVec3::ONE);
        let far = crate::shapes::cuboid(DVec3::splat(5.0), DVec3::splat(6.0));
        let engine = GlobalEngine::new([&cube, &far], Engine::Perturbed, 1e-9, &job)
            .expect("not cancelled")
            .expect("taken");
        let (mesh, _, facts) = engine
            .run(Operation::Intersection, false, &job)
            .expect("not cancelled")
            .expect("a result");
        assert_eq!((mesh.face_count(), facts.volume, facts.components), (0, 0.0, 0));
    }
}
