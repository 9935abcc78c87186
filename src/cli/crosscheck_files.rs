//! The files of a crosscheck: waveforms, checks and impacts as CSV, figures, report, and the folder for ngspice alone.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use videg_circuit::formulas;

use super::crosscheck::{Finished, capacitances};
use super::{crosscheck_picture as picture, crosscheck_report as page, output};
use crate::cosim::CircuitSample;
use crate::crosscheck::export::{Expected, Item};
use crate::crosscheck::{Compared, Curve, Solver, export as folder_for_ngspice};
use videg_system::atomic_file;

/// Writes everything into `folder`; the list has a place for `result.json`, which is written last.
pub fn write(folder: &Path, finished: &Finished) -> anyhow::Result<Vec<PathBuf>> {
    let (mut written, figures) = write_data(folder, finished)?;
    let html = folder.join("report.html");
    output::write(&html, &page::html(finished, figures)?)?;
    written.extend([html, folder.join("result.json")]);
    Ok(written)
}

/// Writes data and figures into `folder`; returns the files, and the figures as SVG.
pub fn write_data(folder: &Path, finished: &Finished) -> anyhow::Result<(Vec<PathBuf>, Vec<String>)> {
    let mut written = vec![folder.join("waveforms.csv"), folder.join("checks.csv"), folder.join("impacts.csv")];
    waveforms(&written[0], finished)?;
    checks(&written[1], finished)?;
    impacts(&written[2], finished)?;
    let mut figures = vec![picture::overlay(finished)?];
    written.push(folder.join("figure.svg"));
    output::write(&folder.join("figure.svg"), &figures[0])?;
    if let Some(sweep) = &finished.sweep {
        let [csv, svg] = ["sweep.csv", "sweep.svg"].map(|name| folder.join(name));
        curves(&csv, sweep.voltage.iter().chain(&sweep.load))?;
        figures.push(picture::sweep(sweep)?);
        output::write(&svg, &figures[1])?;
        written.extend([csv, svg]);
    }
    Ok((written, figures))
}

/// Writes rows into a file that appears when it is whole.
fn csv(path: &Path, heading: &[String], rows: impl Iterator<Item = Vec<String>>) -> anyhow::Result<()> {
    let written = atomic_file::fill(path, |file| -> anyhow::Result<()> {
        let mut writer = csv::Writer::from_writer(file);
        writer.write_record(heading)?;
        for row in rows {
            writer.write_record(row)?;
        }
        Ok(writer.flush()?)
    });
    written.with_context(|| format!("cannot write {}", path.display()))
}

fn shown(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}

