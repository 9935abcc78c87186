//! A machine against the library that it is made of, with random parameters.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use videg_circuit::{Release, Settings, Topology};
use videg_coupled::{TOLERANCE, Times, run};
use videg_explorer::{Machine, Map, Outcome, Reader, Shown};
use videg_model::{Harvester, Parameters};

fn number(outcome: &Outcome, name: &str) -> f64 {
    outcome.values()[Outcome::names().iter().position(|known| known == name).unwrap()]
}

fn column(rows: &[f64], name: &str) -> Vec<f64> {
    let names = Machine::motion_names();
    let at = names.iter().position(|known| known == name).unwrap();
    rows.iter().copied().skip(at).step_by(names.len()).collect()
}

/// The paper's Fig. 14 but for what is given.
fn machine(settings: &[(&str, f64)]) -> Machine {
    let mut machine = Machine::new();
    for (name, value) in settings {
        machine.set(name, *value).unwrap();
    }
    machine
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn a_run_has_the_numbers_of_the_library(
        restitution in 0.1..0.9,
        amplitude in 0.1..2.0,
        frequency in 0.5..5.0,
        (topology, release) in (1..3, 1..3),
        voltage in 2000.0..6000.0,
        load in 7.0..12.0,
    ) {
        let p = Parameters { restitution, amplitude, frequency, ..Parameters::default() };
        let mut circuit = Settings::default();
        circuit.circuit.topology = if topology == 1 { Topology::SharedNode } else { Topology::Isolated };
        circuit.circuit.release = if release == 1 { Release::Zener } else { Release::Switch };
        circuit.circuit.zener_voltage = voltage;
        circuit.circuit.load_resistance = f64::powf(10.0, load);
        let expected = run(&p, &circuit, &Times { until: 8.0, window: [4.0, 8.0], tolerance: TOLERANCE }).unwrap();
        let machine = machine(&[
            ("membrane.restitution", restitution),
            ("excitation.amplitude", amplitude),
            ("excitation.frequency", frequency),
            ("topology", f64::from(topology)),
            ("release", f64::from(release)),
            ("zener.voltage", voltage),
            ("load.resistance", f64::powf(10.0, load)),
        ]);
        let outcome = machine.run(4.0, 8.0).unwrap();
        prop_assert_eq!(number(&outcome, "net_power"), expected.powers.net_power);
        prop_assert_eq!(number(&outcome, "average_voltage_gain"), expected.averages.voltage_gain);
        prop_assert_eq!(number(&outcome, "impacts"), f64::from(expected.averages.impacts));

        // The picture of the motion takes other straight lines, and comes to the same energies.
        let rows = machine.motion(0.0, 8.0, 0.01, 8.0).unwrap();
        let through = number(&outcome, "load.energy").abs() + number(&outcome, "supply.energy").abs();
        for name in ["load.energy", "supply.energy", "mechanical.energy"] {
            let last = *column(&rows, name).last().unwrap();
            prop_assert!((last - number(&outcome, name)).abs() <= 5e-3 * through, "{}: {} of {}", name, last, through);
        }
        let times = column(&rows, "time");
        prop_assert!(times.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] <= 0.01 + 1e-9));
        prop_assert_eq!((times[0], times[times.len() - 1]), (0.0, 8.0));

        // Each impact of the window has a row at its time, with the deflection beginning there.
        let mut harvester = Harvester::new(&p, 0.0).unwrap();
        harvester.advance(8.0).unwrap();
        let impacts = machine.impacts(0.0, 8.0).unwrap();
        prop_assert_eq!(impacts.len() as u64, 3 * harvester.totals().impacts);
        for time in impacts.iter().step_by(3) {
            prop_assert!(times.contains(time), "{}", time);
        }
    }

    #[test]
    fn a_row_of_a_map_is_a_run_for_each_cell(
        restitution in 0.2..0.9,
        by_mechanics in any::<bool>(),
        values in prop::collection::vec(0.3..0.9, 3),
    ) {
        let base = [("membrane.restitution", restitution), ("topology", 2.0), ("release", 2.0)];
        let (x, y) = if by_mechanics { ("membrane.restitution", "zener.voltage") } else { ("load.resistance", "zener.voltage") };
        let xs: Vec<f64> = values.iter().map(|value| if by_mechanics { *value } else { value * 1e10 }).collect();
        let map = Map::new(&machine(&base), x, xs.clone(), y, 2.0, 4.0).unwrap();
        let cells = map.row(2500.0).unwrap();
        for (k, value) in xs.iter().enumerate() {
            let mut one = machine(&base);
            one.set(x, *value).unwrap();
            one.set(y, 2500.0).unwrap();
            let outcome = one.run(2.0, 4.0).unwrap();
            prop_assert_eq!(cells[2 * k], number(&outcome, "net_power"));
            let over = ["area_ratio", "field", "stress", "deflection"].map(|name| number(&outcome, &format!("{name}_over_limit")));
            prop_assert_eq!(cells[2 * k + 1], over.into_iter().fold(0.0, f64::max));
        }
        // A release below the supply is no machine.
        prop_assert_eq!(map.fault(), None);
        prop_assert!(map.row(1000.0).unwrap().iter().all(|value| value.is_nan()));
        prop_assert!(map.fault().unwrap().contains("zener.voltage"));
    }

    #[test]
    fn a_diagram_has_the_impacts_of_the_motion(restitution in 0.35..0.9, periods in 20_u32..60) {
        let machine = machine(&[("membrane.restitution", restitution)]);
        let columns = machine.diagram("membrane.restitution", &[restitution], periods, 10, Shown::Speed).unwrap();
        let from = f64::from(periods) / 2.0;
        let impacts = machine.impacts(0.0, from + 5.0).unwrap();
        let after: Vec<f64> = impacts.chunks(3).filter(|impact| impact[0] > from).map(|impact| impact[2]).take(10).collect();
        prop_assert_eq!(columns[0], after.len() as f64);
        prop_assert_eq!(&columns[1..], &after[..]);
    }
}

