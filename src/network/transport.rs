//! What carries datagrams between stations. It may lose, delay, repeat and reorder them; a station
//! copes with all of that.

use crate::core::To;
use crate::wire::message::Address;

/// Carries datagrams.
pub trait Transport: Send + std::fmt::Debug {
    /// Sets whether datagrams for the current host arrive here from now on.
    fn hosts(&mut self, on: bool);
    /// Sets the local address: datagrams for it arrive here. Called once, before all else.
    fn listen(&mut self, address: Address) -> Result<(), String>;
    /// Sends; never waits.
    fn send(&mut self, to: To, bytes: Vec<u8>);
    /// Datagrams that have come.
    fn incoming(&self) -> crossbeam_channel::Receiver<Vec<u8>>;
}
