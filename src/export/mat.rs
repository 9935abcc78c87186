//! MATLAB's file format, level 5: matrices one after the other, uncompressed.

use std::io::{self, Write};

use super::Table;

/// Types of data elements.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
/// Classes of matrices.
const CHARACTERS: u32 = 4;
const NUMBERS: u32 = 6;

/// Writes `table`: a column vector for each of its columns, its name with `_` for dots, and the texts `header` and `units`.
pub(super) fn write(out: &mut impl Write, table: &Table) -> io::Result<()> {
    let text = concat!("MATLAB 5.0 MAT-file, made by videg ", env!("CARGO_PKG_VERSION"));
    write!(out, "{text:<124}")?;
    // The version, and the order of bytes.
    out.write_all(&[0x00, 0x01, b'I', b'M'])?;
    for column in &table.columns {
        let values: Vec<u8> = column.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        matrix(out, &identifier(&column.name), NUMBERS, [column.values.len(), 1], DOUBLE, &values)?;
    }
    characters(out, "header", &table.header.join("\n"))?;
    characters(out, "units", &table.units())?;
    matrix(out, "rest_capacitance", NUMBERS, [1, 1], DOUBLE, &table.rest.to_le_bytes())
}

/// The name of a variable of the FMU as one of MATLAB: `left_capacitance`.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

fn characters(out: &mut impl Write, name: &str, text: &str) -> io::Result<()> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let bytes: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    matrix(out, name, CHARACTERS, [1, units.len()], UINT16, &bytes)
}

/// A matrix of `class` with this `name` and size; its `data` are of the type `kind`.
fn matrix(out: &mut impl Write, name: &str, class: u32, size: [usize; 2], kind: u32, data: &[u8]) -> io::Result<()> {
    let length = |bytes: usize| u32::try_from(bytes).map_err(io::Error::other);
    let mut body = Vec::with_capacity(data.len() + 64);
    element(&mut body, UINT32, &[class.to_le_bytes(), [0; 4]].concat())?;
    element(&mut body, INT32, &[length(size[0])?.to_le_bytes(), length(size[1])?.to_le_bytes()].concat())?;
    element(&mut body, INT8, name.as_bytes())?;
    element(&mut body, kind, data)?;
    out.write_all(&MATRIX.to_le_bytes())?;
    out.write_all(&length(body.len())?.to_le_bytes())?;
    out.write_all(&body)
}

/// A data element, filled up to a multiple of eight bytes.
fn element(out: &mut impl Write, kind: u32, data: &[u8]) -> io::Result<()> {
    out.write_all(&kind.to_le_bytes())?;
    out.write_all(&u32::try_from(data.len()).map_err(io::Error::other)?.to_le_bytes())?;
    out.write_all(data)?;
    out.write_all(&[0; 7][..data.len().next_multiple_of(8) - data.len()])
}
