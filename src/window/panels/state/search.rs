//! The search for an action by name.

#[derive(Debug, Default)]
pub struct SearchBox {
    pub text: String,
    pub(in crate::panels) at: usize,
    pub(in crate::panels) begun: bool,
}
