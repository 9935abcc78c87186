//! The functions that the libraries of the FMUs export are those of FMI 2.0 and 3.0. Each of them that acts on an instance has its
//! row in the table of legal calls: the tests of the exporter go by these tables, so that they miss none.

#![cfg(target_os = "linux")]

use std::collections::BTreeSet;
use std::path::Path;

use fmu_host::{Function, Functions, Interface};
use fmu_import::{Archive, FUNCTIONS_3};
use object::{Object, ObjectSymbol};

/// Functions that act on no instance.
const WITHOUT_INSTANCE: [&str; 3] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate"];

/// What the library of an FMU for this machine exports.
fn exports(fmu: &Path) -> BTreeSet<String> {
    let name = fmu.file_stem().unwrap().to_str().unwrap();
    let unpacked = Archive::open(fmu).unwrap().unpack().unwrap();
    let bytes = std::fs::read(unpacked.path().join(format!("binaries/linux64/{name}.so"))).unwrap();
    let library = object::File::parse(bytes.as_slice()).unwrap();
    let symbols = library.dynamic_symbols().filter(ObjectSymbol::is_definition);
    symbols.map(|symbol| symbol.name().unwrap().to_owned()).collect()
}

#[test]
fn the_libraries_export_the_functions_of_the_table_and_nothing_else() {
    let fmus = super::archives();
    let exported = [0, 1].map(|k| exports(&fmus[k]));
    let of_3: BTreeSet<_> = FUNCTIONS_3.iter().map(|name| (*name).to_owned()).collect();
    for exported in &exported {
        assert_eq!(exported.iter().filter(|name| name.starts_with("fmi3")).cloned().collect::<BTreeSet<_>>(), of_3);
    }
    let [harvester, circuit] = exported.map(|exported| exported.difference(&of_3).cloned().collect::<BTreeSet<_>>());
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
