//! The results as a Parquet file, made from the CSV file in groups of rows: memory does not grow with the results.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use csv::StringRecord;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type as Schema;

use super::SweepError;
use super::column::{Column, Type};
use videg_system::atomic_file::{self, AtomicFile};

/// Rows of a group.
const GROUP: usize = 8_192;
/// Key of the document in the file.
const KEY: &str = "videg.sweep";

/// Where the table of the results at `csv` is.
pub(super) fn path(csv: &Path) -> PathBuf {
    csv.with_extension("parquet")
}

/// Writes the table beside the results at `csv`, unless it is there and not to be made `anew`; its path.
pub(super) fn write(
    csv: &Path,
    columns: &[Column],
    document: &str,
    anew: bool,
) -> std::result::Result<PathBuf, SweepError> {
    let path = path(csv);
    if anew || !path.exists() {
        let filled = atomic_file::fill(&path, |file| fill(csv, columns, document, file));
        filled.map_err(|cause| SweepError::file("write", &path)(io::Error::other(cause)))?;
    }
    Ok(path)
}

fn fill(csv: &Path, columns: &[Column], document: &str, file: &mut AtomicFile) -> Result<()> {
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(concat!("videg ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(vec![KeyValue::new(KEY.to_owned(), document.to_owned())]))
        .build();
    let fields = columns.iter().map(|column| field(column).map(Arc::new)).collect::<Result<_>>()?;
    let schema = Schema::group_type_builder("sweep").with_fields(fields).build()?;
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
    let mut reader = csv::Reader::from_path(csv).map_err(external)?;
    let (mut record, mut rows) = (StringRecord::new(), Vec::with_capacity(GROUP));
    loop {
        let more = reader.read_record(&mut record).map_err(external)?;
        if more {
            rows.push(record.clone());
        }
        if rows.len() == GROUP || (!more && !rows.is_empty()) {
            group(&mut writer, columns, &rows)?;
            rows.clear();
        }
        if !more {
            break;
        }
    }
    writer.close()?;
    Ok(())
}

fn external(error: csv::Error) -> ParquetError {
    ParquetError::External(Box::new(error))
}

fn field(column: &Column) -> Result<Schema> {
    let (physical, logical) = match column.kind {
        Type::Integer => (Physical::INT64, None),
        Type::Real => (Physical::DOUBLE, None),
        Type::Boolean => (Physical::BOOLEAN, None),
        Type::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let repetition = if column.optional { Repetition::OPTIONAL } else { Repetition::REQUIRED };
    Schema::primitive_type_builder(&column.name, physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()
}

fn group<W: Write + Send>(
    writer: &mut SerializedFileWriter<W>,
    columns: &[Column],
    rows: &[StringRecord],
) -> Result<()> {
    let mut group = writer.next_row_group()?;
    for (index, column) in columns.iter().enumerate() {
        let cells = rows.iter().map(|row| row.get(index).unwrap_or_default());
        match column.kind {
            Type::Integer => cells_of::<Int64Type, W>(&mut group, column, cells, |text| text.parse().ok()),
            Type::Real => cells_of::<DoubleType, W>(&mut group, column, cells, |text| text.parse().ok()),
            Type::Boolean => cells_of::<BoolType, W>(&mut group, column, cells, |text| text.parse().ok()),
            Type::Text => cells_of::<ByteArrayType, W>(&mut group, column, cells, |text| Some(ByteArray::from(text))),
        }?;
    }
    group.close().map(|_| ())
}

/// Writes the cells of a column; an empty one of an optional column is null.
fn cells_of<'a, T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
    cells: impl Iterator<Item = &'a str>,
    read: impl Fn(&str) -> Option<T::T>,
) -> Result<()> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    for cell in cells {
        let is_there = !(column.optional && cell.is_empty());
        levels.push(i16::from(is_there));
        if is_there {
            let unreadable = || io::Error::other(format!("{} = {cell:?} is not of its type", column.name));
            values.push(read(cell).ok_or_else(unreadable)?);
        }
    }
    let missing = || ParquetError::General(format!("there is no column {}", column.name));
    let mut writer = group.next_column()?.ok_or_else(missing)?;
    writer.typed::<T>().write_batch(&values, column.optional.then_some(&levels[..]), None)?;
    writer.close()
}
