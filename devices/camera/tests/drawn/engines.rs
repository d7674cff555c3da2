//! The models' outputs against Google's LiteRT, where Python has it, and what a picture costs.

use std::io::Write;
use std::process::{Command, Stdio};

use sculptd_camera::drawn::{DrawnScene, draw};
use sculptd_camera::drawn_hand::DrawnHand;
use sculptd_camera::inference::Network;
use sculptd_camera::picture::{Border, Crop, Picture};
use sculptd_devices::sim::hand::HandKey;

use crate::stage::{long, models_folder, upright};

/// Runs a model over inputs on standard input; writes all outputs, one after the other.
const REFERENCE: &str = "
import sys, numpy as np
from ai_edge_litert.interpreter import Interpreter
it = Interpreter(model_path=sys.argv[1], num_threads=1); it.allocate_tensors()
i = it.get_input_details()[0]
outs = sorted(it.get_output_details(), key=lambda o: o['name'])
n = int(np.prod(i['shape'])) * 4
while True:
    b = sys.stdin.buffer.read(n)
    if len(b) < n: break
    it.set_tensor(i['index'], np.frombuffer(b, np.float32).reshape(i['shape'])); it.invoke()
    for o in outs: sys.stdout.buffer.write(it.get_tensor(o['index']).astype(np.float32).tobytes())
";

/// Drawn hands in many looks and pure noise, by turns.
fn picture(i: usize) -> Picture {
    let scene = DrawnScene {
        seed: i as u64 + 1,
        noise: [2.0, 6.0, 20.0, 60.0][i % 4],
        clutter: i % 7 * 4,
        light: 0.5 + 0.1 * (i % 8) as f32,
        ..DrawnScene::default()
    };
    let a = i as f32;
    let key = HandKey {
        yaw_pitch_roll: [(0.7 * a).sin() * 0.9, 1.5 + 0.5 * (1.3 * a).cos(), (0.37 * a).sin()],
        ..upright(300.0 + 50.0 * (i % 8) as f32)
    };
    let key = if i % 5 == 1 { key.curled(0.8) } else { key };
    draw(&scene, &[DrawnHand::new(&key, i % 2 == 0, 1.0)])
}

#[test]
fn outputs_equal_litert() {
    let Some(folder) = models_folder() else { return };
    let python = std::env::var("SCULPTD_LITERT_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python).args(["-c", "import ai_edge_litert"]).output();
    if !probe.is_ok_and(|o| o.status.success()) {
        return println!("skipped: {python} has no ai-edge-litert (SCULPTD_LITERT_PYTHON)");
    }
    let count = if long() { 200 } else { 24 };
    // The other two models are compared where they lie beside those that the program uses.
    for name in
        ["palm_detection_lite", "hand_landmark_full", "palm_detection_full", "hand_landmark_lite"]
    {
        let path = folder.join(format!("{name}.tflite"));
        let Ok(bytes) = std::fs::read(&path) else { continue };
        let mut network = Network::load(&bytes).expect("loads");
        let side = network.input_shape().w;
        let mut child = Command::new(&python)
            .args(["-c", REFERENCE])
            .arg(&path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("python starts");
        let mut input = child.stdin.take().expect("its input");
        let mut wanted = child.stdout.take().expect("its output");
        let mut worst = 0.0_f32;
        for i in 0..count {
            let picture = picture(i);
            let crop = Crop { angle: 0.1 * (i % 9) as f32, ..Crop::around(&picture) };
            crop.sample(&picture, Border::Black, side, network.input_mut());
            let bytes: Vec<u8> = network.input_mut().iter().flat_map(|v| v.to_le_bytes()).collect();
            input.write_all(&bytes).expect("written");
            input.flush().expect("written");
            network.run();
            for output in 0..network.output_count() {
                let ours = network.output(output);
                let mut theirs = vec![0; ours.len() * 4];
                std::io::Read::read_exact(&mut wanted, &mut theirs).expect("an answer");
                for (a, b) in ours.iter().zip(theirs.as_chunks::<4>().0) {
                    worst = worst.max((a - f32::from_le_bytes(*b)).abs());
                }
            }
        }
        drop(input);
        let _ = child.wait();
        println!("{name}: largest difference {worst:.1e} over {count} pictures");
        assert!(worst < 1e-3, "{name}: {worst}");
    }
}
