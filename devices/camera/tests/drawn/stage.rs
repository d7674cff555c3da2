//! What the tests share: the models, a camera, and a look at drawn hands.

use std::path::PathBuf;

use glam::Vec3;
use sculptd_camera::drawn::{DrawnScene, draw, draw_exposed};
use sculptd_camera::drawn_hand::DrawnHand;
use sculptd_camera::hand_camera::{HandCamera, HandCameraSettings};
use sculptd_camera::models;
use sculptd_devices::filter::{HandsFilter, OneEuro};
use sculptd_devices::sim::hand::HandKey;
use sculptd_devices::{Body, DeviceId, Hand, Hands};

/// Time between two pictures, microseconds.
pub const FRAME_US: u64 = 33_333;

/// True if the full counts are asked for.
pub fn long() -> bool {
    std::env::var_os("SCULPTD_LONG").is_some()
}

/// The folder of the models; says that the test is skipped if there is none.
pub fn models_folder() -> Option<PathBuf> {
    let mut looked: Vec<PathBuf> =
        std::env::var_os("SCULPTD_CAMERA_MODELS").into_iter().map(PathBuf::from).collect();
    if let Some(home) = std::env::var_os("HOME") {
        looked.push(PathBuf::from(home).join(".local/share/sculptd/hand-models"));
    }
    match models::find(&looked) {
        Ok(folder) => Some(folder),
        Err(e) => {
            println!("skipped: {e}");
            None
        }
    }
}

/// A camera before which hands are drawn, with the filter of the hand tools behind it.
pub struct Stage {
    pub camera: HandCamera,
    filter: HandsFilter,
    pub scene: DrawnScene,
    pub t_us: u64,
}

impl Stage {
    pub fn new(settings: HandCameraSettings) -> Option<Self> {
        let tracks = models::load(&models_folder()?).expect("the models load");
        let camera = HandCamera::new(tracks, settings, DeviceId(210));
        let filter = HandsFilter::new(OneEuro::default());
        Some(Stage { camera, filter, scene: DrawnScene::default(), t_us: 1_000_000 })
    }

    /// Draws the next picture and returns the hands as the camera reports them.
    pub fn see(&mut self, hands: &[DrawnHand]) -> Hands {
        self.scene.seed = self.scene.seed.wrapping_add(1);
        self.t_us += FRAME_US;
        let sample = self.camera.look(draw(&self.scene, hands), self.t_us);
        let Body::Hands(seen) = sample.body else { panic!("{sample:?}") };
        seen
    }

    /// The same with hands that move while the shutter is open, for half of the time between two
    /// pictures. `at`: the hands at a share of that time.
    pub fn see_moving(&mut self, at: impl Fn(f32) -> Vec<DrawnHand>) -> Hands {
        self.scene.seed = self.scene.seed.wrapping_add(1);
        self.t_us += FRAME_US;
        let moments: Vec<_> = [0.0, 0.5, 1.0].map(&at).into();
        let sample = self.camera.look(draw_exposed(&self.scene, &moments), self.t_us);
        let Body::Hands(seen) = sample.body else { panic!("{sample:?}") };
        seen
    }

    /// The same after the filter.
    pub fn see_steady(&mut self, hands: &[DrawnHand]) -> Hands {
        let mut seen = self.see(hands);
        self.filter.apply(&mut seen, self.t_us);
        seen
    }
}

/// An upright hand with its palm to the camera, this far from it.
pub fn upright(depth: f32) -> HandKey {
    HandKey::flat(0, Vec3::new(10.0, 210.0, depth - 450.0))
        .turned(0.0, std::f32::consts::FRAC_PI_2, 0.0)
        .spread(0.3)
}

/// The joints of a reported hand in the order of the landmarks.
pub fn joints(hand: &Hand) -> Option<[Vec3; 21]> {
    let mut all = [hand.wrist?; 21];
    for (finger, own) in hand.fingers.iter().zip(all[1..].as_chunks_mut::<4>().0) {
        for (to, joint) in own.iter_mut().zip(&finger.as_ref()?.joints[1..]) {
            *to = (*joint)?;
        }
    }
    Some(all)
}

/// Runs a part of a count on each processor; each part is given its number and its share.
pub fn shared_out<T: Send>(count: usize, part: impl Fn(u64, usize) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count);
    std::thread::scope(|scope| {
        let part = &part;
        let share = |i: usize| (count * (i + 1)) / threads - (count * i) / threads;
        let run = (0..threads).map(|i| scope.spawn(move || part(i as u64, share(i))));
        run.collect::<Vec<_>>().into_iter().map(|t| t.join().expect("no part failed")).collect()
    })
}

/// Mean and standard deviation.
pub fn spread(values: &[f32]) -> (f32, f32) {
    let n = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / n;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / n;
    (mean, square.sqrt())
}
