//! Tables of numbers: CSV and Parquet.

use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type as Schema;
use videg_system::atomic_file;

use super::{ExportError, Table};

/// Rows of a group of a Parquet file.
const GROUP: usize = 1 << 16;

/// Writes `table` as text: lines of the header with a `#`, the names of the columns, the rows.
pub(super) fn csv(path: &Path, table: &Table) -> Result<Vec<PathBuf>, ExportError> {
    let filled = atomic_file::fill(path, |file| -> io::Result<()> {
        let mut out = BufWriter::new(file);
        for line in &table.header {
            writeln!(out, "# {line}")?;
        }
        let units: Vec<_> = table.columns.iter().map(|column| format!("{} [{}]", column.name, column.unit)).collect();
        writeln!(out, "# {}", units.join(", "))?;
        let names: Vec<_> = table.columns.iter().map(|column| column.name.as_str()).collect();
        writeln!(out, "{}", names.join(","))?;
        for row in 0..table.rows() {
            for (index, column) in table.columns.iter().enumerate() {
                let comma = if index == 0 { "" } else { "," };
                write!(out, "{comma}{:?}", column.values[row])?;
            }
            writeln!(out)?;
        }
        out.flush()
    });
    filled.map_err(|cause| ExportError::Write { path: path.to_owned(), cause })?;
    Ok(vec![path.to_owned()])
}

/// Writes `table` as Parquet; the header and the units are metadata of the file (`videg`, `videg.units`).
pub(super) fn parquet(path: &Path, table: &Table) -> Result<Vec<PathBuf>, ExportError> {
    let filled = atomic_file::fill(path, |file| -> Result<(), ParquetError> {
        let units: Vec<_> = table.columns.iter().map(|column| format!("{} [{}]", column.name, column.unit)).collect();
        let metadata = [("videg", table.header.join("\n")), ("videg.units", units.join(", "))];
        let metadata = metadata.map(|(key, value)| KeyValue::new(key.to_owned(), value)).to_vec();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("videg ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(metadata))
            .build();
        let field = |name: &str| {
            let field = Schema::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
            field.build().map(Arc::new)
        };
        let fields = table.columns.iter().map(|column| field(&column.name)).collect::<Result<_, _>>()?;
        let schema = Schema::group_type_builder("capacitance").with_fields(fields).build()?;
        let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
        for first in (0..table.rows()).step_by(GROUP) {
            let last = (first + GROUP).min(table.rows());
            let mut group = writer.next_row_group()?;
            for column in &table.columns {
                let Some(mut writer) = group.next_column()? else { break };
                writer.typed::<DoubleType>().write_batch(&column.values[first..last], None, None)?;
                writer.close()?;
            }
            group.close()?;
        }
        writer.close()?;
        Ok(())
    });
    filled.map_err(|cause| ExportError::Write { path: path.to_owned(), cause: io::Error::other(cause) })?;
    Ok(vec![path.to_owned()])
}
