//! Which run follows. Of an ordinary sweep it is the next number; of one that takes samples until a mean is precise it also depends on
//! the results of its point, and on nothing else, so that it is the same wherever the sweep goes on.

use std::ops::Range;

use super::Shard;
use super::column::{Column, Type};
use crate::statistics::Intervals;

/// Samples before the first decision: with fewer, heavy tails are often not among them, and the interval is too short.
pub(super) const FIRST: u64 = 50;
/// Most samples of a point unless the user says otherwise.
pub(super) const MOST: u64 = 10_000;

/// When a point has enough samples.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    column: usize,
    /// Half the interval over the mean, at most.
    precision: f64,
    intervals: Intervals,
    /// Most samples of a point.
    most: u64,
}

impl Rule {
    /// A point has enough samples when the mean of the column called `of` has this `precision`, or when it has as many as
    /// `most`; none if there is no such column of numbers.
    pub fn new(columns: &[Column], of: &str, precision: f64, confidence: f64, most: u64) -> Option<Self> {
        let column = columns.iter().position(|column| column.name == of && is_quantity(column))?;
        Some(Self { column, precision, intervals: Intervals::new(confidence), most })
    }

    /// Whether samples that gave `values` are enough. Nothing but failures or values that are no numbers will not become precise.
    fn is_done(&mut self, values: &[f64]) -> bool {
        let mean = self.intervals.mean(values);
        mean.value.is_nan() || mean.precision() <= self.precision
    }
}

/// Whether a column has numbers that a run gives.
pub(super) fn is_quantity(column: &Column) -> bool {
    column.optional && matches!(column.kind, Type::Integer | Type::Real)
}

/// The runs of a sweep or a shard, and how far they are.
#[derive(Debug, Clone)]
pub(super) struct Order {
    range: Range<u64>,
    next: u64,
    rule: Option<Rule>,
    /// Values of the present point.
    values: Vec<f64>,
    /// The first run of the present point behind its next decision.
    decision: u64,
}

impl Order {
    /// The runs of `shard`, or of the whole sweep; with a rule, points are shared out.
    pub fn new(points: u64, samples: u64, rule: Option<Rule>, shard: Option<Shard>) -> Self {
        let share = |count| shard.map_or(0..count, |shard| shard.range(count));
        if rule.is_none() {
            return Self::of(share(points * samples), None);
        }
        let points = share(points);
        Self::of(points.start * samples..points.end * samples, rule)
    }

    /// These runs; with a rule, those of whole points.
    pub fn of(range: Range<u64>, rule: Option<Rule>) -> Self {
        let (next, first) = (range.start, rule.as_ref().map_or(0, |rule| FIRST.min(rule.most)));
        Self { range, next, rule, values: Vec::new(), decision: next + first }
    }

    /// The same order of the runs from `point` on.
    pub fn behind(&self, point: u64) -> Option<Self> {
        let rule = self.rule.clone()?;
        let range = point * rule.most..self.range.end;
        (range.start < range.end).then(|| Self::of(range, Some(rule)))
    }

    /// All runs that there may be.
    pub fn range(&self) -> &Range<u64> {
        &self.range
    }

    /// The run that follows; the end of the range if none does.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// The point of the run that follows, and its runs up to the next decision; none without a rule or at the end.
    pub fn stage(&self) -> Option<(u64, Range<u64>)> {
        let rule = self.rule.as_ref().filter(|_| self.next < self.range.end)?;
        Some((self.next / rule.most, self.next..self.decision))
    }

    /// The run that follows has been made; this is its line.
    pub fn took(&mut self, line: &[u8]) {
        /// Samples for the next decision over those for the last one, as a fraction: few decisions, each of which may be a wrong one.
        const GROWTH: (u64, u64) = (3, 2);
        self.next += 1;
        let Some(rule) = &mut self.rule else { return };
        self.values.extend(cell(line, rule.column));
        if self.next < self.decision {
            return;
        }
        let (first, last) =
            ((self.next - 1) / rule.most * rule.most, (self.next - 1) / rule.most * rule.most + rule.most);
        let taken = self.next - first;
        if self.next == last || rule.is_done(&self.values) {
            self.values.clear();
            self.next = last;
            self.decision = last + FIRST.min(rule.most);
        } else {
            self.decision = last.min(first + (taken * GROWTH.0).div_ceil(GROWTH.1));
        }
    }
}

/// The number in a cell of a line; none if it is empty, as that of a run that failed.
fn cell(line: &[u8], column: usize) -> Option<f64> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).buffer_capacity(line.len()).from_reader(line);
    let mut row = csv::StringRecord::new();
    let is_row = reader.read_record(&mut row).is_ok_and(|is_row| is_row);
    row.get(column).filter(|_| is_row)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> [Column; 3] {
        [Column::always("run", Type::Integer), Column::optional("y", Type::Real), Column::optional("error", Type::Text)]
    }

    fn rule(precision: f64, most: u64) -> Rule {
        Rule::new(&columns(), "y", precision, 0.95, most).unwrap()
    }

    /// Numbers of the runs of points whose samples give `value` of run and sample.
    fn runs(mut order: Order, most: u64, value: impl Fn(u64, u64) -> String) -> Vec<u64> {
        let mut runs = Vec::new();
        while order.next() < order.range().end {
            let run = order.next();
            runs.push(run);
            order.took(format!("{run},{},\n", value(run / most, run % most)).as_bytes());
        }
        runs
    }

    #[test]
    fn points_end_at_fixed_numbers_of_samples_when_their_mean_is_precise() {
        // Point 0: equal samples; 1: zero mean; 2: 1 and 3 in turn, 2 +- 2 / sqrt(n); 3: failures; 4: no numbers.
        let value = |point: u64, sample: u64| match point {
            0 => "7.5".to_owned(),
            1 => if sample.is_multiple_of(2) { "1.0" } else { "-1.0" }.to_owned(),
            2 => if sample.is_multiple_of(2) { "1.0" } else { "3.0" }.to_owned(),
            3 => String::new(),
            _ => "NaN".to_owned(),
        };
        let runs = runs(Order::new(5, 400, Some(rule(0.1, 400)), None), 400, value);
        let of = |point: u64| runs.iter().filter(|run| **run / 400 == point).count();
        // Decisions at 50, 75, 113, 170, 255, 383 and 400 samples; 2 / sqrt(n) < 0.2 from 100 samples on.
        assert_eq!([0, 1, 2, 3, 4].map(of), [50, 400, 113, 50, 50]);
        assert!(runs.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn shards_and_later_points_are_parts_of_the_whole() {
        let value = |point: u64, sample: u64| format!("{}", 10.0 + ((sample * (point + 3)) % 7) as f64);
        let order = |shard| Order::new(7, 60, Some(rule(0.02, 60)), shard);
        let whole = runs(order(None), 60, value);
        let shards = Shard::all(3).flat_map(|shard| runs(order(Some(shard)), 60, value)).collect::<Vec<_>>();
        assert_eq!(shards, whole);
        let later = runs(order(None).behind(5).unwrap(), 60, value);
        assert!(whole.ends_with(&later) && later[0] == 300);
        assert!(order(None).behind(7).is_none());
        let ordinary = Order::new(7, 3, None, None);
        assert!(ordinary.behind(1).is_none() && ordinary.stage().is_none());
        assert_eq!(runs(ordinary, 3, value), (0..21).collect::<Vec<_>>());
    }
}