/// A column of a solver in `waveforms.csv`: its name, and how to read it.
type Column = (&'static str, fn(&CircuitSample) -> f64);

/// They are called as the variables of the FMUs.
const COLUMNS: [Column; 7] = [
    ("left.voltage", |at| at.voltage[0]),
    ("right.voltage", |at| at.voltage[1]),
    ("load.voltage", |at| at.load_voltage),
    ("supply.energy", |at| at.ledger.supply),
    ("load.energy", |at| at.ledger.load),
    ("zener.energy", |at| at.ledger.zener),
    ("supply.charge", |at| at.ledger.supply_charge),
];

fn waveforms(path: &Path, finished: &Finished) -> anyhow::Result<()> {
    let fixed = ["time", "left.capacitance", "right.capacitance"].map(str::to_owned);
    let columns =
        finished.runs.iter().flat_map(|(solver, _)| COLUMNS.map(|(name, _)| format!("{}.{name}", solver.key())));
    let heading: Vec<_> = fixed.into_iter().chain(columns).collect();
    // The pulses have many more rows than that.
    let spacing = finished.scenario.step;
    let mut due = 0.0;
    let kept = finished.case.table.rows().enumerate().filter(move |(_, (time, _))| {
        let keep = *time >= due || *time == finished.scenario.until;
        due = if keep { time + spacing * (1.0 - 1e-9) } else { due };
        keep
    });
    let rows = kept.map(|(row, (time, [left, right]))| {
        let of = |run: &crate::ngspice::Waveforms| {
            // Nothing where ngspice has stopped.
            let sample = run.samples.get(row);
            COLUMNS.map(|(_, value)| sample.map_or_else(String::new, |sample| format!("{:.9e}", value(sample))))
        };
        let values = finished.runs.iter().flat_map(|(_, run)| of(run));
        [time, left, right].map(|value| format!("{value:.9e}")).into_iter().chain(values).collect()
    });
    csv(path, &heading, rows)
}

fn checks(path: &Path, finished: &Finished) -> anyhow::Result<()> {
    let solvers = Solver::ALL.map(|solver| solver.key().to_owned());
    let verdicts =
        ["between", "deviation", "tolerance", "agree", "claim", "claim_deviation", "claim_tolerance", "claim_holds"];
    let head = ["quantity", "unit", "analytic"].map(str::to_owned).into_iter();
    let heading: Vec<_> = head.chain(solvers).chain(verdicts.map(str::to_owned)).collect();
    let rows = finished.checks.iter().map(|check| {
        let mut row = vec![check.name.clone(), check.unit.to_owned(), shown(check.analytic)];
        row.extend(Solver::ALL.map(|solver| shown(check.values.get(solver))));
        row.extend(check.agreement.as_ref().map_or_else(<[String; 4]>::default, |a| {
            [a.between.clone(), format!("{:?}", a.deviation), format!("{:?}", a.tolerance), a.agree.to_string()]
        }));
        row.extend(check.claim.as_ref().map_or_else(<[String; 4]>::default, |c| {
            [c.says.clone(), format!("{:?}", c.deviation), format!("{:?}", c.tolerance), c.holds.to_string()]
        }));
        row
    });
    csv(path, &heading, rows)
}

/// The impacts, and what the single pulses among them reach on an open circuit.
fn impacts(path: &Path, finished: &Finished) -> anyhow::Result<()> {
    let (case, supply) = (&finished.case, finished.settings.circuit.supply_voltage);
    let fixed = ["time", "membrane", "c3_over_c2", "u_de4_eq12", "u_de4_node"].map(str::to_owned);
    let columns = finished.open.iter().map(|(solver, _)| format!("peak.{}", solver.key()));
    let heading: Vec<_> = fixed.into_iter().chain(columns).collect();
    let order = finished.pulses.as_ref().map_or(&[][..], |pulses| &pulses.order);
    let expected = finished.pulses.as_ref().map(|p| p.expected(case, finished.settings.circuit.topology, supply));
    let rows = case.impacts.iter().enumerate().map(|(index, impact)| {
        let place = order.iter().position(|&other| other == index);
        let at = |column: &[f64]| shown(place.and_then(|place| column.get(place).copied()));
        let eq12 = formulas::peak_voltage(supply, 1.0, impact.ratio);
        let mut row = vec![format!("{:?}", impact.time), ["left", "right"][impact.side].to_owned()];
        row.extend([impact.ratio, eq12].map(|value| format!("{value:?}")));
        row.push(expected.as_deref().map(at).unwrap_or_default());
        row.extend(finished.open.iter().map(|(_, peaks)| at(peaks)));
        row
    });
    csv(path, &heading, rows)
}

fn curves<'a>(path: &Path, curves: impl Iterator<Item = &'a Curve>) -> anyhow::Result<()> {
    let heading = ["parameter", "x", "circuit", "solver", "converted", "surplus"].map(str::to_owned);
    let rows = curves.flat_map(|curve| {
        let embedded = curve.points.iter().map(|point| (Solver::Ideal, point));
        let witnesses = curve.witnesses.iter().map(|point| (Solver::Batch, point));
        embedded.chain(witnesses).map(|(solver, point)| {
            let [x, converted, surplus] = [point.x, point.converted, point.surplus].map(|value| format!("{value:?}"));
            vec![curve.parameter.to_owned(), x, curve.circuit.clone(), solver.key().to_owned(), converted, surplus]
        })
    });
    csv(path, &heading, rows)
}

/// Writes the folder that ngspice alone can run.
pub fn export(folder: &Path, finished: &Finished) -> anyhow::Result<Vec<PathBuf>> {
    let case = &finished.case;
    let mut items = Vec::new();
    for (index, compared) in finished.compared.iter().enumerate() {
        let name = if index == 0 { "circuit".to_owned() } else { format!("comparison_{index}") };
        let about = format!("{}, load {:e} ohm", compared.label, compared.settings.circuit.load_resistance);
        items.push(Item::circuit(name, about, &compared.settings, &case.table, expected(compared))?);
    }
    let [c2, c3] = capacitances(case);
    items.extend(Item::capacitors(finished.settings.circuit.supply_voltage, c2, c3)?);
    let title =
        format!("{}: {}, 0 to {} s", finished.scenario.name, finished.scenario.description, finished.scenario.until);
    Ok(folder_for_ngspice::write(folder, &title, &items)?)
}

/// That an export may go to the folder, as far as can be told before the solvers run.
pub fn check_export(folder: &Path) -> anyhow::Result<()> {
    Ok(folder_for_ngspice::check(folder)?)
}

fn expected(compared: &Compared) -> Vec<Expected> {
    let (ngspice, embedded) = (&compared.ngspice, &compared.embedded);
    let value = |name, ngspice: f64, embedded: f64, unit| Expected {
        name,
        value: ngspice,
        unit,
        source: format!("this ngspice in batch; {} {embedded:.9e}", Solver::Exponential.name()),
    };
    vec![
        value("supply_charge", ngspice.charge.supply, embedded.charge.supply, "C"),
        value("supply_energy", ngspice.energy.supply, embedded.energy.supply, "J"),
        value("load_charge", ngspice.charge.load, embedded.charge.load, "C"),
        value("load_energy", ngspice.energy.load, embedded.energy.load, "J"),
    ]
}
