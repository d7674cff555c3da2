//! The system's random bytes, for those who do not simulate.

use ring::rand::{SecureRandom, SystemRandom};

use crate::keyring::Entropy;

/// Random bytes of the operating system.
///
/// # Panics
/// If the operating system has none: no key may be made then.
pub fn system_entropy() -> Entropy {
    let random = SystemRandom::new();
    Box::new(move |bytes| {
        assert!(random.fill(bytes).is_ok(), "the operating system gives no random bytes");
    })
}
