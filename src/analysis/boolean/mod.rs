//! Union, intersection and both differences of polygon solids.
