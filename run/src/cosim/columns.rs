//! A Parquet file of real columns, written in groups of rows: memory does not grow with their number.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type as Schema;

/// Rows of a group.
const GROUP: usize = 1 << 16;

/// The file while it is written to `W`.
pub struct RealColumns<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    columns: Vec<Vec<f64>>,
}

impl<W: Write + Send> RealColumns<W> {
    /// Begins the file of these columns in `out`; `name` is that of its schema, `metadata` are keys and values in it.
    ///
    /// # Errors
    /// Two columns with one name.
    pub fn new(out: W, name: &str, columns: &[&str], metadata: &[(&str, String)]) -> Result<Self> {
        let metadata = metadata.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("videg ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(metadata.collect()))
            .build();
        let field = |name: &&str| {
            let field = Schema::primitive_type_builder(name, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
            field.build().map(Arc::new)
        };
        let fields = columns.iter().map(field).collect::<Result<_>>()?;
        let schema = Schema::group_type_builder(name).with_fields(fields).build()?;
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
        Ok(Self { writer, columns: vec![Vec::new(); columns.len()] })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A group that cannot be written.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) -> Result<()> {
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        if self.columns.first().is_some_and(|column| column.len() == GROUP) { self.write_group() } else { Ok(()) }
    }

    /// Writes the rest.
    ///
    /// # Errors
    /// A refusal of the file system.
    pub fn finish(mut self) -> Result<W> {
        if self.columns.iter().any(|column| !column.is_empty()) {
            self.write_group()?;
        }
        self.writer.into_inner()
    }

    fn write_group(&mut self) -> Result<()> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            writer.typed::<DoubleType>().write_batch(column, None, None)?;
            writer.close()?;
            column.clear();
        }
        group.close().map(|_| ())
    }
}
