//! The page that lists the inputs.

use videg_golden::Golden;

use super::sandbox::{Input, Told};

const GOLDEN: Golden = Golden::new("UPDATE_HOSTILE", "cargo test --test hostile -- --ignored");

const HEAD: &str = "# Hostile inputs

The tables list broken and hostile inputs with the message of videg. `UPDATE_HOSTILE=1 cargo test --test hostile -- --ignored` writes them. The test tries
each input and fails if the result differs. For every input it checks that nothing is written outside the folder for results,
that existing files do not change, that no temporary file stays, and that no command inside an input is executed.
Messages are shown without folders, and long texts are cut (`[...]`). `fuzz/` tests random inputs of the same kinds. [Isolation](isolation.md)
lists what an FMU can do in spite of isolation.
";

/// Longest cell, characters.
const LONGEST: usize = 330;

/// A row of the table.
pub fn row(input: &Input, told: &Told) -> String {
    let code = told.code.map_or_else(|| "-".to_owned(), |code| code.to_string());
    format!("| {} | {} | {code} | {} |\n", cell(input.what), code_of(&input.shown()), cell(&told.line))
}

/// A table with its heading.
pub fn section(kind: &str, rows: &[String]) -> String {
    format!("\n## {kind}\n\n| input | command | exit code | message |\n|---|---|---|---|\n{}", rows.concat())
}

/// Compares the page with what was found, or writes it.
pub fn check(sections: &[String]) {
    let page = format!("{HEAD}{}", sections.concat());
    GOLDEN.file(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/hostile-inputs.md"), &page);
}

fn code_of(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{}`", text.replace('|', "\\|").replace('`', "'")) }
}

fn cell(text: &str) -> String {
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short += " [...]";
    }
    // What looks like HTML or a column is text.
    let text = short.replace('|', "\\|").replace('<', "&lt;").replace('*', "\\*").replace('_', "\\_");
    text.trim().to_owned()
}
