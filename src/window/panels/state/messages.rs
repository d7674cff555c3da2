//! The messages of background tasks.

#[derive(Debug, Clone)]
pub struct Message {
    pub text: String,
    pub wrong: bool,
    /// Seconds on egui's clock when it was first shown; set by the panel.
    pub since: Option<f64>,
}
