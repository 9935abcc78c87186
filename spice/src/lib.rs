//! The membranes as subcircuits `deg_left` and `deg_right` with the nodes p and n.
//!
//! Each is a linear capacitor of the capacitance at 0 s, and the charge that the rest of C(t) holds. A capacitance that varies would be wrong:
//! simulators make I = C dV/dt of it and lose V dC/dt.
#![forbid(unsafe_code)]

use std::fmt::Write as _;

/// Capacitances stand in tables in units of this, F: then a table has numbers that simulators interpolate well.
pub const PICO: f64 = 1e-12;

/// Points of a source on a line.
const POINTS: usize = 4;
const SIDES: [&str; 2] = ["left", "right"];

/// Which simulator reads the subcircuits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flavour<'a> {
    /// ngspice, with the table in a file of this name beside them.
    Ngspice(&'a str),
    /// ngspice, also in `KiCad`, with the points in the subcircuits.
    Kicad,
    /// `LTspice`.
    Ltspice,
    /// QSPICE, and any SPICE with B, F and PWL sources.
    Qspice,
}

/// C(t) in points, between which it is a straight line.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// Times, s, ascending.
    pub times: &'a [f64],
    /// Capacitances of the left and of the right membrane, F.
    pub capacitances: [&'a [f64]; 2],
}

impl Flavour<'_> {
    /// How the file is used, and what it relies on.
    pub fn notes(self) -> &'static [&'static str] {
        match self {
            Self::Ngspice(_) => &[
                "ngspice with code models: .include this file, keep the table (time in s, left and right in pF) in the folder of",
                "your netlist, and put Xl a b deg_left and Xr c d deg_right into it. Step limit (tmax) well below a pulse, 1e-4 s.",
            ],
            Self::Kicad => &[
                "KiCad: symbols with Sim.Library = this file and Sim.Name = deg_left or deg_right; pins p and n. ngspice searches a",
                "PWL source point by point: for more than some 10,000 points use --format ngspice.",
            ],
            Self::Ltspice => &[
                "LTspice: .include this file and put Xl a b deg_left and Xr c d deg_right into your netlist. Capacitors with a charge",
                "Q, x being the voltage across them, and PWL sources, as its help describes them.",
            ],
            Self::Qspice => &[
                "QSPICE, and any SPICE with B, F and PWL sources: .include this file and put Xl a b deg_left and Xr c d deg_right into",
                "your netlist. A mirror repeats the current of a capacitor that holds the charge; 1 V stands for 1 nC.",
            ],
        }
    }

    /// Both subcircuits below a `header` of comments.
    pub fn library<'h>(self, header: impl IntoIterator<Item = &'h str>, points: Points<'_>) -> String {
        let mut text = String::new();
        for line in header.into_iter().chain(self.notes().iter().copied()) {
            let _ = writeln!(text, "* {line}");
        }
        (0..2).for_each(|side| self.subcircuit(&mut text, points, side));
        text
    }

    fn subcircuit(self, text: &mut String, points: Points<'_>, side: usize) {
        let pico: Vec<f64> = points.capacitances[side].iter().map(|value| value / PICO).collect();
        let start = pico.first().copied().unwrap_or_default();
        let _ = writeln!(text, "\n.subckt deg_{} p n", SIDES[side]);
        if let Self::Ngspice(file) = self {
            let nodes = [["c", "other"], ["other", "c"]][side].join(" ");
            let _ = writeln!(text, "Atable %v([{nodes}]) table");
            let _ = writeln!(text, ".model table filesource (file=\"{file}\" amploffset=[0 0] amplscale=[1 1])");
        } else {
            let _ = write!(text, "Vc c 0 PWL(");
            for (index, (time, value)) in points.times.iter().zip(&pico).enumerate() {
                if index % POINTS == 0 {
                    let _ = write!(text, "\n+");
                }
                let _ = write!(text, " {time:e} {value:e}");
            }
            let _ = writeln!(text, ")");
        }
        let _ = writeln!(text, "Cfix p n {:e}", start * PICO);
        let _ = match self {
            Self::Ltspice => writeln!(text, "Cvar p n Q=(V(c)-{start:e})*1e-12*x"),
            Self::Qspice => writeln!(
                text,
                "Bq q 0 V=(V(c)-{start:e})*1e-3*(V(p)-V(n))\nVsense q s 0\nCq s 0 1e-9\nFmirror p n Vsense 1"
            ),
            Self::Ngspice(_) | Self::Kicad => writeln!(text, "Cvar p n Q='(V(c)-{start:e})*1e-12*V(p,n)'"),
        };
        let _ = writeln!(text, ".ends deg_{}", SIDES[side]);
    }
}