#[test]
fn what_is_wrong_is_named_and_nothing_is_lost() {
    let mut machine = Machine::new();
    assert_eq!(machine.set("ball.wait", 1.0).unwrap_err(), "ball.wait: no such variable");
    assert!(machine.set("excitation.seed", 1.5).unwrap_err().contains("1.5 is no whole number"));
    machine.set("membrane.restitution", 1.7).unwrap();
    assert!(machine.run(0.0, 1.0).unwrap_err().contains("membrane.restitution = 1.7"), "{:?}", machine.run(0.0, 1.0));
    machine.set("membrane.restitution", f64::NAN).unwrap();
    assert!(machine.run(0.0, 1.0).unwrap_err().contains("NaN"));
    machine.clear();
    assert!(machine.run(0.0, 1.0).is_ok());
    assert!(machine.run(2.0, 1.0).unwrap_err().contains("window = 2,1 s"));
    assert!(machine.motion(1.0, f64::INFINITY, 0.1, 1.0).unwrap_err().contains("finite"));
    assert!(machine.motion(0.0, 1.0, 0.0, 1.0).unwrap_err().contains("above 0"));
    assert!(machine.motion(0.0, 1.0, 1e-9, 1.0).unwrap_err().contains("too many"));
    assert!(machine.diagram("ball", &[1.0], 1, 1, Shown::Phase).is_err());
    let refused = machine.diagram("membrane.restitution", &[0.5, 7.0], 10, 3, Shown::Phase).unwrap();
    assert_eq!((refused[0], refused[refused.len() - 1]), (3.0, 0.0), "a value out of bounds has an empty column");
    machine.set("contact.electrostaticFeedback", 1.0).unwrap();
    assert!(machine.run(0.0, 1.0).unwrap_err().contains("contact.electrostaticFeedback"));
    machine.clear();
    machine.set("supply.voltage", 3000.0).unwrap();
    machine.set("zener.voltage", 2500.0).unwrap();
    assert!(machine.run(0.0, 1.0).unwrap_err().contains("zener.voltage"));
}

