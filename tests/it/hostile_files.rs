//! Files that are no meshes and no pictures, given to a running daemon: each is refused with a
//! reason, in time, and the daemon's memory stays under a bound that this test reads itself.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use sculptd_daemon::control::client::call;
use sculptd_devices::Clock;
use serde_json::{Value, json};

use crate::hostile::{Daemon, most_memory_kib};

/// Longest time for one request.
const PATIENCE: Duration = Duration::from_secs(30);
/// Most memory of the daemon at any time, KiB.
const MEMORY_KIB: u64 = 1 << 20;

fn put(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    #[allow(clippy::disallowed_methods)] // A hostile file is what it is.
    std::fs::write(&path, content).expect("written");
    path
}

/// A file of holes, with these bytes at its beginning.
fn sparse(folder: &Path, name: &str, head: &[u8], length: u64) -> PathBuf {
    let path = put(folder, name, head);
    let file = File::options().write(true).open(&path).expect("opens");
    file.set_len(length).expect("lengthened");
    path
}

/// The head of a binary STL file that says it has so many triangles.
fn stl_head(triangles: u32) -> Vec<u8> {
    let mut head = vec![0; 80];
    head.extend_from_slice(&triangles.to_le_bytes());
    head
}

/// Bits of a deflate stream (RFC 1951), the lowest first.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    used: u32,
}

impl Bits {
    fn put(&mut self, value: u32, count: u32) {
        for i in 0..count {
            if self.used == 0 {
                self.bytes.push(0);
            }
            let last = self.bytes.len() - 1;
            self.bytes[last] |= ((value >> i & 1) as u8) << self.used;
            self.used = (self.used + 1) % 8;
        }
    }

    /// A Huffman code, which goes out from its highest bit.
    fn code(&mut self, value: u32, count: u32) {
        (0..count).rev().for_each(|i| self.put(value >> i & 1, 1));
    }
}

/// So many spaces (about), deflated with the fixed codes: 13 bits for each 258 of them.
fn deflated_spaces(length: u64) -> Vec<u8> {
    let mut bits = Bits::default();
    bits.put(1, 1);
    bits.put(1, 2);
    bits.code(0x30 + u32::from(b' '), 8);
    for _ in 0..length / 258 {
        // Length 258 (symbol 285), distance 1.
        bits.code(0b1100_0101, 8);
        bits.code(0, 5);
    }
    bits.code(0, 7);
    bits.bytes
}

/// A ZIP archive of one deflated entry (PKWARE's APPNOTE, 4.3) that says it has `stated` bytes.
fn zip(name: &str, deflated: &[u8], stated: u32) -> Vec<u8> {
    let fields = |out: &mut Vec<u8>| {
        out.extend_from_slice(&[20, 0, 0, 0, 8, 0, 0, 0, 0, 0]);
        out.extend_from_slice(&0u32.to_le_bytes());
        out.extend_from_slice(&(deflated.len() as u32).to_le_bytes());
        out.extend_from_slice(&stated.to_le_bytes());
        out.extend_from_slice(&(name.len() as u16).to_le_bytes());
        out.extend_from_slice(&[0, 0]);
    };
    let mut out = b"PK\x03\x04".to_vec();
    fields(&mut out);
    out.extend_from_slice(name.as_bytes());
    out.extend_from_slice(deflated);
    let directory = out.len() as u32;
    out.extend_from_slice(b"PK\x01\x02\x14\0");
    fields(&mut out);
    out.extend_from_slice(&[0; 14]);
    out.extend_from_slice(name.as_bytes());
    let size = out.len() as u32 - directory;
    out.extend_from_slice(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    out.extend_from_slice(&size.to_le_bytes());
    out.extend_from_slice(&directory.to_le_bytes());
    out.extend_from_slice(&[0, 0]);
    out
}

/// The head of a PNG that says it is so large. The checksum of its header is right.
fn png_head(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend_from_slice(&width.to_be_bytes());
    header.extend_from_slice(&height.to_be_bytes());
    header.extend_from_slice(&[8, 6, 0, 0, 0]);
    let crc = header.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| c >> 1 ^ (0xEDB8_8320 & (c & 1).wrapping_neg()))
    });
    let mut out = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    out.extend_from_slice(&header);
    out.extend_from_slice(&(!crc).to_be_bytes());
    out
}

