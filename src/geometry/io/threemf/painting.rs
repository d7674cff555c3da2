//! The attributes in which slicers keep the filament of a triangle: `slic3rpe:mmu_segmentation` of
//! PrusaSlicer, `paint_color` of OrcaSlicer and Bambu Studio. Both have the same code.
//!
//! A code is a tree of hexadecimal digits, the root last: the lower two bits of a digit are the
//! number of cuts of the triangle, the upper two the filament of a piece that is not cut, where 3
//! stands for a filament of 3 plus the digit before. sculptd paints whole triangles alone.

/// The code of a whole triangle of filament 1 to 16; `None` beyond.
pub(in crate::io) fn filament_code(filament: u8) -> Option<String> {
    match filament {
        1..=2 => Some(format!("{:X}", filament << 2)),
        3..=16 => Some(format!("{:X}C", filament - 3)),
        _ => None,
    }
}

/// The painting of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum TrianglePaint {
    /// The filament of the object.
    #[default]
    None,
    /// The number of a filament, from 1.
    Filament(u8),
    /// Pieces with several filaments, or two slicers' attributes that differ.
    Other,
}

/// The painting of a triangle that has these two attributes.
pub(super) fn paint_of(prusa: Option<&str>, orca: Option<&str>) -> TrianglePaint {
    let of = |code: Option<&str>| match code.map(str::trim) {
        None | Some("") => TrianglePaint::None,
        Some(code) => (1..=16)
            .find(|&f| filament_code(f).is_some_and(|c| c.eq_ignore_ascii_case(code)))
            .map_or(TrianglePaint::Other, TrianglePaint::Filament),
    };
    match (of(prusa), of(orca)) {
        (a, b) if a == b => a,
        (_, _) if prusa.is_some() && orca.is_some() => TrianglePaint::Other,
        (TrianglePaint::None, only) | (only, _) => only,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_the_slicers() {
        let known = ["4", "8", "0C", "1C", "2C", "3C", "4C", "5C", "6C", "7C", "8C", "9C", "AC"];
        let more = ["BC", "CC", "DC"];
        for (code, filament) in known.into_iter().chain(more).zip(1u8..) {
            assert_eq!(filament_code(filament).as_deref(), Some(code));
            for (a, b) in [(Some(code), Some(code)), (None, Some(code)), (Some(code), None)] {
                assert_eq!(paint_of(a, b), TrianglePaint::Filament(filament));
            }
        }
        assert_eq!((filament_code(0), filament_code(17)), (None, None));
        assert_eq!(paint_of(None, None), TrianglePaint::None);
        assert_eq!(paint_of(Some("48403"), None), TrianglePaint::Other);
        assert_eq!(paint_of(Some("4"), Some("8")), TrianglePaint::Other);
    }
}
