//! Tables of numbers: CSV and Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type as Schema;

use super::Table;

/// Rows of a group of a Parquet file.
const GROUP: usize = 1 << 16;

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
    writer.close().map(drop)
}
