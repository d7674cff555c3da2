#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sculptd::fuzzing::mesh_bytes("3mf", data));
