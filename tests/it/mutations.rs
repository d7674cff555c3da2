//! Every parser that faces the outside, fed with whole files and with seeded mutations of them: an
//! answer or a refusal, never a panic, never unbounded memory. `tests/fuzz` holds the same targets
//! for a coverage-guided fuzzer.
//!
//! Some hundred cases a target by default; `SCULPTD_LONG=1` runs each for a minute and a half.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use sculptd::fuzzing;
use sculptd_daemon::session;
use sculptd_daemon::tick::Journal;
use sculptd_devices::Clock;
use sculptd_devices::sim::faults::Rng;
use sculptd_geometry::io::encode;
use sculptd_geometry::shapes;

/// Numbers that parsers trip over.
const WORDS: &[&[u8]] = &[
    b"\xff\xff\xff\xff",
    b"\x00\x00\x00\x80",
    b"\xff\xff\xff\x7f",
    b"\x00\x00\xc0\x7f",
    b"-1",
    b"1e999",
    b"nan",
    b"18446744073709551616",
    b"\0",
    b"\n",
    b"{[",
    b"\"\\u0000\"",
];

/// One to eight changes: bits, bytes, words, cuts, repeats, and parts moved about.
fn mutate(seed: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut data = seed.to_vec();
    for _ in 0..=rng.below(8) {
        if data.is_empty() {
            return data;
        }
        let len = data.len() as u64;
        let at = rng.below(len) as usize;
        match rng.below(7) {
            0 => data[at] ^= 1 << rng.below(8),
            1 => data[at] = rng.below(256) as u8,
            2 => {
                let word = WORDS[rng.below(WORDS.len() as u64) as usize];
                let end = (at + word.len()).min(data.len());
                data[at..end].copy_from_slice(&word[..end - at]);
            }
            3 => {
                let word = WORDS[rng.below(WORDS.len() as u64) as usize];
                data.splice(at..at, word.iter().copied());
            }
            4 => data.truncate(at),
            5 => {
                let end = (at + 1 + rng.below(64) as usize).min(data.len());
                let part = data[at..end].to_vec();
                let to = rng.below(len) as usize;
                data.splice(to..to, part);
            }
            _ => {
                let end = (at + 1 + rng.below(64) as usize).min(data.len());
                data.drain(at..end);
            }
        }
    }
    data
}

/// Feeds a target with each seed and with mutations of them; a panic tells the line that repeats
/// it.
fn torment(name: &str, seeds: &[Vec<u8>], cases: u64, target: impl Fn(&[u8])) {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let clock = Clock::monotonic();
    for (i, seed) in seeds.iter().enumerate() {
        assert!(catch_unwind(AssertUnwindSafe(|| target(seed))).is_ok(), "{name}: seed {i}");
    }
    let mut case = 0;
    while if long { clock.now_us() < 90_000_000 } else { case < cases } {
        let mut rng = Rng::new(0x5eed_0000 + case);
        let seed = &seeds[rng.below(seeds.len() as u64) as usize];
        let data = mutate(seed, &mut rng);
        if catch_unwind(AssertUnwindSafe(|| target(&data))).is_err() {
            panic!("{name}: case {case} panics");
        }
        case += 1;
    }
    println!("{name}: {case} mutations of {} seeds, no panic", seeds.len());
}

fn meshes(kind: &str) -> Vec<Vec<u8>> {
    let all = [shapes::sphere_of_about(40).to_poly(), shapes::sphere_of_about(600).to_poly()];
    all.iter()
        .map(|mesh| {
            let mut out = Vec::new();
            encode(kind, mesh, &mut out).expect("encodes");
            out
        })
        .collect()
}

fn mesh_case(kind: &str, more: &[&[u8]]) {
    let mut seeds = meshes(kind);
    seeds.extend(more.iter().map(|m| m.to_vec()));
    torment(kind, &seeds, 1500, |data| fuzzing::mesh_bytes(kind, data));
}

#[test]
fn obj() {
    mesh_case(
        "obj",
        &[b"mtllib a.mtl\no x\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng \
        a\nusemtl b\ns off\nf 1/1/1 2//1 -1\nf 1 2 \\\n3\nl 1 2\n"],
    );
}

