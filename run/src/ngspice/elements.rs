//! The harvesting circuit as ngspice gets it: which templates, with which numbers.

use videg_circuit::{DiodeParameters, Diodes, Parameters, Release, Topology, names};

use super::NgspiceError;
use super::run::{CapacitanceSource, Run, coarseness};
use super::template::{Netlist, Values, template};

/// The circuit, with everything that ngspice needs to know of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    /// The circuit, but for its diodes.
    pub(super) circuit: Parameters,
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
        let load = parameters.load_resistance;
        if parameters.release != Release::Storage && !(load > 0.0 && load.is_finite()) {
            return Err(NgspiceError::Value {
                name: names::LOAD_RESISTANCE.to_owned(),
                value: load.to_string(),
                bound: "ngspice takes a load above 0 and below infinity only",
            });
        }
        let diode = match parameters.diodes {
            Diodes::Ideal => near_ideal(coarseness(growth)),
            Diodes::Exponential(diode) => diode,
        };
        Ok(Self { circuit: *parameters, diode })
    }

    /// Vectors that ngspice saves, after the time. `TrapezoidalLedger` takes them in this order.
    pub(crate) fn vectors(&self) -> &'static [&'static str] {
        let all: &[&str] = match self.circuit.topology {
            Topology::SharedNode => &["v(videg_cl)", "v(videg_cr)", "v(de)", "i(vs)", "i(vr)", "v(out)"],
            Topology::Isolated => {
                &["v(videg_cl)", "v(videg_cr)", "v(left)", "v(right)", "i(vsl)", "i(vsr)", "i(vrl)", "i(vrr)", "v(out)"]
            }
        };
        // A load behind a switch is no node.
        &all[..all.len() - usize::from(self.circuit.release == Release::Switch)]
    }

    /// What an element of the netlists is for, by its name in ngspice; none for sources that only show a current.
    pub(crate) fn role(name: &str) -> Option<Role> {
        let begins = |word: &str| name.starts_with(word);
        if begins("vin") {
            Some(Role::Supply)
        } else if begins("rload") || begins("vstorage") || begins("bswitch") {
            Some(Role::Load)
        } else if begins("dzener") || begins("dblock") {
            Some(Role::Zener)
        } else if begins("dcharge") || begins("dstorage") {
            Some(Role::Diode)
        } else {
            begins("bleak").then_some(Role::Leakage)
        }
    }

    /// The circuit that these elements are.
    pub fn circuit(&self) -> &Parameters {
        &self.circuit
    }

    /// `R`, ohm, as ngspice gets it. The embedded solver bounds the conductance of a switch likewise, see its
    /// `SWITCH_CONDUCTANCE`.
    pub(crate) fn resistance(&self) -> f64 {
        const LEAST_SWITCHED: f64 = 1e3;
        let load = self.circuit.load_resistance;
        if self.circuit.release == Release::Switch { load.max(LEAST_SWITCHED) } else { load }
    }

    /// Voltages before any charge has moved.
    pub(super) fn start(&self) -> Start {
        let load = if self.circuit.release == Release::Storage { self.circuit.storage_voltage } else { 0.0 };
        Start { membranes: [self.circuit.supply_voltage; 2], load }
    }

    /// The netlist of a run from `initial` capacitances (left, right), F.
    pub fn netlist(&self, source: CapacitanceSource, initial: [f64; 2], run: &Run) -> Result<Netlist, NgspiceError> {
        self.netlist_from(&self.start(), source, initial, run)
    }

    /// The netlist of a run that begins with other voltages: those at the end of an earlier one.
    pub(super) fn netlist_from(
        &self,
        start: &Start,
        source: CapacitanceSource,
        initial: [f64; 2],
        run: &Run,
    ) -> Result<Netlist, NgspiceError> {
        let circuit = match self.circuit.topology {
            Topology::SharedNode => template!("shared_node.cir"),
            Topology::Isolated => template!("isolated.cir"),
        };
        let [left, right] = start.membranes;
        let values = run.values(source, self.circuit.supply_voltage, initial, self.vectors())?;
        let values = values.number("start_left", left).number("start_right", right).number("start_out", start.load);
        let values = self.device_values(values);
        let release = match (self.circuit.topology, self.circuit.release) {
            (Topology::SharedNode, Release::Zener) => template!("zener_shared.cir"),
            (Topology::SharedNode, Release::Switch) => template!("switch_shared.cir"),
            (Topology::SharedNode, Release::Storage) => template!("storage_shared.cir"),
            (Topology::Isolated, Release::Zener) => template!("zener_isolated.cir"),
            (Topology::Isolated, Release::Switch) => template!("switch_isolated.cir"),
            (Topology::Isolated, Release::Storage) => template!("storage_isolated.cir"),
        };
        let leakage = match self.circuit.topology {
            _ if !self.circuit.leaks() => "",
            Topology::SharedNode => template!("leakage_shared.cir"),
            Topology::Isolated => template!("leakage_isolated.cir"),
        };
        let (release, models) = (values.render(&[release, leakage].concat())?, values.render(template!("models.cir"))?);
        values.part("release", &release).part("models", &models).render(circuit)
    }

    /// The one place where parameters of the embedded model meet those of ngspice's model cards; see the table in
    /// `ngspice_netlists/README.md`.
    fn device_values(&self, values: Values) -> Values {
        /// 0 degrees Celsius, K: ngspice takes Celsius.
        const ZERO_CELSIUS: f64 = 273.15;
        let (release, diode) = (self.circuit.release_voltage(), &self.diode);
        values
            .number("supply_voltage", self.circuit.supply_voltage)
            .number("load_resistance", self.resistance())
            .number("zener_voltage", release)
            .number("storage_voltage", release)
            .number("leakage_time_constant", self.circuit.leakage_time_constant)
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

/// What an element of a circuit is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Energy from it is a cost.
    Supply,
    /// Energy into it is a gain.
    Load,
    /// Release elements that burn their voltage.
    Zener,
    /// Diodes and all other elements.
    Diode,
    /// Leakage of the films.
    Leakage,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 5] = [Self::Supply, Self::Load, Self::Zener, Self::Diode, Self::Leakage];
}

