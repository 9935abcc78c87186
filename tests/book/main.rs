//! The book holds what it says: every code block of its chapters and of the README runs, and what is printed is what they
//! show. `UPDATE_BOOK=1 cargo test --test book -- --include-ignored` writes outputs, reference pages and scripts anew.
//!
//! | block | what happens to it |
//! |---|---|
//! | `console` | commands after `$ ` run one by one in a copy of the source tree; what they print is compared |
//! | `sh`, `bash` | commands to choose from: the tool takes their arguments, and each runs to the end with exit code 0 |
//! | `python` | all blocks of a chapter run in order in one interpreter; a `text` block behind one is what it prints |
//! | `rust` | a documentation test: `src/book.rs` and `fmu/export/src/lib.rs` list the chapters |
//! | `c`, `spice`, `toml`, `json`, `xml`, `csv` | a file that a command of the chapter takes; `toml` without a name: a case file |
//! | `diff` | a change of the sources: it applies, and they compile and pass their tests with it |
//!
//! A comment before a block says more: `<!-- file: NAME -->` writes it into a file before the chapter begins;
//! `<!-- run by PATH -->` says that the test at this path runs it, which names the page;
//! `<!-- not run: REASON -->` leaves it alone, and with `not run "PART" "OTHER": REASON` only those of its lines that
//! contain one of these.
//! Only programs that are known not to install anything or work for hours run at all (`console.rs`); others need such a comment.
//! In what is printed, `...` stands for any words of a line, and alone on a line for any lines, of which some must be shown.
//! Numbers with a point or an exponent are compared to 0.1 %, all else exactly.

#![cfg(unix)] // A shell runs the commands.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

mod block;
mod chapter;
mod clone;
mod compare;
mod console;
mod interpreter;
mod links;
mod notebook;
mod patch;
mod reference;
mod results;
mod run;

use std::path::{Path, PathBuf};

use videg_golden::Golden;

/// Outputs in the chapters, reference pages, scripts.
const GOLDEN: Golden = Golden::new("UPDATE_BOOK", "cargo test --test book -- --include-ignored");

/// Root of the source tree.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The interpreter of `./test.sh setup`. Without it Python blocks cannot run; under `./test.sh` they must.
fn python() -> Option<PathBuf> {
    let found = root().join(".venv/bin/python");
    assert!(found.exists() || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "{} is not there", found.display());
    found.exists().then_some(found)
}

/// Whether ngspice is there; under `./test.sh` it must be.
fn has_ngspice() -> bool {
    let found = videg::ngspice::Ngspice::find(None).is_ok();
    assert!(found || std::env::var_os("VIDEG_ALL_TOOLS").is_none(), "ngspice is not there");
    found
}
