//! The conclusion of a crosscheck in words, with the numbers of the run.

use super::check::QuantityCheck;
use super::compare::ComparedCircuit;
use super::solver::Solver;
use super::stop::{Repeat, Stop};

/// The conclusion, a paragraph a line: agreement of the solvers, claims that hold and that do not, the best circuit.
pub fn conclusion(
    checks: &[QuantityCheck],
    compared: &[ComparedCircuit],
    stops: &[Stop],
    repeats: &[Repeat],
) -> Vec<String> {
    let mut lines = vec![agreement(checks)];
    lines.extend(stops.iter().map(|stop| stop.sentence() + "."));
    // A repeat that did not help is in the sentence of the stop.
    let helped = repeats.iter().filter(|repeat| stops.iter().all(|stop| stop.task != repeat.task));
    lines.extend(helped.map(|repeat| repeat.sentence() + "."));
    lines.extend(claims(checks, true));
    lines.extend(claims(checks, false));
    lines.extend(why(checks));
    lines.extend(better(compared));
    lines
}

fn agreement(checks: &[QuantityCheck]) -> String {
    let failed: Vec<_> = checks.iter().filter(|check| check.failed()).collect();
    let compared = checks.iter().filter(|check| check.agreement.is_some()).count();
    if failed.is_empty() {
        return format!("The solvers agree on all {compared} quantities compared, each within its tolerance.");
    }
    let names: Vec<_> = failed
        .iter()
        .filter_map(|check| check.agreement.as_ref().map(|agreement| (check, agreement)))
        .map(|(check, a)| format!("{} ({}: {:.1e}, allowed {:.1e})", check.name, a.between, a.deviation, a.tolerance))
        .collect();
    format!("The solvers do NOT agree on {} of {compared} quantities: {}.", failed.len(), names.join("; "))
}

/// The claims that hold, or those that do not.
fn claims(checks: &[QuantityCheck], hold: bool) -> Option<String> {
    let list: Vec<_> = checks
        .iter()
        .filter_map(|check| check.claim.as_ref())
        .filter(|claim| claim.holds == hold)
        .map(|claim| format!("{} ({:+.2} %)", claim.says, 100.0 * claim.deviation))
        .collect();
    let verb = if hold { "What holds" } else { "What does not hold" };
    (!list.is_empty()).then(|| format!("{verb} in a circuit simulator (deviation of ngspice): {}.", list.join("; ")))
}

/// Value of ngspice of the quantity whose name begins so, in mJ.
fn millijoules(checks: &[QuantityCheck], name: &str) -> Option<f64> {
    Some(1e3 * checks.iter().find(|check| check.name.starts_with(name))?.values.get(Solver::Batch)?)
}

/// Why W is not what is gained.
fn why(checks: &[QuantityCheck]) -> Option<String> {
    let value = |name| millijoules(checks, name);
    let (supply, zener, load) = (value("supply energy")?, value("Zener energy")?, value("load energy")?);
    let (surplus, converted) = (value("surplus")?, value("converted")?);
    let eq13 = 1e3 * checks.iter().find(|check| check.name.starts_with("load energy"))?.analytic?;
    let zener = if zener > 0.0 { format!(", of which the Zener burns {zener:.4} mJ") } else { String::new() };
    Some(format!(
        "Why: W of Eq. (13), {eq13:.4} mJ here, is half of what the supply gives for U_in dC, and the change of the stored \
         energy in each impact; it is handed back when the membrane relaxes. The supply gives {supply:.4} mJ and the \
         mechanics {converted:.4} mJ{zener}; the load gets {load:.4} mJ. The net is {surplus:.4} mJ."
    ))
}

/// The circuit that gains most, next to the paper's.
fn better(compared: &[ComparedCircuit]) -> Option<String> {
    let surplus = |circuit: &ComparedCircuit| 1e3 * circuit.ngspice.energy.surplus;
    let best = compared.iter().max_by(|a, b| surplus(a).total_cmp(&surplus(b)))?;
    let others: Vec<_> = compared
        .iter()
        .filter(|circuit| circuit.label != best.label)
        .map(|circuit| format!("{}: {:.4} mJ", circuit.label, surplus(circuit)))
        .collect();
    let sign = if surplus(best) > 0.0 { "gains" } else { "loses least" };
    Some(format!(
        "The better circuit: {} {sign}, {:.4} mJ by ngspice and {:.4} mJ by the embedded solver; the others come to {}.",
        best.label,
        surplus(best),
        1e3 * best.embedded.energy.surplus,
        others.join(", ")
    ))
}
