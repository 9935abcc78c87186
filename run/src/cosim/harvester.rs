//! The harvester FMU as the master sees it.

use super::CosimError;
use super::balance::ENERGIES;
use super::instance::{SavedState, begin, read, references};
use crate::scenario::{Scenario, Setting};
use fmu_import::{Causality, Fmu, Instance, Logging, Status, Value, Variable};
use videg_model::Parameters;

/// Real outputs that the master reads at each communication point, in the order of [`HarvesterSample`]'s columns.
const REALS: [&str; 17] = [
    "left.capacitance",
    "right.capacitance",
    "left.deflection",
    "right.deflection",
    "left.areaRatio",
    "right.areaRatio",
    "cylinder.position",
    "cylinder.velocity",
    "ball.position",
    "ball.velocity",
    "relativeDisplacement",
    "impact.lastVelocity",
    "gain.voltage",
    "gain.energyEq13",
    "impact.nextTime",
    "pulse.nextKnot",
    "pulse.knownUntil",
];

/// How many of them make a row of a time series: all but the three that look ahead.
const RECORDED: usize = 14;

/// Integral of 1/2 U^2 dC so far, J: work of the force of the connected voltages on the ball. Only a harvester on which
/// voltages act has it.
const ELECTRICAL_WORK: &str = "energy.electrical";

/// Outputs of the harvester at one communication point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarvesterSample([f64; REALS.len()]);

impl HarvesterSample {
    /// Names of [`HarvesterSample::columns`]: variables of the FMU.
    pub fn names() -> &'static [&'static str] {
        &REALS[..RECORDED]
    }

    /// The values of a row of the time series.
    pub fn columns(&self) -> &[f64] {
        &self.0[..RECORDED]
    }

    /// Capacitances of the membranes, left and right, F.
    pub fn capacitance(&self) -> [f64; 2] {
        [self.0[0], self.0[1]]
    }

    /// Deflections of the membranes, left and right, m.
    pub fn deflection(&self) -> [f64; 2] {
        [self.0[2], self.0[3]]
    }

    /// `z_M` - `z_m`, m.
    pub fn relative_displacement(&self) -> f64 {
        self.0[10]
    }

    /// Sum of `U_DE4` - `U_in` so far, V.
    pub fn voltage_gain(&self) -> f64 {
        self.0[12]
    }

    /// Sum of W, Eq. (13), so far, J.
    pub fn energy_eq13(&self) -> f64 {
        self.0[13]
    }

    /// Next time at which a capacitance has a kink or an extremum, or at which the ball hits a membrane, s.
    pub fn next_knot(&self) -> f64 {
        self.0[14].min(self.0[15])
    }

    /// Time, s, up to which the next knot is known: none comes before it that is not announced.
    pub fn known_until(&self) -> f64 {
        self.0[16]
    }
}

/// The FMU `VibroImpactHarvester`, initialised for a scenario.
pub struct HarvesterFmu {
    instance: Instance,
    reals: [u32; REALS.len()],
    counts: [u32; 2],
    voltages: [u32; 2],
    bias_voltage: f64,
    feedback: Option<Feedback>,
    /// References of the mechanical energies, if the FMU has them.
    energies: Option<[u32; ENERGIES.len()]>,
    saved: SavedState,
}

/// How voltages act on a harvester with `contact.electrostaticFeedback`.
#[derive(Debug, Clone, Copy)]
struct Feedback {
    /// The voltages may be given with their first derivatives.
    takes_rates: bool,
    /// Reference of the electrical work, if the FMU sums it up.
    work: Option<[u32; 1]>,
}

/// An instance of the harvester in `fmu`, initialised with `settings` for a run from 0 s to `stop`, s.
///
/// # Errors
/// A setting that the FMU refuses.
pub fn instantiate(fmu: &Fmu, stop: Option<f64>, settings: &[Setting]) -> Result<Instance, CosimError> {
    let mut settings = settings.to_vec();
    let like = |bias: &Setting, name: &str| Some(Setting { name: name.to_owned(), ..bias.clone() });
    set_voltages(&mut settings, |setting| &setting.name, like);
    let mut instance = begin(fmu, "harvester", stop, &settings, Setting::value_for_fmu)?;
    instance.exit_initialization_mode()?;
    Ok(instance)
}

