//! The energy table of a co-simulation, the reasons why its rows differ, and the HTML report.

use super::format::{Sheet, significant};
use super::{drawn, energy_flow, excitation, parameter_table, run_output};
use crate::cosim::{CouplingSummary, Device, EnergyBalance, LabelledCircuit, Powers, Results};
use crate::ngspice::Role;
use crate::scenario::Scenario;
use videg_report::{KeyNumber, Report, Section};

/// Why the rows of the energy table differ (derived in the design notes of Eq. (13)).
pub const EXPLANATION: [&str; 10] = [
    "Why they differ: an impact moves the charge dQ = U_in dC from the supply, which gives U_in dQ. W of Eq. (13) is half",
    "of that: the change of the stored energy, not a gain. A Zener in series then burns U_z dQ, and the load gets only the",
    "voltage above U_z. At U_z = U_in a charge q released at U thus gains q (U - 2 U_in): the paper's circuit loses unless",
    "C3/C2 is above 2, or 3 with both membranes on one node. With an ideal switch at U_z = U_in and a quick load the net gain",
    "is zero; with U_z above U_in the work of the mechanics reaches the load, more of it with isolated membranes. A diode into",
    "a storage at U_out does the same without a driven switch; the energy into the storage counts as the load's. Such a quick",
    "release gains (C3 U_in - C2 U_out) (U_out - U_in), the most at U_out = U_in (C3/C2 + 1)/2. Where impacts differ, the switch",
    "and the storage of the last two columns are at the voltage with the largest net gain over all of them. A load that takes",
    "the charge slowly, at C2, gains up to twice that, and at a lower voltage: videg reproduce tuning finds the best pair.",
    "The last row is the charge from the supply over the charge in Eq. (13), the sum of U_in dC over all impacts.",
];

/// Under the table of a circuit FMU of the user.
const UNTOLD: &str = "A dash is what the circuit FMU does not tell: map its variable to see it.";

