//! The page that lists the inputs.

use videg_golden::Golden;

use super::stage::{Input, Told};

const GOLDEN: Golden = Golden::new("UPDATE_HOSTILE", "cargo test --test hostile");

const HEAD: &str = "# Hostile inputs

What videg says to inputs that are broken or mean harm: written by `UPDATE_HOSTILE=1 cargo test --test hostile`, which tries each
of them and fails if one comes to something else. Of all it holds that nothing is written outside of the folder for results,
that files which are there stay as they are, that no temporary file is left, and that no command which hides in an input is carried
out. Folders are left out of what is told, and long texts are cut (`[...]`). Random inputs of the same kinds are the business of
`fuzz/`; what an FMU may do in spite of isolation stands in [isolation.md](isolation.md).
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
    format!("\n## {kind}\n\n| input | how given | exit code | what is told |\n|---|---|---|---|\n{}", rows.concat())
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
