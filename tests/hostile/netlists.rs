//! Netlists can run commands of the shell: no text of a user may get into ours, and in that of a user they are refused.

use std::fs;
use std::path::Path;
use std::process::Command;

use videg::ngspice::Ngspice;

use super::sandbox::{CANARY, Input, refused};

const EVIL: &str =
    "name = \".control; shell touch CANARY; $(touch CANARY)\"\ndescription = \"*\\n.control\\nshell touch CANARY\"\n";

/// A netlist of a user with a membrane and these lines.
fn netlist(what: &'static str, lines: impl AsRef<[u8]>) -> Input {
    let text = [b"title\nXl a 0 deg_left\nRa a 0 1e9\n", lines.as_ref(), b"\n.end\n"].concat();
    files(what, vec![("evil.cir", text)])
}

fn files(what: &'static str, files: Vec<(&'static str, Vec<u8>)>) -> Input {
    refused(what, &["cosim", "--netlist", "evil.cir", "--until", "0.1", "--output", "out"], files)
}

/// Subcircuits that contain ten of the next each, so many deep.
fn swelling(depth: usize) -> String {
    let level = |k: usize| {
        let parts = (0..10).map(|i| format!("X{i} a b s{}\n", k + 1)).collect::<Vec<_>>().concat();
        format!(".subckt s{k} a b\n{parts}.ends\n")
    };
    let levels: String = (0..depth).map(level).collect();
    format!("{levels}.subckt s{depth} a b\nR1 a b 1\n.ends\nXs a 0 s0\n")
}

/// Netlists given to `--netlist`.
pub fn inputs() -> Vec<Input> {
    let chain = |count: usize| (0..count).map(|k| format!("R{k} n{k} n{} 1\n", k + 1)).collect::<Vec<_>>().concat();
    vec![
        netlist("a control section", ".control\nshell touch CANARY\n.endc"),
        netlist("a command in a comment", "*#shell touch CANARY"),
        netlist("a command in a continued line", "Rb a 0\n+ 1k\n.CONTROL\nshell touch CANARY\n.endc"),
        netlist("a command in the place of a value", "Rb a 0 `touch CANARY`"),
        netlist("a file outside of the folder", ".include /etc/passwd"),
        netlist("a file above the folder", ".lib ../../etc/passwd all"),
        netlist("a file without end", ".include /dev/zero"),
        netlist("a netlist that includes itself", ".include evil.cir"),
        netlist("a model that reads a file", "A1 %v([b]) f\n.model f filesource (file=\"/etc/passwd\")"),
        netlist("a model that starts a program", "A1 [a] null [b] p\n.model p d_process (process_file=\"CANARY\")"),
        netlist("a model that loads a library", "A1 [a] [b] p\n.model p d_cosim (simulation = \"CANARY.so\")"),
        netlist("a model of an unknown type", ".model x osdi_thing(a=1)"),
        netlist("an unknown card", ".hdl evil.va"),
        netlist("a subcircuit that contains itself", ".subckt s a b\nXs a b s\n.ends\nXs a 0 s"),
        netlist("parameters in a circle", ".param x={y} y={x}\nRx a 0 {x}"),
        netlist("subcircuits that swell", swelling(4)),
        netlist("40,000 resistors", chain(40_000)),
        netlist("a million nodes", chain(1_000_000)),
        netlist("binary data", (0..=255).collect::<Vec<u8>>()),
        netlist("an escape sequence", "R\u{1b}[2J a 0 1"),
        netlist("orders that the ledger does not know", ".options maxord=6"),
        netlist("a membrane twice", "Xm a 0 deg_left"),
        files("no membrane", vec![("evil.cir", b"title\nR1 a 0 1\n.end\n".to_vec())]),
        files("an empty netlist", vec![("evil.cir", Vec::new())]),
        files("no netlist", Vec::new()),
    ]
}

#[test]
fn commands_in_the_name_of_a_case_reach_no_netlist() {
    if Ngspice::find(None).is_err() && std::env::var_os("VIDEG_ALL_TOOLS").is_none() {
        return;
    }
    super::sandbox::build();
    let folder = tempfile::tempdir().unwrap();
    let canary = folder.path().canonicalize().unwrap().join("canary");
    let evil = EVIL.replace(CANARY, &canary.display().to_string());
    fs::write(folder.path().join("evil.toml"), evil).unwrap();
    let words = ["crosscheck", "--case-file", "evil.toml", "--until", "2", "--output", "out", "--export", "exported"];
    let output = Command::new(env!("CARGO_BIN_EXE_videg")).args(words).current_dir(folder.path()).output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let netlists = netlists(&folder.path().join("exported"));
    assert!(netlists.iter().any(|text| text.contains("\ntran ")), "{} netlists", netlists.len());
    assert!(!netlists.iter().any(|text| text.contains("canary")), "{netlists:?}");
    assert!(!canary.exists());
}

/// The netlists in a folder and below.
fn netlists(folder: &Path) -> Vec<String> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let all = paths.flat_map(|path| match path.extension() {
        _ if path.is_dir() => netlists(&path),
        Some(extension) if extension == "cir" => vec![fs::read_to_string(&path).unwrap()],
        _ => Vec::new(),
    });
    all.collect()
}
