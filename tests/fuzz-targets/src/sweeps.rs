//! What several targets do with settings and sweeps, as the command line does it.

use std::sync::LazyLock;

use fmu_import::{ModelDescription, Value};
use videg::cosim::EmbeddedCircuit;
use videg::scenario::{self, Setting};
use videg::sweep::{self, Request, Sweep, SweepError, SweepFile, Times};
use videg_circuit::Settings;

/// What the harvester says of itself.
pub(crate) static HARVESTER: LazyLock<ModelDescription> =
    LazyLock::new(|| sweep::harvester_description().unwrap_or_else(|error| panic!("{error}")));

/// Gives a setting to the harvester and to a circuit, whoever has such a variable. A value that is taken stays the same
/// when it is written and read again.
pub(crate) fn apply(setting: &Setting) {
    if let Ok(variable) = HARVESTER.variable(&setting.name)
        && let Ok(value) = Value::parse(&HARVESTER, variable, &setting.value)
    {
        assert_eq!(Value::parse(&HARVESTER, variable, &value.to_string()), Ok(value), "{setting:?}");
    }
    let _ = EmbeddedCircuit::apply(&mut Settings::default(), setting);
}

/// The sweep of the harvester that a file asks for.
pub(crate) fn resolve(file: SweepFile, settings: Vec<Setting>) -> Result<Sweep, SweepError> {
    let SweepFile { case, sampling, record, vary } = file;
    let (name, step) = (case.name.clone().unwrap_or_default(), case.step);
    let scenario = scenario::Request { file: Some(case), settings, ..scenario::Request::default() }.resolve()?;
    let is_own = |setting: &Setting| HARVESTER.variables.iter().any(|variable| variable.name == setting.name);
    let settings = scenario.settings.into_iter().filter(is_own).collect();
    let times = Times { until: scenario.until, step, window: scenario.window };
    Sweep::new(&Request { vary, sampling, record, ..Request::new(name, &HARVESTER, settings, times) })
}

/// That a sweep has as many runs as it says, each with values of the right types, and a document that can be read.
pub(crate) fn check(sweep: &Sweep) {
    assert_eq!(sweep.points().checked_mul(sweep.samples()), Some(sweep.runs()));
    let last = sweep.runs().checked_sub(1).unwrap_or_else(|| panic!("a sweep without runs"));
    for number in [0, 1, last / 2, last - last.min(1), last].map(|number| number.min(last)) {
        for (name, value) in sweep.given(number) {
            let variable = HARVESTER.variable(name).unwrap();
            assert_eq!(value.type_name(), variable.kind.name(), "{name} in run {number}");
            assert!(!matches!(value, Value::Real(real) if real.is_nan()), "{name} in run {number}");
        }
    }
    let document: serde_json::Value = serde_json::from_str(sweep.document()).unwrap();
    assert_eq!(document["runs"], sweep.runs());
    assert_eq!(document["columns"].as_array().map(Vec::len), Some(sweep.columns().len()));
}

/// Rows of results, as programs that know CSV see them.
pub(crate) fn rows(results: &[u8]) -> usize {
    csv::Reader::from_reader(results).into_byte_records().collect::<Result<Vec<_>, _>>().unwrap().len()
}
