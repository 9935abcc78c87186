//! Circuits driven by one run of the harvester, and their mean power.

use videg_circuit::{Ledger, Release, Settings, Topology};
use videg_coupled::Impacts;

use super::{PaperError, Study};
use crate::cosim::{
    CircuitSlave, CosimError, Coupling, EmbeddedCircuit, HarvesterFmu, ImpactLog, Master, Observer, Row,
};
use crate::scenario::{Request, Setting};

/// A run of a case of the paper that drives circuits.
#[derive(Debug, Clone)]
pub struct Drive {
    /// The case.
    pub case: &'static str,
    /// Settings that differ from it.
    pub settings: Vec<Setting>,
    /// Averaging window, s; the run ends with it.
    pub window: [f64; 2],
    /// Largest error of C(t) within a communication step, relative to its value.
    pub tolerance: f64,
}

/// Results of a [`Drive`].
#[derive(Debug, Clone)]
pub struct Driven {
    /// Mean flows in the circuits over the window, W, in their order.
    pub power: Vec<Ledger>,
    /// Highest voltages of the membranes in the window, V, in the order of the circuits.
    pub peaks: Vec<f64>,
    /// Those in the window.
    pub impacts: Impacts,
    /// P, Eq. (14), W, over the window.
    pub eq14: f64,
}

impl Drive {
    /// Runs the harvester with `circuits`; without circuits, for its impacts alone.
    pub fn run(&self, study: &Study<'_>, circuits: &[Settings]) -> Result<Driven, PaperError> {
        let [from, to] = self.window;
        let request = Request {
            case: Some(self.case.to_owned()),
            settings: self.settings.clone(),
            until: Some(to),
            window: Some(self.window),
            ..Request::default()
        };
        let Coupled { master, rest_capacitance, bias_voltage } =
            Coupled::new(study, request, circuits, self.tolerance)?;
        let mut log = ImpactLog::new(bias_voltage);
        let mut recorder = WindowRecorder { from, start: None, peaks: vec![0.0; circuits.len()] };
        let outcome = master.run(&mut [&mut log, &mut recorder])?;
        let ends = recorder.start.iter().flatten().zip(&outcome.circuits);
        let ratios = log.impacts.iter().filter(|impact| impact.time > from).map(|impact| impact.ratio).collect();
        Ok(Driven {
            power: ends.map(|(start, end)| end.ledger.flows_since(start, to - from)).collect(),
            peaks: recorder.peaks,
            impacts: Impacts { ratios, time: to - from, rest_capacitance: rest_capacitance[0], bias_voltage },
            eq14: outcome.mechanics.average_power_eq13,
        })
    }
}

/// The harvester and embedded circuits, ready to run.
pub struct Coupled {
    /// The master.
    pub master: Master,
    /// `C_2` of the membranes, left and right, F.
    pub rest_capacitance: [f64; 2],
    /// `U_in`, V.
    pub bias_voltage: f64,
}

impl Coupled {
    /// Couples what `request` asks for with `circuits`; the largest error of C(t) within a communication step, relative to
    /// its value, is `tolerance`.
    pub fn new(study: &Study<'_>, request: Request, circuits: &[Settings], tolerance: f64) -> Result<Self, PaperError> {
        let scenario = request.resolve()?;
        let harvester = HarvesterFmu::new(study.fmu, &scenario, &scenario.settings)?;
        let rest_capacitance = harvester.sample()?.capacitance();
        let bias_voltage = harvester.bias_voltage();
        let slaves = circuits.iter().map(|settings| -> Result<Box<dyn CircuitSlave>, CosimError> {
            Ok(Box::new(EmbeddedCircuit::new("embedded", settings, rest_capacitance)?))
        });
        let slaves = slaves.collect::<Result<_, _>>()?;
        let coupling = Coupling { tolerance: Some(tolerance), ..Coupling::default() };
        Ok(Self { master: Master::new(harvester, slaves, &scenario, coupling)?, rest_capacitance, bias_voltage })
    }
}

/// A circuit with these values and defaults for the rest.
pub fn circuit(topology: Topology, release: Release, voltage: f64, resistance: f64) -> Settings {
    let mut settings = Settings::default();
    settings.circuit.topology = topology;
    settings.circuit.release = release;
    settings.circuit.zener_voltage = voltage;
    settings.circuit.load_resistance = resistance;
    settings
}

/// Notes the ledgers at the start of the window, and the highest voltages in it.
struct WindowRecorder {
    from: f64,
    start: Option<Vec<Ledger>>,
    peaks: Vec<f64>,
}

impl Observer for WindowRecorder {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        if self.start.is_none() && row.time >= self.from {
            self.start = Some(row.circuits.iter().map(|circuit| circuit.ledger).collect());
        }
        if self.start.is_some() {
            for (peak, circuit) in self.peaks.iter_mut().zip(row.circuits) {
                *peak = circuit.voltage.into_iter().fold(*peak, f64::max);
            }
        }
        Ok(())
    }
}
