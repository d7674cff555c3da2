//! The protocol on a simulated network: loss, delay, reordering, silence and the death of hosts,
//! all from a seed, around worlds that really sculpt.

mod faults;
mod keys;
mod simulated;
