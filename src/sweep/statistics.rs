//! Statistics over the samples of each point: the table `statistics.csv`.

use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::by_point::{self, Layout, Samples};
use super::column::{self, real};
use super::document::Kept;
use super::electrical::POWERS;
use super::summary::Summary;
use super::{SweepError, figure};
use crate::statistics::{Intervals, Mean, QUANTILES, Statistics};
use videg_system::atomic_file;

/// Most points of a figure, which stay in memory.
pub(super) const MOST_POINTS: u64 = 20_000;
/// Most quantities that are drawn.
const MOST_PANELS: usize = 4;

/// Table and figure of the results at `csv`: `statistics.csv` and `statistics.svg` of `sweep.csv`.
pub(super) fn paths(csv: &Path) -> [PathBuf; 2] {
    let name = csv.file_name().unwrap_or_default().to_string_lossy().replacen("sweep", "statistics", 1);
    ["csv", "svg"].map(|extension| csv.with_file_name(&name).with_extension(extension))
}

/// Whether the sweep has statistics.
pub(super) fn has(kept: &Kept) -> bool {
    kept.samples > 1
}

/// Makes the statistics of the results at `csv`. Writes table and figure, unless both are there and not to be made `anew`.
pub(super) fn write(csv: &Path, kept: &Kept, anew: bool) -> Result<(Summary, Vec<PathBuf>), SweepError> {
    let [table, drawing] = paths(csv);
    let is_drawn = kept.points <= MOST_POINTS;
    let files: Vec<_> = [Some(table.clone()), is_drawn.then(|| drawing.clone())].into_iter().flatten().collect();
    let writes = anew || files.iter().any(|file| !file.exists());
    let made = if writes {
        let mut made = None;
        let filled = atomic_file::fill(&table, |file| {
            let mut out = BufWriter::new(file);
            made = Some(fill(csv, kept, &mut out)?);
            out.flush()
        });
        filled.map(|()| made)
    } else {
        fill(csv, kept, &mut io::sink()).map(Some)
    };
    let summary = made.map_err(SweepError::file("write", &table))?.unwrap_or_else(|| Summary::new(kept, &[]));
    if writes && is_drawn {
        let svg = figure::draw(&summary, kept).map_err(|error| SweepError::content(&drawing, error.to_string()))?;
        atomic_file::write(&drawing, svg).map_err(SweepError::file("write", &drawing))?;
    }
    Ok((summary, files))
}

/// Writes the table to `out`.
fn fill(csv: &Path, kept: &Kept, out: &mut impl io::Write) -> io::Result<Summary> {
    let layout = Layout::new(kept);
    let names: Vec<&str> = layout.quantities().iter().map(|&index| kept.columns[index].name.as_str()).collect();
    let main = main_quantities(&names);
    let mut summary = Summary::new(kept, &main.iter().map(|&index| names[index]).collect::<Vec<_>>());
    let of = kept.precision_of.as_deref().and_then(|of| names.iter().position(|name| *name == of));
    let precision = of.zip(kept.until_precision);
    let mut intervals = Intervals::new(summary.confidence);
    out.write_all(&column::line(heading(kept, &names).iter().map(String::as_str)))?;
    by_point::each(csv, &layout, |samples| {
        let statistics: Vec<_> = samples.values.iter().map(|values| intervals.statistics(values)).collect();
        let reached = precision.map(|(place, precision)| (statistics[place].mean.precision(), precision));
        let is_short = reached.is_some_and(|(found, asked)| found.is_nan() || found > asked);
        summary.unreached += u64::from(is_short);
        let mut cells = cells(&samples, &statistics);
        cells.extend(reached.iter().flat_map(|(found, _)| [real(*found), (!is_short).to_string()]));
        out.write_all(&column::line(cells.iter().map(String::as_str)))?;
        if kept.points <= MOST_POINTS {
            summary.add(samples, &statistics, &main, kept.points == 1);
        }
        Ok(())
    })?;
    Ok(summary)
}

/// The quantities that matter most: powers, then the voltage gain and what is recorded. The paper's power and the number of impacts stand in
/// the table only.
fn main_quantities(names: &[&str]) -> Vec<usize> {
    let rank = |name: &str| match name {
        "average_power_eq13" | "impacts" => None,
        _ => Some(POWERS.iter().position(|power| *power == name).unwrap_or(POWERS.len())),
    };
    let mut ranked: Vec<_> = names.iter().enumerate().filter_map(|(index, name)| Some((rank(name)?, index))).collect();
    ranked.sort_unstable();
    ranked.into_iter().take(MOST_PANELS).map(|(_, index)| index).collect()
}

fn heading(kept: &Kept, quantities: &[&str]) -> Vec<String> {
    let given = kept.columns.iter().skip(3).take(kept.vary.len()).map(|column| column.name.clone());
    let mut heading: Vec<String> = vec!["point".to_owned()];
    heading.extend(given);
    heading.extend(["succeeded", "failed"].map(str::to_owned));
    for name in quantities {
        heading.extend(["mean", "low", "high", "deviation"].map(|of| format!("{name}.{of}")));
        heading.extend(QUANTILES.map(|share| format!("{name}.q{:02.0}", 100.0 * share)));
    }
    heading.extend(kept.until_precision.iter().flat_map(|_| ["precision", "reached"].map(str::to_owned)));
    heading
}

fn cells(samples: &Samples, statistics: &[Statistics]) -> Vec<String> {
    let mut cells = vec![samples.point.to_string()];
    cells.extend(samples.given.iter().cloned());
    cells.extend([samples.succeeded, samples.failed].map(|count| count.to_string()));
    for (values, Statistics { mean: Mean { value, interval: [low, high] }, deviation, quantiles }) in
        samples.values.iter().zip(statistics)
    {
        // Of few samples there is no number at all, which is something else than NaN among them.
        let known = [1, 2, 2, 2, 1, 1, 1].map(|least| values.len() >= least);
        let numbers = [*value, *low, *high, *deviation].into_iter().chain(*quantiles);
        cells.extend(numbers.zip(known).map(|(number, known)| if known { real(number) } else { String::new() }));
    }
    cells
}
