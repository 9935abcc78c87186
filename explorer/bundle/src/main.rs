//! Makes one file of the page that shows the harvester in a browser: `cargo run -p videg-explorer-bundle -- FILE`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use videg_explorer_bundle::{Engine, page};

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(output), None) = (arguments.next().map(PathBuf::from), arguments.next()) else {
        bail!("usage: videg-explorer-bundle FILE");
    };
    let explorer = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the folder of the explorer")?;
    let engine = Engine::build(explorer)?;
    let page = page(&explorer.join("page"), &engine)?;
    if let Some(folder) = output.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    std::fs::write(&output, &page).with_context(|| format!("cannot write {}", output.display()))?;
    println!("{}: {} bytes, {} of them the model", output.display(), page.len(), engine.wasm.len());
    Ok(())
}
