//! Simulated devices that send bytes through the same parsers and reader threads as real devices.
//!
//! A **script** ([`PenScript`], [`HandScript`]) gives the position of a pen or a hand at any
//! instant. A **device** ([`SimTablet`], [`SerialPen`], [`Tracker`]) turns it into bytes.
//! [`Faults`] damage the bytes, in the same way for the same seed. The owner advances a device
//! (`advance(until)`), so that with a manual [`crate::Clock`] two runs give the same bits.
//!
//! A hand tracker, its client, and every frame of a performance, with no hardware and no waiting
//! for the clock:
//!
//! ```
//! use std::time::Duration;
//! use sculptd_devices::{Clock, leap, queue, sim};
//!
//! let mut tracker = sim::Tracker::new(sim::journal().hands, sim::TrackerConfig::default())?;
//! let (factory, mut samples) = queue::channel(1024);
//! let clock = Clock::manual();
//! let config = leap::LeapConfig { url: tracker.url(), ..leap::LeapConfig::default() };
//! let _client = leap::start(config, clock.clone(), factory.sender())?;
//! assert!(tracker.wait_for_client(Duration::from_secs(10)));
//! for us in (0..200_000).step_by(10_000) {
//!     clock.set_us(us);
//!     for _ in 0..tracker.advance(us) {
//!         let sample = samples.next_within(Duration::from_secs(10)).expect("one for each frame");
//!         assert!(sample.t_us <= us);
//!     }
//! }
//! # Ok::<(), std::io::Error>(())
//! ```

pub mod faults;
pub mod hand;
pub mod jitter;
pub mod journal;
pub mod pen;
pub mod serial;
pub mod tablet;
pub mod tracker;

pub use faults::Faults;
pub use hand::{HandKey, HandScript, Performer};
pub use jitter::{Jitter, JitterState};
pub use journal::{Journal, journal};
pub use pen::{PenPose, PenScript, Shape, Stroke};
pub use serial::{SerialPen, SerialPenConfig};
pub use tablet::{SimTablet, TabletConfig, TabletEnd};
pub use tracker::{Tracker, TrackerConfig};
