//! Options of the time series, and a warning before a large one is written.

use clap::Args;

use super::results::{chosen, listed};
use crate::cosim::{Sample, SeriesFormat, SeriesOptions};
use crate::scenario::Scenario;

/// What of a run is written.
#[derive(Args)]
pub struct TimeSeriesOptions {
    /// Distance of the rows of the time series, s; step: each communication point. Impacts and peaks of C(t) have rows besides, as
    /// long as these are fewer than three for each other one [default: 1/10000 of the run]
    #[arg(long, value_name = "S|step", value_parser = parse_sample, allow_negative_numbers = true)]
    sample: Option<Sample>,
    /// Columns of the time series beside the time, with commas between them [default: all]
    #[arg(long, value_name = "VARIABLES", value_delimiter = ',')]
    columns: Vec<String>,
    /// File of the time series
    #[arg(long, value_enum, default_value_t)]
    format: SeriesFormat,
}

fn parse_sample(text: &str) -> Result<Sample, String> {
    if text == "step" {
        return Ok(Sample::Step);
    }
    text.parse().map(Sample::Every).map_err(|_| "a number of seconds or the word step is expected".to_owned())
}

impl TimeSeriesOptions {
    /// The options for a run.
    pub fn options(&self) -> SeriesOptions {
        SeriesOptions { format: self.format, sample: self.sample.unwrap_or_default(), columns: self.columns.clone() }
    }

    /// Those that are not the default, for the name of the folder.
    pub fn distinct(&self) -> [(&'static str, Option<String>); 3] {
        let sample = match self.sample {
            None | Some(Sample::Overview) => None,
            Some(Sample::Step) => Some("step".to_owned()),
            Some(Sample::Every(spacing)) => Some(spacing.to_string()),
        };
        [("sample", sample), ("columns", listed(&self.columns)), ("format", chosen(&self.format, &SeriesFormat::Csv))]
    }
}

/// Bytes of a number in a CSV file, as `simulate --sample step` and `cosim --sample step` write them, and in a Parquet file at most.
const NUMBER: [f64; 2] = [16.5, 8.0];
/// Columns without and with a circuit, the time among them.
const COLUMNS: [usize; 2] = [15, 29];
/// Size above which the user is warned, bytes.
const LARGE: f64 = 1e9;

/// The warning if the time series of `scenario`, with or without a circuit, fills more than 1 GB.
pub fn warning(options: &SeriesOptions, scenario: &Scenario, circuit: bool) -> Option<String> {
    let number = match options.format {
        SeriesFormat::Csv => NUMBER[0],
        SeriesFormat::Parquet => NUMBER[1],
        SeriesFormat::None => return None,
    };
    let spacing = options.spacing(scenario).ok()?.max(scenario.step);
    let points = (scenario.until / spacing).ceil() + 1.0;
    let asked = options.columns.len();
    let columns = if asked == 0 { COLUMNS[usize::from(circuit)] } else { asked + 1 };
    let bytes = points * number * columns as f64;
    (bytes > LARGE).then(|| {
        format!(
            "the time series will have {points:.0} points or more and fill some {:.0} GB; a larger --sample, fewer --columns or \
             --format parquet makes it smaller, --format none writes none",
            bytes / 1e9
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Request;

    fn of(until: f64, sample: Sample, columns: &[&str], circuit: bool) -> Option<String> {
        let columns = columns.iter().map(|name| (*name).to_owned()).collect();
        let options = SeriesOptions { sample, columns, ..SeriesOptions::default() };
        warning(&options, &Request { until: Some(until), ..Request::default() }.resolve().unwrap(), circuit)
    }

    #[test]
    fn a_time_series_of_more_than_a_gigabyte_is_told_of_with_its_points_and_size() {
        let said = of(200_000.0, Sample::Step, &[], true).unwrap();
        assert!(said.starts_with("the time series will have 200000001 points or more and fill some 96 GB; "), "{said}");
        assert_eq!((of(2000.0, Sample::Step, &[], true), of(4000.0, Sample::Step, &[], false)), (None, None));
        assert!(of(2200.0, Sample::Step, &[], true).is_some() && of(4200.0, Sample::Step, &[], false).is_some());
        assert_eq!(of(2200.0, Sample::Step, &["load.voltage"], true), None);
        assert_eq!(
            (of(900_000.0, Sample::Overview, &[], true), of(200_000.0, Sample::Every(0.1), &[], true)),
            (None, None)
        );
    }
}
