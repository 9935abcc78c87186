//! The FMUs of this project, put together when a verb needs them.

use std::path::PathBuf;
use std::sync::Once;

use anyhow::Context as _;

use super::message::say;
use super::progress::Spinner;
use crate::package::{self, FMUS, Options, Placed};
use fmu_import::Fmu;

/// Packages the FMUs, with progress; returns the archives, in the order of [`FMUS`].
pub fn build() -> anyhow::Result<Vec<PathBuf>> {
    let waiting = Spinner::new("packaging the FMUs");
    // Cargo sets CARGO for what it runs: `cargo run` and tests want what the sources say now.
    let as_is = std::env::var_os("CARGO").is_none();
    let placed = package::build_for_use(&Options { as_is, progress: Spinner::tell, ..Options::default() });
    drop(waiting);
    let Placed { archives, refused } = placed.context("cannot package the FMUs")?;
    if let (Some(refused), Some(folder)) = (refused, archives.first().and_then(|archive| archive.parent())) {
        static SAID: Once = Once::new();
        SAID.call_once(|| say(&format!("{refused}; the FMUs are in {}", folder.display())));
    }
    Ok(archives)
}

/// This program's own file, which runs FMUs and ngspice's library in processes of their own.
pub fn program() -> anyhow::Result<PathBuf> {
    std::env::current_exe().context("cannot find this program's own file")
}

/// Packages the FMUs, with progress; returns the archive of the one with this identifier.
pub fn path(identifier: &str) -> anyhow::Result<PathBuf> {
    let mut paths = build()?;
    let index = FMUS.iter().position(|fmu| fmu.identifier == identifier).filter(|&index| index < paths.len());
    Ok(paths.swap_remove(index.with_context(|| format!("no FMU is called {identifier}"))?))
}

/// Packages the FMUs, with progress, and opens the one with this identifier.
pub fn open(identifier: &str) -> anyhow::Result<Fmu> {
    Ok(Fmu::open(path(identifier)?)?)
}
