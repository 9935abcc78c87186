//! The page with all that it needs inside.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

use crate::engine::Engine;
use crate::module;

/// The page in `folder` with the model inside. What `videg explore` knows of variables and cases goes in place of `{{ description }}`.
///
/// # Errors
/// A file that is missing, or one that would end its element of the page.
pub fn page(folder: &Path, engine: &Engine) -> Result<String> {
    let read = |name: &str| {
        let path = folder.join(name);
        std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    };
    let main = module::script(&folder.join("main.js"))?;
    // Runs in a thread of its own, made from this text.
    let worker = format!("{}\n{}", engine.script, module::script(&folder.join("worker.js"))?);
    let parts = [
        ("policy", policy(&main)),
        ("style", read("style.css")?),
        ("model", BASE64_STANDARD.encode(&engine.wasm)),
        ("worker", worker),
        ("main", main),
    ];
    let mut page = read("page.html")?;
    for (name, part) in parts {
        let is_inert = !part.contains("</script") && !part.contains("<!--") && !part.contains("</style");
        ensure!(is_inert, "{name} would end its element");
        let place = format!("{{{{ {name} }}}}");
        ensure!(page.matches(&place).count() == 1, "page.html has no place for {name}, or more than one");
        page = page.replace(&place, &part);
    }
    Ok(page)
}

/// Lets one script run, compile the model and make threads; nothing is loaded.
fn policy(script: &str) -> String {
    let hash = BASE64_STANDARD.encode(Sha256::digest(script.as_bytes()));
    format!(
        "default-src 'none'; script-src 'sha256-{hash}' 'wasm-unsafe-eval'; worker-src blob:; style-src 'unsafe-inline'; \
         img-src data: blob:"
    )
}
