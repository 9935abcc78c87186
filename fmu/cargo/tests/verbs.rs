//! `cargo fmu` as Cargo calls it. What its FMUs do is tested in `tests/exporter`.

use std::io;
use std::path::Path;
use std::process::{Command, Output};

fn cargo_fmu(folder: &Path, arguments: &[&str]) -> io::Result<Output> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cargo-fmu"));
    command.arg("fmu").args(arguments).current_dir(folder).output()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_new_package_is_one_that_cargo_reads() {
    let folder = tempfile::tempdir().unwrap();
    let exporter = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("export");
    let made = cargo_fmu(folder.path(), &["new", "heat-pump", "--fmu-export", exporter.to_str().unwrap()]).unwrap();
    assert!(made.status.success(), "{}", text(&made.stderr));
    assert_eq!(text(&made.stdout), "heat-pump/Cargo.toml\nheat-pump/src/lib.rs\n");
    let mut metadata = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    metadata.args(["metadata", "--no-deps", "--format-version=1"]).current_dir(folder.path().join("heat-pump"));
    let read = metadata.output().unwrap();
    assert!(read.status.success(), "{}", text(&read.stderr));
    assert!(text(&read.stdout).contains(r#""crate_types":["cdylib"]"#), "{}", text(&read.stdout));
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, named) in [
        (&["new", "2b"][..], "2b"),
        (&["new", "here", "--fmu-export", "nowhere"], "nowhere"),
        (&["build", "--manifest-path", "absent/Cargo.toml"], "absent/Cargo.toml"),
        (&["build", "--fmi", "1"], "'1'"),
    ] {
        let refused = cargo_fmu(folder.path(), arguments).unwrap();
        assert!(!refused.status.success(), "{arguments:?}");
        assert!(text(&refused.stderr).contains(named), "{arguments:?}: {}", text(&refused.stderr));
        assert_eq!(text(&refused.stdout), "", "{arguments:?}");
    }
    assert!(!folder.path().join("here").exists());
}
