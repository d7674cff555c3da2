//! Results that follow strokes made while they were computed.
//!
//! Strokes without dynamic topology move, paint and mask vertices, and leave the triangles as they
//! are. So each vertex of a result has a place on the surface that the result was computed from: it
//! goes where that place has gone, and has the colour and the mask of it where these have changed.
//! Every other vertex keeps its bits. Each round starts from the result as it was computed, so it
//! depends on the state that it follows and not on the rounds before.
//!
//! Where that would be a guess, there is no rebased result: where triangles were cut, where an
//! operand of a Boolean was put elsewhere, and where a stroke came so near to the other operand
//! that it may cross it anew.
//!
//! The pages of a result are built once, of the result as it was computed; each round moves its
//! vertices there, at the cost of the pages that change. The command says both, so that a replay,
//! which has the command alone, comes to the same pages and the same bits.

use std::sync::Arc;

use super::basis::{Basis, Placing};
use super::error::OperationError;
use super::surface::{BasisSurface, MASKED, MOVED, PAINTED};
use crate::carry_over::{self, OldPlace};
use crate::command_queue::QueuedCommand;
use crate::published::Published;
use sculptd_clay::{Clay, Level, Snapshot, VertexState};
use sculptd_engine::command::{Command, OfClay, Rebased};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{Exchange, NewObject, ObjectSource, Operand, SceneCommand};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;

/// How far a vertex of a Boolean's result may be from the operand that it came from, as a share of
/// the largest coordinate: some roundings of a float.
const ROUNDING: f64 = 1e-6;

/// The place of each vertex of a result on one operand's surface.
type VertexPlaces = Vec<Option<OldPlace>>;
/// A mesh, and the mask of each vertex; `None`: nothing is masked.
type MaskedMesh = (Arc<TriMesh>, Option<Arc<Vec<f32>>>);

/// A result that can be brought up to date.
#[derive(Debug)]
pub struct Rebase {
    basis: Basis,
    /// As it was computed.
    command: Command,
    surfaces: Vec<BasisSurface>,
    /// Of a Boolean: each operand, and the tool.
    solids: Vec<DistanceSolid>,
    /// The meshes of the command, with their masks.
    meshes: Vec<MaskedMesh>,
    /// The clay of each.
    clays: Vec<Clay>,
    /// False if masks do not go along to the result.
    keeps_masks: bool,
    /// For each mesh, for each surface.
    places: Vec<Vec<VertexPlaces>>,
    /// Distance within which a vertex of a Boolean is on a surface.
    rounding: f64,
}

impl Rebase {
    /// Finds the place of each vertex of the result.
    ///
    /// # Errors
    /// Returns an error if the job was cancelled.
    pub fn new(basis: Basis, command: Command, job: &Job) -> Result<Rebase, OperationError> {
        let surfaces: Vec<BasisSurface> =
            basis.operands.iter().map(|(_, clay, into)| BasisSurface::new(clay, *into)).collect();
        let largest = |mesh: &TriMesh| {
            let (lo, hi) = mesh.bounds();
            f64::from(lo.abs().max(hi.abs()).max_element())
        };
        let size = surfaces.iter().map(|s| largest(&s.mesh)).fold(0.0, f64::max);
        let rounding = size * ROUNDING;
        let mut solids = Vec::new();
        if !matches!(basis.placing, Placing::Finer | Placing::Coarser) {
            for surface in &surfaces {
                solids.push(DistanceSolid::build(&surface.mesh, job)?);
            }
        }
        let meshes = meshes_of(&command);
        let keeps_masks = matches!(command, Command::OfClay(_));
        let mut clays = Vec::with_capacity(meshes.len());
        for (mesh, masks) in &meshes {
            let masks = masks.as_ref().map_or(&[][..], |m| m);
            let built = Clay::build_masked(mesh, masks, job);
            clays.push(built.map_err(|e| OperationError::Build(e.to_string()))?);
        }
        let mut places = Vec::new();
        for (mesh, _) in &meshes {
            let mut all = Vec::with_capacity(surfaces.len());
            for (i, surface) in surfaces.iter().enumerate() {
                all.push(match &basis.placing {
                    Placing::Nearest => {
                        carry_over::places(&surface.mesh, &solids[i], &mesh.positions, job)?
                    }
                    Placing::Boolean { .. } => {
                        let old = &surface.mesh;
                        let mut found = carry_over::places(old, &solids[i], &mesh.positions, job)?;
                        for (place, p) in found.iter_mut().zip(&mesh.positions) {
                            *place = place.filter(|f| f.point.distance(p.as_dvec3()) <= rounding);
                        }
                        found
                    }
                    Placing::Finer => finer_places(&surface.mesh, mesh),
                    Placing::Coarser => coarser_places(&surface.mesh, mesh),
                });
            }
            places.push(all);
        }
        if let Placing::Boolean { tool: Some(tool) } = &basis.placing {
            solids.push(DistanceSolid::build(tool, job)?);
        }
        Ok(Rebase {
            basis,
            command,
            surfaces,
            solids,
            meshes,
            clays,
            keeps_masks,
            places,
            rounding,
        })
    }

