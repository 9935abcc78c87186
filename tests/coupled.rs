//! A coupled run without communication steps: against co-simulation in small steps, against closed forms, and in itself.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use videg::cosim::{self, CircuitSlave, Coupling, EmbeddedCircuit, HarvesterFmu, Master};
use videg::coupled::{self, CoupledError, TOLERANCE, Times};
use videg::scenario::{Request, Setting};
use videg_circuit::{Release, Settings, Topology};
use videg_model::{Case, ContactLaw, Parameters};

fn times(until: f64, tolerance: f64) -> Times {
    Times { until, window: [0.5 * until, until], tolerance }
}

fn circuit(topology: Topology, release: Release, voltage: f64, load: f64) -> Settings {
    let mut settings = Settings::default();
    settings.circuit.topology = topology;
    settings.circuit.release = release;
    settings.circuit.zener_voltage = voltage;
    settings.circuit.storage_voltage = voltage;
    settings.circuit.load_resistance = load;
    settings
}

fn case(name: &str) -> Parameters {
    (Case::find(name).unwrap().parameters)()
}

/// The same by the master, in steps that keep C(t) within `tolerance`.
fn by_master(case: &str, settings: &[Setting], circuit: &Settings, until: f64, tolerance: f64) -> cosim::Outcome {
    let fmu = fmu_import::Fmu::open(fmu_path()).unwrap();
    let request = Request {
        case: Some(case.to_owned()),
        settings: settings.to_vec(),
        until: Some(until),
        window: Some([0.5 * until, until]),
        ..Request::default()
    };
    let scenario = request.resolve().unwrap();
    let harvester = HarvesterFmu::new(&fmu, &scenario, &scenario.settings).unwrap();
    let rest = harvester.sample().unwrap().capacitance();
    let slave: Box<dyn CircuitSlave> = Box::new(EmbeddedCircuit::new("embedded", circuit, rest).unwrap());
    let coupling = Coupling { tolerance: Some(tolerance), ..Coupling::default() };
    Master::new(harvester, vec![slave], &scenario, coupling).unwrap().run(&mut []).unwrap()
}

fn fmu_path() -> std::path::PathBuf {
    static BUILT: std::sync::LazyLock<std::path::PathBuf> = std::sync::LazyLock::new(|| {
        let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("coupled");
        let arguments = ["fmu", "build", "--output"];
        let built = std::process::Command::new(env!("CARGO_BIN_EXE_videg")).args(arguments).arg(&folder).output();
        assert!(built.unwrap().status.success());
        folder.join("VibroImpactHarvester.fmu")
    });
    BUILT.clone()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn the_energies_are_those_of_co_simulation_in_small_steps(
        restitution in 0.2..0.95_f64,
        isolated in prop::bool::ANY,
        release in prop_oneof![Just(Release::Zener), Just(Release::Switch), Just(Release::Storage)],
        voltage in 2050.0..2800.0_f64,
        load in 8.0..11.0_f64,
        leakage in prop_oneof![Just(0.0), 1.0..100.0_f64],
        compliant in prop::bool::ANY,
    ) {
        let topology = if isolated { Topology::Isolated } else { Topology::SharedNode };
        let mut circuit = circuit(topology, release, voltage, 10.0_f64.powf(load));
        circuit.circuit.leakage_time_constant = leakage;
        let law = if compliant { ContactLaw::Compliant } else { ContactLaw::Impulsive };
        let p = Parameters { restitution, contact_law: law, ..case("fig14") };
        let fast = coupled::run(&p, &circuit, &times(8.0, 1e-5)).unwrap();
        let settings = [
            Setting::new("membrane.restitution", format!("{restitution:?}")),
            Setting::new("contact.law", if compliant { "compliant" } else { "impulsive" }),
        ];
        let slow = by_master("fig14", &settings, &circuit, 8.0, 1e-5);
        prop_assert_eq!(fast.averages.impacts, slow.mechanics.impacts - before(&p));
        let (found, expected) = (fast.circuit.ledger, slow.circuits[0].ledger);
        let scale = expected.supply.abs() + expected.load.abs() + expected.mechanical.abs();
        for (what, found, expected) in [
            ("supply", found.supply, expected.supply),
            ("load", found.load, expected.load),
            ("zener", found.zener, expected.zener),
            ("leakage", found.leakage, expected.leakage),
            ("mechanical", found.mechanical, expected.mechanical),
        ] {
            prop_assert!((found - expected).abs() < 1e-4 * scale, "{what}: {found:e} against {expected:e}");
        }
        prop_assert!((fast.powers.net_power - slow.powers[0].net_power).abs() < 1e-4 * scale / 4.0);
        prop_assert!((found.converted() - found.mechanical).abs() < 1e-9 * scale);
    }
}

