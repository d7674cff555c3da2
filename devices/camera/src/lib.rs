//! Bare hands from any webcam.

pub mod inference;
