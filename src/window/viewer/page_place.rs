//! Where a vertex of the clay lies among those of the card.

use sculptd_clay::Page;

/// Returns the index of a page's vertex on the card. A halo vertex is drawn from its home's slot,
/// so that every vertex is stored once.
pub fn place(page: &Page, p: usize, slot: usize, v: impl Into<u64>) -> u32 {
    let v = v.into() as usize;
    let (home, local) = match v.checked_sub(page.own()) {
        None => (p, v),
        Some(k) => {
            let (home, local) = page.topology().halo_home(k);
            (home as usize, local as usize)
        }
    };
    (home * slot + local) as u32
}
