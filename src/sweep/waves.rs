//! Points that get samples until a mean is precise: their runs up to the next decision, of as many points at once as the cores need.

use std::collections::VecDeque;
use std::ops::Range;

use super::SweepError;
use super::order::Order;
use super::record::Record;
use crate::threads::{self, Sharing};

/// Runs of a wave for each thread, so that few threads wait for its last run.
const EACH: u64 = 8;

/// A point that is not in the results yet.
struct Pending {
    point: u64,
    order: Order,
    /// Lines that wait for those of earlier points.
    lines: Vec<Vec<u8>>,
}

impl Pending {
    fn new(order: Order) -> Option<Self> {
        let (point, _) = order.stage()?;
        Some(Self { point, order, lines: Vec::new() })
    }

    /// Its next run and those after it up to a decision, unless it has enough samples.
    fn runs(&self) -> Range<u64> {
        self.order.stage().filter(|(point, _)| *point == self.point).map_or(0..0, |(_, runs)| runs)
    }
}

/// Computes runs by `line` and appends them to `record`, until it is complete or the work is stopped. What later points have done goes
/// if it is stopped.
pub(super) fn compute(
    record: &mut Record,
    sharing: Sharing<'_>,
    line: impl Fn(u64) -> Result<Vec<u8>, SweepError> + Sync,
    tell: impl Fn(u64) + Sync,
) -> Result<(), SweepError> {
    let enough = sharing.threads as u64 * EACH;
    let mut window: VecDeque<Pending> = Pending::new(record.order().clone()).into_iter().collect();
    while !window.is_empty() && !(sharing.is_stopped)() {
        fill(&mut window, enough);
        let wave: Vec<(usize, u64)> = window
            .iter()
            .enumerate()
            .flat_map(|(place, pending)| pending.runs().map(move |run| (place, run)))
            .collect();
        let mut places = wave.iter().map(|(place, _)| *place);
        let run = |number: u64| line(wave[usize::try_from(number).unwrap_or(usize::MAX)].1);
        threads::in_order(0..wave.len() as u64, sharing, run, |lines| {
            for (line, place) in lines.into_iter().zip(places.by_ref()) {
                window[place].order.took(&line);
                if place == 0 {
                    record.append(&[line])?;
                } else {
                    window[place].lines.push(line);
                }
            }
            tell(record.next());
            Ok(())
        })?;
        write_decided(&mut window, record)?;
    }
    Ok(())
}

/// Adds points until the next runs of all are `enough`.
fn fill(window: &mut VecDeque<Pending>, enough: u64) {
    let count = |pending: &Pending| pending.runs().end - pending.runs().start;
    let mut runs: u64 = window.iter().map(count).sum();
    while runs < enough
        && let Some(next) = window.back().and_then(|last| last.order.behind(last.point + 1)).and_then(Pending::new)
    {
        runs += count(&next);
        window.push_back(next);
    }
}

/// Removes the points at the front that have enough samples, and writes what waits for them.
fn write_decided(window: &mut VecDeque<Pending>, record: &mut Record) -> Result<(), SweepError> {
    while window.front().is_some_and(|pending| pending.runs().is_empty()) {
        let last = window.pop_front();
        if window.is_empty() {
            window.extend(last.and_then(|last| last.order.behind(last.point + 1)).and_then(Pending::new));
        }
        if let Some(front) = window.front_mut() {
            record.append(&std::mem::take(&mut front.lines))?;
        }
    }
    Ok(())
}
