//! C(t) for other programs.

use std::fmt::Write as _;

use videg_spice::{Flavour, Points};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::machine::Machine;

/// Rows between two knots of C(t) while a membrane is deflected.
const IN_PULSE: u32 = 32;

/// What reads C(t).
#[wasm_bindgen]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// Whatever reads comma-separated values.
    Csv,
    /// ngspice and `KiCad`.
    Ngspice,
    /// `LTspice`.
    Ltspice,
    /// QSPICE, and any SPICE with B, F and PWL sources.
    Qspice,
}

#[wasm_bindgen]
impl Machine {
    /// C(t) from 0 to `until`, s, for a `reader`: a table, or the membranes as subcircuits; `title` says of what.
    ///
    /// # Errors
    /// As [`Machine::motion`].
    #[wasm_bindgen(js_name = exportCapacitances)]
    pub fn export_capacitances(&self, until: f64, reader: Reader, title: &str) -> Result<String, String> {
        let mut columns = [const { Vec::new() }; 3];
        self.follow([0.0, until], until, (f64::INFINITY, IN_PULSE), |simulation| {
            let harvester = simulation.harvester();
            let [left, right] = videg_model::Side::BOTH.map(|side| harvester.capacitance(side));
            columns.iter_mut().zip([harvester.time(), left, right]).for_each(|(column, value)| column.push(value));
            columns[0].len()
        })?;
        let [times, left, right] = columns;
        let title = title.replace(['\n', '\r'], " ");
        let flavour = match reader {
            Reader::Csv => return Ok(table(&title, &times, [&left, &right])),
            Reader::Ngspice => Flavour::Kicad,
            Reader::Ltspice => Flavour::Ltspice,
            Reader::Qspice => Flavour::Qspice,
        };
        let header = [title.as_str(), "C(t) of the membranes, between the points straight lines"];
        Ok(flavour.library(header, Points { times: &times, capacitances: [&left, &right] }))
    }
}

fn table(title: &str, times: &[f64], [left, right]: [&[f64]; 2]) -> String {
    let mut text = format!("# {title}\ntime,left.capacitance,right.capacitance\n");
    for ((time, left), right) in times.iter().zip(left).zip(right) {
        let _ = writeln!(text, "{time:?},{left:?},{right:?}");
    }
    text
}
