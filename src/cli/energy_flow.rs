//! The diagram of a report that shows where the energy goes, from the excitation to the load.

use videg_circuit::Ledger;
use videg_model::{ExcitationKind, Parameters};
use videg_report::{Kind, ReportError, Sankey, Section, Stage};

use crate::cosim::{Device, EnergyBalance, Flows};

/// Names of the flows of a circuit.
pub struct Names {
    pub supply: &'static str,
    pub load: &'static str,
    /// What the ledger calls diode.
    pub diode: &'static str,
}

pub const PAPER: Names = Names { supply: "supply", load: "load", diode: "diodes" };
pub const NETLIST: Names = Names { supply: "cost", load: "gain", diode: "other elements" };

const FREE_CYLINDER: &str = " The cylinder does not feel the ball (contact.reaction = false): the work of its walls is not taken from the \
    excitation.";
const DEAF_BALL: &str = " The ball does not feel the voltages (contact.electrostaticFeedback = false): the work of the membranes is \
    not taken from its energy.";

/// The section; none if nothing flows, or nothing is known of the harvester.
pub fn section(
    flows: &Flows,
    device: &Device,
    [from, to]: [f64; 2],
    names: &Names,
) -> Result<Option<Section>, ReportError> {
    let Some((parameters, _)) = &device.parameters else { return Ok(None) };
    let sankey = sankey(flows, parameters, names);
    if sankey.is_empty() {
        return Ok(None);
    }
    let mut caption = format!("Mean flows of energy from {from} to {to} s, from the ledgers of harvester and circuit.");
    if flows.mechanics.is_some() && !reacts(parameters) {
        caption += FREE_CYLINDER;
    }
    if flows.circuit.is_some() && !parameters.electrostatic_feedback {
        caption += DEAF_BALL;
    }
    Ok(Some(Section::new("Energy flow").figure(sankey.render()?, caption)))
}

/// Whether the walls take from the cylinder what they give to the ball: a shaker moves it whatever acts on it.
fn reacts(parameters: &Parameters) -> bool {
    parameters.reaction && parameters.excitation_kind == ExcitationKind::Force
}

fn sankey(flows: &Flows, parameters: &Parameters, names: &Names) -> Sankey {
    let is_felt = parameters.electrostatic_feedback && flows.mechanics.is_some();
    let mut sankey = Sankey::new("Energy flow from the excitation to the load", "mW");
    let electrical = flows.circuit.map_or(0.0, |ledger| mw(ledger.mechanical));
    if let Some(balance) = &flows.mechanics {
        let is_one = reacts(parameters);
        if is_one {
            sankey = sankey.stage(cylinder(balance));
        }
        let ball = ball(balance, is_one);
        sankey = sankey.stage(if is_felt { ball.hands_on(electrical) } else { ball });
    }
    flows.circuit.iter().fold(sankey, |sankey, ledger| {
        let stage = Stage::new("circuit").gets(names.supply, mw(ledger.supply), Kind::Given);
        let stage = if is_felt { stage } else { stage.gets("work of the membranes", electrical, Kind::Given) };
        sankey.stage(spent(stage, ledger, names))
    })
}

/// Milliwatts.
fn mw(watt: f64) -> f64 {
    1e3 * watt
}

fn cylinder(balance: &EnergyBalance) -> Stage {
    Stage::new("cylinder")
        .gets("excitation", mw(balance.excitation), Kind::Given)
        .gives("motion of the cylinder", mw(balance.cylinder_kinetic + balance.suspension), Kind::Stored)
        .gives("damper", mw(balance.damping), Kind::Lost)
        .hands_on(mw(balance.wall))
}

fn ball(balance: &EnergyBalance, is_driven: bool) -> Stage {
    let stage = Stage::new("ball");
    let stage = if is_driven { stage } else { stage.gets("walls of the cylinder", mw(balance.wall), Kind::Given) };
    stage
        .gets("gravity", mw(balance.gravity), Kind::Given)
        .gives("losses of impacts", mw(balance.impact_loss), Kind::Lost)
        .gives("viscous films", mw(balance.viscous), Kind::Lost)
        .gives("friction", mw(balance.friction), Kind::Lost)
        .gives("motion and films", mw(balance.kinetic + balance.elastic), Kind::Stored)
}

fn spent(stage: Stage, ledger: &Ledger, names: &Names) -> Stage {
    let known = [ledger.load, ledger.zener, ledger.diode, ledger.leakage, ledger.stored];
    let told: f64 = known.into_iter().filter(|energy| !energy.is_nan()).sum();
    // A circuit FMU of a user may not tell where the energy went.
    let untold =
        if known.iter().any(|energy| energy.is_nan()) { ledger.supply + ledger.mechanical - told } else { 0.0 };
    stage
        .gives(names.load, mw(ledger.load), Kind::Useful)
        .gives("electric field", mw(ledger.stored), Kind::Stored)
        .gives("Zener diodes", mw(ledger.zener), Kind::Lost)
        .gives(names.diode, mw(ledger.diode), Kind::Lost)
        .gives("leakage of the films", mw(ledger.leakage), Kind::Lost)
        .gives("not told by the circuit", mw(untold), Kind::Lost)
}
