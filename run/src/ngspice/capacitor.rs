//! Tests of ngspice's time-varying capacitor against closed forms: if these fail, nothing else from it counts.

use super::capacitance::CapacitanceTable;
use super::raw::RawReader;
use super::run::{CapacitanceSource, Run};
use super::runner::Ngspice;
use super::template::{Netlist, template};
use super::{Complaints, NgspiceError};

/// A circuit of one capacitor, the left one of a table, that has a closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CapacitorTest {
    /// Isolated: `V = V(0) C(0) / C(t)`.
    Isolated,
    /// Held at U: charge from the source `U (C(t) - C(0))`.
    ConstantVoltage,
    /// Discharged by a resistor while C runs linearly: `q = q(0) (C / C(0))^(-1 / (R k))`, `k = dC/dt`.
    Discharge {
        /// R, ohm.
        resistance: f64,
    },
}

/// The deviation of ngspice from a closed form.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Largest difference from the closed form over all time points, relative to the largest value of the closed form.
    pub largest: f64,
    /// Value at the end: voltage, V, or charge, C.
    pub found: f64,
    /// Its closed form.
    pub expected: f64,
}

impl CapacitorTest {
    /// Vectors saved, after the time.
    fn vectors(self) -> &'static [&'static str] {
        match self {
            Self::ConstantVoltage => &["v(de)", "i(vin)"],
            Self::Isolated | Self::Discharge { .. } => &["v(de)"],
        }
    }

    /// The netlist of a run that starts at `voltage`, V, and `initial` capacitances (left, right), F.
    pub fn netlist(self, voltage: f64, initial: [f64; 2], run: &Run) -> Result<Netlist, NgspiceError> {
        let values =
            run.values(CapacitanceSource::Table, voltage, initial, self.vectors())?.number("supply_voltage", voltage);
        match self {
            Self::Isolated => values.render(template!("charged_capacitor.cir")),
            Self::ConstantVoltage => values.render(template!("constant_voltage.cir")),
            Self::Discharge { resistance } => {
                values.number("load_resistance", resistance).render(template!("rc_discharge.cir"))
            }
        }
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
        let output = ngspice.run(&self.netlist(voltage, table.initial(), run)?, table)?;
        let stopped = |reached: f64, said: &Complaints| {
            Err(NgspiceError::Stopped { reached, until: run.until, said: said.clone() })
        };
        let Some(raw) = output.raw()? else { return stopped(0.0, output.complaints()) };
        let mut reader = RawReader::new(raw)?;
        let columns = reader.indices(self.vectors())?;
        let (mut point, mut reached) = (Vec::new(), 0.0);
        let (mut charge, mut largest, mut scale) = (0.0, 0.0_f64, 0.0_f64);
        let mut last_current = None;
        let mut deviation = Deviation::default();
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
            let expected = self.closed_form(voltage, now, [table.initial()[0], table.left_at(now)]);
            largest = largest.max((found - expected).abs());
            scale = scale.max(expected.abs());
            reached = now;
            deviation = Deviation { largest: 0.0, found, expected };
        }
        if reached < run.until * (1.0 - 1e-9) {
            return stopped(reached, output.complaints());
        }
        Ok(Deviation { largest: largest / scale, ..deviation })
    }

    /// Voltage, V, or charge, C, at `time`, s, if the capacitance has gone from `start` to `now`, F.
    pub fn closed_form(self, voltage: f64, time: f64, [start, now]: [f64; 2]) -> f64 {
        match self {
            Self::Isolated => voltage * start / now,
            Self::ConstantVoltage => voltage * (now - start),
            Self::Discharge { resistance } => {
                let rate = (now - start) / time;
                voltage * start / now * (now / start).powf(-1.0 / (resistance * rate))
            }
        }
    }
}
