#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sculptd_devices::fuzzing::leap_bytes(data));