#[test]
fn files_are_taken_and_faults_in_them_are_named_with_their_line() {
    let mut machine = Machine::new();
    let fault = machine.set_recording("time,force\n0,0\n0,1\n").unwrap_err();
    assert!(fault.starts_with("line 3"), "{fault}");
    let fault = machine.set_table("deflection,force\n0,0\n").unwrap_err();
    assert!(fault.contains("at least 3"), "{fault}");
    let before = machine.run(1.0, 2.0).unwrap();
    machine.set_table("deflection,force\n0,0\n1e-3,0.01\n2e-3,0.05\n9e-3,2\n").unwrap();
    assert_eq!(machine.run(1.0, 2.0).unwrap(), before, "the law does not ask for the table");
    machine.set("membrane.law", 2.0).unwrap();
    assert_ne!(machine.run(1.0, 2.0).unwrap(), before);
    machine.set_table("deflection,force,capacitance\n0,0,3e-11\n1e-3,0.01,3.1e-11\n9e-3,2,6e-11\n").unwrap();
    let place = Machine::derived_names().iter().position(|name| name == "restCapacitance").unwrap();
    assert_eq!(machine.derived().unwrap()[place], 3e-11, "as it was measured");
    machine.set_table("").unwrap();
    assert!(machine.run(1.0, 2.0).unwrap_err().contains("membrane.law"));
    machine.clear();
    machine.set_recording("time,force\n0,0\n1,5\n2,0\n").unwrap();
    assert_ne!(machine.run(1.0, 2.0).unwrap(), before);
}

#[test]
fn limits_are_those_at_which_the_library_warns() {
    let machine = machine(&[("topology", 2.0), ("biasVoltage", 9e3), ("zener.voltage", 1e5)]);
    let outcome = machine.run(0.0, 2.0).unwrap();
    let warnings = outcome.warnings();
    assert!(warnings.iter().any(|text| text.starts_with("electric field")), "{warnings:?}");
    assert!(number(&outcome, "field_over_limit") > 1.0);
    let rows = machine.motion(0.0, 2.0, 0.01, 2.0).unwrap();
    let over =
        column(&rows, "left.voltage").iter().zip(column(&rows, "left.limit")).any(|(voltage, limit)| *voltage > limit);
    assert!(over, "the voltage crosses its limit");
    let limit = machine.deflection_limit().unwrap();
    let ratio = |deflection: f64| {
        let harvester = Harvester::new(&Parameters::default(), 0.0).unwrap();
        harvester.membrane().over_limits(deflection, 0.0)[0]
    };
    assert!(ratio(limit * 1.0001) > 1.0 && ratio(limit * 0.9999) < 1.0, "{limit}");
}

#[test]
fn c_of_t_is_exported_with_the_points_of_the_motion() {
    let machine = Machine::new();
    let text = machine.export_capacitances(1.0, Reader::Csv, "a\nb").unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[..2], ["# a b", "time,left.capacitance,right.capacitance"]);
    let last: Vec<f64> = lines[lines.len() - 1].split(',').map(|cell| cell.parse().unwrap()).collect();
    let mut harvester = Harvester::new(&Parameters::default(), 0.0).unwrap();
    harvester.advance(1.0).unwrap();
    let expected = videg_model::Side::BOTH.map(|side| harvester.capacitance(side));
    assert_eq!(last, [1.0, expected[0], expected[1]]);
    for (reader, part) in [(Reader::Ngspice, "V(p,n)'"), (Reader::Ltspice, "*x"), (Reader::Qspice, "Fmirror")] {
        let text = machine.export_capacitances(1.0, reader, "a").unwrap();
        assert!(text.contains(part) && text.contains(".subckt deg_left") && text.contains(".ends deg_right"), "{text}");
    }
}
