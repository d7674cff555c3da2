//! Simplify: draws small triangles together to the wanted size, and leaves large ones; the form stays.
//!
//! The cutting is that of every brush that cuts ([`super::options::Topology`]); its own file turns it on.

use super::dab::{Brush, Change, Dab, Spot};
use crate::brush::surface_query::Ground;
use super::relax::Relax;

#[derive(Debug, Clone, Copy)]
pub struct Simplify(Relax);

impl Brush for Simplify {
    fn ready(dab: &Dab<'_>, on: &mut Ground<'_>) -> Self {
        Simplify(Relax::ready(dab, on))
    }

    fn change(&self, dab: &Dab<'_>, spot: &Spot<'_>) -> Change {
        self.0.change(dab, spot)
    }
}
