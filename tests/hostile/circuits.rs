//! Circuit FMUs that are none, and mappings of their variables that say nothing, too much or what a terminal would execute.

use super::sandbox::{Input, refused};

fn circuit(what: &'static str, options: &[&str], files: Vec<(&'static str, Vec<u8>)>) -> Input {
    let words = [&["cosim", "--circuit-fmu", "evil.fmu", "--until", "0.1", "--output", "out"][..], options].concat();
    refused(what, &words, files)
}

fn file(what: &'static str, text: impl Into<Vec<u8>>) -> Input {
    circuit(what, &["--map-file", "map.toml"], vec![("map.toml", text.into())])
}

/// Given to `--circuit-fmu`, `--map` and `--map-file`.
pub fn inputs() -> Vec<Input> {
    let option = |what, text: &str| circuit(what, &["--map", text], Vec::new());
    vec![
        circuit("an archive that is none", &[], vec![("evil.fmu", b"PK\x03\x04 no archive".to_vec())]),
        circuit("no FMU", &[], Vec::new()),
        option("an entry without a variable", "left.voltage="),
        option("a factor that is no number", "left.voltage=u*NaN"),
        option("an infinite factor", "left.voltage=u*inf"),
        circuit("a name twice", &["--map", "left=none", "--map", "left=none"], Vec::new()),
        circuit("a mapping without end", &["--map-file", "/dev/zero"], Vec::new()),
        circuit("a mapping that is a folder", &["--map-file", "."], Vec::new()),
        file("a mapping of binary data", (0..=255).collect::<Vec<u8>>()),
        file("tables without end", "[map]\na = ".to_owned() + &"[".repeat(100_000)),
        file("an escape sequence in a name", "[map]\nleft.voltage = \"\\u001b[2J\"\n"),
        file("a variable that is a list", "[map]\nleft.voltage = [\"u\"]\n"),
        file("a factor that is text", "[map]\nleft.voltage = { variable = \"u\", factor = \"1\" }\n"),
        file("a start value that is a date", "[set]\nR = 2020-01-01\n"),
        file("a key twice", "[map]\nleft = \"none\"\nleft = \"none\"\n"),
    ]
}
