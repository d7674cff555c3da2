//! Hours of input at full speed with faults from a seed: a pen that is unplugged and comes back, samples that are torn off or
//! come twice, clocks that jump, a loop that falls behind. After every tick the world is sound.

use glam::Vec2;
use sculptd::command::Command;
use sculptd::config::Resolved;
use sculptd::daemon::rig;
use sculptd::devices::sim::faults::Rng;
use sculptd::devices::{Body, DeviceId, Pen, Sample, queue};
use sculptd::mesh::{Mesh, shapes};

fn soak(seed: u64, ticks: u64) -> Result<(), String> {
    let mut config = Resolved::defaults().config;
    config.undo.bytes = 8 << 20;
    let mesh =
        Mesh::build(&shapes::sphere_of_about(3_000), &Default::default()).map_err(|e| e.to_string())?;
    let mut world = rig::world(mesh, &config);
    let (factory, mut receiver) = queue::channel(256);
    let mut sender = factory.sender();
    let mut rng = Rng::new(seed);
    let mut samples = Vec::new();
    let (mut plugged, mut skew, mut slow, mut settled) = (true, 0u64, 0u64, None);
    for tick in 1..=ticks {
        // The pen speaks twice a tick; one in some thousand packets meets a fault.
        for half in 0..2 {
            match rng.below(4000) {
                0 => plugged = !plugged,
                1 => skew += rng.below(3_000_000),
                2 => slow = rng.below(60),
                3 => continue,
                _ => {}
            }
            let phase = (tick * 2 + half) as f32 * 0.03;
            let tip = plugged && (tick / 40) % 3 != 2;
            let body = Pen {
                in_range: plugged,
                tip,
                pos_mm: Vec2::new(112.0 + 45.0 * phase.sin(), 70.0 + 30.0 * (phase * 0.37).cos()),
                area_mm: Vec2::new(224.0, 140.0),
                pressure: Some(if rng.below(500) == 0 { f32::NAN } else { 0.4 }),
                ..Pen::default()
            };
            let t_us = tick * 8333 + half * 4000 + skew;
            let sample = Sample { device: DeviceId(0), t_us, device_t_us: None, body: Body::Pen(body) };
            sender.push(sample);
            if rng.below(1000) == 0 {
                sender.push(sample);
            }
        }
        sender.flush();
        // A slow loop: nothing is taken for a while, the channel fills and motion is coalesced.
        if slow > 0 {
            slow -= 1;
            continue;
        }
        samples.clear();
        receiver.drain(4096, &mut samples);
        let commands = match rng.below(400) {
            0 => vec![Command::Undo],
            1 => vec![Command::Redo],
            2 => vec![Command::LiftAll],
            _ => vec![],
        };
        world.step(tick, &samples, &commands);
        let at = |e: String| format!("tick {tick}: {e}");
        world.verify_invariants().map_err(at)?;
        let lost = receiver.stats().total().lost_transition;
        if lost != 0 {
            return Err(format!("tick {tick}: {lost} transitions lost"));
        }
        // Memory after the undo store has filled is memory for good.
        let bytes = world.mesh().memory().at_rest() as f64;
        if tick == ticks / 2 {
            settled = Some(bytes);
        }
        if let Some(before) = settled
            && bytes > before * 1.1 + 8e6
        {
            return Err(format!("tick {tick}: {bytes} bytes, {before} half way"));
        }
    }
    Ok(())
}

#[test]
fn an_hour_of_faults() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let number = |key: &str| std::env::var(key).ok().and_then(|v| v.parse::<u64>().ok());
    let seed = number("SCULPTD_SEED").unwrap_or(20);
    let ticks = number("SCULPTD_TICKS").unwrap_or(if long { 432_000 } else { 3_000 });
    if let Err(e) = soak(seed, ticks) {
        panic!("{e}; again: SCULPTD_SEED={seed} SCULPTD_TICKS={ticks} cargo test --release --test it soak");
    }
}
