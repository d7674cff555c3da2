//! A runner for Open Boolean Benchmark: `obb --request request.json --result result.json`.
//!
//! The contract is "Runner I/O Contract", version 1, of the repository
//! `solidean/boolean-benchmark-runners`: runs of operations in which each refers to earlier ones by
//! number. The result of each is written to `op_N.obj`, and the times that the contract names are
//! measured:
//!
//! * `io_ms`: the file to polygons; `import_ms`: polygons to triangles, checked as an operand.
//! * `operation_ms`: the Boolean with all its checks. The search trees of a solid are made in the
//!   first operation that has it as its first argument, and are counted there.
//! * `export_ms`: the solid as an indexed mesh of triangles.
//!
//! Lists of more than two are supported, and one argument alone for a union: what crosses itself
//! becomes the solid that it goes around.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::{
    BooleanError, BooleanOptions, Operation, ResultFaces, SolidState, check, compute, solve,
};
use sculptd_geometry::io::{read_mesh, write_beside, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::repair::weld;
use sculptd_geometry::written::triangulated;
use serde_json::{Value, json};

type Failure = Box<dyn Error>;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("{e}");
            ExitCode::FAILURE
        }
    }
}

/// The file after an option.
fn option(name: &str) -> Result<PathBuf, Failure> {
    let value = std::env::args().skip_while(|a| a != name).nth(1);
    value.map(PathBuf::from).ok_or_else(|| format!("expected {name} FILE").into())
}

/// Returns whether all runs succeeded.
fn run() -> Result<bool, Failure> {
    let (request, result) = (option("--request")?, option("--result")?);
    let request: Value = serde_json::from_slice(&std::fs::read(request)?)?;
    let mut runs: Vec<Value> = Vec::new();
    let mut good = true;
    for run in request["runs"].as_array().into_iter().flatten() {
        let clock = Clock::start();
        let ops = operations(run);
        let status = ops.last().map_or(json!("success"), |op| op["status"].clone());
        good &= status == "success";
        runs.push(json!({
            "case_id": run["case_id"], "status": status, "duration_ms": clock.ms(), "ops": ops,
        }));
        // After each run: the caller may end this process at any time.
        let all = json!({
            "kind": request["kind"], "version": request["version"], "id": request["id"],
            "runs": runs,
        });
        write_beside(&result, |out| std::io::Write::write_all(out, all.to_string().as_bytes()))?;
    }
    Ok(good)
}

/// A stopwatch in milliseconds.
struct Clock(Instant);

impl Clock {
    #[expect(clippy::disallowed_methods, reason = "a bench of a crate that knows no clock")]
    fn start() -> Clock {
        Clock(Instant::now())
    }

    fn ms(&self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1e3
    }
}

/// The result of an operation.
#[derive(Clone)]
enum Slot {
    Mesh(Arc<PolyMesh>),
    State(SolidState),
}

impl Slot {
    fn mesh(&self) -> Arc<PolyMesh> {
        match self {
            Slot::Mesh(mesh) => mesh.clone(),
            Slot::State(state) => Arc::new(state.mesh()),
        }
    }
}

/// The operations of a run until one fails.
fn operations(run: &Value) -> Vec<Value> {
    let folder = PathBuf::from(run["out_dir"].as_str().unwrap_or_default());
    let (mut slots, mut said): (Vec<Slot>, Vec<Value>) = (Vec::new(), Vec::new());
    for (n, op) in run["operations"].as_array().into_iter().flatten().enumerate() {
        let clock = Clock::start();
        let mut answer = json!({});
        match operation(op, &slots, &mut answer) {
            Ok(slot) => {
                let export = Clock::start();
                let mesh = slot.mesh();
                if op["op"] != "load-mesh" {
                    answer["export_ms"] = json!(export.ms());
                }
                let file = folder.join(format!("op_{n}.obj"));
                if let Err(e) = write_mesh(&file, &mesh) {
                    answer["error"] = json!(e.to_string());
                }
                answer["file"] = json!(file);
                slots.push(slot);
            }
            Err(failure) => {
                let kind = match failure.downcast_ref::<BooleanError>() {
                    _ if failure.is::<Unsupported>() => "unsupported",
                    Some(BooleanError::Inconsistent(_)) => "invalid_output",
                    _ => "invalid_input",
                };
                answer["status"] = json!(kind);
                answer["error"] = json!(failure.to_string());
            }
        }
        answer["debug_total_ms"] = json!(clock.ms());
        let failed = answer.get("error").is_some();
        if answer.get("status").is_none() {
            answer["status"] = json!(if failed { "invalid_output" } else { "success" });
        }
        said.push(answer);
        if failed {
            break;
        }
    }
    said
}

