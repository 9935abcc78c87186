//! C sources of the baselines, compiled when a benchmark starts, as users would: `cc -O3` for the machine's plain
//! target.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

/// Compiles `source` of `benches/baseline` to a shared library in `folder`, by the compiler that `CC` names, or `cc`,
/// with these options besides. Returns its path.
pub fn compile(source: &str, folder: &Path, options: &[&str]) -> Result<PathBuf> {
    let library = folder.join(source).with_extension("library");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/baseline").join(source);
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let mut command = Command::new(&compiler);
    command.args(["-std=c11", "-O3", "-shared", "-fPIC"]).args(options);
    command.arg("-o").arg(&library).arg(&source).args(["-lm", "-ldl"]);
    let status = command.status().with_context(|| format!("C compiler {compiler}"))?;
    ensure!(status.success(), "{compiler} does not compile {}: {status}", source.display());
    Ok(library)
}
