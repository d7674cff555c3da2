//! Prints what one run of each hand model takes on one core, in milliseconds.
//!
//!     cargo run --release -p sculptd-camera --example model_times -- FOLDER
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use sculptd_camera::inference::Network;
use sculptd_devices::Clock;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("expected the folder of the models")?);
    let clock = Clock::monotonic();
    for entry in std::fs::read_dir(&folder)? {
        let path = entry?.path();
        if path.extension().is_none_or(|e| e != "tflite") {
            continue;
        }
        let mut network = Network::load(&std::fs::read(&path)?)?;
        let mut times: Vec<u64> = (0..50)
            .map(|_| {
                network.input_mut().fill(0.5);
                let begun = clock.now_us();
                network.run();
                clock.now_us() - begun
            })
            .collect();
        times.sort_unstable();
        let ms = |us: u64| us as f64 / 1e3;
        println!("{}: median {:.2}, least {:.2}", path.display(), ms(times[25]), ms(times[0]));
    }
    Ok(())
}
