//! Closed forms of ngspice's capacitor: it grows linearly, isolated, at constant voltage, or discharged by a resistor.

use super::check::{Agreement, QuantityCheck, Values};
use super::mechanics::MechanicalRun;
use super::solver::Solver;
use crate::ngspice::{CapacitanceTable, CapacitorTest, Ngspice, NgspiceError, Run};

/// Time in which the capacitor grows, s, and the resistor of one test, ohm: R C is some three times that.
const GROWTH: f64 = 0.1;
const RESISTANCE: f64 = 2e10;

/// A test with its closed form.
pub struct ClosedForm {
    /// The test.
    pub test: CapacitorTest,
    /// Its folder in an export.
    pub folder: &'static str,
    /// Description.
    pub about: &'static str,
    /// Commands of ngspice that calculate the quantity at the end.
    pub sums: &'static str,
    /// Name of that quantity, and its unit.
    pub quantity: [&'static str; 2],
    /// The closed form as a formula.
    pub formula: &'static str,
}

/// The tests.
pub const CLOSED_FORMS: [ClosedForm; 3] = [
    ClosedForm {
        test: CapacitorTest::Isolated,
        folder: "check_charged_capacitor",
        about: "a charged capacitor that grows",
        sums: "let final_voltage = v(de)[last]",
        quantity: ["final_voltage", "V"],
        formula: "V = V(0) C(0) / C(t)",
    },
    ClosedForm {
        test: CapacitorTest::ConstantVoltage,
        folder: "check_constant_voltage",
        about: "a capacitor that grows at constant voltage",
        sums: "let current = -i(vin)\nlet sum = integ(current)\n* ngspice does not tell its point at 0 s.\nlet final_charge = sum[last] + current[0] * time[0]",
        quantity: ["final_charge", "C"],
        formula: "U (C(t) - C(0))",
    },
    ClosedForm {
        test: CapacitorTest::Discharge { resistance: RESISTANCE },
        folder: "check_rc_discharge",
        about: "a capacitor that grows while a resistor discharges it",
        sums: "let final_voltage = v(de)[last]",
        quantity: ["final_voltage", "V"],
        formula: "V = V(0) (C(t) / C(0))^(-1 - 1 / (R dC/dt))",
    },
];

/// The capacitor on which ngspice is tested.
pub struct GrowingCapacitor {
    voltage: f64,
    capacitance: [f64; 2],
    /// C(t).
    pub table: CapacitanceTable,
    /// Accurate to 1e-7, as the capacitor is tested.
    pub run: Run,
}

impl GrowingCapacitor {
    /// A capacitor at `voltage`, V, that grows as the left membrane at the largest impact, by a half without impacts.
    pub fn new(voltage: f64, mechanics: &MechanicalRun) -> Result<Self, NgspiceError> {
        let (c2, ratio) = (mechanics.rest[0], mechanics.largest_ratio());
        let c3 = c2 * if ratio > 1.0 { ratio } else { 1.5 };
        let table = CapacitanceTable::new(&[0.0, GROWTH], &[c2, c3], &[c2, c2])?;
        let run = Run { max_step: 2e-5, ..Run::new(table.until(), table.growth()) };
        Ok(Self { voltage, capacitance: [c2, c3], table, run })
    }

    /// Voltage at the start, V.
    pub fn voltage(&self) -> f64 {
        self.voltage
    }

    /// The quantity of `form` at the end.
    pub fn expected(&self, form: &ClosedForm) -> f64 {
        form.test.closed_form(self.voltage, GROWTH, self.capacitance)
    }

    /// Compares ngspice with `form`.
    pub fn check(&self, form: &ClosedForm, ngspice: &Ngspice) -> Result<QuantityCheck, NgspiceError> {
        /// Both sides are good to some 1e-8; a capacitor that loses V dC/dt is off by tens of percent.
        const TOLERANCE: f64 = 1e-6;
        let found = form.test.run(ngspice, self.voltage, &self.table, &self.run)?;
        let between = format!("closed form and {}", Solver::Batch.name());
        let values = Values::by([(Solver::Batch, found.found)]);
        Ok(QuantityCheck {
            analytic: Some(found.expected),
            agreement: Some(Agreement::new(between, found.largest, TOLERANCE)),
            ..QuantityCheck::new(form.about, form.quantity[1], values)
        })
    }
}
