//! The harvesting circuit as ngspice gets it: which templates, with which numbers.

use videg_circuit::{DiodeParameters, Diodes, Parameters, Release, Topology, names};

use super::NgspiceError;
use super::run::{CapacitanceSource, Run, coarseness};
use super::template::{Netlist, Template, Value, Values, template};

/// What lets the charge out to the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Branch {
    /// A Zener diode in series with the load.
    Zener {
        /// `U_z`, V.
        voltage: f64,
    },
    /// A lossless switch that is closed above `U_z`.
    Switch {
        /// `U_z`, V.
        voltage: f64,
    },
    /// A diode into a storage of fixed voltage, in place of the load.
    Storage {
        /// Voltage of the storage, V, at least that of the supply.
        voltage: f64,
    },
}

/// The circuit, with everything that ngspice needs to know of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    /// `U_in`, V.
    pub supply_voltage: f64,
    /// `R`, ohm, above 0 and finite; unused with a storage.
    pub load_resistance: f64,
    /// How the membranes are connected.
    pub topology: Topology,
    /// What releases the charge.
    pub branch: Branch,
    /// The diodes.
    pub diode: DiodeParameters,
}

impl Elements {
    /// The elements of an embedded circuit whose capacitances grow to at most `growth` times what they are at rest.
    /// ngspice has no ideal diodes: they become the near-ideal ones of [`DiodeParameters::default`], with a drop that
    /// grows with the voltages where these are extreme.
    ///
    /// # Errors
    /// Parameters out of bounds; a load of 0 or infinite resistance.
    pub fn new(parameters: &Parameters, growth: f64) -> Result<Self, NgspiceError> {
        parameters.validate()?;
        let voltage = parameters.release_voltage();
        Self {
            supply_voltage: parameters.supply_voltage,
            load_resistance: parameters.load_resistance,
            topology: parameters.topology,
            branch: match parameters.release {
                Release::Zener => Branch::Zener { voltage },
                Release::Switch => Branch::Switch { voltage },
                Release::Storage => Branch::Storage { voltage },
            },
            diode: match parameters.diodes {
                Diodes::Ideal => near_ideal(coarseness(growth)),
                Diodes::Exponential(diode) => diode,
            },
        }
        .checked()
    }

    /// Checks what a netlist needs beyond finite numbers.
    ///
    /// # Errors
    /// A load of 0 or infinite resistance; a storage below the supply.
    pub fn checked(self) -> Result<Self, NgspiceError> {
        let fail = |name: &str, value: f64, bound| {
            Err(NgspiceError::Value { name: name.to_owned(), value: value.to_string(), bound })
        };
        match self.branch {
            Branch::Storage { voltage } if !(voltage >= self.supply_voltage && voltage.is_finite()) => {
                fail("storage.voltage", voltage, "must be finite and at least supply.voltage")
            }
            Branch::Zener { .. } | Branch::Switch { .. }
                if !(self.load_resistance > 0.0 && self.load_resistance.is_finite()) =>
            {
                fail(
                    names::LOAD_RESISTANCE,
                    self.load_resistance,
                    "ngspice takes a load above 0 and below infinity only",
                )
            }
            _ => Ok(self),
        }
    }

