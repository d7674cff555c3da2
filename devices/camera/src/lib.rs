//! Bare hands from any webcam: pictures in, hand samples in mm out. No Python at run time, no
//! network, no graphics card; frames never leave the process and nothing is stored.
//!
//! **Read first:** [`hand_camera`], which puts the parts together; then [`camera_thread`], which
//! runs them.
//!
//! | module | what it does |
//! |---|---|
//! | [`source`] | pictures from a camera, a folder, Motion JPEG or Y4M |
//! | [`inference`] | runs the hand models on one core |
//! | [`models`] | the model files: found, checked, installed |
//! | [`palm`], [`landmarks`] | where palms are; the 21 joints of one hand |
//! | [`hand_tracks`] | hands from picture to picture |
//! | [`spatial`], [`lens`] | pixels to millimetres in the tracker's axes |
//! | [`hand_sample`] | joints to the hand that a tracker would report |
//! | [`drawn`], [`drawn_hand`], [`performance`] | pictures of hands whose joints are known |
//! | [`skeleton`] | the bones between joints, drawn over a picture |
//!
//! Rules:
//! * Nothing that a camera or a file can send panics or allocates without bound.
//! * A hand that is not clear has a low confidence, and a hand of low confidence neither begins
//!   nor ends a pinch.
//! * The same pictures give the same samples.

#![deny(missing_docs)]

pub mod camera_thread;
pub mod drawn;
pub mod drawn_hand;
pub mod hand_camera;
pub mod hand_sample;
pub mod hand_tracks;
pub mod inference;
pub mod landmarks;
pub mod lens;
pub mod models;
pub mod palm;
mod palm_pose;
pub mod performance;
pub mod picture;
pub mod sha256;
pub mod skeleton;
pub mod source;
pub mod spatial;
mod steady_shape;
