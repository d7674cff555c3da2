//! Primitive solids, for the start of a session and as tools.
