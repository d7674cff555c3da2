//! Where things are in a window of 1280 x 720 pixels at scale 1: the one list of places that the
//! tests press on.

type Place = (i32, i32);

/// The mirror over x, in the header.
pub const MIRROR_X: Place = (888, 20);
/// The slider of the radius, in the header.
pub const RADIUS: Place = (271, 20);

/// Brushes in the left panel.
pub const DRAW: Place = (43, 105);
pub const CLAY: Place = (119, 105);
pub const CLAY_STRIPS: Place = (195, 105);

/// The icons of the pages, from the left.
pub const fn page(number: i32) -> Place {
    (1050 + 25 * number, 61)
}

/// The scene page with two objects.
pub const NAME_OF_FIRST: Place = (1180, 146);
pub const NAME_OF_SECOND: Place = (1180, 172);
pub const EYE_OF_SECOND: Place = (1047, 172);
pub const GIZMO: Place = (1063, 240);
pub const FOLLOW: Place = (1044, 266);
/// From where the menu of an object's name was opened to the difference in it.
pub const DIFFERENCE: Place = (-98, 236);

/// The same with a layer, the first object active.
pub const ADD_LAYER: Place = (1117, 484);
pub const EYE_OF_LAYER: Place = (1047, 510);
pub const SLIDER_OF_LAYER: Place = (1160, 536);
pub const FACE_SETS: Place = (1080, 656);

/// The same after so many turns of the wheel, with the face sets unfolded.
pub const TURNS: u32 = 4;
pub const SET_FROM_MASK: Place = (1095, 414);
/// Once there is one set.
pub const EYE_OF_SET: Place = (1065, 414);

/// The first finding of the Check page.
pub const FIRST_FINDING: Place = (1150, 490);
/// The list of languages on the page of preferences.
pub const LANGUAGES: Place = (1195, 139);

/// An exhibit, and the page behind the PIN.
pub const EXHIBIT_CARVE: Place = (307, 645);
pub const EXHIBIT_FINISHED: Place = (978, 645);
pub const EXHIBIT_COMPARE: Place = (1090, 513);
pub const STAFF_DOOR: Place = (1196, 75);
/// "End for good" on a page without a gallery.
pub const STAFF_END: Place = (891, 440);
/// The same with a gallery.
pub const STAFF_END_BESIDE_EXPORT: Place = (891, 500);

/// A key of the keypad, from 1; 11 is 0 and 12 is OK.
pub const fn staff_key(number: i32) -> Place {
    (1045 + (number - 1) % 3 * 80, 136 + (number - 1) / 3 * 76)
}