/// Voltages of the membranes, which are inputs.
const VOLTAGES: [&str; 2] = ["left.voltage", "right.voltage"];

/// Adds the voltages of the membranes to settings that give the voltage of the supply but not these: so the model has them where no
/// circuit gives them another. `name` is that of a setting, `like` one that sets another variable to the same, if it can be set.
pub fn set_voltages<T>(settings: &mut Vec<T>, name: impl Fn(&T) -> &str, like: impl Fn(&T, &'static str) -> Option<T>) {
    let Some(bias) = settings.iter().rposition(|setting| name(setting) == "biasVoltage") else { return };
    for voltage in VOLTAGES {
        if settings.iter().all(|setting| name(setting) != voltage) {
            settings.extend(like(&settings[bias], voltage));
        }
    }
}

impl HarvesterFmu {
    /// Instantiates `fmu` and initialises it with `settings`, from 0 s on.
    ///
    /// # Errors
    /// A setting that the FMU refuses, or an FMU that lacks a variable.
    pub fn new(fmu: &Fmu, scenario: &Scenario, settings: &[Setting]) -> Result<Self, CosimError> {
        let instance = instantiate(fmu, Some(scenario.until), settings)?;
        let reals = references(fmu, REALS)?;
        let counts = references(fmu, ["impact.count", "solver.events"])?;
        let voltages = references(fmu, VOLTAGES)?;
        let bias = references(fmu, ["biasVoltage"])?;
        let [bias_voltage] = read(&instance, &bias)?;
        let feedback = Feedback::of(fmu, &instance, &voltages)?;
        let (energies, saved) = (references(fmu, ENERGIES).ok(), SavedState::default());
        Ok(Self { instance, reals, counts, voltages, bias_voltage, feedback, energies, saved })
    }

    /// Values of all parameters, in the order of the FMU.
    pub(super) fn settings(&self) -> Vec<(&Variable, Value)> {
        let variables = self.instance.description().variables.iter();
        let parameters = variables.filter(|variable| variable.causality == Causality::Parameter);
        parameters.filter_map(|it| Some((it, self.instance.get_by_name(&it.name).ok()?))).collect()
    }

    /// The parameters, and the file of the recording; none if the FMU lacks one of them or has another type for it.
    pub(super) fn parameters(&self) -> Option<(Parameters, String)> {
        let mut parameters = Parameters::default();
        for quantity in Parameters::TABLE {
            let Ok(Value::Real(value)) = self.instance.get_by_name(quantity.name) else { return None };
            (quantity.set)(&mut parameters, value);
        }
        for choice in Parameters::CHOICES {
            let value = match self.instance.get_by_name(choice.name).ok()? {
                Value::Integer(value) | Value::Enumeration { value, .. } => value,
                Value::Boolean(on) => i32::from(on),
                _ => return None,
            };
            (choice.set)(&mut parameters, value);
        }
        let Ok(Value::String(file)) = self.instance.get_by_name("excitation.file") else { return None };
        Some((parameters, file))
    }

    /// Warnings of the FMU so far.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let messages = self.instance.messages().into_iter();
        messages.filter(|record| record.status == Status::Warning).map(|record| record.message).collect()
    }

    /// Steps from `time` by `step`, s.
    pub fn step(&mut self, time: f64, step: f64) -> Result<(), CosimError> {
        Ok(self.instance.do_step(time, step)?)
    }

    /// Connects the membranes to `voltage` (left, right), V, from the communication point on.
    pub(super) fn set_voltage(&mut self, voltage: [f64; 2]) -> Result<(), CosimError> {
        Ok(self.instance.set_real(&self.voltages, &voltage)?)
    }

    /// Sets the rate (left, right), V/s, of the voltages over the next step.
    pub(super) fn set_voltage_rate(&mut self, rate: [f64; 2]) -> Result<(), CosimError> {
        Ok(self.instance.set_real_input_derivatives(&self.voltages, &[1, 1], &rate)?)
    }

    /// Whether the voltages act on the ball.
    pub(super) fn feels_voltage(&self) -> bool {
        self.feedback.is_some()
    }

    /// Whether [`HarvesterFmu::set_voltage_rate`] works and is of use.
    pub(super) fn takes_voltage_rates(&self) -> bool {
        self.feedback.is_some_and(|feedback| feedback.takes_rates)
    }

    /// Energy that the mechanics gave to the membranes so far, J, as the harvester sums it up; none if it does not.
    pub(super) fn electrical_work(&self) -> Result<Option<f64>, CosimError> {
        let work = self.feedback.and_then(|feedback| feedback.work);
        work.map(|reference| read(&self.instance, &reference).map(|[work]| -work)).transpose()
    }

    /// Values of [`ENERGIES`], if the harvester has them.
    pub(super) fn energies(&self) -> Result<Option<[f64; ENERGIES.len()]>, CosimError> {
        self.energies.map(|references| read(&self.instance, &references)).transpose()
    }

    /// dC/dt of the membranes, left and right, F/s, at the communication point.
    pub(super) fn capacitance_rate(&self) -> Result<[f64; 2], CosimError> {
        let mut rate = [0.0; 2];
        self.instance.get_real_output_derivatives(&self.reals[..2], &[1, 1], &mut rate)?;
        Ok(rate)
    }

    /// Saves the state in place of the one before.
    pub(super) fn save(&mut self) -> Result<(), CosimError> {
        self.saved.save(&self.instance)
    }

    /// Goes back to the state saved.
    pub(super) fn restore(&mut self) -> Result<(), CosimError> {
        self.saved.restore(&mut self.instance)
    }

    /// References to Real variables.
    pub(crate) fn references(&self, names: &[String]) -> Result<Vec<u32>, CosimError> {
        let description = self.instance.description();
        names.iter().map(|name| Ok(description.variable(name)?.value_reference)).collect()
    }

    /// Value of any variable at the communication point.
    pub(crate) fn value(&self, name: &str) -> Result<Value, CosimError> {
        Ok(self.instance.get_by_name(name)?)
    }

    /// Reads Real variables at the communication point.
    pub(crate) fn read(&self, references: &[u32], values: &mut [f64]) -> Result<(), CosimError> {
        Ok(self.instance.get_real(references, values)?)
    }

    /// Outputs at the communication point.
    pub fn sample(&self) -> Result<HarvesterSample, CosimError> {
        read(&self.instance, &self.reals).map(HarvesterSample)
    }

    /// Capacitances at the communication point, left and right, F: without what is predicted, which takes longer.
    pub(super) fn capacitance(&self) -> Result<[f64; 2], CosimError> {
        let mut capacitance = [0.0; 2];
        self.instance.get_real(&self.reals[..2], &mut capacitance)?;
        Ok(capacitance)
    }

    /// Impacts, and events computed, so far.
    pub fn counts(&self) -> Result<[i32; 2], CosimError> {
        let mut counts = [0; 2];
        self.instance.get_integer(&self.counts, &mut counts)?;
        Ok(counts)
    }

    /// `U_in`, V.
    pub fn bias_voltage(&self) -> f64 {
        self.bias_voltage
    }

    /// Ends the run.
    pub(super) fn terminate(&mut self) -> Result<(), CosimError> {
        Ok(self.instance.terminate()?)
    }
}

impl Feedback {
    /// None for a harvester that feels no voltage. FMI 2.0 declares input derivatives for an FMU, not for a variable. So a
    /// second instance tries those of `voltages`: a refusal would end a run.
    fn of(fmu: &Fmu, instance: &Instance, voltages: &[u32]) -> Result<Option<Self>, CosimError> {
        let mut on = [false];
        instance.get_boolean(&references(fmu, ["contact.electrostaticFeedback"])?, &mut on)?;
        if !on[0] {
            return Ok(None);
        }
        let mut trial = fmu.instantiate("trial", Logging::default())?;
        let takes_rates = trial.set_real_input_derivatives(voltages, &[1, 1], &[0.0, 0.0]).is_ok();
        let work = references(fmu, [ELECTRICAL_WORK]).ok();
        Ok(Some(Self { takes_rates, work }))
    }
}
