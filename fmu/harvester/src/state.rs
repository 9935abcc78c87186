//! The state of the slave as bytes. The envelope around them (version, GUID, checksum) is the exporter's.

use fmu_export::{StateError, StateReader, StateWriter};
use videg_model::{
    Changes, ContactLaw, ContactState, Harvester as Model, NoiseModel, OutsideGap, Parameters, Phase, Point, Pulse,
    PulseChange, Ramp, Side, Snapshot, Start, Totals, Works,
};

use crate::harvester::Harvester;

impl Harvester {
    /// Parameters, inputs and, once it has a state of its own, the model.
    pub(crate) fn write(&self, out: &mut StateWriter) {
        write_parameters(&self.parameters, out);
        write_all([self.external_force, self.external_force_rate], out);
        write_all(self.voltages, out);
        write_all(self.voltage_rates, out);
        out.f64(self.start_time);
        out.bool(self.placed);
        // Otherwise it follows from the parameters; if they have changed since it was made, it is made anew anyway.
        let model = self.model().filter(|model| *model.parameters() == self.parameters);
        out.bool(model.is_some());
        if let Some(model) = model {
            write_snapshot(&model.snapshot(), out);
        }
    }

    /// What [`Harvester::write`] wrote.
    pub(crate) fn read_from(from: &mut StateReader<'_>) -> Result<Self, StateError> {
        let parameters = read_parameters(from)?;
        let [external_force, external_force_rate] = finite(from)?;
        let (voltages, voltage_rates) = (finite(from)?, finite(from)?);
        let [start_time] = finite(from)?;
        let placed = from.bool()?;
        let mut slave = Self {
            parameters,
            external_force,
            external_force_rate,
            voltages,
            voltage_rates,
            start_time,
            placed,
            checked: [f64::NAN; 2],
            model: Model::new(&Parameters::default(), 0.0),
        };
        slave.model = if from.bool()? {
            let snapshot = read_snapshot(from)?;
            let restore = if placed { Model::restore_placed } else { Model::restore };
            let restored = restore(&parameters, &snapshot);
            Ok(restored.map_err(|error| StateError::Invalid(error.to_string()))?)
        } else {
            slave.at_start()
        };
        Ok(slave)
    }
}

fn write_parameters(parameters: &Parameters, out: &mut StateWriter) {
    for quantity in Parameters::TABLE {
        out.f64((quantity.get)(parameters));
    }
    out.i32(parameters.seed);
    out.bool(parameters.noise_model == NoiseModel::Wiener);
    out.bool(parameters.outside_gap == OutsideGap::Free);
    out.bool(parameters.contact_law == ContactLaw::Compliant);
    out.bool(parameters.reaction);
    out.bool(parameters.electrostatic_feedback);
}

fn read_parameters(from: &mut StateReader<'_>) -> Result<Parameters, StateError> {
    let mut parameters = Parameters::default();
    for quantity in Parameters::TABLE {
        (quantity.set)(&mut parameters, from.f64()?);
    }
    parameters.seed = from.i32()?;
    parameters.noise_model = if from.bool()? { NoiseModel::Wiener } else { NoiseModel::Held };
    parameters.outside_gap = if from.bool()? { OutsideGap::Free } else { OutsideGap::Project };
    parameters.contact_law = if from.bool()? { ContactLaw::Compliant } else { ContactLaw::Impulsive };
    parameters.reaction = from.bool()?;
    parameters.electrostatic_feedback = from.bool()?;
    Ok(parameters)
}

fn write_snapshot(snapshot: &Snapshot, out: &mut StateWriter) {
    out.f64(snapshot.time);
    write_start(snapshot.cylinder, out);
    write_all([snapshot.external, snapshot.external_rate], out);
    write_start(snapshot.ball, out);
    write_start(snapshot.relative, out);
    write_side(snapshot.resting, out);
    out.u64(snapshot.noise_sample);
    out.f64(snapshot.noise_walk);
    for pulses in &snapshot.pulses {
        out.len(pulses.len());
        for pulse in pulses {
            let PulseChange { start, speed, peak } = pulse.change;
            write_all([pulse.start, pulse.speed, pulse.peak, start, speed, peak], out);
        }
    }
    write_contact(snapshot.contact.as_ref(), out);
    snapshot.voltages.iter().for_each(|Ramp { start, value, rate }| write_all([*start, *value, *rate], out));
    let totals = &snapshot.totals;
    for count in [totals.impacts, totals.chatters, totals.releases] {
        out.u64(count);
    }
    write_all([totals.last_speed, totals.voltage_gain, totals.energy], out);
    let Works { wall, electrical, loss, contact_time } = snapshot.works;
    write_all([wall, electrical, loss, contact_time], out);
    out.bool(snapshot.changes.is_some());
    if let Some(Changes { since, displacement, rate, last_speed, voltage_gain, energy, wall, loss }) = snapshot.changes
    {
        write_all([since, displacement, rate, last_speed, voltage_gain, energy, wall, loss], out);
    }
    out.f64(snapshot.second);
    out.u64(snapshot.second_events);
}