/// Voltages at the beginning of a run, V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ngspice::CapacitorTest;

    #[test]
    fn every_circuit_has_a_netlist_without_placeholders_and_with_all_it_saves() {
        let run = Run::new(0.1, 1.4);
        let is_complete = |text: &str| !text.contains(['<', '>']) && text.ends_with(".end\n");
        for topology in [Topology::SharedNode, Topology::Isolated] {
            for (release, leakage_time_constant) in
                [Release::Zener, Release::Switch, Release::Storage].into_iter().flat_map(|it| [(it, 0.0), (it, 0.5)])
            {
                let parameters = Parameters { topology, release, leakage_time_constant, ..Parameters::default() };
                let elements = Elements::new(&parameters, 1.4).unwrap();
                for source in [CapacitanceSource::Table, CapacitanceSource::External] {
                    let netlist = elements.netlist(source, [15e-12; 2], &run).unwrap();
                    let text = netlist.text();
                    assert!(is_complete(text), "{text}");
                    assert_eq!(text.contains("5e-1*V("), leakage_time_constant > 0.0, "{text}");
                    // A program that has loaded ngspice gives the commands and takes the vectors itself.
                    let by_itself = source == CapacitanceSource::Table;
                    assert_eq!(text.contains(".control"), by_itself);
                    assert_eq!(text.contains(&elements.vectors().join(" ")), by_itself);
                }
            }
        }
        for test in
            [CapacitorTest::Isolated, CapacitorTest::ConstantVoltage, CapacitorTest::Discharge { resistance: 1e9 }]
        {
            let netlist = test.netlist(2000.0, [15e-12; 2], &run).unwrap();
            assert!(is_complete(netlist.text()), "{}", netlist.text());
        }
        let run = Run { max_step: f64::NAN, ..run };
        let elements = Elements::new(&Parameters::default(), 1.4).unwrap();
        let error = elements.netlist(CapacitanceSource::Table, [15e-12; 2], &run).unwrap_err().to_string();
        assert!(error.contains("max_step = NaN"), "{error}");
    }

    #[test]
    fn a_circuit_that_ngspice_cannot_have_is_named_with_its_bound() {
        let load = |load_resistance| Parameters { load_resistance, ..Parameters::default() };
        let storage = Parameters { release: Release::Storage, ..load(f64::INFINITY) };
        assert!(Elements::new(&storage, 1.4).is_ok(), "a storage has no load resistance");
        for (parameters, expected) in [
            (load(0.0), "load.resistance = 0: ngspice takes"),
            (load(f64::INFINITY), "load.resistance = inf: ngspice takes"),
            (load(f64::NAN), "load.resistance = NaN"),
            (Parameters { zener_voltage: 1.0, ..load(1e9) }, "zener.voltage = 1 V"),
            (Parameters { storage_voltage: 1999.0, ..storage }, "storage.voltage = 1999"),
        ] {
            let error = Elements::new(&parameters, 1.4).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
