//! The functions that the libraries of the FMUs export are those of FMI 2.0, each of which has its row in the table of
//! legal calls: the tests of the exporter go by that table, so that they miss none.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::io::Read;

use fmu_host::{Function, Functions, Interface};
use object::{Object, ObjectSymbol};
use videg::package::{Options, build_all};

/// Functions that act on no instance.
const WITHOUT_INSTANCE: [&str; 3] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate"];

/// What the library of an FMU for this machine exports.
fn exports(fmu: &std::path::Path) -> BTreeSet<String> {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu).unwrap()).unwrap();
    let names: Vec<_> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    let name = names.iter().find(|name| name.starts_with("binaries/") && !name.ends_with('/')).unwrap();
    let mut bytes = Vec::new();
    archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
    let library = object::File::parse(bytes.as_slice()).unwrap();
    let symbols = library.dynamic_symbols().filter(ObjectSymbol::is_definition);
    symbols.map(|symbol| symbol.name().unwrap().to_owned()).collect()
}

#[test]
#[cfg(target_os = "linux")]
fn the_libraries_export_the_functions_of_the_table_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let fmus = build_all(&Options { output: Some(folder.path().to_owned()), ..Options::default() }).unwrap();
    let [harvester, circuit] = [0, 1].map(|k| exports(&fmus[k]));
    let names = |of: &dyn Fn(&Function) -> bool| -> BTreeSet<String> {
        let functions = Function::ALL.iter().filter(|f| of(f)).map(|f| f.name());
        functions.chain(WITHOUT_INSTANCE).map(str::to_owned).collect()
    };
    assert_eq!(harvester, names(&|_| true));
    let co_simulation = names(&|f| f.interface() != Some(Interface::ModelExchange));
    assert_eq!(circuit, co_simulation);
    let called: BTreeSet<_> = Functions::NAMES.iter().map(|name| (*name).to_owned()).collect();
    assert_eq!(called, co_simulation, "the host that errs calls them all");
}
