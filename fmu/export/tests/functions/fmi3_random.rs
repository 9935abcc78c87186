//! Random calls of FMI 3.0 in any order, with arguments right and wrong, within steps, too: each answer is held against the table
//! and against what is known of the state of the instance.

use crate::common::fmi3::fmu;
use fmu_host::fmi3::{Fmu, run};

/// Sequences; few for Miri, which is a thousand times slower.
const SEQUENCES: u64 = if cfg!(miri) { 40 } else { 100_000 };

/// Texts, most of which make a hook of the toy fail.
const WORDS: [&core::ffi::CStr; 17] = [
    c"",
    c"",
    c"",
    c"other",
    c"\xff",
    c"panic getter",
    c"error step",
    c"warning step",
    c"discard step",
    c"refuse step",
    c"terminate step",
    c"panic step",
    c"fatal step",
    c"error terminate",
    c"fatal terminate",
    c"panic event handler",
    c"fatal event handler",
];

#[test]
fn a_hundred_thousand_random_call_sequences_go_as_the_table_says() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // The toy panics often.
        if !info.to_string().contains("panic in ") {
            hook(info);
        }
    }));
    let fmu = Fmu { words: WORDS.map(Into::into).to_vec(), ..fmu() };
    let census = run(&fmu, 0..SEQUENCES);
    drop(std::panic::take_hook());
    if !cfg!(miri) {
        assert!(census.statuses.iter().all(|count| *count > 200) && census.restored > 1000, "{census:?}");
        // Six states of model exchange, six of co-simulation, and what is called within a step.
        assert_eq!(census.cells.len(), 70 * (6 + 6 + 1), "every function in every state");
    }
}