/// Fields are read in the order in which they stand here.
fn read_snapshot(from: &mut StateReader<'_>) -> Result<Snapshot, StateError> {
    Ok(Snapshot {
        time: from.f64()?,
        cylinder: read_start(from)?,
        external: from.f64()?,
        external_rate: from.f64()?,
        ball: read_start(from)?,
        relative: read_start(from)?,
        resting: read_side(from)?,
        noise_sample: from.u64()?,
        noise_walk: from.f64()?,
        pulses: [read_pulses(from)?, read_pulses(from)?],
        contact: read_contact(from)?,
        voltages: [read_ramp(from)?, read_ramp(from)?],
        totals: Totals {
            impacts: from.u64()?,
            chatters: from.u64()?,
            releases: from.u64()?,
            last_speed: from.f64()?,
            voltage_gain: from.f64()?,
            energy: from.f64()?,
        },
        works: Works { wall: from.f64()?, electrical: from.f64()?, loss: from.f64()?, contact_time: from.f64()? },
        changes: if from.bool()? { Some(read_changes(from)?) } else { None },
        second: from.f64()?,
        second_events: from.u64()?,
    })
}

fn read_changes(from: &mut StateReader<'_>) -> Result<Changes, StateError> {
    let [since, displacement, rate, last_speed, voltage_gain, energy, wall, loss] = array(from)?;
    Ok(Changes { since, displacement, rate, last_speed, voltage_gain, energy, wall, loss })
}

fn write_start(Start { time, position, velocity }: Start, out: &mut StateWriter) {
    write_all([time, position, velocity], out);
}

fn read_start(from: &mut StateReader<'_>) -> Result<Start, StateError> {
    let [time, position, velocity] = array(from)?;
    Ok(Start { time, position, velocity })
}

fn read_ramp(from: &mut StateReader<'_>) -> Result<Ramp, StateError> {
    let [start, value, rate] = array(from)?;
    Ok(Ramp { start, value, rate })
}

fn write_side(side: Option<Side>, out: &mut StateWriter) {
    out.u8(side.map_or(0, |side| if side == Side::Left { 1 } else { 2 }));
}

fn read_side(from: &mut StateReader<'_>) -> Result<Option<Side>, StateError> {
    match from.u8()? {
        0 => Ok(None),
        1 => Ok(Some(Side::Left)),
        2 => Ok(Some(Side::Right)),
        other => Err(StateError::Invalid(format!("{other} is no side"))),
    }
}

/// The branches of the membrane's force, in the order of their numbers in the state.
const PHASES: [Phase; 3] = [Phase::Loading, Phase::Unloading, Phase::Held];

fn write_contact(contact: Option<&ContactState>, out: &mut StateWriter) {
    write_side(contact.map(|contact| contact.side), out);
    let Some(ContactState { phase, since, largest, start, credited, proposal, .. }) = contact else { return };
    out.u8(match phase {
        Phase::Loading => 0,
        Phase::Unloading => 1,
        Phase::Held => 2,
    });
    write_all([*since, *largest, *credited, *proposal], out);
    write_all([start.time, start.x, start.v], out);
}

fn read_contact(from: &mut StateReader<'_>) -> Result<Option<ContactState>, StateError> {
    let Some(side) = read_side(from)? else { return Ok(None) };
    let number = from.u8()?;
    let phase = PHASES.get(usize::from(number)).copied();
    let phase = phase.ok_or_else(|| StateError::Invalid(format!("{number} is no branch of the force")))?;
    let [since, largest, credited, proposal] = array(from)?;
    let [time, x, v] = array(from)?;
    Ok(Some(ContactState { side, phase, since, largest, start: Point { time, x, v }, credited, proposal }))
}

fn read_pulses(from: &mut StateReader<'_>) -> Result<Vec<Pulse>, StateError> {
    let count = from.len(6 * size_of::<f64>())?;
    (0..count).map(|_| array(from).map(pulse)).collect()
}

fn pulse([start, speed, peak, by_start, by_speed, by_peak]: [f64; 6]) -> Pulse {
    Pulse { start, speed, peak, change: PulseChange { start: by_start, speed: by_speed, peak: by_peak } }
}

fn write_all<const N: usize>(values: [f64; N], out: &mut StateWriter) {
    for value in values {
        out.f64(value);
    }
}

fn array<const N: usize>(from: &mut StateReader<'_>) -> Result<[f64; N], StateError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = from.f64()?;
    }
    Ok(values)
}

/// Values that no Set lets become infinite or NaN.
fn finite<const N: usize>(from: &mut StateReader<'_>) -> Result<[f64; N], StateError> {
    let values = array(from)?;
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(StateError::Invalid(format!("an input or the start time is {value}"))),
        None => Ok(values),
    }
}
