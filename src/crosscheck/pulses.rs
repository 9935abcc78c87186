//! Single impacts: peak voltages and the charge from the supply.

use videg_circuit::{Topology, formulas};

use super::mechanics::MechanicalRun;
use crate::cosim::MembraneImpact;
use crate::ngspice::{CapacitanceTable, NgspiceError, Waveforms};

/// The pulses of a run that differ in height, in order of their height, one after the other.
///
/// On an open circuit a membrane keeps the charge of the highest pulse so far, so that a lower one after it would say
/// nothing about Eq. (12). In order of their height each pulse raises the voltage to its own `U_DE4`.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulses {
    /// C(t) of the pulses.
    pub table: CapacitanceTable,
    /// The impacts that made them, by their indices in the run, in this order.
    pub order: Vec<usize>,
    /// These impacts.
    impacts: Vec<MembraneImpact>,
    /// First row of each, and the number of rows.
    starts: Vec<usize>,
}

impl Pulses {
    /// A membrane counts as at rest up to this part of the height of the pulse.
    const REST: f64 = 1e-3;
    /// Pulses count as equal up to this, relative: the error of C(t). A periodic motion has few that differ.
    const DISTINCT: f64 = MechanicalRun::TABLE_ERROR;
    /// Rest between two pulses, s.
    const GAP: f64 = 1e-3;

    /// The pulses of `run` that end before the next impact, one of each height; `None` without any.
    pub(super) fn new(run: &MechanicalRun, topology: Topology) -> Result<Option<Self>, NgspiceError> {
        let mut pieces: Vec<(usize, [usize; 2])> = rows_of_impacts(run.table.times(), &run.impacts)
            .enumerate()
            .filter_map(|(index, rows)| Some((index, Self::pulse(run, &run.impacts[index], rows)?)))
            .collect();
        let height = |index: usize| run.node_capacitances(topology, &run.impacts[index])[1];
        pieces.sort_by(|(a, _), (b, _)| height(*a).total_cmp(&height(*b)));
        let mut highest = [0.0; 2];
        pieces.retain(|&(index, _)| {
            let node = if topology == Topology::SharedNode { 0 } else { run.impacts[index].side };
            let is_higher = height(index) > highest[node] * (1.0 + Self::DISTINCT);
            if is_higher {
                highest[node] = height(index);
            }
            is_higher
        });
        if pieces.is_empty() {
            return Ok(None);
        }
        let rows: Vec<_> = run.table.rows().collect();
        let mut table = CapacitanceTable::default();
        table.push(0.0, run.rest)?;
        let (mut now, mut starts) = (Self::GAP, Vec::new());
        for &(_, [from, to]) in &pieces {
            starts.push(table.len());
            for &(at, capacitance) in &rows[from..=to] {
                table.push(now + at - rows[from].0, capacitance)?;
            }
            // To the very end of the pulse, where the voltage is highest.
            now += rows[to].0 - rows[from].0 + Self::GAP;
            table.push(now - 0.5 * Self::GAP, run.rest)?;
        }
        starts.push(table.len());
        let order: Vec<_> = pieces.into_iter().map(|(index, _)| index).collect();
        let impacts = order.iter().map(|&index| run.impacts[index]).collect();
        Ok(Some(Self { table, order, impacts, starts }))
    }

    /// First and last row of a pulse between the rows of two impacts, if both membranes are at rest there.
    fn pulse(run: &MechanicalRun, impact: &MembraneImpact, [from, to]: [usize; 2]) -> Option<[usize; 2]> {
        let least = Self::REST * (impact.ratio - 1.0) * run.rest[impact.side];
        let columns = [run.table.left(), run.table.right()];
        let rests = |row: usize| (0..2).all(|j| (columns[j][row] - run.rest[j]).abs() <= least);
        let last = (from..to).rev().find(|&row| !rests(row))?;
        (rests(from) && rests(to)).then_some([from, last + 1])
    }

    /// `U_DE4` of each pulse by `U_in C_3 / C_2` of the node, V.
    pub fn expected(&self, run: &MechanicalRun, topology: Topology, supply_voltage: f64) -> Vec<f64> {
        let capacitances = self.impacts.iter().map(|impact| run.node_capacitances(topology, impact));
        capacitances.map(|[c2, c3]| formulas::peak_voltage(supply_voltage, c2, c3)).collect()
    }

    /// Keeps the first `count` pulses.
    pub fn truncate(&mut self, count: usize) {
        self.order.truncate(count);
        self.impacts.truncate(count);
        self.starts.truncate(count + 1);
    }

    /// Highest voltage of the struck membrane after each pulse in `waveforms`, which are of [`Self::table`], V; of the
    /// complete pulses.
    pub fn peaks(&self, waveforms: &Waveforms) -> Vec<f64> {
        let highest = |(impact, ends): (&MembraneImpact, &[usize])| {
            let samples = &waveforms.samples[ends[0]..ends[1]];
            let voltages = samples.iter().map(|sample| sample.voltage[impact.side]);
            voltages.max_by(f64::total_cmp).unwrap_or(f64::NAN)
        };
        let complete = self.starts.windows(2).take_while(|ends| ends[1] <= waveforms.samples.len());
        self.impacts.iter().zip(complete).map(highest).collect()
    }
}

/// Charge drawn from the supply from each impact to the next, C; not after the last.
pub fn charges(waveforms: &Waveforms, impacts: &[MembraneImpact]) -> Vec<f64> {
    let charge = |row: usize| waveforms.samples.get(row).map_or(f64::NAN, |sample| sample.ledger.supply_charge);
    rows_of_impacts(&waveforms.time, impacts).map(|[from, to]| charge(to) - charge(from)).collect()
}

/// Rows from each impact to the next, of a table with these times.
fn rows_of_impacts<'a>(times: &'a [f64], impacts: &'a [MembraneImpact]) -> impl Iterator<Item = [usize; 2]> + 'a {
    // The table and the run that found the impacts round their times differently.
    let row = |impact: &MembraneImpact| times.partition_point(|&time| time < impact.time - 1e-9);
    impacts.windows(2).map(move |pair| [row(&pair[0]), row(&pair[1])])
}

/// Largest deviation of `found` from `expected`, relative to it, with its sign; NaN without any.
pub fn largest_deviation(found: &[f64], expected: &[f64]) -> f64 {
    let deviations = found.iter().zip(expected).map(|(a, b)| a / b - 1.0);
    // In the total order, NaN lies above everything else.
    deviations.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::largest_deviation;

    #[test]
    fn the_largest_deviation_has_its_sign_and_nan_is_larger_than_all() {
        assert_eq!(largest_deviation(&[1.25, 0.5, 1.0], &[1.0; 3]), -0.5);
        assert_eq!(largest_deviation(&[1.5, 0.75], &[1.0; 2]), 0.5);
        assert!(largest_deviation(&[f64::NAN, 9.0], &[1.0; 2]).is_nan() && largest_deviation(&[], &[]).is_nan());
    }
}
