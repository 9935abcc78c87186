//! What the runs of both standards share: the connection of the two FMUs, and the tables that are compared with those of
//! other importers.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result};

/// Outputs of the harvester and inputs of the circuit.
pub const CONNECTED: [&str; 2] = ["left.capacitance", "right.capacitance"];

/// Values of the outputs, row by row.
pub type Rows = Vec<Vec<f64>>;

/// Writes `FOLDER/MODEL.csv`, of outputs given by name and reference.
///
/// # Errors
/// If the file cannot be written.
pub fn write(folder: &Path, model: &str, outputs: &[(String, u32)], rows: &Rows) -> Result<()> {
    let path = folder.join(model).with_extension("csv");
    let mut file = BufWriter::new(File::create(&path).with_context(|| path.display().to_string())?);
    let names: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
    writeln!(file, "{}", names.join(","))?;
    for row in rows {
        let row: Vec<String> = row.iter().map(|value| format!("{value:e}")).collect();
        writeln!(file, "{}", row.join(","))?;
    }
    Ok(file.flush()?)
}
