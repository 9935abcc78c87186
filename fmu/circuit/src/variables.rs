//! The variable table: each name, unit and description stands here once, those of the parameters in the table of the
//! circuit.

use fmu_export::{EnumerationType, Variable, concat};
use videg_circuit::{Choice, Circuit, Quantity, Settings, names};

use crate::harvesting::{Harvesting, REST_CAPACITANCE};

type V = Variable<Harvesting>;

impl AsRef<Settings> for Harvesting {
    fn as_ref(&self) -> &Settings {
        &self.settings
    }
}

impl AsMut<Settings> for Harvesting {
    fn as_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }
}

const fn real(of: &Quantity<Harvesting>) -> V {
    let row = V::parameter(of.name, of.unit, of.start, of.description).min(of.min);
    let row = if of.max == f64::INFINITY { row.infinity_allowed() } else { row.max(of.max) };
    row.access(of.get, of.set)
}

const fn real_rows<const N: usize>(table: &[Quantity<Harvesting>]) -> [V; N] {
    let mut rows = [real(&table[0]); N];
    let mut k = 1;
    while k < N {
        rows[k] = real(&table[k]);
        k += 1;
    }
    rows
}

const fn enumeration(name: &'static str, of: &Choice<Harvesting>) -> EnumerationType {
    EnumerationType { name, description: of.description, items: of.items }
}

const fn choice(of: &Choice<Harvesting>, items: &'static EnumerationType) -> V {
    V::enumeration_parameter(of.name, items, 1, of.description).access(of.get, of.set)
}

static TOPOLOGY: EnumerationType = enumeration("Topology", &Choice::TOPOLOGY);
static RELEASE: EnumerationType = enumeration("Release", &Choice::RELEASE);
static DIODE_MODEL: EnumerationType = enumeration("DiodeModel", &Choice::DIODE_MODEL);

static QUANTITIES: [V; Settings::QUANTITIES.len()] = real_rows(Quantity::TABLE);

/// Those before the leakage came, which have their value references; it and its energy come last.
static FIRST: (&[V], &[V]) = QUANTITIES.split_at(11);

static CHOICES: [V; Settings::CHOICES.len()] = [
    choice(&Choice::TOPOLOGY, &TOPOLOGY),
    choice(&Choice::RELEASE, &RELEASE),
    choice(&Choice::DIODE_MODEL, &DIODE_MODEL),
];

macro_rules! capacitance {
    ($index:literal, $name:expr, $side:literal) => {
        V::input($name, "F", REST_CAPACITANCE, concat!("C: capacitance of the ", $side, " membrane, Eq. (1); with its first derivative set it runs from this value over the step, without from the value before to this one; 0 means that nothing has been handed over yet, and the capacitance stays"))
            .min(0.0)
            .nominal(1e-11)
            .input_derivatives(1, |slave, _order, rate| slave.rate[$index] = Some(rate))
            .access(|slave| slave.capacitance[$index], |slave, value| slave.capacitance[$index] = value)
    };
}

static INPUTS: [V; 2] =
    [capacitance!(0, names::LEFT_CAPACITANCE, "left"), capacitance!(1, names::RIGHT_CAPACITANCE, "right")];

/// The membranes are charged by the supply.
const SUPPLY: &[&str] = &[names::SUPPLY_VOLTAGE];

/// A storage has its voltage; a load has none before the first charge comes.
const STORAGE: &[&str] = &["release", names::STORAGE_VOLTAGE];

/// The supply gives what leaks at rest.
const LEAK: &[&str] = &[names::LEAKAGE_TIME_CONSTANT, names::LEFT_CAPACITANCE, names::RIGHT_CAPACITANCE];

/// The outputs, with what their initial values depend on. The membranes hold charge, so no output depends on an input of the
/// same communication point.
macro_rules! outputs {
    ($($name:expr, $unit:literal, $description:literal, $initially:expr, $get:expr;)*) => {
        [$(V::output($name, $unit, $description)
            .depends_on(&[])
            .initially_depends_on($initially)
            .get(|slave| slave.read($get))),*]
    };
}

static OUTPUTS: [V; 14] = outputs! {
    names::LEFT_VOLTAGE, "V", "U_DE: voltage of the left membrane, Table 1", &[SUPPLY], |c| c.voltage()[0];
    names::RIGHT_VOLTAGE, "V", "U_DE: voltage of the right membrane, Table 1", &[SUPPLY], |c| c.voltage()[1];
    "load.voltage", "V", "U_out: voltage across the load or of the storage, Fig. 8", &[STORAGE], Circuit::load_voltage;
    "load.current", "A", "Current through the load or into the storage", &[], Circuit::load_current;
    "supply.current", "A", "Current drawn from the supply", &[SUPPLY, LEAK], Circuit::supply_current;
    "supply.energy", "J", "Energy drawn from the supply since the start", &[], |c| c.ledger().supply;
    "load.energy", "J", "Energy given to the load or the storage since the start", &[], |c| c.ledger().load;
    "zener.energy", "J", "Energy burnt in the Zener diodes since the start", &[], |c| c.ledger().zener;
    "diode.energy", "J", "Energy burnt in the charging diodes and those into a storage since the start", &[], |c| c.ledger().diode;
    "stored.energy", "J", "Change of the energy stored in the membranes since the start", &[], |c| c.ledger().stored;
    "converted.energy", "J", "Energy that the mechanics gave: load + Zener + diode + leakage + stored - supply", &[], |c| c.ledger().converted();
    "mechanical.energy", "J", "The same, as the work -1/2 U^2 dC on the capacitances: an independent sum", &[], |c| c.ledger().mechanical;
    "supply.charge", "C", "Charge drawn from the supply since the start", &[], |c| c.ledger().supply_charge;
    "load.charge", "C", "Charge through the load or into the storage since the start", &[], |c| c.ledger().load_charge;
};

static LEAKAGE: [V; 1] = outputs! {
    "leakage.energy", "J", "Energy burnt by leakage through the films of the membranes since the start", &[], |c| c.ledger().leakage;
};

/// Number of variables.
const COUNT: usize = QUANTITIES.len() + CHOICES.len() + INPUTS.len() + OUTPUTS.len() + LEAKAGE.len();

/// The table; the value reference of a variable is its index.
pub static VARIABLES: [V; COUNT] = concat(&[FIRST.0, &CHOICES, &INPUTS, &OUTPUTS, FIRST.1, &LEAKAGE]);