    /// Returns the command with the strokes up to `shown`; `None` if the result has to be computed
    /// again.
    ///
    /// # Errors
    /// Returns an error if no clay can be built, or if the job was cancelled.
    pub fn follow(
        &mut self,
        shown: &Published,
        job: &Job,
    ) -> Result<Option<RebasedEdit>, OperationError> {
        let Some(now) = self.basis.now(shown) else { return Ok(None) };
        self.surfaces.iter_mut().zip(&now).for_each(|(s, (_, clay))| s.compare(clay));
        if self.may_cross() {
            return Ok(None);
        }
        let found = match &self.command {
            Command::OfClay(of) => self.of_clay(of, &now[0]),
            Command::Scene(SceneCommand::Exchange(exchange)) => {
                let exchange = exchange_of(exchange, &now);
                let states = (0..self.meshes.len()).map(|k| self.states(k)).collect();
                Some((Command::Scene(SceneCommand::Exchange(exchange)), states))
            }
            Command::Scene(SceneCommand::ExchangeLive(asked)) => {
                let mut live = asked.1.clone();
                live.operands.iter_mut().for_each(|o| *o = current_operand(o, &now));
                let asked = Box::new((exchange_of(&asked.0, &now), live));
                let states = (0..self.meshes.len()).map(|k| self.states(k)).collect();
                Some((Command::Scene(SceneCommand::ExchangeLive(asked)), states))
            }
            _ => None,
        };
        let Some((command, states)) = found else { return Ok(None) };
        job.check()?;
        let each = self.clays.iter().zip(&states);
        let mut clays: Vec<Clay> = each.map(|(clay, s)| clay.with_vertices(s)).collect();
        let payload = match (&command, clays.pop()) {
            (Command::OfClay(_), Some(clay)) => Payload::Clay(Box::new(clay)),
            (_, last) => {
                clays.extend(last);
                Payload::Clays(clays)
            }
        };
        let rebased = Rebased { command, vertices: Arc::new(states) };
        let command = Command::Rebased(Box::new(rebased));
        let queued = QueuedCommand::with_payload(command, payload);
        let revisions = now.iter().map(|(o, _)| o.revision).collect();
        Ok(Some(RebasedEdit { queued, revisions }))
    }

    /// Returns true if the operands are still as `followed` has them.
    pub fn is_current(&self, followed: &RebasedEdit, shown: &Published) -> bool {
        self.basis.now(shown).is_some_and(|now| {
            now.iter().map(|(o, _)| o.revision).eq(followed.revisions.iter().copied())
        })
    }

    /// Returns true if what has moved of an operand of a Boolean may have come to touch another.
    fn may_cross(&self) -> bool {
        if !matches!(self.basis.placing, Placing::Boolean { .. }) {
            return false;
        }
        let moved = |i: usize| self.surfaces.get(i).map_or(0.0, |s| s.farthest);
        self.surfaces.iter().enumerate().any(|(i, surface)| {
            // A point of the other is at most so far from where its solid has it.
            let margin = |k: usize| moved(k) + 4.0 * self.rounding;
            let mut others = (0..self.solids.len()).filter(|k| *k != i);
            others.any(|k| surface.swept_near(&self.solids[k], margin(k)))
        })
    }

    fn of_clay(
        &self,
        of: &OfClay,
        (operand, clay): &(Operand, Snapshot),
    ) -> Option<(Command, Vec<Vec<VertexState>>)> {
        let states = self.states(0);
        let mut command = of.command.clone();
        let masks = match &command {
            Command::ReplaceMasked(_, masks) => Some(masks.clone()),
            _ => None,
        };
        let (Command::Replace(new) | Command::ReplaceMasked(new, _)) = &mut command else {
            return None;
        };
        if let (Placing::Coarser, Some(levels)) = (&self.basis.placing, &mut new.levels) {
            let finer = Level { mesh: clay.to_tri(), masks: clay.masks() };
            let coarser = with_states(&new.plain, masks.as_deref(), &states);
            Arc::make_mut(levels).keep_above(finer, &coarser);
        }
        let (clay, revision) = (operand.clay, Some(operand.revision));
        Some((Command::OfClay(Box::new(OfClay { clay, revision, command })), vec![states]))
    }

