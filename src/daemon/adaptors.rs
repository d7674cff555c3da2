//! Starting what the configuration asks for.