#[test]
fn stl() {
    mesh_case(
        "stl",
        &[b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 \
        0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"],
    );
}

#[test]
fn ply() {
    mesh_case(
        "ply",
        &[b"ply\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty float \
        x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list \
        uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n"],
    );
}

#[test]
fn glb() {
    mesh_case("glb", &[]);
}

#[test]
fn threemf() {
    mesh_case("3mf", &[]);
}

#[test]
fn json_rpc() {
    let seeds: Vec<Vec<u8>> = [
        r#"{"jsonrpc":"2.0","id":1,"method":"status","params":{"version":1}}"#,
        concat!(
            r#"{"jsonrpc":"2.0","id":"a","method":"brush","params":{"kind":"gaussian","#,
            r#""radius":0.1,"symmetry":[true,false,false]}}"#,
        ),
        r#"{"jsonrpc":"2.0","method":"camera","params":{"target":[0,0,0],"yaw":1.5}}"#,
        concat!(
            r#"{"jsonrpc":"2.0","id":3,"method":"reach","#,
            r#""params":{"middle_mm":[0,200,0],"half_mm":100}}"#,
        ),
    ]
    .iter()
    .map(|s| s.as_bytes().to_vec())
    .collect();
    torment("json-rpc", &seeds, 20_000, fuzzing::rpc_bytes);
}

#[test]
fn config() {
    let mut seeds = vec![sculptd::settings::DAEMON.as_bytes().to_vec()];
    seeds.extend(
        [
            "[loop]\nrate_hz = 60\n",
            "[devices]\nserial = [\"/dev/ttyS4\"]\nmodels = { \"256c:006d\" = \"x\" }\n",
        ]
        .map(|s| s.as_bytes().to_vec()),
    );
    torment("config", &seeds, 3000, fuzzing::config_bytes);
}

#[test]
fn stored_pages() {
    let mesh = sculptd_clay::Clay::build(&shapes::sphere_of_about(1200), &Default::default())
        .expect("a ball");
    let seeds: Vec<Vec<u8>> = (0..mesh.page_count() as u32)
        .map(|i| {
            let (shape, points) = (mesh.page(i).topology().to_bytes(), mesh.page(i).to_bytes());
            [&(shape.len() as u32).to_le_bytes()[..], &shape, &points].concat()
        })
        .collect();
    torment("stored pages", &seeds, 1500, fuzzing::page_bytes);
}

#[test]
fn session_file() {
    use sculptd_engine::command::Command;
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("seed.sculpt");
    let config = sculptd_daemon::config::Config::default();
    let settings = session::format::Settings {
        rate_hz: 120,
        dab_budget: 400_000,
        undo_bytes: 1 << 24,
        camera: config.camera.camera(),
        brush: config.brush,
        hands: config.hand,
    };
    let start = shapes::sphere_of_about(60);
    let (mut writer, thread) = session::create(&path, &start, &settings).expect("created");
    let mesh = sculptd_clay::Clay::build(&start, &Default::default()).expect("a ball");
    let mut world = sculptd_daemon::startup::world(mesh, &config);
    let mut thread = thread;
    let keeper = session::history::Keeper::start(path.as_path(), &mut world, 0, None, 1 << 40)
        .expect("a history");
    writer.keep(keeper.handle.clone());
    thread.history = Some(keeper);
    for tick in 1..200 {
        let mut commands = vec![Command::Brush(config.brush), Command::Undo];
        if tick % 50 == 0 {
            commands.push(Command::Mask(sculptd_clay::brush::MaskAction::Fill));
            commands.push(Command::Mask(sculptd_clay::brush::MaskAction::Invert));
        }
        world.step(tick, &[], &commands);
        writer.tick(tick, &[], &commands, &mut world);
    }
    drop(writer);
    assert_eq!(thread.finish(), None);
    let seed = std::fs::read(&path).expect("read");
    torment("session file", &[seed], 150, |data| session_bytes(dir.path(), data));
}

/// Opened, and where it opens replayed; salvaged where it is damaged.
fn session_bytes(dir: &Path, data: &[u8]) {
    let here = tempfile::tempdir_in(dir).expect("a folder");
    fuzzing::session_bytes(here.path(), data);
}
