//! A folder that needs ngspice only: netlists, tables, scripts that sum up, expected values.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use videg_circuit::{Release, Settings, Topology};

use super::capacitor::{CLOSED_FORMS, ClosedForm, GrowingCapacitor};
use super::compare::ComparedCircuit;
use super::error::FileError;
use super::run::Crosscheck;
use super::solver::Solver;
use crate::ngspice::{CapacitanceSource, CapacitanceTable, Elements, Netlist, Ngspice, NgspiceError, Run};
use crate::ngspice::{NETLIST_FILE, RAW_FILE, TABLE_FILE};
use videg_system::atomic_file;

/// First line of the page, which tells a folder made here from any other.
const MARK: &str = "Made by: videg crosscheck --export";
/// The page.
const PAGE: &str = "README.txt";
/// The script that sums up a result.
const EVALUATION: &str = "evaluate.cir";

/// An expected value.
struct Expected {
    /// Name, as the script prints it.
    name: &'static str,
    value: f64,
    unit: &'static str,
    source: String,
}

/// One netlist with all that belongs to it, in a folder of its own.
struct Item<'a> {
    folder: String,
    about: String,
    netlist: Netlist,
    table: &'a CapacitanceTable,
    script: String,
    expected: Vec<Expected>,
}

impl<'a> Item<'a> {
    fn circuit(folder: String, compared: &ComparedCircuit, table: &'a CapacitanceTable) -> Result<Self, NgspiceError> {
        let settings = Settings { exponential: true, ..compared.settings };
        let elements = Elements::new(&settings.parameters(), table.growth())?;
        let run = Run::new(table.until(), table.growth());
        let netlist = elements.netlist(CapacitanceSource::Table, table.initial(), &run)?;
        let about = format!("{}, load {:e} ohm", compared.label, settings.circuit.load_resistance);
        let (ngspice, embedded) = (&compared.ngspice, &compared.embedded);
        let expected = [
            ("supply_charge", ngspice.charge.supply, embedded.charge.supply, "C"),
            ("supply_energy", ngspice.energy.supply, embedded.energy.supply, "J"),
            ("load_charge", ngspice.charge.load, embedded.charge.load, "C"),
            ("load_energy", ngspice.energy.load, embedded.energy.load, "J"),
        ];
        let expected = expected.map(|(name, value, embedded, unit)| {
            let source = format!("this ngspice in batch; {} {embedded:.9e}", Solver::Exponential.name());
            Expected { name, value, unit, source }
        });
        Ok(Self { folder, about, netlist, table, script: circuit_script(&settings), expected: expected.into() })
    }

    fn capacitor(capacitor: &'a GrowingCapacitor, form: &ClosedForm) -> Result<Self, NgspiceError> {
        let [name, unit] = form.quantity;
        let source = format!("closed form {}", form.formula);
        Ok(Self {
            folder: form.folder.to_owned(),
            about: form.about.to_owned(),
            netlist: form.test.netlist(capacitor.voltage(), capacitor.table.initial(), &capacitor.run)?,
            table: &capacitor.table,
            script: script(form.sums, name),
            expected: vec![Expected { name, value: capacitor.expected(form), unit, source }],
        })
    }
}

/// Writes the circuits of `found` and the tests of the capacitor into `folder`, each into a folder of its own, and a page that
/// describes them. Nothing that is not of an earlier export is overwritten, and no link is followed.
///
/// # Errors
/// Another file of these names; a file that cannot be written.
pub fn write(folder: &Path, found: &Crosscheck) -> Result<Vec<PathBuf>, FileError> {
    let mut items = Vec::new();
    for (index, compared) in found.compared.iter().enumerate() {
        let name = if index == 0 { "circuit".to_owned() } else { format!("comparison_{index}") };
        items.push(Item::circuit(name, compared, &found.mechanics.table)?);
    }
    let capacitor = GrowingCapacitor::new(found.settings.circuit.supply_voltage, &found.mechanics)?;
    for form in &CLOSED_FORMS {
        items.push(Item::capacitor(&capacitor, form)?);
    }
    let page = folder.join(PAGE);
    let names = [NETLIST_FILE, TABLE_FILE, EVALUATION];
    let paths = items.iter().flat_map(|item| names.map(|name| folder.join(&item.folder).join(name)));
    let files: Vec<_> = std::iter::once(page.clone()).chain(paths).collect();
    refuse_foreign(&page, &files)?;
    for item in &items {
        let folder = folder.join(&item.folder);
        std::fs::create_dir_all(&folder).map_err(FileError::write(&folder))?;
        Ngspice::export(&folder, &item.netlist, item.table)?;
        let path = folder.join(EVALUATION);
        atomic_file::write(&path, &item.script).map_err(FileError::write(&path))?;
    }
    let scenario = &found.scenario;
    let title = format!("{}: {}, 0 to {} s", scenario.name, scenario.description, scenario.until);
    atomic_file::write(&page, page_text(&title, &items)).map_err(FileError::write(&page))?;
    Ok(files)
}

