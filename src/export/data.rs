//! Tables of numbers: CSV and Parquet.

use std::io::{self, Write};

use parquet::errors::ParquetError;

use super::Table;
use crate::cosim::RealColumns;

/// Writes `table` as text: lines of the header with a `#`, the names of the columns, the rows.
pub(super) fn csv(out: &mut impl Write, table: &Table) -> io::Result<()> {
    for line in &table.header {
        writeln!(out, "# {line}")?;
    }
    writeln!(out, "# {}", table.units())?;
    let names: Vec<_> = table.columns.iter().map(|column| column.name.as_str()).collect();
    writeln!(out, "{}", names.join(","))?;
    for row in 0..table.rows() {
        for (index, column) in table.columns.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            write!(out, "{comma}{:?}", column.values[row])?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Writes `table` as Parquet; the header and the units are metadata of the file (`videg`, `videg.units`).
pub(super) fn parquet(file: impl Write + Send, table: &Table) -> Result<(), ParquetError> {
    let metadata = [("videg", table.header.join("\n")), ("videg.units", table.units())];
    let names: Vec<_> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let mut rows = RealColumns::new(file, "capacitance", &names, &metadata)?;
    (0..table.rows()).try_for_each(|row| rows.push(table.columns.iter().map(|column| column.values[row])))?;
    rows.finish().map(|_| ())
}
