//! What happens while a part is built in layers: how it stands on its plate, what begins in the
//! air, what is sealed, and what needs support.

pub mod bridge;
pub mod overhangs;
pub mod placement;
pub mod plate;
pub mod sweep;
mod voids;
