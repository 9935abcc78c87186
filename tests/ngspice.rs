//! ngspice and the embedded solver on the same C(t): two programs that share nothing but the problem.

#![allow(clippy::unwrap_used)]

use videg::cosim::HarvesterFmu;
use videg::fmi::Fmu;
use videg::ngspice::{CapacitanceTable, Elements, Ngspice, Run, Waveforms};
use videg::package::{Options, build_all};
use videg::scenario::Request;
use videg_circuit::{DiodeParameters, Diodes, Parameters};

fn harvester_fmu() -> Fmu {
    let folder = tempfile::tempdir().unwrap();
    let paths = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() }).unwrap();
    Fmu::open(&paths[0]).unwrap()
}

fn table(fmu: &Fmu, case: &str, until: f64, error: f64) -> CapacitanceTable {
    let scenario = Request { case: Some(case.to_owned()), until: Some(until), ..Request::default() }.resolve().unwrap();
    let mut harvester = HarvesterFmu::new(fmu, &scenario, &scenario.settings).unwrap();
    CapacitanceTable::from_harvester(&mut harvester, until, error).unwrap()
}

#[test]
fn the_paper_circuit_moves_the_same_energy_in_both_solvers() {
    let table = table(&harvester_fmu(), "fig14", 2.0, 1e-4);
    let parameters = Parameters { diodes: Diodes::Exponential(DiodeParameters::default()), ..Parameters::default() };
    let embedded = Waveforms::embedded(&parameters, &table).unwrap().ledger();
    let elements = Elements::new(&parameters).unwrap();
    let ngspice = Ngspice::find(None).unwrap().simulate(&elements, &table, &Run::new(2.0)).unwrap().ledger();
    assert!((ngspice.supply / embedded.supply - 1.0).abs() < 3e-4);
    assert!((ngspice.load / embedded.load - 1.0).abs() < 3e-4);
}
