#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sculptd::fuzzing::page_bytes(data));
