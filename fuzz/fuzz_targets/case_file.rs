//! A case file, and the same bytes as what stands behind `--set`.
#![no_main]

use std::sync::LazyLock;

use videg::fmi::{ModelDescription, Value};
use videg::scenario::{CaseFile, Request, Setting};

static DESCRIPTION: LazyLock<ModelDescription> = LazyLock::new(|| {
    let document = include_bytes!("../../modelDescription/VibroImpactHarvester.xml");
    ModelDescription::parse(document, "VibroImpactHarvester").unwrap_or_else(|error| panic!("{error}"))
});

/// Reads a setting as an instance of the harvester does.
fn read(setting: &Setting) {
    if let Ok(variable) = DESCRIPTION.variable(&setting.name) {
        let _ = Value::parse(&DESCRIPTION, variable, &setting.value);
    }
}

libfuzzer_sys::fuzz_target!(|text: &str| {
    let set: Vec<_> = text.lines().filter_map(|line| Setting::parse(line).ok()).collect();
    set.iter().for_each(read);
    let Ok(file) = CaseFile::parse(text) else { return };
    let Ok(scenario) = (Request { file: Some(file), settings: set, ..Request::default() }).resolve() else { return };
    let [from, to] = scenario.window;
    assert!(0.0 <= from && from < to && to <= scenario.until && scenario.step > 0.0, "{scenario:?}");
    scenario.settings.iter().for_each(read);
});
