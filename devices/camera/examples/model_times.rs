//! Runs each model of a folder and prints what one run takes.
use sculptd_camera::inference::Network;
#[allow(clippy::disallowed_methods)]
fn main() {
    let dir = std::env::args().nth(1).unwrap_or_default();
    for name in
        ["palm_detection_lite", "palm_detection_full", "hand_landmark_lite", "hand_landmark_full"]
    {
        let bytes = std::fs::read(format!("{dir}/{name}.tflite")).expect("a model");
        let mut net = Network::load(&bytes).expect("loads");
        let mut ts = vec![];
        for _ in 0..40 {
            net.input_mut().fill(0.5);
            let t = std::time::Instant::now();
            net.run();
            ts.push(t.elapsed().as_secs_f64() * 1e3);
        }
        ts.sort_by(f64::total_cmp);
        println!(
            "{name}: median {:.2} min {:.2} ms; {:?}",
            ts[20],
            ts[0],
            (0..net.output_count()).map(|i| net.output(i)[0]).collect::<Vec<_>>()
        );
    }
}
