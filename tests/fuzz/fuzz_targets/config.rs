#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sculptd::fuzzing::config_bytes(data));
