//! Length, accuracy and options of a run of ngspice, and the source of C(t).

use super::NgspiceError;
use super::capacitance::PICO;
use super::template::{RAW_FILE, TABLE_FILE, Values, template};

/// Source of C(t).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CapacitanceSource {
    /// The table file beside the netlist, for a batch run.
    Table,
    /// The voltage sources `vcl` and `vcr` of type `external`, in pF, for a program that has loaded ngspice as a library.
    /// The netlist then has no control section: its owner gives the commands.
    External,
}

/// Length and accuracy of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// End of the run, s.
    pub until: f64,
    /// Longest piece that ngspice runs in one go, s: it keeps all its time points in memory, some 6 MB for each second. The
    /// next piece begins with the voltages at the end of the last one.
    pub piece: f64,
    /// Longest internal step, s. The table sets no breakpoints, so this must stay well below the length of a pulse.
    pub max_step: f64,
    /// `reltol`.
    pub relative_tolerance: f64,
    /// `abstol`, A.
    pub current_tolerance: f64,
    /// `vntol`, V.
    pub voltage_tolerance: f64,
    /// `gmin`, S.
    pub minimum_conductance: f64,
}

impl Run {
    /// A run until `until`, s, while capacitances grow to at most `growth` times what they are at rest. `reltol` times the
    /// voltage must stay below N Vt, over which the current of a diode changes by e, or Newton's iteration ends at false
    /// solutions. Where the voltage rises to many times `U_in`, the current rises with its square.
    /// `ngspice_netlists/README.md` has a reason for each option.
    pub fn new(until: f64, growth: f64) -> Self {
        let coarseness = coarseness(growth);
        Self {
            until,
            piece: 5.0,
            max_step: 1e-4,
            relative_tolerance: 1e-8 * coarseness.sqrt(),
            current_tolerance: 1e-11 * coarseness * coarseness,
            voltage_tolerance: 1e-6,
            minimum_conductance: 1e-20,
        }
    }

    /// The same run with other time points, for when ngspice has stopped, and the change in words. Shorter steps cost no
    /// accuracy.
    pub fn changed(&self) -> [(String, Self); 2] {
        [0.5, 0.2].map(|part| {
            let max_step = part * self.max_step;
            (format!("steps of at most {max_step:e} s in place of {:e} s", self.max_step), Self { max_step, ..*self })
        })
    }

    /// Values that every netlist has: C(t), options, commands; for membranes charged to `voltage`, V.
    ///
    /// `chgtol` is the charge of the membranes at the start, which is what `reltol` means here: the element of the charge
    /// that C(t) adds to it passes through 0 wherever C(t) does, and an error relative to that would let no step
    /// cross a corner of C(t).
    pub(super) fn values(
        &self,
        source: CapacitanceSource,
        voltage: f64,
        [left, right]: [f64; 2],
        saved: &'static [&'static str],
    ) -> Result<Values, NgspiceError> {
        let values = Values::default()
            .number("until", self.until)
            .number("max_step", self.max_step)
            .number("reltol", self.relative_tolerance)
            .number("abstol", self.current_tolerance)
            .number("vntol", self.voltage_tolerance)
            .number("chgtol", voltage * (left + right))
            .number("gmin", self.minimum_conductance)
            .number("initial_left", left)
            .number("initial_right", right)
            .number("initial_left_pf", left / PICO)
            .number("initial_right_pf", right / PICO)
            .words("saved", saved)
            .words("table_file", &[TABLE_FILE])
            .words("raw_file", &[RAW_FILE]);
        let (capacitance, run) = match source {
            CapacitanceSource::Table => (template!("capacitance_table.cir"), template!("run_batch.cir")),
            CapacitanceSource::External => (template!("capacitance_external.cir"), template!("run_live.cir")),
        };
        let capacitance = [capacitance, template!("membranes.cir")].concat();
        let (capacitance, run) = (values.render(&capacitance)?, values.render(run)?);
        Ok(values.part("capacitance", &capacitance).part("run", &run))
    }
}

/// Factor by which diodes and tolerances have to be coarser than for the pulses of the paper's Fig. 9 to 15, which raise
/// the voltage by less than a factor of 5: doubles resolve a voltage of 300 kV to 60 pV only.
pub(super) fn coarseness(growth: f64) -> f64 {
    (growth / 5.0).max(1.0)
}
