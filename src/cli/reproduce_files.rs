//! The files of `videg reproduce` and `videg dynamics`: data as CSV, pictures as SVG and PNG.

use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::{output, reproduce_report as page};
use crate::artefact::{Picture, Sheet};
use crate::paper::Finding;
use videg_report::render_png;

/// Pixels of a PNG for each px of the figure.
const DENSITY: f64 = 2.0;

/// Writes data and pictures into `folder`; returns the files.
pub fn write(folder: &Path, sheets: &[Sheet], pictures: &[Picture]) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for sheet in sheets {
        let path = folder.join(&sheet.name).with_extension("csv");
        output::write(&path, &csv(sheet)?)?;
        files.push(path);
    }
    for picture in pictures {
        let path = folder.join(&picture.name);
        let (svg, png) = (path.with_extension("svg"), path.with_extension("png"));
        output::write(&svg, &picture.drawing.svg)?;
        output::write(&png, render_png(&picture.drawing.svg, DENSITY)?)?;
        files.extend([svg, png]);
    }
    Ok(files)
}

/// Numbers as short as they can be without losing a bit.
fn csv(sheet: &Sheet) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&sheet.columns)?;
    for (index, row) in sheet.rows.iter().enumerate() {
        let cell = |value: &f64| if value.is_nan() { String::new() } else { format!("{value:?}") };
        let words = sheet.words.get(index).into_iter().flatten().cloned();
        writer.write_record(words.chain(row.iter().map(cell)))?;
    }
    text(writer).with_context(|| format!("sheet {}", sheet.name))
}

/// Writes the summary table to `path`.
pub fn summary<'a>(path: &Path, findings: impl Iterator<Item = &'a Finding>) -> anyhow::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(page::HEADINGS)?;
    for finding in findings {
        let mut cells = page::cells(finding);
        cells[3] = finding.paper.map(|paper| format!("{paper:?}")).unwrap_or_default();
        cells[4] = format!("{:?}", finding.videg);
        writer.write_record(cells)?;
    }
    output::write(path, &text(writer)?)
}

fn text(writer: csv::Writer<Vec<u8>>) -> anyhow::Result<String> {
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    Ok(String::from_utf8(bytes)?)
}
