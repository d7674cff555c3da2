//! What a collection is for, by its usage.

use hidreport::Field;

use super::page_id;

/// Kind of an application collection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CollectionKind {
    /// A digitiser, pen or stylus.
    Pen,
    /// A touch screen or touch pad.
    Touch,
    /// A mouse, absolute or relative.
    Mouse,
    /// A keyboard.
    Keyboard,
    /// Media keys.
    Consumer,
    /// A page that a vendor defined.
    Vendor,
    /// Anything else.
    Other,
}

/// Returns the kind of the innermost collection that has one.
pub(super) fn kind_of(field: &Field) -> Option<CollectionKind> {
    let mut kind = None;
    for c in field.collections() {
        for u in c.usages() {
            let (page, id) = page_id(u32::from(u));
            let this = match (page, id) {
                (0x0d | 0xff0d, 0x22 | 0x04 | 0x05) => Some(CollectionKind::Touch),
                (0x0d | 0xff0d, 0x01 | 0x02 | 0x20) => Some(CollectionKind::Pen),
                (0x0d, 0x03) => Some(CollectionKind::Pen),
                (0x01, 0x02) => Some(CollectionKind::Mouse),
                (0x01, 0x06) => Some(CollectionKind::Keyboard),
                (0x0c, _) => Some(CollectionKind::Consumer),
                (p, _) if p >= 0xff00 => Some(CollectionKind::Vendor),
                _ => None,
            };
            kind = match (kind, this) {
                // A finger inside a digitiser is a finger; a stylus inside a touch screen is a
                // stylus.
                (_, Some(CollectionKind::Touch)) => Some(CollectionKind::Touch),
                (Some(CollectionKind::Touch), Some(CollectionKind::Pen)) if id == 0x20 => {
                    Some(CollectionKind::Pen)
                }
                (None, this) => this,
                (Some(CollectionKind::Vendor), Some(this)) => Some(this),
                (kept, _) => kept,
            };
        }
    }
    kind.or(Some(CollectionKind::Other))
}