/// The script that sums up a circuit's result by the trapezoidal rule, as ngspice integrates charges.
fn circuit_script(settings: &Settings) -> String {
    let switch = settings.circuit.release == Release::Switch;
    let (supply, load, power) = match settings.circuit.topology {
        Topology::SharedNode => ("i(vs)", "i(vr)", if switch { "v(de)*i(vr)" } else { "v(out)*i(vr)" }),
        Topology::Isolated => (
            "(i(vsl)+i(vsr))",
            "(i(vrl)+i(vrr))",
            if switch { "(v(left)*i(vrl)+v(right)*i(vrr))" } else { "v(out)*(i(vrl)+i(vrr))" },
        ),
    };
    let voltage = settings.circuit.supply_voltage;
    let sums = format!(
        "let supply_sum = integ({supply})\nlet load_sum = integ({load})\nlet load_work = integ({power})\n\
         let supply_charge = supply_sum[last]\nlet supply_energy = {voltage:e} * supply_sum[last]\n\
         let load_charge = load_sum[last]\nlet load_energy = load_work[last]"
    );
    script(&sums, "supply_charge supply_energy load_charge load_energy")
}

fn script(sums: &str, printed: &str) -> String {
    let raw = RAW_FILE;
    format!(
        "* videg: sums up {raw}; charges in C, energies in J, voltages in V\n.control\nload {raw}\n\
         let last = length(time) - 1\n{sums}\nset numdgt=9\nprint {printed}\nquit\n.endc\n.end\n"
    )
}

/// Checks that the folder does not exist, or that its page, if there is one, is of an earlier export.
pub fn check(folder: &Path) -> Result<(), FileError> {
    if folder.exists() && !folder.is_dir() {
        return Err(FileError::Foreign(folder.to_owned()));
    }
    refuse_foreign(&folder.join(PAGE), &[folder.join(PAGE)])
}

fn refuse_foreign(page: &Path, files: &[PathBuf]) -> Result<(), FileError> {
    let kind = |path: &Path| std::fs::symlink_metadata(path).map(|metadata| metadata.file_type());
    let regular = |path: &Path| kind(path).is_ok_and(|kind| kind.is_file());
    let ours = regular(page) && std::fs::read_to_string(page).is_ok_and(|text| text.starts_with(MARK));
    for parent in files.iter().filter_map(|file| file.parent()).filter(|parent| Some(*parent) != page.parent()) {
        if kind(parent).is_ok_and(|kind| !kind.is_dir()) {
            return Err(FileError::Foreign(parent.to_owned()));
        }
    }
    for file in files.iter().flat_map(|file| [file.clone(), atomic_file::partial(file)]) {
        let free = kind(&file).is_err();
        if !(free || ours && regular(&file)) {
            return Err(FileError::Foreign(file));
        }
    }
    Ok(())
}

fn page_text(title: &str, items: &[Item<'_>]) -> String {
    // A name may hold anything; it stays on its line.
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let [netlist, raw] = [NETLIST_FILE, RAW_FILE];
    let mut text = format!(
        "{MARK}\n\n{title}\n\nEach folder holds a circuit for ngspice (with its XSPICE code models, as Debian's package \
         has them): the\nnetlist {netlist}, C(t) in {TABLE_FILE} (time in s, capacitances of the left and the right membrane in \
         pF),\nand {EVALUATION}, which sums up the result. In such a folder\n\n    ngspice -n -b {netlist}\n    ngspice -n -b \
         {EVALUATION}\n\nleaves the waveforms in {raw} and prints the values that stand here: to some 1e-4, as the script sums\ncurrents by \
         the trapezoidal rule alone; to 3e-4 or better with another version of ngspice; the closed forms as far as the\n\
         crosscheck says.\n"
    );
    for item in items {
        let _ = write!(text, "\n{}/: {}\n", item.folder, item.about);
        for value in &item.expected {
            let _ =
                writeln!(text, "    {:<16} = {:>16.9e} {:<2} {}", value.name, value.value, value.unit, value.source);
        }
    }
    text
}
