#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(folder) = tempfile::tempdir() {
        sculptd::fuzzing::session_bytes(folder.path(), data);
    }
});
