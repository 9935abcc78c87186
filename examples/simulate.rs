//! Times of the run that `videg.simulate` of the package for Python asks for: 100 s of Fig. 14, a row each 1e-3 s, both capacitances.
//! Prints the shortest of 30 in seconds. `tests/python/speed.py` holds the package against it.

use std::time::Instant;

use fmu_import::Fmu;
use videg::package;
use videg::scenario::Request;
use videg::simulate::{Points, TableOptions, table};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let fmus = package::build_all(&package::Options::default())?;
    let (harvester, scenario) = (Fmu::open(&fmus[0])?, Request::default().resolve()?);
    let columns = ["left.capacitance", "right.capacitance"].map(str::to_owned);
    let options =
        TableOptions { harvester: &harvester, scenario: &scenario, points: Points::Sample(1e-3), columns: &columns };
    let mut shortest = f64::INFINITY;
    for _ in 0..30 {
        let started = Instant::now();
        let found = table(&options, &())?;
        shortest = shortest.min(started.elapsed().as_secs_f64());
        assert_eq!(found.rows(), 100_001);
    }
    println!("{shortest}");
    Ok(())
}