    /// Vectors that ngspice saves, after the time. Those of [`super::Books`], in its order.
    pub fn vectors(&self) -> &'static [&'static str] {
        let all: &[&str] = match self.topology {
            Topology::SharedNode => &SHARED,
            Topology::Isolated => &ISOLATED,
        };
        // A load behind a switch is no node.
        &all[..all.len() - usize::from(self.is_switched())]
    }

    fn is_switched(&self) -> bool {
        matches!(self.branch, Branch::Switch { .. })
    }

    /// `R`, ohm, as ngspice gets it. The embedded solver bounds the conductance of a switch likewise, see its
    /// `SWITCH_CONDUCTANCE`.
    pub(super) fn resistance(&self) -> f64 {
        if self.is_switched() { self.load_resistance.max(LEAST_SWITCHED_RESISTANCE) } else { self.load_resistance }
    }

    /// Voltages before any charge has moved.
    pub fn start(&self) -> Start {
        let load = match self.branch {
            Branch::Storage { voltage } => voltage,
            Branch::Zener { .. } | Branch::Switch { .. } => 0.0,
        };
        Start { membranes: [self.supply_voltage; 2], load }
    }

    /// The netlist of a run from `initial` capacitances (left, right), F.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn netlist(&self, source: CapacitanceSource, initial: [f64; 2], run: &Run) -> Result<Netlist, NgspiceError> {
        self.netlist_from(&self.start(), source, initial, run)
    }

    /// The netlist of a run that begins with other voltages: those in which an earlier one ended.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn netlist_from(
        &self,
        start: &Start,
        source: CapacitanceSource,
        initial: [f64; 2],
        run: &Run,
    ) -> Result<Netlist, NgspiceError> {
        let (whole, release) = self.templates();
        self.fill(&whole, &release, start, run.values(source, self.supply_voltage, initial, self.vectors())?)
    }

    fn fill(&self, whole: &Template, release: &Template, start: &Start, run: Values) -> Result<Netlist, NgspiceError> {
        let [left, right] = start.membranes;
        let run = run.number("start_left", left).number("start_right", right).number("start_out", start.load);
        let values = self.device_values(run);
        let release = release.render(&values)?;
        let models = template!("models.cir").render(&values)?;
        whole.render(&values.with("release", Value::Fragment(release)).with("models", Value::Fragment(models)))
    }

    fn templates(&self) -> (Template, Template) {
        match (self.topology, self.branch) {
            (Topology::SharedNode, branch) => (
                template!("shared_node.cir"),
                match branch {
                    Branch::Zener { .. } => template!("zener_shared.cir"),
                    Branch::Switch { .. } => template!("switch_shared.cir"),
                    Branch::Storage { .. } => template!("storage_shared.cir"),
                },
            ),
            (Topology::Isolated, branch) => (
                template!("isolated.cir"),
                match branch {
                    Branch::Zener { .. } => template!("zener_isolated.cir"),
                    Branch::Switch { .. } => template!("switch_isolated.cir"),
                    Branch::Storage { .. } => template!("storage_isolated.cir"),
                },
            ),
        }
    }

    /// The one place where parameters of the embedded model meet those of ngspice's model cards; see the table in
    /// `ngspice_netlists/README.md`.
    fn device_values(&self, values: Values) -> Values {
        let diode = &self.diode;
        let (Branch::Zener { voltage } | Branch::Switch { voltage } | Branch::Storage { voltage }) = self.branch;
        values
            .number("supply_voltage", self.supply_voltage)
            .number("load_resistance", self.resistance())
            .number("zener_voltage", voltage)
            .number("storage_voltage", voltage)
            .number("saturation_current", diode.saturation_current)
            .number("emission_coefficient", diode.emission_coefficient)
            .number("breakdown_current", diode.breakdown_current)
            .number("breakdown_emission", diode.breakdown_emission)
            .number("temperature", diode.temperature - ZERO_CELSIUS)
            .number("band", diode.switch_band)
            .number("half_band", 0.5 * diode.switch_band)
            .number("quarter_band", 0.25 * diode.switch_band)
    }
}

/// Voltages that a run begins with, V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Of the membranes, left and right; on a shared node the first counts.
    pub membranes: [f64; 2],
    /// Across the load or storage.
    pub load: f64,
}

/// Diodes whose drop is negligible, `coarseness` times as coarse as the default ones.
fn near_ideal(coarseness: f64) -> DiodeParameters {
    let fine = DiodeParameters::default();
    DiodeParameters {
        emission_coefficient: coarseness * fine.emission_coefficient,
        breakdown_emission: coarseness * fine.breakdown_emission,
        switch_band: coarseness * fine.switch_band,
        ..fine
    }
}

const SHARED: [&str; 6] = ["v(cl)", "v(cr)", "v(de)", "i(vs)", "i(vr)", "v(out)"];
const ISOLATED: [&str; 9] = ["v(cl)", "v(cr)", "v(left)", "v(right)", "i(vsl)", "i(vsr)", "i(vrl)", "i(vrr)", "v(out)"];

/// Smallest load behind a switch, ohm.
const LEAST_SWITCHED_RESISTANCE: f64 = 1e3;

