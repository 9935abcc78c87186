#![no_main]

videg_fuzz::program!(videg_fuzz_targets::TARGETS);
