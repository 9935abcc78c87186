//! The compiled model.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use wasm_bindgen_cli_support::Bindgen;

const TARGET: &str = "wasm32-unknown-unknown";
const PROFILE: &str = "wasm";

/// The compiled model and what calls it.
pub struct Engine {
    /// Defines the function `wasm_bindgen`.
    pub script: String,
    /// The model.
    pub wasm: Vec<u8>,
}

impl Engine {
    /// Compiles the model of the folder `explorer`.
    ///
    /// # Errors
    /// When Cargo or wasm-bindgen fails.
    pub fn build(explorer: &Path) -> Result<Self> {
        let target = compile(explorer)?;
        let library = target.join(TARGET).join(PROFILE).join("videg_explorer.wasm");
        let mut output = Bindgen::new()
            .input_path(&library)
            .no_modules(true)
            .map(|bindgen| bindgen.typescript(false).remove_name_section(true).remove_producers_section(true))
            .and_then(Bindgen::generate_output)
            .with_context(|| format!("wasm-bindgen on {}", library.display()))?;
        let script = output.js().to_owned();
        Ok(Self { script, wasm: output.wasm_mut().emit_wasm() })
    }
}

/// Compiles the model; the build folder.
fn compile(explorer: &Path) -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let workspace = explorer.parent().context("the workspace")?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    let target = std::path::absolute(&target)?;
    let mut command = Command::new(cargo);
    command.current_dir(workspace).arg("build").args(["--profile", PROFILE, "--target", TARGET]);
    // Flags of this machine are none of a browser's.
    command.args(["-p", "videg-explorer"]).env("CARGO_TARGET_DIR", &target).env_remove("RUSTFLAGS");
    let status = command.status().context("cannot run cargo")?;
    ensure!(
        status.success(),
        "cargo could not compile the model for {TARGET}; if it has no such target: rustup target add {TARGET}"
    );
    Ok(target)
}
