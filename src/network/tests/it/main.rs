//! The protocol on a simulated network: loss, delay, reordering, silence and the death of hosts,
//! all from a seed, around worlds that really sculpt.

#![allow(clippy::print_stdout)] // Traffic and times are told on standard output.

mod attacks;
mod echo;
mod faults;
mod fleet;
mod fleet_simulated;
mod keys;
mod members;
mod people;
mod replay;
mod simulated;
