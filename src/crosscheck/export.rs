//! A folder for somebody who has ngspice and nothing else: netlists, tables, scripts that sum up, expected values.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use thiserror::Error;
use videg_circuit::{Release, Settings, Topology};

use crate::ngspice::{
    CapacitanceSource, CapacitanceTable, Check, Elements, FileName, Netlist, Ngspice, NgspiceError, Run,
};
use videg_system::atomic_file;

/// First line of the page that tells a folder made here from any other.
const MARK: &str = "Made by: videg crosscheck --export";
/// The page.
const PAGE: &str = "README.txt";
/// The script that sums up a result.
const EVALUATION: &str = "evaluate.cir";

/// Why the folder cannot be written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// Something of that name is there.
    #[error("--export: {} is there already and is not of an earlier export; name another folder", .0.display())]
    Foreign(PathBuf),
    /// It cannot be written.
    #[error("cannot write {}: {cause}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A netlist cannot be made.
    #[error(transparent)]
    Ngspice(#[from] NgspiceError),
}

/// A value to expect, and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Name, as the script prints it.
    pub name: &'static str,
    /// The value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Where it comes from.
    pub source: String,
}

/// One netlist with all that belongs to it, in a folder of its own.
#[derive(Debug, Clone)]
pub struct Item {
    folder: String,
    about: String,
    netlist: Netlist,
    table: CapacitanceTable,
    script: String,
    expected: Vec<Expected>,
}

impl Item {
    /// A circuit over `table`. `folder` is one of the names that the harness gives.
    ///
    /// # Errors
    /// A circuit that ngspice cannot have.
    pub fn circuit(
        folder: String,
        about: String,
        settings: &Settings,
        table: &CapacitanceTable,
        expected: Vec<Expected>,
    ) -> Result<Self, NgspiceError> {
        let elements = Elements::new(&Settings { exponential: true, ..*settings }.parameters(), table.growth())?;
        let run = Run::new(table.until(), table.growth());
        let netlist = elements.netlist(CapacitanceSource::Table, table.initial(), &run)?;
        Ok(Self { folder, about, netlist, table: table.clone(), script: circuit_script(settings), expected })
    }

    /// The three checks of a capacitor that grows from `c2` to `c3`, F, in 0.1 s, with `voltage`, V, at the start.
    ///
    /// # Errors
    /// Numbers that make no table or netlist.
    pub fn capacitors(voltage: f64, c2: f64, c3: f64) -> Result<Vec<Self>, NgspiceError> {
        let table = growing_capacitor(c2, c3)?;
        let run = capacitor_run(&table);
        let forms = closed_forms(voltage, c2, c3).into_iter();
        forms
            .map(|form| {
                Ok(Self {
                    folder: form.folder.to_owned(),
                    about: form.about.to_owned(),
                    netlist: form.check.netlist(voltage, table.initial(), &run)?,
                    table: table.clone(),
                    script: script(form.sums, form.expected.name),
                    expected: vec![form.expected],
                })
            })
            .collect()
    }
}

/// Time in which the capacitor of the checks grows, s, and the resistor of one of them, ohm: R C is some three times that.
const GROWTH: f64 = 0.1;
const RESISTANCE: f64 = 2e10;

/// C(t) of the checks: linear from `c2` to `c3`, F.
///
/// # Errors
/// Capacitances that make no table.
pub fn growing_capacitor(c2: f64, c3: f64) -> Result<CapacitanceTable, NgspiceError> {
    CapacitanceTable::new(&[0.0, GROWTH], &[c2, c3], &[c2, c2])
}

/// A run of the checks over `table`: the integration is good to 1e-7 there, as what is tried is the capacitor.
pub fn capacitor_run(table: &CapacitanceTable) -> Run {
    Run { max_step: 2e-5, ..Run::new(table.until(), table.growth()) }
}

/// A check with what it comes to.
pub struct ClosedForm {
    /// The check.
    pub check: Check,
    folder: &'static str,
    /// What it is.
    pub about: &'static str,
    sums: &'static str,
    /// Value at the end.
    pub expected: Expected,
}

