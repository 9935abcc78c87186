//! The energy table of a co-simulation, as text and in the HTML report, and why its rows differ.

use super::cosim::{Compared, Finished};
use super::{format, output, simulate};
use crate::cosim::{CouplingSummary, EnergyBalance};
use videg_report::{self, Column, Report, ReportError, Section, Table};

/// Why the rows of the energy table differ (derived in the design notes of Eq. (13)).
pub const EXPLANATION: [&str; 10] = [
    "Why they differ: an impact moves the charge dQ = U_in dC from the supply, which gives U_in dQ. W of Eq. (13) is half",
    "of that: the change of the stored energy, not a gain. A Zener in series then burns U_z dQ, and the load sees only what",
    "is above U_z. At U_z = U_in a charge q let out at U thus gains q (U - 2 U_in): the paper's circuit loses unless C3/C2 is",
    "above 2, or 3 with both membranes on one node. An ideal switch at U_z = U_in into a quick load hands on what the supply",
    "gave; with U_z above U_in the mechanics' work reaches the load, the more so with isolated membranes. It does so without",
    "a switch to be driven where a diode leads into a storage at U_out, whose intake counts as the load's: a quick release,",
    "which gains (C3 U_in - C2 U_out) (U_out - U_in), the most at U_out = U_in (C3/C2 + 1)/2. Where impacts differ, the switch",
    "and the storage of the last two columns are at the voltage that gains most over all of them. A load that takes the",
    "charge slowly, at C2, gains up to twice that, and at a lower voltage: videg reproduce tuning looks for the best pair.",
    "The last row is the charge from the supply over what Eq. (13) has in mind, the sum of U_in dC over all impacts.",
];

/// A row of the energy table: its name and how to read it from a circuit, in J.
type EnergyRow = (&'static str, fn(&Compared) -> f64);

const ENERGIES: [EnergyRow; 8] = [
    ("W, Eq. (13)", |c| c.summary.energy.eq13),
    ("supply", |c| c.summary.energy.supply),
    ("Zener", |c| c.summary.energy.zener),
    ("diode", |c| c.summary.energy.diode),
    ("load", |c| c.summary.energy.load),
    ("stored", |c| c.summary.energy.stored),
    ("converted = load + Zener + diode + stored - supply", |c| c.summary.energy.converted),
    ("surplus = load - supply", |c| c.summary.energy.surplus),
];

/// Significant digits of energies.
const DIGITS: usize = 5;

/// Cells of the table, row by row: energies in mJ and the charge moved against `U_in` dC.
fn cells(finished: &Finished) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = ENERGIES
        .iter()
        .map(|(name, value)| {
            let values = finished.circuits.iter().map(|circuit| format::significant(1e3 * value(circuit), DIGITS));
            std::iter::once((*name).to_owned()).chain(values).collect()
        })
        .collect();
    let ratio = |circuit: &Compared| format::significant(circuit.summary.charge.supply / finished.cycle_charge, DIGITS);
    let charge = std::iter::once("supply charge / (U_in dC)".to_owned()).chain(finished.circuits.iter().map(ratio));
    if finished.cycle_charge > 0.0 {
        rows.push(charge.collect());
    }
    rows
}

fn headings(finished: &Finished) -> Vec<String> {
    std::iter::once("energy over the whole run, mJ".to_owned())
        .chain(finished.circuits.iter().map(|circuit| circuit.label.clone()))
        .collect()
}

/// The energy table as text.
pub fn energy_table(finished: &Finished) -> String {
    let headings: Vec<_> = headings(finished).iter().map(|heading| heading.replace(", ", "\n")).collect();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = format::table(&headings);
    for cells in cells(finished) {
        table.add_row(format::row(&cells));
    }
    table.to_string()
}

/// What the coupling with the first circuit came to, and where the energy of both went.
pub fn coupling_lines(finished: &Finished) -> String {
    let balance = finished.balance.as_ref().map(balance_line);
    std::iter::once(coupling_line(&finished.coupling)).chain(balance).collect::<Vec<_>>().join("\n")
}

fn balance_line(balance: &EnergyBalance) -> String {
    let work = |joule: f64| format::significant(1e3 * joule, DIGITS);
    let EnergyBalance { wall, kinetic, elastic, impact_loss, converted, residual, relative_residual, .. } = *balance;
    format!(
        "balance: the walls gave {} mJ = kinetic {} + elastic {} + lost in impacts {} + to the circuit {} mJ; residual \
         {residual:.1e} J, {relative_residual:.1e} of the energy moved",
        work(wall),
        work(kinetic),
        work(elastic),
        work(impact_loss),
        work(converted),
    )
}

fn coupling_line(coupling: &CouplingSummary) -> String {
    let work = |joule: f64| format::significant(1e3 * joule, DIGITS);
    let CouplingSummary { steps, rejected, circuit_work, harvester_work, residual, relative_residual, .. } = *coupling;
    format!(
        "coupling: {steps} communication steps, {rejected} undone; work -1/2 U^2 dC booked by the circuit {} mJ, by the \
         harvester {} mJ; residual {residual:.1e} J, {relative_residual:.1e} of the energy moved",
        work(circuit_work),
        work(harvester_work),
    )
}

/// What the figure shows.
pub const FIGURE_CAPTION: &str = "(a) Relative displacement, (b) capacitances and (c) membrane voltages in the last seconds \
    of the run; (d) energies of the first circuit since its start.";

/// The energy table in an HTML report.
pub fn table(finished: &Finished) -> Table {
    let columns = headings(finished).into_iter().enumerate();
    let columns = columns.map(|(k, heading)| if k == 0 { Column::words(heading) } else { Column::numbers(heading) });
    cells(finished).into_iter().fold(Table::new(columns), Table::row)
}

/// The HTML report.
pub fn html(finished: &Finished) -> Result<String, ReportError> {
    let scenario = &finished.scenario;
    let [from, to] = scenario.window;
    let mut result = Section::new("Result").table(simulate::report_table(scenario, &finished.mechanics));
    for warning in &finished.warnings {
        result = result.warning(warning.clone());
    }
    let report = Report::new(
        format!("Co-simulation of {}", scenario.name),
        format!("{}; 0 to {} s, averages over {from} to {to} s.", scenario.description, scenario.until),
    )
    .command(output::command_line())
    .generated_by(concat!("videg ", env!("CARGO_PKG_VERSION")))
    .section(result)
    .section(Section::new("Where the energy goes").text(EXPLANATION.join(" ")).table(table(finished)))
    .section(Section::new("Coupling").text(coupling_lines(finished)))
    .section(
        Section::new("Motion, capacitances, voltages and energies")
            .figure(finished.drawing.svg.clone(), FIGURE_CAPTION),
    );
    videg_report::render_html(&report)
}
