//! Small pictures of the object after each step, as far as they are taken.

use std::sync::mpsc;

/// A picture that the card is still drawing.
#[derive(Debug)]
pub(super) struct PendingPicture {
    pub(super) step: usize,
    pub(super) mark: u64,
    pub(super) bytes: wgpu::Buffer,
    pub(super) mapped: mpsc::Receiver<bool>,
}

/// Taken pictures and those under way.
#[derive(Debug, Default)]
pub(super) struct StepPictures {
    pub(super) target: Option<wgpu::Texture>,
    pub(super) pending: Option<PendingPicture>,
    /// The revision that was looked at last, and the steps then.
    pub(super) seen: Option<u64>,
    pub(super) steps: (usize, usize),
}
