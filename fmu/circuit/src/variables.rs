//! The variable table: each name, unit and description stands here once, those of the parameters in the table of the
//! circuit.

use fmu_export::{EnumerationItem, EnumerationType, Variable, concat};
use videg_circuit::{Circuit, Settings, names};

use crate::slave::{Harvesting, REST_CAPACITANCE};

type V = Variable<Harvesting>;

/// Real parameter number `INDEX` of the circuit's table.
const fn quantity<const INDEX: usize>() -> V {
    let quantity = &Settings::QUANTITIES[INDEX];
    let mut row = V::parameter(quantity.name, quantity.unit, quantity.start, quantity.description).min(quantity.min);
    if quantity.max == f64::INFINITY {
        row = row.infinity_allowed();
    } else {
        row = row.max(quantity.max);
    }
    row.access(
        |slave| (Settings::QUANTITIES[INDEX].get)(&slave.settings),
        |slave, value| (Settings::QUANTITIES[INDEX].set)(&mut slave.settings, value),
    )
}

/// The items of choice number `INDEX`, all of them: a `COUNT` that is not theirs does not compile.
const fn items<const INDEX: usize, const COUNT: usize>() -> [EnumerationItem; COUNT] {
    let items = Settings::CHOICES[INDEX].items;
    assert!(items.len() == COUNT);
    let mut found = [EnumerationItem::new("", ""); COUNT];
    let mut k = 0;
    while k < COUNT {
        found[k] = EnumerationItem::new(items[k].0, items[k].1);
        k += 1;
    }
    found
}

const fn enumeration<const INDEX: usize>(name: &'static str, items: &'static [EnumerationItem]) -> EnumerationType {
    EnumerationType::new(name, Settings::CHOICES[INDEX].description, items)
}

static TOPOLOGY_ITEMS: [EnumerationItem; 2] = items::<0, 2>();
static RELEASE_ITEMS: [EnumerationItem; 3] = items::<1, 3>();
static DIODE_ITEMS: [EnumerationItem; 2] = items::<2, 2>();
static TOPOLOGY: EnumerationType = enumeration::<0>("Topology", &TOPOLOGY_ITEMS);
static RELEASE: EnumerationType = enumeration::<1>("Release", &RELEASE_ITEMS);
static DIODE_MODEL: EnumerationType = enumeration::<2>("DiodeModel", &DIODE_ITEMS);

/// Choice number `INDEX` of the circuit's table. FMI counts items from 1, the table from 0.
const fn choice<const INDEX: usize>(of: &'static EnumerationType) -> V {
    let choice = &Settings::CHOICES[INDEX];
    #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, clippy::cast_sign_loss)] // numbers of items
    V::enumeration_parameter(choice.name, of, 1, choice.description).access(
        |slave| (Settings::CHOICES[INDEX].get)(&slave.settings) as i32 + 1,
        |slave, item| (Settings::CHOICES[INDEX].set)(&mut slave.settings, item as usize - 1),
    )
}

macro_rules! quantities {
    ($($index:literal)*) => { [$(quantity::<$index>()),*] };
}

static QUANTITIES: [V; Settings::QUANTITIES.len()] = quantities!(0 1 2 3 4 5 6 7 8 9 10);

static CHOICES: [V; Settings::CHOICES.len()] =
    [choice::<0>(&TOPOLOGY), choice::<1>(&RELEASE), choice::<2>(&DIODE_MODEL)];

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

/// The outputs, with what their initial values depend on. The membranes hold charge, so no output depends on an input of the
/// same communication point, nor does an initial value.
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
    "supply.current", "A", "Current drawn from the supply", &[], Circuit::supply_current;
    "supply.energy", "J", "Energy drawn from the supply since the start", &[], |c| c.ledger().supply;
    "load.energy", "J", "Energy given to the load or the storage since the start", &[], |c| c.ledger().load;
    "zener.energy", "J", "Energy burnt in the Zener diodes since the start", &[], |c| c.ledger().zener;
    "diode.energy", "J", "Energy burnt in the charging diodes and those into a storage since the start", &[], |c| c.ledger().diode;
    "stored.energy", "J", "Change of the energy stored in the membranes since the start", &[], |c| c.ledger().stored;
    "converted.energy", "J", "Energy that the mechanics gave: load + Zener + diode + stored - supply", &[], |c| c.ledger().converted();
    "mechanical.energy", "J", "The same, as the work -1/2 U^2 dC on the capacitances: an independent sum", &[], |c| c.ledger().mechanical;
    "supply.charge", "C", "Charge drawn from the supply since the start", &[], |c| c.ledger().supply_charge;
    "load.charge", "C", "Charge through the load or into the storage since the start", &[], |c| c.ledger().load_charge;
};

/// Number of variables.
const COUNT: usize = QUANTITIES.len() + CHOICES.len() + INPUTS.len() + OUTPUTS.len();

/// The whole table; the value reference of a variable is its index.
pub static VARIABLES: [V; COUNT] = concat(&[&QUANTITIES, &CHOICES, &INPUTS, &OUTPUTS]);

#[cfg(test)]
mod tests {
    use super::*;
    use fmu_export::Kind;

    /// The compiler makes the rows of the table; here one is made again, where it can be looked at as it is made.
    #[test]
    fn a_parameter_has_name_unit_start_and_bounds_of_the_table_of_the_circuit() {
        let mut infinite = 0;
        for (row, quantity) in quantities!(0 1 2 3 4 5 6 7 8 9 10).iter().zip(Settings::QUANTITIES) {
            assert_eq!((row.name(), row.description()), (quantity.name, quantity.description));
            let Kind::Real(real) = row.kind() else { panic!("{} is no Real", row.name()) };
            assert_eq!((real.unit, real.start), (quantity.unit, Some(quantity.start)), "{}", row.name());
            assert_eq!((real.min, real.max), (quantity.min, quantity.max), "{}", row.name());
            assert_eq!(real.infinity_allowed, quantity.max == f64::INFINITY, "{}", row.name());
            infinite += usize::from(real.infinity_allowed);
        }
        assert!(infinite > 0 && infinite < Settings::QUANTITIES.len(), "{infinite} parameters may be infinite");
    }

    #[test]
    fn a_choice_has_the_items_of_the_table_of_the_circuit() {
        let items: [EnumerationItem; 3] = items::<1, 3>();
        let wanted = Settings::CHOICES[1].items;
        assert!(items.iter().map(|item| (item.name, item.description)).eq(wanted.iter().copied()), "{items:?}");
        let of = enumeration::<1>("Release", &RELEASE_ITEMS);
        assert_eq!(of, RELEASE);
        let row = choice::<1>(&RELEASE);
        assert_eq!((row.name(), row.description()), (Settings::CHOICES[1].name, Settings::CHOICES[1].description));
    }

    #[test]
    #[should_panic(expected = "items.len() == COUNT")]
    fn a_count_of_items_that_is_not_theirs_is_refused() {
        let _ = items::<1, 2>();
    }
}