    /// Returns the vertices of a mesh of the result that differ where the surfaces are now.
    fn states(&self, k: usize) -> Vec<VertexState> {
        let (plain, masks) = (&self.meshes[k].0, &self.meshes[k].1);
        let mut states: Vec<VertexState> = Vec::new();
        for (surface, places) in self.surfaces.iter().zip(&self.places[k]) {
            for (v, place) in places.iter().enumerate() {
                let Some(place) = place else { continue };
                let change = surface.change_at(place);
                if change == 0 {
                    continue;
                }
                let mut state = VertexState {
                    vertex: v as u32,
                    position: plain.positions[v],
                    mask: masks.as_ref().map_or(0.0, |m| m[v]),
                    colour: plain.colours.as_ref().map_or([255; 4], |c| c[v]),
                };
                if change & MOVED != 0 {
                    let p = plain.positions[v].as_dvec3() + surface.shift_at(place);
                    state.position = p.as_vec3();
                }
                if change & PAINTED != 0 {
                    state.colour = place.colour(&surface.mesh, &surface.colours);
                }
                if change & MASKED != 0 && self.keeps_masks {
                    state.mask = place.value(&surface.mesh, &surface.masks).clamp(0.0, 1.0);
                }
                states.push(state);
            }
        }
        states
    }
}

/// A level with some of its vertices in another state.
fn with_states(plain: &TriMesh, masks: Option<&Vec<f32>>, states: &[VertexState]) -> Level {
    let mut level = Level { mesh: plain.clone(), masks: masks.cloned() };
    let n = plain.positions.len();
    for s in states {
        let v = s.vertex as usize;
        level.mesh.positions[v] = s.position;
        if s.colour != [255; 4] || level.mesh.colours.is_some() {
            level.mesh.colours.get_or_insert_with(|| vec![[255; 4]; n])[v] = s.colour;
        }
        if s.mask != 0.0 || level.masks.is_some() {
            level.masks.get_or_insert_with(|| vec![0.0; n])[v] = s.mask;
        }
    }
    level
}

/// A command that has followed the strokes.
#[derive(Debug)]
pub struct RebasedEdit {
    pub queued: QueuedCommand,
    /// The revisions of the operands that it has followed to.
    revisions: Vec<u64>,
}

/// The meshes that a command puts in place, with their masks.
fn meshes_of(command: &Command) -> Vec<MaskedMesh> {
    let exchange = match command {
        Command::OfClay(of) => {
            return match &of.command {
                Command::Replace(new) => vec![(new.plain.clone(), None)],
                Command::ReplaceMasked(new, masks) => {
                    vec![(new.plain.clone(), Some(masks.clone()))]
                }
                _ => Vec::new(),
            };
        }
        Command::Scene(SceneCommand::Exchange(exchange)) => exchange,
        Command::Scene(SceneCommand::ExchangeLive(asked)) => &asked.0,
        _ => return Vec::new(),
    };
    let mesh = |new: &NewObject| match &new.source {
        ObjectSource::Mesh(plain) => Some((plain.clone(), None)),
        ObjectSource::Primitive(_) => None,
    };
    exchange.add.iter().filter_map(mesh).collect()
}

/// The exchange of the operands as they are now.
fn exchange_of(exchange: &Exchange, now: &[(Operand, Snapshot)]) -> Exchange {
    let mut exchange = exchange.clone();
    exchange.from.iter_mut().for_each(|o| *o = current_operand(o, now));
    exchange
}

/// The operand as it is now.
fn current_operand(was: &Operand, now: &[(Operand, Snapshot)]) -> Operand {
    now.iter().find(|(o, _)| o.id == was.id).map_or(*was, |(o, _)| *o)
}

/// The places of one subdivision's vertices: its triangles are four for each old one, in order,
/// three at the corners and one in the middle.
fn finer_places(old: &TriMesh, new: &TriMesh) -> VertexPlaces {
    let mut places = vec![None; new.positions.len()];
    for (t, four) in new.triangles.chunks_exact(4).enumerate().take(old.triangles.len()) {
        let at = [
            (four[0][0], [1.0, 0.0, 0.0]),
            (four[1][1], [0.0, 1.0, 0.0]),
            (four[2][2], [0.0, 0.0, 1.0]),
            (four[0][1], [0.5, 0.5, 0.0]),
            (four[1][2], [0.0, 0.5, 0.5]),
            (four[0][2], [0.5, 0.0, 0.5]),
        ];
        for (v, weights) in at {
            let place = &mut places[v as usize];
            *place = place.or_else(|| Some(OldPlace::within(old, t, weights)));
        }
    }
    places
}

/// The places of the level below: each of its vertices is a vertex of the finer level, of the same
/// number.
fn coarser_places(old: &TriMesh, new: &TriMesh) -> VertexPlaces {
    let mut places = vec![None; new.positions.len()];
    for (t, corners) in old.triangles.iter().enumerate() {
        for (k, &v) in corners.iter().enumerate() {
            if let Some(place @ None) = places.get_mut(v as usize) {
                let mut weights = [0.0; 3];
                weights[k] = 1.0;
                *place = Some(OldPlace::within(old, t, weights));
            }
        }
    }
    places
}
