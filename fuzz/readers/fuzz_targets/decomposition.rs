#![no_main]

#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(
    // Parry's panics are caught in the core; libFuzzer's hook would end the run before. Others
    // still end it.
    init: std::panic::set_hook(Box::new(|_| {})),
    |data: &[u8]| targets::decomposition(data)
);
