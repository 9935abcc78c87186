//! The tools that a build for another system needs: a missing one is named, with the command that installs it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::error::{PackageError, Result};
use super::target::Target;

/// The mingw linker that Rust's Windows target runs, as Debian names it.
const MINGW: &str = "x86_64-w64-mingw32-gcc";

/// Cargo. Inside `cargo run`, CARGO names the very one that runs.
pub(super) fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"))
}

/// Checks that everything is there to build for `target`.
///
/// # Errors
/// When a tool is missing; the error names it and the way to install it.
pub(super) fn check(workspace: &Path, target: &Target) -> Result<()> {
    if target.glibc.is_some() {
        check_zig(workspace, target)?;
    }
    check_rust_target(workspace, target)?;
    check_mingw(target)
}

fn check_zig(workspace: &Path, target: &Target) -> Result<()> {
    // Through Cargo, which also looks into its own folder.
    if !succeeds(Command::new(cargo()).current_dir(workspace).args(["zigbuild", "--help"])) {
        return Err(missing("cargo-zigbuild", target, "cargo install --locked cargo-zigbuild"));
    }
    // Where cargo-zigbuild looks.
    let python = program("CARGO_ZIGBUILD_PYTHON_PATH", "python3");
    let zig = program("CARGO_ZIGBUILD_ZIG_PATH", "zig");
    let found =
        succeeds(Command::new(python).args(["-m", "ziglang", "version"])) || succeeds(Command::new(zig).arg("version"));
    if found { Ok(()) } else { Err(missing("zig", target, "pip install ziglang")) }
}

fn check_rust_target(workspace: &Path, target: &Target) -> Result<()> {
    let rustc = program("RUSTC", "rustc");
    let output = Command::new(rustc).current_dir(workspace).args(["--print", "sysroot"]).output();
    // Cargo reports what is wrong.
    let Ok(output) = output else { return Ok(()) };
    let sysroot = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    if !output.status.success() || sysroot.join("lib/rustlib").join(&target.triple).join("lib").is_dir() {
        return Ok(());
    }
    let triple = &target.triple;
    Err(missing(&format!("the Rust target {triple}"), target, &format!("rustup target add {triple}")))
}

fn check_mingw(target: &Target) -> Result<()> {
    let configured = std::env::var_os("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER").is_some();
    if cfg!(windows) || configured || target.triple != "x86_64-pc-windows-gnu" {
        return Ok(());
    }
    if succeeds(Command::new(MINGW).arg("--version")) {
        return Ok(());
    }
    Err(missing(&format!("the linker {MINGW}"), target, "apt-get install gcc-mingw-w64-x86-64"))
}

fn program(variable: &str, default: &str) -> OsString {
    std::env::var_os(variable).filter(|value| !value.is_empty()).unwrap_or_else(|| default.into())
}

fn succeeds(command: &mut Command) -> bool {
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

fn missing(tool: &str, target: &Target, install: &str) -> PackageError {
    PackageError::MissingTool { tool: tool.to_owned(), target: target.argument(), install: install.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Platform;

    #[test]
    fn a_rust_target_that_is_not_there_is_named_with_its_cure() {
        let triple = "x86_64-nobody-linux-musl".to_owned();
        let target = Target { triple, glibc: None, platform: Platform { folder: "linux64" } };
        let error = check(Path::new(env!("CARGO_MANIFEST_DIR")), &target).unwrap_err().to_string();
        let wanted = "cannot build for x86_64-nobody-linux-musl: the Rust target x86_64-nobody-linux-musl is missing; \
                      install it with `rustup target add x86_64-nobody-linux-musl`";
        assert_eq!(error, wanted);
    }

    #[test]
    fn a_program_counts_only_if_it_runs() {
        assert!(succeeds(Command::new(cargo()).arg("--version")));
        assert!(!succeeds(Command::new(cargo()).arg("no-such-command-at-all")));
        assert!(!succeeds(Command::new("no-such-program-at-all").arg("--version")));
    }
}