/// An operation that this runner does not know.
#[derive(Debug, thiserror::Error)]
#[error("{0} is not supported")]
struct Unsupported(String);

fn operation(op: &Value, slots: &[Slot], answer: &mut Value) -> Result<Slot, Failure> {
    let job = Job::default();
    let name = op["op"].as_str().unwrap_or_default();
    let kind = match name {
        "load-mesh" => return load(op, answer, &job),
        "boolean-union" => Operation::Union,
        "boolean-intersection" => Operation::Intersection,
        "boolean-difference" => Operation::Difference,
        other => return Err(Unsupported(other.into()).into()),
    };
    let arguments = op["args"].as_array().into_iter().flatten();
    let find = |a: &Value| a.as_u64().and_then(|n| slots.get(n as usize)).cloned();
    let arguments: Option<Vec<Slot>> = arguments.map(find).collect();
    let arguments = arguments.ok_or("args: expected numbers of earlier operations")?;
    let clock = Clock::start();
    let made = match &arguments[..] {
        [] => return Err("args: expected at least one".into()),
        [one] if kind == Operation::Union => {
            Slot::Mesh(Arc::new(triangulated(&solve(&one.mesh(), &job)?)))
        }
        [_] => return Err(Unsupported(format!("{name} of one argument")).into()),
        [first, tools @ ..] => {
            let mut made = first.clone();
            for tool in tools {
                made = joined(&made, &tool.mesh(), kind, &job)?;
            }
            made
        }
    };
    answer["operation_ms"] = json!(clock.ms());
    Ok(made)
}

fn load(op: &Value, answer: &mut Value, job: &Job) -> Result<Slot, Failure> {
    let clock = Clock::start();
    let mut mesh = read_mesh(Path::new(op["path"].as_str().unwrap_or_default()), job)?.mesh;
    answer["io_ms"] = json!(clock.ms());
    let clock = Clock::start();
    mesh = triangulated(&mesh);
    if check(&mesh, "the mesh", job).is_err() {
        // Triangle soups (STL) say their corners anew for each triangle.
        weld(&mut mesh, 0.0);
        check(&mesh, "the mesh", job)?;
    }
    answer["import_ms"] = json!(clock.ms());
    Ok(Slot::Mesh(Arc::new(mesh)))
}

/// One step, at the cost of what the tool cuts where that decides.
fn joined(first: &Slot, tool: &PolyMesh, kind: Operation, job: &Job) -> Result<Slot, Failure> {
    let options = BooleanOptions { faces: ResultFaces::Triangles, ..BooleanOptions::default() };
    let state = match first {
        Slot::State(state) => Some(state.clone()),
        Slot::Mesh(_) if kind == Operation::Intersection => None,
        Slot::Mesh(mesh) => SolidState::new(mesh, options, job)?,
    };
    if let Some(state) = state
        && let Some((made, _)) = state.step(kind, tool, job)?
    {
        return Ok(Slot::State(made));
    }
    let (made, _) = compute([&first.mesh(), tool], &[kind], &options, job, || 0.0)?;
    let solid = made.into_iter().next().ok_or("no result")?;
    Ok(Slot::Mesh(Arc::new(solid.mesh)))
}
