//! C sources of the baselines, compiled when a benchmark starts, as users would: `cc -O3` for the machine's plain
//! target.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use libloading::Library;

/// The library made from `name` in `benches/baseline`, by the compiler that `CC` names, or `cc`.
pub fn library(name: &str) -> Result<Library> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/baseline").join(name);
    let folder = tempfile::tempdir()?;
    let output = folder.path().join("baseline");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let mut command = Command::new(&compiler);
    command.args(["-std=c11", "-O3", "-shared", "-fPIC", "-o"]).arg(&output).arg(&source).arg("-lm");
    let status = command.status().with_context(|| format!("C compiler {compiler}"))?;
    ensure!(status.success(), "{compiler} does not compile {}", source.display());
    // SAFETY: nothing runs when the library is loaded.
    Ok(unsafe { Library::new(&output) }?)
}
