//! `cargo fmu new`: a package with a model, to begin with.

use std::path::{Path, PathBuf};

use clap::Args;
use fmu_package::{Messages, PackageError, cargo};

/// The model.
const MODEL: &str = include_str!("../template/lib.rs");

/// Arguments of the task.
#[derive(Args)]
pub struct Arguments {
    /// Folder to make
    folder: PathBuf,
    /// Name of the package [default: that of the folder]
    #[arg(long)]
    name: Option<String>,
    /// Folder of the package fmu-export, in place of its released version
    #[arg(long, value_name = "DIR")]
    fmu_export: Option<PathBuf>,
}

/// Makes the package, and says what to do next.
///
/// # Errors
/// When Cargo refuses the name, or a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<String, PackageError> {
    let folder = &arguments.folder;
    let exporter = match &arguments.fmu_export {
        None => format!("\"{}\"", env!("CARGO_PKG_VERSION")),
        Some(path) => {
            let path = std::fs::canonicalize(path).map_err(PackageError::io("read", path))?;
            format!("{{ path = {:?} }}", path.display().to_string())
        }
    };
    let Some(named) = folder.to_str() else {
        return Err(PackageError::File {
            path: folder.clone(),
            reason: "the name of the folder is not UTF-8".to_owned(),
        });
    };
    // Cargo knows which names are none, and whether the folder lies in a workspace.
    let mut command = vec!["new", "--lib", "--quiet", named];
    command.extend(arguments.name.iter().flat_map(|name| ["--name", name]));
    cargo::run(Path::new("."), &command, Messages::Shown)?;
    let [manifest, library] = ["Cargo.toml", "src/lib.rs"].map(|file| folder.join(file));
    let mut text = std::fs::read_to_string(&manifest).map_err(PackageError::io("read", &manifest))?;
    let name = arguments.name.clone().unwrap_or_else(|| file_name(folder));
    text = with_exporter(&text, &exporter);
    let model = MODEL.replace("{identifier}", &identifier(&name));
    for (file, text) in [(&manifest, &text), (&library, &model)] {
        std::fs::write(file, text).map_err(PackageError::io("write", file))?;
    }
    Ok(format!("{}\n{}", manifest.display(), library.display()))
}

/// The manifest that Cargo has written, with the crate type and the exporter.
fn with_exporter(manifest: &str, exporter: &str) -> String {
    let library = "[lib]\ncrate-type = [\"cdylib\"]\n";
    let dependency = format!("fmu-export = {exporter}\n");
    match manifest.split_once("[dependencies]\n") {
        Some((head, tail)) => format!("{head}{library}\n[dependencies]\n{dependency}{tail}"),
        None => format!("{manifest}\n{library}\n[dependencies]\n{dependency}"),
    }
}

fn file_name(folder: &Path) -> String {
    folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A model identifier: `heat-pump` becomes `HeatPump`.
fn identifier(name: &str) -> String {
    let words = name.split(|character: char| !character.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let capital = |word: &str| word[..1].to_ascii_uppercase() + &word[1..];
    let identifier: String = words.map(capital).collect();
    match identifier.chars().next() {
        None => "Model".to_owned(),
        Some(first) if first.is_ascii_digit() => format!("_{identifier}"),
        Some(_) => identifier,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        for (name, wanted) in
            [("heat-pump", "HeatPump"), ("lag", "Lag"), ("a_2b", "A2b"), ("_2b", "_2b"), ("\u{e9}", "Model")]
        {
            assert_eq!(identifier(name), wanted);
        }
    }

    #[test]
    fn the_manifest_gets_crate_type_and_exporter() {
        let made = with_exporter("[package]\nname = \"lag\"\n\n[dependencies]\n", "\"1.0\"");
        let wanted =
            "[package]\nname = \"lag\"\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n[dependencies]\nfmu-export = \"1.0\"\n";
        assert_eq!(made, wanted);
        assert_eq!(with_exporter("[package]\nname = \"lag\"\n", "\"1.0\""), wanted);
    }
}
