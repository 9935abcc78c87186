//! The files of a crosscheck: waveforms, checks, impacts and the sweep as CSV, figures as SVG.

use std::path::{Path, PathBuf};

use videg_circuit::formulas;
use videg_system::atomic_file;

use super::error::FileError;
use super::figures;
use super::run::Crosscheck;
use super::solver::Solver;
use super::sweep::ReleaseSweep;
use crate::cosim::CircuitSample;

/// Writes data and figures into `folder`; returns the files, and the figures as SVG: the overlay and, if there is a sweep,
/// that of the sweep.
pub fn write(folder: &Path, found: &Crosscheck) -> Result<(Vec<PathBuf>, Vec<String>), FileError> {
    let mut files = vec![
        csv(folder.join("waveforms.csv"), waveforms(found))?,
        csv(folder.join("checks.csv"), checks(found))?,
        csv(folder.join("impacts.csv"), impacts(found))?,
    ];
    let mut figures = vec![figures::overlay(found)?];
    files.push(svg(folder.join("figure.svg"), &figures[0])?);
    if let Some(sweep) = &found.sweep {
        files.push(csv(folder.join("sweep.csv"), curves(sweep))?);
        figures.push(figures::sweep(sweep)?);
        files.push(svg(folder.join("sweep.svg"), &figures[1])?);
    }
    Ok((files, figures))
}

fn svg(path: PathBuf, figure: &str) -> Result<PathBuf, FileError> {
    atomic_file::write(&path, figure).map_err(FileError::write(&path))?;
    Ok(path)
}

/// A heading and rows.
type Table<'a> = (Vec<String>, Box<dyn Iterator<Item = Vec<String>> + 'a>);

fn csv(path: PathBuf, (heading, rows): Table<'_>) -> Result<PathBuf, FileError> {
    let written = atomic_file::fill(&path, |file| -> std::io::Result<()> {
        let mut writer = csv::Writer::from_writer(file);
        writer.write_record(heading)?;
        for row in rows {
            writer.write_record(row)?;
        }
        writer.flush()
    });
    written.map_err(FileError::write(&path))?;
    Ok(path)
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}

/// A column of a solver in `waveforms.csv`, named as the variable of the FMU.
type Column = (&'static str, fn(&CircuitSample) -> f64);

const COLUMNS: [Column; 7] = [
    ("left.voltage", |at| at.voltage[0]),
    ("right.voltage", |at| at.voltage[1]),
    ("load.voltage", |at| at.load_voltage),
    ("supply.energy", |at| at.ledger.supply),
    ("load.energy", |at| at.ledger.load),
    ("zener.energy", |at| at.ledger.zener),
    ("supply.charge", |at| at.ledger.supply_charge),
];

/// One row a communication step: the pulses have many more.
fn waveforms(found: &Crosscheck) -> Table<'_> {
    let fixed = ["time", "left.capacitance", "right.capacitance"].map(str::to_owned);
    let columns = found.runs.iter().flat_map(|(solver, _)| COLUMNS.map(|(name, _)| format!("{}.{name}", solver.key())));
    let mut due = 0.0;
    let kept = found.mechanics.table.rows().enumerate().filter(move |(_, (time, _))| {
        let is_kept = *time >= due || *time == found.scenario.until;
        due = if is_kept { time + found.scenario.step * (1.0 - 1e-9) } else { due };
        is_kept
    });
    let rows = kept.map(|(row, (time, [left, right]))| {
        let values = found.runs.iter().flat_map(|(_, run)| {
            // Nothing where ngspice has stopped.
            let sample = run.samples.get(row);
            COLUMNS.map(|(_, value)| sample.map_or_else(String::new, |sample| format!("{:.9e}", value(sample))))
        });
        [time, left, right].map(|value| format!("{value:.9e}")).into_iter().chain(values).collect()
    });
    (fixed.into_iter().chain(columns).collect(), Box::new(rows))
}

fn checks(found: &Crosscheck) -> Table<'_> {
    let solvers = Solver::ALL.map(Solver::key).into_iter();
    let judgement =
        ["between", "deviation", "tolerance", "agree", "claim", "claim_deviation", "claim_tolerance", "claim_holds"];
    let heading = ["quantity", "unit", "analytic"].into_iter().chain(solvers).chain(judgement).map(str::to_owned);
    let rows = found.checks.iter().map(|check| {
        let mut row = vec![check.name.clone(), check.unit.to_owned(), optional(check.analytic)];
        row.extend(Solver::ALL.map(|solver| optional(check.values.get(solver))));
        row.extend(check.agreement.as_ref().map_or_else(<[String; 4]>::default, |a| {
            [a.between.clone(), format!("{:?}", a.deviation), format!("{:?}", a.tolerance), a.agree.to_string()]
        }));
        row.extend(check.claim.as_ref().map_or_else(<[String; 4]>::default, |c| {
            [c.says.clone(), format!("{:?}", c.deviation), format!("{:?}", c.tolerance), c.holds.to_string()]
        }));
        row
    });
    (heading.collect(), Box::new(rows))
}

/// The impacts, and the peaks on an open circuit of the single pulses among them.
fn impacts(found: &Crosscheck) -> Table<'_> {
    let supply = found.settings.circuit.supply_voltage;
    let fixed = ["time", "membrane", "c3_over_c2", "u_de4_eq12", "u_de4_node"].map(str::to_owned);
    let columns = found.open.iter().map(|(solver, _)| format!("peak.{}", solver.key()));
    let topology = found.settings.circuit.topology;
    let order = found.pulses.as_ref().map_or(&[][..], |pulses| &pulses.order);
    let expected = found.pulses.as_ref().map(|pulses| pulses.expected(&found.mechanics, topology, supply));
    let rows = found.mechanics.impacts.iter().enumerate().map(move |(index, impact)| {
        let place = order.iter().position(|&other| other == index);
        let at = |column: &[f64]| optional(place.and_then(|place| column.get(place).copied()));
        let eq12 = formulas::peak_voltage(supply, 1.0, impact.ratio);
        let mut row = vec![format!("{:?}", impact.time), ["left", "right"][impact.side].to_owned()];
        row.extend([impact.ratio, eq12].map(|value| format!("{value:?}")));
        row.push(expected.as_deref().map(at).unwrap_or_default());
        row.extend(found.open.iter().map(|(_, peaks)| at(peaks)));
        row
    });
    (fixed.into_iter().chain(columns).collect(), Box::new(rows))
}

fn curves(sweep: &ReleaseSweep) -> Table<'_> {
    let heading = ["parameter", "x", "circuit", "solver", "converted", "surplus"].map(str::to_owned);
    let rows = sweep.voltage.iter().chain(&sweep.load).flat_map(|curve| {
        let embedded = curve.points.iter().map(|point| (Solver::Ideal, point));
        let witnesses = curve.witnesses.iter().map(|point| (Solver::Batch, point));
        embedded.chain(witnesses).map(|(solver, point)| {
            let [x, converted, surplus] = [point.x, point.converted, point.surplus].map(|value| format!("{value:?}"));
            vec![curve.parameter.to_owned(), x, curve.circuit.clone(), solver.key().to_owned(), converted, surplus]
        })
    });
    (heading.into(), Box::new(rows))
}