fn glb(json: &str) -> Vec<u8> {
    let mut text = json.as_bytes().to_vec();
    text.resize(text.len().div_ceil(4) * 4, b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend_from_slice(&(text.len() as u32 + 20).to_le_bytes());
    out.extend_from_slice(&(text.len() as u32).to_le_bytes());
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&text);
    out
}

/// Files that are no meshes.
fn no_meshes(folder: &Path) -> Vec<PathBuf> {
    let mut all: Vec<PathBuf> =
        ["/dev/zero", "/dev/null", "/dev/random", "/dev/full", "/proc/self/mem", "/dev/stdin"]
            .map(PathBuf::from)
            .to_vec();
    let pipe = folder.join("pipe.stl");
    assert!(Command::new("mkfifo").arg(&pipe).status().is_ok_and(|s| s.success()));
    let socket = folder.join("socket.stl");
    std::mem::forget(std::os::unix::net::UnixListener::bind(&socket).expect("bound"));
    let link = folder.join("link.stl");
    std::os::unix::fs::symlink("/dev/zero", &link).expect("linked");
    all.extend([pipe, socket, link, folder.to_path_buf(), folder.join("absent.stl")]);
    all.push(sparse(folder, "sparse.stl", &stl_head(42_949_671), (2 << 30) + 84));
    all.push(sparse(folder, "sparse.obj", b"v 0 0 0\n", 4 << 30));
    all.push(sparse(folder, "holes.obj", b"v 0 0 0\n", 256 << 20));
    all.push(put(folder, "count.stl", &stl_head(u32::MAX)));
    all.push(put(folder, "index.obj", b"v 0 0 0\nf 1 2 99999999999999999999\n"));
    all.push(put(folder, "line.obj", &[&b"v "[..], &vec![b'1'; 64 << 20]].concat()));
    let ply = |vertices: &str, kind: &str| {
        format!(
            "ply\nformat {kind} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float \
             y\nproperty float z\nelement face 1\nproperty list uint int vertex_indices\n\
             end_header\n"
        )
    };
    let enormous = ply("18446744073709551615", "binary_little_endian");
    all.push(put(folder, "vertices.ply", enormous.as_bytes()));
    all.push(put(folder, "many.ply", ply("1000000000", "ascii").as_bytes()));
    let list = [ply("0", "binary_little_endian").as_bytes(), &[0xff; 4]].concat();
    all.push(put(folder, "list.ply", &list));
    all.push(put(folder, "count.off", b"OFF\n4000000000 4000000000 0\n"));
    all.push(put(
        folder,
        "buffer.glb",
        &glb(r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":1099511627776}],
            "bufferViews":[{"buffer":0,"byteLength":1099511627776}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":91625968981,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#),
    ));
    all.push(put(
        folder,
        "nodes.glb",
        &glb(&format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#,
            (0..5000)
                .map(|n| format!(r#"{{"children":[{}]}}"#, (n + 1) % 5000))
                .collect::<Vec<_>>()
                .join(",")
        )),
    ));
    let outside = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"/dev/zero"}],
        "bufferViews":[{"buffer":0,"byteLength":9}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":1,"type":"VEC3"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}"#;
    all.push(put(folder, "outside.gltf", outside.as_bytes()));
    all.push(put(folder, "deep.gltf", "[".repeat(5_000_000).as_bytes()));
    let spaces = deflated_spaces(4 << 30);
    all.push(put(folder, "bomb.3mf", &zip("3D/3dmodel.model", &spaces, u32::MAX - 1)));
    all.push(put(folder, "liar.3mf", &zip("3D/3dmodel.model", &spaces, 100)));
    all
}

/// Files that are no pictures.
fn no_pictures(folder: &Path) -> Vec<PathBuf> {
    let mut all = vec![PathBuf::from("/dev/zero"), folder.join("pipe.stl"), folder.to_path_buf()];
    all.push(put(folder, "large.png", &png_head(1 << 30, 1 << 30)));
    all.push(put(folder, "wide.png", &png_head(u32::MAX, 1)));
    all.push(put(folder, "cut.png", &png_head(64, 64)));
    all.push(put(folder, "noise.png", &[0x5a; 4096]));
    all.push(put(folder, "empty.png", b""));
    all.push(sparse(folder, "sparse.png", &png_head(4096, 4096), 3 << 30));
    all
}

#[test]
fn every_hostile_file_is_refused_by_a_daemon_that_stays_under_a_gibibyte() {
    let dir = tempfile::tempdir().expect("a folder");
    let daemon = Daemon::start(&["run", "--headless"], "");
    let ask = |method: &str, params: &Value| call(&daemon.socket(), method, params, PATIENCE);
    let before = ask("hash", &Value::Null).expect("answers")["hash"].clone();
    let mut worst = ("nothing".to_owned(), 0.0);
    let mut count = 0;
    let mut refused = |method: &str, path: &Path| {
        let clock = Clock::monotonic();
        let mut params = json!({ "path": path });
        if method == "boolean" {
            params["operation"] = "union".into();
            params["at"] = json!([0.0, 0.0, 0.0]);
        }
        let reply = ask(method, &params);
        let seconds = clock.now_us() as f64 * 1e-6;
        let why = reply.expect_err(&format!("{method} takes {}", path.display())).to_string();
        assert!(why.contains("refused"), "{method} {}: {why}", path.display());
        assert!(seconds < 20.0, "{method} {}: {seconds} s", path.display());
        if seconds > worst.1 {
            worst = (format!("{method} {}", path.display()), seconds);
        }
        let kib = most_memory_kib(daemon.id());
        assert!(kib < MEMORY_KIB, "{method} {}: {} MiB", path.display(), kib >> 10);
        count += 1;
    };
    let meshes = no_meshes(dir.path());
    for path in &meshes {
        refused("load", path);
    }
    // The same door, by other names.
    for method in ["take-up", "boolean"] {
        for path in meshes.iter().filter(|p| p.starts_with("/dev") || p.ends_with("pipe.stl")) {
            refused(method, path);
        }
    }
    for path in no_pictures(dir.path()) {
        refused("picture", &path);
    }
    let after = ask("hash", &Value::Null).expect("still answers")["hash"].clone();
    assert_eq!(before, after, "the sculpture is untouched");
    println!(
        "{count} hostile files: at most {} MiB; the slowest took {:.2} s: {}",
        most_memory_kib(daemon.id()) >> 10,
        worst.1,
        worst.0
    );
}

#[test]
fn the_command_line_refuses_a_sparse_file_under_a_limit_of_address_space() {
    let dir = tempfile::tempdir().expect("a folder");
    // As much as the machine gives to one process here: 1 GiB.
    let limited = |path: &Path| {
        Command::new("sh")
            .args(["-c", "ulimit -v 1048576; exec \"$0\" info --json \"$1\""])
            .arg(env!("CARGO_BIN_EXE_sculptd"))
            .arg(path)
            .stdin(Stdio::null())
            .output()
            .expect("runs")
    };
    let mut whole = stl_head(1);
    whole.extend_from_slice(&[0; 50]);
    let at = whole.len();
    for (x, i) in [(1.0f32, at - 50 + 24), (1.0, at - 50 + 40)] {
        whole[i..i + 4].copy_from_slice(&x.to_le_bytes());
    }
    assert!(limited(&put(dir.path(), "one.stl", &whole)).status.success(), "the limit is too low");
    let sparse_stl = sparse(dir.path(), "sparse.stl", &stl_head(42_949_671), (2 << 30) + 84);
    let mut long = File::options().write(true).open(sparse_stl.clone()).expect("opens");
    long.seek(SeekFrom::Start(2 << 30)).and_then(|_| long.write_all(&[0; 84])).expect("written");
    for path in [sparse_stl, PathBuf::from("/dev/zero"), dir.path().join("absent.stl")] {
        let out = limited(&path);
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(6), "{}: {said}", path.display());
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        assert!(said.contains(&name) && !said.contains("panicked"), "{said}");
    }
}
