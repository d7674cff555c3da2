#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sculptd::fuzzing::mesh_bytes("obj", data));
