//! The programs that libFuzzer runs. What they check stands in `tests/fuzz-targets`, where a stable compiler can use it.

/// The program of the target that is called as this program, in a table of them.
#[macro_export]
macro_rules! program {
    ($targets:expr) => {
        static TARGETS: &[videg_fuzz_targets::Target] = &$targets;

        libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
            (videg_fuzz_targets::find(TARGETS, env!("CARGO_BIN_NAME")).check)(bytes);
        });
    };
}
