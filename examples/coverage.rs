//! How often intervals of the mean of a sweep's samples contain the mean of all of them, as one Markdown table:
//! `cargo run --release --example coverage -- FOLDER COLUMN`, with the folder of a sweep of one point and many samples. Draws samples from
//! them 2000 times, with replacement, and takes the interval that `videg sweep` takes, those of Student, and of the bootstrap.

use std::error::Error;
use std::path::Path;

use videg::statistics::{Intervals, Mean, mean, quantile};

/// How often samples are drawn.
const REPETITIONS: usize = 2000;
/// Draws of a bootstrap.
const RESAMPLES: usize = 500;
/// Samples before the first decision of `--until-precision`, and most of them.
const FIRST: usize = 50;
const MOST: usize = 10_000;

type Interval = [f64; 2];

/// Draws with replacement.
fn draw(values: &[f64], count: usize, random: &mut fastrand::Rng) -> Vec<f64> {
    (0..count).map(|_| values[random.usize(..values.len())]).collect()
}

fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values.iter().copied());
    (values.iter().map(|value| (value - middle).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)).sqrt()
}

fn videg(values: &[f64], _: &mut fastrand::Rng) -> Interval {
    Intervals::new(0.95).mean(values).interval
}

/// Student's: without skewness the interval of videg is that one.
fn student(values: &[f64], _: &mut fastrand::Rng) -> Interval {
    let n = values.len();
    // As many values without skewness, of mean 0 and of the standard deviation 1.
    let even: Vec<f64> = (0..n).map(|k| 2.0 * k as f64 - (n as f64 - 1.0)).collect();
    let [low, high] = Intervals::new(0.95).mean(&even).interval;
    let scale = deviation(values) / deviation(&even);
    let middle = mean(values.iter().copied());
    [middle + scale * low, middle + scale * high]
}

/// Percentiles of the means of resamples.
fn percentile(values: &[f64], random: &mut fastrand::Rng) -> Interval {
    let resample = |_| mean(draw(values, values.len(), random).into_iter());
    let mut means: Vec<f64> = (0..RESAMPLES).map(resample).collect();
    means.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|share| quantile(&means, share))
}

/// Bootstrap-t: percentiles of the t of resamples.
fn bootstrap_t(values: &[f64], random: &mut fastrand::Rng) -> Interval {
    let middle = mean(values.iter().copied());
    let mut ts: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn = draw(values, values.len(), random);
            let difference = mean(drawn.iter().copied()) - middle;
            if difference == 0.0 { 0.0 } else { difference / deviation(&drawn) }
        })
        .collect();
    ts.sort_by(f64::total_cmp);
    [0.975, 0.025].map(|share| middle - quantile(&ts, share) * deviation(values))
}

/// A method with its name.
type Method = (&'static str, fn(&[f64], &mut fastrand::Rng) -> Interval);

const METHODS: [Method; 4] =
    [("videg", videg), ("Student", student), ("percentile", percentile), ("bootstrap-t", bootstrap_t)];

/// Samples until half their interval is at most `precision` of their mean.
fn until(values: &[f64], precision: f64, random: &mut fastrand::Rng) -> (usize, Interval) {
    let (mut drawn, mut count) = (Vec::new(), FIRST);
    loop {
        drawn.extend(draw(values, count - drawn.len(), random));
        let found: Mean = Intervals::new(0.95).mean(&drawn);
        if found.precision() <= precision || count >= MOST {
            return (count, found.interval);
        }
        count = (count * 3).div_ceil(2).min(MOST);
    }
}

fn percent(hits: usize) -> String {
    format!("{:.1} %", 100.0 * hits as f64 / REPETITIONS as f64)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(column)) = (arguments.next(), arguments.next()) else {
        return Err("FOLDER and COLUMN are expected".into());
    };
    let mut reader = csv::Reader::from_path(Path::new(&folder).join("sweep.csv"))?;
    let place = reader.headers()?.iter().position(|name| name == column).ok_or("no such column")?;
    let rows = reader.records().collect::<Result<Vec<_>, _>>()?;
    let values: Vec<f64> = rows.iter().filter_map(|row| row[place].parse().ok()).collect();
    let expected = mean(values.iter().copied());
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    println!(
        "{} samples: mean {expected:.4}, standard deviation {:.4}, 5 %, 50 % and 95 % quantiles {:.4}, {:.4}, {:.4}\n",
        values.len(),
        deviation(&values),
        quantile(&sorted, 0.05),
        quantile(&sorted, 0.5),
        quantile(&sorted, 0.95)
    );
    let mut random = fastrand::Rng::with_seed(1);
    let contains = |[low, high]: Interval| low <= expected && expected <= high;
    println!("| samples | {} |", METHODS.map(|(name, _)| name).join(" | "));
    println!("|---|{}", "---|".repeat(METHODS.len()));
    for count in [10, 20, 50, 100] {
        let cells = METHODS.map(|(_, method)| {
            let hit = |_: &usize| contains(method(&draw(&values, count, &mut random.fork()), &mut random));
            percent((0..REPETITIONS).filter(hit).count())
        });
        println!("| {count} | {} |", cells.join(" | "));
    }
    println!("\n| until precision | samples, on average | contains the mean |\n|---|---|---|");
    for precision in [0.2, 0.1, 0.05, 0.02] {
        let ended: Vec<_> = (0..REPETITIONS).map(|_| until(&values, precision, &mut random)).collect();
        let samples = ended.iter().map(|(count, _)| *count as f64).sum::<f64>() / REPETITIONS as f64;
        let hits = ended.iter().filter(|(_, interval)| contains(*interval)).count();
        println!("| {precision} | {samples:.0} | {} |", percent(hits));
    }
    Ok(())
}
