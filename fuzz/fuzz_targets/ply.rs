#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| deepshade_fuzz::run("ply", data));