/// A row of the energy table: its name and how to read it from a circuit, in J.
type EnergyRow = (&'static str, fn(&LabelledCircuit) -> f64);

const ENERGIES: [EnergyRow; 5] = [
    ("W, Eq. (13)", |c| c.summary.energy.eq13),
    ("supply", |c| c.summary.energy.supply),
    ("Zener", |c| c.summary.energy.zener),
    ("diode", |c| c.summary.energy.diode),
    ("load", |c| c.summary.energy.load),
];

/// What the paper's circuit does not have is named where it is.
const LEAKAGE: [EnergyRow; 3] = [
    ("leakage", |c| c.summary.energy.leakage),
    ("stored", |c| c.summary.energy.stored),
    ("converted = load + Zener + diode + leakage + stored - supply", |c| c.summary.energy.converted),
];

const NO_LEAKAGE: [EnergyRow; 2] = [
    ("stored", |c| c.summary.energy.stored),
    ("converted = load + Zener + diode + stored - supply", |c| c.summary.energy.converted),
];

const SURPLUS: EnergyRow = ("surplus = load - supply", |c| c.summary.energy.surplus);

/// Significant digits of energies.
const DIGITS: usize = 5;

/// A number of a table; a circuit FMU of a user need not tell all.
fn number(value: f64) -> String {
    if value.is_nan() { "-".to_owned() } else { significant(value, DIGITS) }
}

fn is_netlist(results: &Results) -> bool {
    !results.elements.is_empty()
}

/// The energy table: energies in mJ and the charge moved against `U_in` dC.
pub fn energies(results: &Results) -> Sheet {
    let row = |name: &str, value: &dyn Fn(&LabelledCircuit) -> f64| {
        let values = results.circuits.iter().map(|circuit| number(value(circuit)));
        std::iter::once(name.to_owned()).chain(values).collect()
    };
    let leaks = results.circuits.iter().any(|circuit| circuit.summary.energy.leakage != 0.0);
    let balance: &[EnergyRow] = if leaks { &LEAKAGE } else { &NO_LEAKAGE };
    let energies = ENERGIES.iter().chain(balance).chain([&SURPLUS]);
    let mut rows: Vec<_> = energies.map(|(name, value)| row(name, &|circuit| 1e3 * value(circuit))).collect();
    if results.cycle_charge > 0.0 {
        rows.push(row("supply charge / (U_in dC)", &|circuit| circuit.summary.charge.supply / results.cycle_charge));
    }
    let labels = results.circuits.iter().map(|circuit| circuit.label.clone());
    Sheet::new(std::iter::once("energy over the whole run, mJ".to_owned()).chain(labels), &[0], rows)
}

/// A mean power of a circuit: its name, and how to read it, in W.
type PowerRow = (&'static str, fn(&Powers) -> f64);

const POWERS: [PowerRow; 3] = [
    ("net power = load - supply + stored", |powers| powers.net_power),
    ("load power", |powers| powers.load_power),
    ("supply power", |powers| powers.supply_power),
];
/// With a netlist, by what counts as a gain and as a cost.
const NETLIST_POWERS: [&str; 3] = ["net power = gain - cost + stored", "gain", "cost"];

/// Why P of Eq. (14), which stands above, is not among the powers.
pub const NO_GAIN: &str = "P of Eq. (14) is the mean of W, the change of the stored energy at an impact. That is half of what the \
    supply gives, not a gain.";

/// What a user gains: mean powers over the averaging window.
pub fn powers(scenario: &Scenario, results: &Results) -> Sheet {
    let [from, to] = scenario.window;
    let rows = POWERS.iter().zip(NETLIST_POWERS).map(|((name, value), netlist)| {
        let name = if is_netlist(results) { netlist } else { name };
        let values = results.circuits.iter().map(|circuit| number(1e3 * value(&circuit.powers)));
        std::iter::once(name.to_owned()).chain(values).collect()
    });
    let labels = results.circuits.iter().map(|circuit| circuit.label.clone());
    let heading = format!("mean over {from} to {to} s, mW");
    Sheet::new(std::iter::once(heading).chain(labels), &[0], rows.collect())
}

/// The energies of the elements of a netlist, the largest first.
fn elements(results: &Results) -> Sheet {
    let mut elements: Vec<_> = results.elements.iter().collect();
    elements.sort_by(|a, b| b.energy.abs().total_cmp(&a.energy.abs()));
    let rows = elements.iter().map(|element| {
        let role = match element.role {
            Some(Role::Load) => "gain",
            Some(Role::Supply) => "cost",
            Some(_) => "",
            None => "membrane",
        };
        vec![element.name.clone(), role.to_owned(), significant(1e3 * element.energy, DIGITS)]
    });
    Sheet::new(["element", "counts as", "took over the whole run, mJ"], &[0, 1], rows.collect())
}

/// By how much the energies of the elements, whose sum is zero by Kirchhoff's law, miss that.
fn closure(results: &Results) -> String {
    let sum: f64 = results.elements.iter().map(|element| element.energy).sum();
    let moved: f64 = 0.5 * results.elements.iter().map(|element| element.energy.abs()).sum::<f64>();
    let relative = if moved > 0.0 { sum.abs() / moved } else { 0.0 };
    format!("The energies of all elements sum to {sum:.1e} J, {relative:.1e} of the energy moved.")
}

/// What stands under the energy table, in lines with `separator` between them.
fn explanation(results: &Results) -> String {
    let is_untold = || results.circuits.iter().any(|circuit| circuit.summary.energy.converted.is_nan());
    match results.is_foreign {
        false => EXPLANATION.join(" "),
        true if is_untold() => UNTOLD.to_owned(),
        true => "The energies are those that the circuit FMU tells.".to_owned(),
    }
}

/// The tables of energies with their explanation.
pub fn tables(results: &Results) -> String {
    if is_netlist(results) {
        return format!("{}\n\n{}", elements(results).text(), closure(results));
    }
    format!("{}\n\n{}", energies(results).narrow(", "), explanation(results))
}

/// The coupling with the first circuit, and the energy balance.
pub fn coupling_lines(results: &Results) -> String {
    let balance = results.balance.as_ref().map(balance_line);
    std::iter::once(coupling_line(&results.coupling)).chain(balance).collect::<Vec<_>>().join("\n")
}

fn balance_line(balance: &EnergyBalance) -> String {
    let work = |joule: f64| significant(1e3 * joule, DIGITS);
    let EnergyBalance { wall, kinetic, elastic, impact_loss, converted, residual, relative_residual, .. } = *balance;
    // What the paper's device does not have is named where it is.
    let gravity = if balance.gravity == 0.0 { String::new() } else { format!(", gravity {}", work(balance.gravity)) };
    let friction =
        if balance.friction == 0.0 { String::new() } else { format!(" + friction {}", work(balance.friction)) };
    format!(
        "balance: the walls gave {}{gravity} mJ = kinetic {} + elastic {} + lost in impacts {}{friction} + to the circuit {} mJ; \
         residual {residual:.1e} J, {relative_residual:.1e} of the energy moved",
        work(wall),
        work(kinetic),
        work(elastic),
        work(impact_loss),
        work(converted),
    )
}

fn coupling_line(coupling: &CouplingSummary) -> String {
    let work = |joule: f64| significant(1e3 * joule, DIGITS);
    let CouplingSummary { steps, rejected, circuit_work, harvester_work, residual, relative_residual, .. } = *coupling;
    format!(
        "coupling: {steps} communication steps, {rejected} undone; work -1/2 U^2 dC booked by the circuit {} mJ, by the \
         harvester {} mJ; residual {residual:.1e} J, {relative_residual:.1e} of the energy moved",
        work(circuit_work),
        work(harvester_work),
    )
}

/// Caption of the figure.
pub const FIGURE_CAPTION: &str = "The last seconds of the run: (a) relative displacement, (b) capacitances, (c) membrane voltages, (d) energies of \
    the circuit, which grow in steps at the impacts; (e) the same energies since the start of the run.";
const OWN_CAPTION: &str = "The last seconds of the run: (a) relative displacement, (b) capacitances, (c) membrane voltages, then waveforms \
    and energies of the circuit; last panel: energies since the start of the run.";

/// The numbers that a user looks for first.
fn keys(scenario: &Scenario, results: &Results, device: &Device) -> Vec<KeyNumber> {
    let Some((first, others)) = results.circuits.split_first() else { return Vec::new() };
    let [from, to] = scenario.window;
    let Powers { net_power, load_power, supply_power } = first.powers;
    let largest = [net_power, load_power, supply_power]
        .into_iter()
        .filter(|power| !power.is_nan())
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    let [load, supply] = if is_netlist(results) { ["gain", "cost"] } else { ["load power", "supply power"] };
    let note = format!("{}: mean over {from} to {to} s; load - supply + change of what is stored", first.label);
    let mut keys = vec![
        run_output::power("net power", net_power, largest).note(note).main(),
        run_output::power(load, load_power, largest),
        run_output::power(supply, supply_power, largest),
    ];
    let best = others.iter().max_by(|a, b| a.powers.net_power.total_cmp(&b.powers.net_power));
    if let Some(best) = best.filter(|best| best.powers.net_power > net_power) {
        let power = best.powers.net_power;
        keys.push(
            run_output::power("best net power compared", power, power.abs().max(largest)).note(best.label.clone()),
        );
    }
    keys.extend([
        run_output::voltage_gain(scenario, &results.mechanics),
        run_output::impact_rate(scenario, &results.mechanics, device),
    ]);
    keys
}

/// The HTML report; its end is that of `circuit`, the parameters of the user's circuit, or nothing.
pub fn report(
    scenario: &Scenario,
    results: &Results,
    device: &Device,
    svg: String,
    circuit: impl FnOnce(Section) -> Section,
) -> anyhow::Result<Report> {
    let caption = if results.is_foreign { OWN_CAPTION } else { FIGURE_CAPTION };
    let answer = run_output::result(&results.warnings)
        .keys(keys(scenario, results, device))
        .figure(svg, caption)
        .table(powers(scenario, results).html())
        .table(run_output::mechanics(scenario, &results.mechanics).html())
        .folded(Section::new("Why P of Eq. (14) is not among the powers").text(NO_GAIN));
    let names = if is_netlist(results) { &energy_flow::NETLIST } else { &energy_flow::PAPER };
    let flow = energy_flow::section(&results.flows, device, scenario.window, names)?;
    let energies = flow.unwrap_or_else(|| Section::new("Energy flow"));
    let energies = if is_netlist(results) {
        energies.table(elements(results).html()).text(closure(results))
    } else {
        let why = if results.is_foreign { "What the energies are" } else { "Why the circuits differ" };
        energies.table(self::energies(results).html()).folded(Section::new(why).text(explanation(results)))
    };
    let parameters = parameter_table::section(device, scenario);
    let parameters = match &results.asked {
        Some(asked) => parameter_table::with_circuit(parameters, asked, scenario),
        None => circuit(parameters),
    };
    let report = run_output::report(format!("Co-simulation of {}", scenario.name), scenario).section(answer);
    let drawn = drawn::section(device, results.asked.as_ref())?;
    let report = drawn.into_iter().fold(report, Report::section).section(energies).section(parameters);
    let report = excitation::described(report, device, scenario.until)?;
    Ok(report.section(Section::new("Coupling").text(coupling_lines(results))))
}
