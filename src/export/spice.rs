//! The membranes as subcircuits `deg_left` and `deg_right` with the nodes p and n.
//!
//! Each is a linear capacitor of the capacitance at 0 s, and the charge that the rest of C(t) holds. A capacitance that varies would be wrong:
//! simulators make I = C dV/dt of it and lose V dC/dt.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::{ExportError, Format, Table, fill};
use crate::ngspice::{PICO, write_rows};

/// Points of a source on a line.
const POINTS: usize = 4;
const SIDES: [&str; 2] = ["left", "right"];

/// Writes the subcircuits of `table`, and for ngspice the table that they read beside them; the path of the latter.
pub(super) fn write(path: &Path, format: Format, table: &Table) -> Result<Option<PathBuf>, ExportError> {
    let tab = path.with_extension("tab");
    let mut text = String::new();
    for line in table.header.iter().map(String::as_str).chain(notes(format).iter().copied()) {
        let _ = writeln!(text, "* {line}");
    }
    for side in 0..2 {
        subcircuit(&mut text, format, table, side, &tab);
    }
    if format == Format::Ngspice {
        let [time, left, right] = [0, 1, 2].map(|column| &table.columns[column].values);
        let rows = time.iter().zip(left).zip(right).map(|((time, left), right)| (*time, [*left, *right]));
        fill(&tab, |out| write_rows(rows, out))?;
    }
    fill(path, |out| out.write_all(text.as_bytes()))?;
    Ok((format == Format::Ngspice).then_some(tab))
}

/// How the file is used, and what it relies on.
fn notes(format: Format) -> &'static [&'static str] {
    match format {
        Format::Ngspice => &[
            "ngspice with code models: .include this file, keep the table (time in s, left and right in pF) in the folder of",
            "your netlist, and put Xl a b deg_left and Xr c d deg_right into it. Step limit (tmax) well below a pulse, 1e-4 s.",
        ],
        Format::Kicad => &[
            "KiCad: symbols with Sim.Library = this file and Sim.Name = deg_left or deg_right; pins p and n. ngspice searches a",
            "PWL source point by point: for more than some 10,000 points use --format ngspice.",
        ],
        Format::Ltspice => &[
            "LTspice: .include this file and put Xl a b deg_left and Xr c d deg_right into your netlist. Capacitors with a charge",
            "Q, x being the voltage across them, and PWL sources, as its help describes them.",
        ],
        _ => &[
            "QSPICE, and any SPICE with B, F and PWL sources: .include this file and put Xl a b deg_left and Xr c d deg_right into",
            "your netlist. A mirror repeats the current of a capacitor that holds the charge; 1 V stands for 1 nC.",
        ],
    }
}

fn subcircuit(text: &mut String, format: Format, table: &Table, side: usize, tab: &Path) {
    let pico: Vec<f64> = table.columns[1 + side].values.iter().map(|value| value / PICO).collect();
    let start = pico.first().copied().unwrap_or_default();
    let _ = writeln!(text, "\n.subckt deg_{} p n", SIDES[side]);
    if format == Format::Ngspice {
        let nodes = [["c", "other"], ["other", "c"]][side].join(" ");
        let name = tab.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let _ = writeln!(text, "Atable %v([{nodes}]) table");
        let _ = writeln!(text, ".model table filesource (file=\"{name}\" amploffset=[0 0] amplscale=[1 1])");
    } else {
        let _ = write!(text, "Vc c 0 PWL(");
        for (index, (time, value)) in table.columns[0].values.iter().zip(&pico).enumerate() {
            if index % POINTS == 0 {
                let _ = write!(text, "\n+");
            }
            let _ = write!(text, " {time:e} {value:e}");
        }
        let _ = writeln!(text, ")");
    }
    let _ = writeln!(text, "Cfix p n {:e}", start * PICO);
    let _ = match format {
        Format::Ltspice => writeln!(text, "Cvar p n Q=(V(c)-{start:e})*1e-12*x"),
        Format::Qspice => writeln!(
            text,
            "Bq q 0 V=(V(c)-{start:e})*1e-3*(V(p)-V(n))\nVsense q s 0\nCq s 0 1e-9\nFmirror p n Vsense 1"
        ),
        _ => writeln!(text, "Cvar p n Q='(V(c)-{start:e})*1e-12*V(p,n)'"),
    };
    let _ = writeln!(text, ".ends deg_{}", SIDES[side]);
}
