//! Checks of ngspice's time-varying capacitor against closed forms: if these fail, nothing else from it counts.

use super::capacitance::{CapacitanceTable, PICO};
use super::raw::RawReader;
use super::run::{CapacitanceSource, Run};
use super::runner::Ngspice;
use super::template::{Netlist, Template, template};
use super::{NgspiceError, Said};

/// A circuit of one capacitor, the left one of a table, that has a closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Check {
    /// Isolated: `V = V(0) C(0) / C(t)`.
    ChargedCapacitor,
    /// Held at U: charge from the source `U (C(t) - C(0))`.
    ConstantVoltage,
    /// Discharged by a resistor while C runs linearly: `q = q(0) (C / C(0))^(-1 / (R k))`, `k = dC/dt`.
    RcDischarge {
        /// R, ohm.
        resistance: f64,
    },
}

/// How far ngspice is off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Largest difference from the closed form over all time points, relative to the largest value of the closed form.
    pub largest: f64,
    /// Value at the end: voltage, V, or charge, C.
    pub found: f64,
    /// Its closed form.
    pub expected: f64,
}

impl Check {
    /// Vectors saved, after the time.
    fn vectors(self) -> &'static [&'static str] {
        match self {
            Self::ConstantVoltage => &["v(de)", "i(vin)"],
            Self::ChargedCapacitor | Self::RcDischarge { .. } => &["v(de)"],
        }
    }

    fn template(self) -> Template {
        match self {
            Self::ChargedCapacitor => template!("charged_capacitor.cir"),
            Self::ConstantVoltage => template!("constant_voltage.cir"),
            Self::RcDischarge { .. } => template!("rc_discharge.cir"),
        }
    }

    /// The netlist of a run that starts at `voltage`, V, and `initial` capacitances (left, right), F.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn netlist(self, voltage: f64, initial: [f64; 2], run: &Run) -> Result<Netlist, NgspiceError> {
        let values =
            run.values(CapacitanceSource::Table, voltage, initial, self.vectors())?.number("supply_voltage", voltage);
        let values = match self {
            Self::RcDischarge { resistance } => values.number("load_resistance", resistance),
            Self::ChargedCapacitor | Self::ConstantVoltage => values,
        };
        self.template().render(&values)
    }

    /// Runs it over `table` from `voltage`, V, and compares each time point.
    ///
    /// # Errors
    /// What ngspice says.
    pub fn run(
        self,
        ngspice: &Ngspice,
        voltage: f64,
        table: &CapacitanceTable,
        run: &Run,
    ) -> Result<Deviation, NgspiceError> {
        let finished = ngspice.run(&self.netlist(voltage, table.initial(), run)?, table)?;
        let stopped =
            |reached: f64, said: &Said| NgspiceError::Stopped { reached, until: run.until, said: said.clone() };
        let raw = finished.raw()?.ok_or_else(|| stopped(0.0, finished.said()))?;
        let mut reader = RawReader::new(raw)?;
        let columns = self.vectors().iter().map(|name| reader.index(name)).collect::<Result<Vec<_>, _>>()?;
        let (mut point, mut reached) = (Vec::new(), 0.0);
        let (mut charge, mut largest, mut scale) = (0.0, 0.0_f64, 0.0_f64);
        let mut last_current = None;
        let mut deviation = Deviation::default();
        let mut cursor = Cursor { table, row: 0 };
        while reader.next_point(&mut point)? {
            let now = point[0];
            let found = if let [_, current] = columns[..] {
                // The current into the source; the first step of ngspice is one of the implicit Euler method.
                let current = -point[current];
                charge += 0.5 * (now - reached) * (last_current.unwrap_or(current) + current);
                last_current = Some(current);
                charge
            } else {
                point[columns[0]]
            };
            let expected = self.expected(voltage, table.initial()[0], now, cursor.at(now));
            largest = largest.max((found - expected).abs());
            scale = scale.max(expected.abs());
            reached = now;
            deviation = Deviation { largest: 0.0, found, expected };
        }
        if reached < run.until * (1.0 - 1e-9) {
            return Err(stopped(reached, finished.said()));
        }
        Ok(Deviation { largest: largest / scale, ..deviation })
    }

    /// The closed form at `time`, s, when the capacitance is `now`, F, and was `start`, F.
    fn expected(self, voltage: f64, start: f64, time: f64, now: f64) -> f64 {
        match self {
            Self::ChargedCapacitor => voltage * start / now,
            Self::ConstantVoltage => voltage * (now - start),
            Self::RcDischarge { resistance } => {
                let rate = (now - start) / time;
                voltage * start / now * (now / start).powf(-1.0 / (resistance * rate))
            }
        }
    }
}

/// Looks up the left capacitance at rising times.
struct Cursor<'a> {
    table: &'a CapacitanceTable,
    row: usize,
}

impl Cursor<'_> {
    fn at(&mut self, time: f64) -> f64 {
        let (times, left) = (self.table.times(), self.table.left());
        while self.row + 2 < times.len() && times[self.row + 1] < time {
            self.row += 1;
        }
        let (a, b) = (self.row, self.row + 1);
        let part = ((time - times[a]) / (times[b] - times[a])).clamp(0.0, 1.0);
        // As ngspice reads it, in pF.
        (left[a] / PICO + part * (left[b] - left[a]) / PICO) * PICO
    }
}
