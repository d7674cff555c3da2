//! The one module in which `unsafe` is allowed, for one reason: calling a function compiled for
//! AVX2 is only sound on a processor that has it, and only a run-time check can know. Everything
//! that is dispatched here has a portable twin that gives the same bits: no fused multiply-add, the
//! same order of operations.
#![allow(unsafe_code)]

pub mod cotangents;
pub mod leaves;
pub mod rings;
#[cfg(target_arch = "x86_64")]
mod token;
pub mod wide;
