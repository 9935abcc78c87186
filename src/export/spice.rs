//! Subcircuits in a file, and for ngspice the table that they read beside it.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use videg_spice::{Flavour, Points};

use super::{ExportError, Format, Table, fill};
use crate::ngspice::write_rows;

/// Writes the subcircuits of `table`; the path of the table that they read, if they read one.
pub(super) fn write(path: &Path, format: Format, table: &Table) -> Result<Option<PathBuf>, ExportError> {
    let tab = path.with_extension("tab");
    let name = tab.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let flavour = match format {
        Format::Ngspice => Flavour::Ngspice(&name),
        Format::Kicad => Flavour::Kicad,
        Format::Ltspice => Flavour::Ltspice,
        _ => Flavour::Qspice,
    };
    let [times, left, right] = [0, 1, 2].map(|column| table.columns[column].values.as_slice());
    let header = table.header.iter().map(String::as_str);
    let text = flavour.library(header, Points { times, capacitances: [left, right] });
    if format == Format::Ngspice {
        let rows = times.iter().zip(left).zip(right).map(|((time, left), right)| (*time, [*left, *right]));
        fill(&tab, |out| write_rows(rows, out))?;
    }
    fill(path, |out| out.write_all(text.as_bytes()))?;
    Ok((format == Format::Ngspice).then_some(tab))
}