/// Impacts before the window of 4 to 8 s.
fn before(p: &Parameters) -> i32 {
    let mut harvester = videg_model::Harvester::new(p, 0.0).unwrap();
    harvester.advance(4.0).unwrap();
    i32::try_from(harvester.totals().impacts).unwrap()
}

#[test]
fn finer_lines_converge_with_the_square_of_their_number() {
    let circuit = circuit(Topology::Isolated, Release::Switch, 2450.0, 1e9);
    let power = |tolerance| coupled::run(&case("fig14"), &circuit, &times(20.0, tolerance)).unwrap();
    let exact = power(1e-8).powers.net_power;
    let errors = [1e-2, 1e-3, 1e-4, 1e-5].map(|tolerance| (power(tolerance).powers.net_power / exact - 1.0).abs());
    // The bound goes with the square of the distance of the knots, and so does the error.
    for (error, tolerance) in errors.iter().zip([1e-2, 1e-3, 1e-4, 1e-5]) {
        assert!(*error < tolerance, "{errors:?}");
    }
    assert!(power(TOLERANCE).lines < power(1e-5).lines / 5);
}

#[test]
fn any_law_noise_and_mount_runs_and_keeps_its_books() {
    let circuit = circuit(Topology::Isolated, Release::Switch, 2450.0, 1e9);
    let base = case("fig14");
    for (what, p) in [
        ("noise", Parameters { phase_noise: 4.0, ..base }),
        ("chatter", Parameters { restitution: 0.3, amplitude: 0.2, ..base }),
        ("inclined", case("capsule-1-1")),
        ("friction", Parameters { friction: 0.05, ..base }),
        ("suspended", Parameters { suspension_stiffness: 5.0, suspension_damping: 0.02, ..base }),
        ("compliant", Parameters { contact_law: ContactLaw::Compliant, ..base }),
    ] {
        let Times { until, window, .. } = times(20.0, TOLERANCE);
        let results = coupled::run(&p, &circuit, &Times { until, window, tolerance: TOLERANCE }).unwrap();
        let ledger = results.circuit.ledger;
        let scale = ledger.supply.abs() + ledger.mechanical.abs();
        assert!((ledger.converted() - ledger.mechanical).abs() < 1e-9 * scale, "{what}: {ledger:?}");
        let mut alone = videg_model::Harvester::new(&p, 0.0).unwrap();
        alone.advance(until).unwrap();
        assert!(results.averages.impacts > 0 && alone.totals().impacts > 0, "{what}");
    }
}

#[test]
fn what_cannot_run_says_why() {
    let good = circuit(Topology::Isolated, Release::Switch, 2450.0, 1e9);
    let feedback =
        Parameters { contact_law: ContactLaw::Compliant, electrostatic_feedback: true, ..Parameters::default() };
    let refused = coupled::run(&feedback, &good, &times(1.0, TOLERANCE)).unwrap_err();
    assert!(matches!(refused, CoupledError::Feedback), "{refused}");
    let low = circuit(Topology::Isolated, Release::Switch, 1000.0, 1e9);
    let refused = coupled::run(&Parameters::default(), &low, &times(1.0, TOLERANCE)).unwrap_err();
    assert!(refused.to_string().contains("zener.voltage = 1000"), "{refused}");
    let heavy = Parameters { ball_mass: f64::NAN, ..Parameters::default() };
    let refused = coupled::run(&heavy, &good, &times(1.0, TOLERANCE)).unwrap_err();
    assert!(refused.to_string().contains("ball.mass"), "{refused}");
}
