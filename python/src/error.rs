//! What goes wrong, as an exception of Python.

use std::fmt::Display;

use pyo3::PyErr;

pyo3::create_exception!(
    videg,
    Error,
    pyo3::exceptions::PyException,
    "videg cannot do what was asked for. The message names the thing, its value and the bound."
);

/// The exception that says `error`, and why.
pub fn error(error: impl Display) -> PyErr {
    // An option has the name of the argument here.
    Error::new_err(without_dashes(&format!("{error:#}")))
}

/// The same where the package calls the option `--columns` of the command line `record`.
pub fn error_of_record(error: impl Display) -> String {
    let said = error.to_string();
    said.strip_prefix("--columns").map_or_else(|| said.clone(), |rest| format!("--record{rest}"))
}

/// `text` with `--until-precision` as `until_precision`.
fn without_dashes(text: &str) -> String {
    let mut said = String::with_capacity(text.len());
    for (index, word) in text.split(' ').enumerate() {
        if index > 0 {
            said.push(' ');
        }
        match word.strip_prefix("--").filter(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase())) {
            Some(option) => {
                let end = option.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(option.len());
                said.push_str(&option[..end].replace('-', "_"));
                said.push_str(&option[end..]);
            }
            None => said.push_str(word),
        }
    }
    said
}