/// The checks of a capacitor that grows from `c2` to `c3`, F, with `voltage`, V, at the start.
pub fn closed_forms(voltage: f64, c2: f64, c3: f64) -> [ClosedForm; 3] {
    let expected =
        |name, value, unit, source: &str| Expected { name, value, unit, source: format!("closed form {source}") };
    let exponent = -GROWTH / (RESISTANCE * (c3 - c2));
    [
        ClosedForm {
            check: Check::ChargedCapacitor,
            folder: "check_charged_capacitor",
            about: "a charged capacitor that grows",
            sums: "let final_voltage = v(de)[last]",
            expected: expected("final_voltage", voltage * c2 / c3, "V", "V = V(0) C(0) / C(t)"),
        },
        ClosedForm {
            check: Check::ConstantVoltage,
            folder: "check_constant_voltage",
            about: "a capacitor that grows at constant voltage",
            sums: "let current = -i(vin)\nlet sum = integ(current)\n* ngspice does not tell its point at 0 s.\nlet final_charge = sum[last] + current[0] * time[0]",
            expected: expected("final_charge", voltage * (c3 - c2), "C", "U (C(t) - C(0))"),
        },
        ClosedForm {
            check: Check::RcDischarge { resistance: RESISTANCE },
            folder: "check_rc_discharge",
            about: "a capacitor that grows while a resistor discharges it",
            sums: "let final_voltage = v(de)[last]",
            expected: expected(
                "final_voltage",
                voltage * c2 / c3 * (c3 / c2).powf(exponent),
                "V",
                "V = V(0) (C(t) / C(0))^(-1 - 1 / (R dC/dt))",
            ),
        },
    ]
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
    let raw = FileName::Raw.name();
    format!(
        "* videg: sums up {raw}; charges in C, energies in J, voltages in V\n.control\nload {raw}\n\
         let last = length(time) - 1\n{sums}\nset numdgt=9\nprint {printed}\nquit\n.endc\n.end\n"
    )
}

/// Writes the items into `folder`, each into a folder of its own, and a page that says what they are; `title` is what
/// was run. Nothing that is not of an earlier export is overwritten, and no link is followed.
///
/// # Errors
/// Something that is in the way; a file that cannot be written.
pub fn write(folder: &Path, title: &str, items: &[Item]) -> Result<Vec<PathBuf>, ExportError> {
    let page = folder.join(PAGE);
    let mut files = vec![page.clone()];
    for item in items {
        let names = [FileName::Netlist.name(), FileName::Table.name(), EVALUATION];
        files.extend(names.map(|name| folder.join(&item.folder).join(name)));
    }
    refuse_foreign(&page, &files)?;
    let fail = |path: &Path| {
        let path = path.to_owned();
        move |cause| ExportError::Write { path, cause }
    };
    for item in items {
        let own = folder.join(&item.folder);
        std::fs::create_dir_all(&own).map_err(fail(&own))?;
        Ngspice::export(&own, &item.netlist, &item.table)?;
        let path = own.join(EVALUATION);
        atomic_file::write(&path, &item.script).map_err(fail(&path))?;
    }
    atomic_file::write(&page, page_text(title, items)).map_err(fail(&page))?;
    Ok(files)
}

/// That the folder is none yet, or one whose page, if it has one, is of an earlier export.
///
/// # Errors
/// Something else that is there.
pub fn check(folder: &Path) -> Result<(), ExportError> {
    if folder.exists() && !folder.is_dir() {
        return Err(ExportError::Foreign(folder.to_owned()));
    }
    refuse_foreign(&folder.join(PAGE), &[folder.join(PAGE)])
}

fn refuse_foreign(page: &Path, files: &[PathBuf]) -> Result<(), ExportError> {
    let kind = |path: &Path| std::fs::symlink_metadata(path).map(|metadata| metadata.file_type());
    let regular = |path: &Path| kind(path).is_ok_and(|kind| kind.is_file());
    let ours = regular(page) && std::fs::read_to_string(page).is_ok_and(|text| text.starts_with(MARK));
    let parents =
        files.iter().filter_map(|file| file.parent()).filter(|parent| *parent != page.parent().unwrap_or(parent));
    for parent in parents {
        if kind(parent).is_ok_and(|kind| !kind.is_dir()) {
            return Err(ExportError::Foreign(parent.to_owned()));
        }
    }
    for file in files.iter().flat_map(|file| [file.clone(), atomic_file::partial(file)]) {
        let free = kind(&file).is_err();
        if !(free || ours && regular(&file)) {
            return Err(ExportError::Foreign(file));
        }
    }
    Ok(())
}

fn page_text(title: &str, items: &[Item]) -> String {
    // A name may hold anything; it stays on its line.
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let [netlist, raw] = [FileName::Netlist.name(), FileName::Raw.name()];
    let mut text = format!(
        "{MARK}\n\n{title}\n\nEach folder holds a circuit for ngspice (with its XSPICE code models, as Debian's package \
         has them): the\nnetlist {netlist}, C(t) in {} (time in s, capacitances of the left and the right membrane in \
         pF),\nand {EVALUATION}, which sums up the result. In such a folder\n\n    ngspice -n -b {netlist}\n    ngspice -n -b \
         {EVALUATION}\n\nleaves the waveforms in {raw} and prints the values that stand here: to some 1e-4, as the script sums\ncurrents by \
         the trapezoidal rule alone; to 3e-4 or better with another version of ngspice; the closed forms as far as the\n\
         crosscheck says.\n",
        FileName::Table.name()
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