/// 0 degrees Celsius, K: ngspice takes Celsius.
const ZERO_CELSIUS: f64 = 273.15;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ngspice::CapacitanceTable;
    use crate::ngspice::reading::Reading;
    use crate::ngspice::{Ngspice, Waveforms};

    /// A pulse of the left membrane by 40 %.
    fn pulse() -> CapacitanceTable {
        let time: Vec<f64> = (0..=200).map(|k| f64::from(k) * 5e-4).collect();
        let bump = |t: f64| 1.0 + 0.4 * (std::f64::consts::PI * (t / 0.06).min(1.0)).sin();
        let left: Vec<_> = time.iter().map(|&t| 15e-12 * bump(t)).collect();
        let right = vec![15e-12; time.len()];
        CapacitanceTable::new(&time, &left, &right).unwrap()
    }

    /// Relative difference of the load charge of a netlist made from `whole` from that of the embedded solver.
    fn difference(ngspice: &Ngspice, whole: &Template) -> f64 {
        let (table, parameters) = (pulse(), Parameters::default());
        let elements = Elements::new(&parameters, table.growth()).unwrap();
        // Loose, for the wrong form gets nowhere with the tight options.
        let loose = Run::new(table.until(), table.growth());
        let run = Run { relative_tolerance: 1e-5, current_tolerance: 1e-9, ..loose };
        let values = run
            .values(CapacitanceSource::Table, parameters.supply_voltage, table.initial(), elements.vectors())
            .unwrap();
        let netlist = elements.fill(whole, &template!("zener_shared.cir"), &elements.start(), values).unwrap();
        let finished = ngspice.run(&netlist, &table).unwrap();
        let mut found = Reading::new(&elements, &table);
        found.take(finished.raw().unwrap().unwrap(), 0).unwrap();
        let (found, expected) = (found.finish(), Waveforms::embedded(&parameters, &table).unwrap());
        (found.ledger().load_charge / expected.ledger().load_charge - 1.0).abs()
    }

    #[test]
    fn a_capacitor_that_loses_v_dc_dt_does_not_pass() {
        let Some(ngspice) = Ngspice::for_tests() else { return };
        let right = template!("shared_node.cir");
        assert!(difference(&ngspice, &right) < 1e-3);
        let start = right.text.find("Cfix de 0").unwrap();
        let length = right.text[start..].find("\n\n").unwrap();
        let wrong = right.text.replace(&right.text[start..start + length], "Cvar de 0 C='(V(cl)+V(cr))*1e-12'");
        let wrong = Template { name: "wrong.cir", text: wrong.leak() };
        assert!(difference(&ngspice, &wrong) > 0.1);
    }

    #[test]
    fn every_circuit_has_a_netlist_without_placeholders_and_with_all_it_saves() {
        for topology in [Topology::SharedNode, Topology::Isolated] {
            for branch in [
                Branch::Zener { voltage: 2100.0 },
                Branch::Switch { voltage: 2100.0 },
                Branch::Storage { voltage: 2100.0 },
            ] {
                let elements = Elements {
                    supply_voltage: 2000.0,
                    load_resistance: 1e9,
                    topology,
                    branch,
                    diode: DiodeParameters::default(),
                };
                for source in [CapacitanceSource::Table, CapacitanceSource::External] {
                    let netlist =
                        elements.netlist(source, [15e-12; 2], &Run::new(pulse().until(), pulse().growth())).unwrap();
                    let text = netlist.text();
                    assert!(!text.contains('<') && text.ends_with(".end\n"), "{text}");
                    // A program that has loaded ngspice gives the commands and takes the vectors itself.
                    let by_itself = source == CapacitanceSource::Table;
                    assert_eq!(text.contains(".control"), by_itself);
                    assert_eq!(text.contains(&elements.vectors().join(" ")), by_itself);
                }
            }
        }
    }

    #[test]
    fn a_circuit_that_ngspice_cannot_have_is_named_with_its_bound() {
        let load = |load_resistance| Parameters { load_resistance, ..Parameters::default() };
        for (parameters, expected) in [
            (load(0.0), "load.resistance = 0: ngspice takes"),
            (load(f64::INFINITY), "load.resistance = inf: ngspice takes"),
            (load(f64::NAN), "load.resistance = NaN"),
            (Parameters { zener_voltage: 1.0, ..load(1e9) }, "zener.voltage = 1 V"),
        ] {
            let error = Elements::new(&parameters, pulse().growth()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        let mut storage = Elements::new(&load(1e9), pulse().growth()).unwrap();
        storage.branch = Branch::Storage { voltage: 1999.0 };
        assert!(storage.checked().unwrap_err().to_string().contains("storage.voltage = 1999"));
        let run = Run { max_step: f64::NAN, ..Run::new(pulse().until(), pulse().growth()) };
        let error = storage.netlist(CapacitanceSource::Table, [15e-12; 2], &run).unwrap_err().to_string();
        assert!(error.contains("max_step = NaN"), "{error}");
    }
}
