#![no_main]

#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(
    // Panics of the decoder of JPEG are caught; libFuzzer's hook would end the run before. Others
    // still end it.
    init: std::panic::set_hook(Box::new(|_| {})),
    |data: &[u8]| targets::image(data)
);
