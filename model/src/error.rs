//! What the model refuses, with the thing, its value and its bound in each message.

/// Error of the model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A parameter is not finite or outside its bounds.
    #[error("{name} = {value} {unit} is outside its bounds [{min}, {max}] {unit}")]
    Bounds {
        /// Name of the parameter.
        name: &'static str,
        /// Value given.
        value: f64,
        /// Unit of value and bounds.
        unit: &'static str,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// Two or more parameters contradict each other.
    #[error("{name} = {value} {unit} must be greater than {bound_name} = {bound} {unit}")]
    Order {
        /// Name of the quantity that is too small.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Name of the quantity that it must exceed.
        bound_name: &'static str,
        /// Value of that quantity.
        bound: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// An option that the impulsive law does not have.
    #[error("{name} = true needs contact.law = compliant: {reason}; allowed: false")]
    NeedsCompliantLaw {
        /// Name of the option.
        name: &'static str,
        /// Why.
        reason: &'static str,
    },
    /// Contacts that take time and act back on a suspended cylinder.
    #[error(
        "contact.reaction = true and contact.law = compliant cannot be combined with cylinder.suspensionStiffness or \
         cylinder.suspensionDamping above 0; allowed: contact.law = impulsive, or contact.reaction = false"
    )]
    SuspendedReaction,
    /// A suspension where the motion is prescribed.
    #[error(
        "{name} = {value} {unit} needs excitation.kind = force: a shaker prescribes the motion, whatever holds the cylinder; \
         allowed: 0"
    )]
    NeedsForce {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A suspension that is too fast to be followed.
    #[error(
        "{name} = {value:e} {unit} is too large for cylinder.mass = {mass} kg: {rate:.1e} 1/s, at most {limit} 1/s"
    )]
    TooStiff {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// M, kg.
        mass: f64,
        /// sqrt(k / M) or c / M, 1/s.
        rate: f64,
        /// Its bound, 1/s.
        limit: f64,
    },
    /// A recording whose lists of times and values differ in length.
    #[error("a recording has {times} times and {values} values: each sample needs both")]
    SamplePairs {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A recording with too few or too many samples.
    #[error("a recording has {count} samples: at least {min}, at most {max}")]
    SampleCount {
        /// Number of samples.
        count: usize,
        /// Least number allowed.
        min: usize,
        /// Largest number allowed.
        max: usize,
    },
    /// A sample that is NaN or too large.
    #[error(
        "sample {index} of the recording (from 0): {name} = {value} {unit} is outside [-{bound:e}, {bound:e}] {unit}"
    )]
    Sample {
        /// Number of the sample, from 0.
        index: usize,
        /// `time` or `value`.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// Largest size allowed.
        bound: f64,
    },
    /// A sample that does not come after the one before.
    #[error(
        "sample {index} of the recording (from 0): time = {time} s must be at least {spacing:e} s after that of the sample \
         before, {before} s"
    )]
    SampleOrder {
        /// Number of the sample, from 0.
        index: usize,
        /// Its time, s.
        time: f64,
        /// Time of the one before, s.
        before: f64,
        /// Least difference allowed, s.
        spacing: f64,
    },
    /// A recording of what is not prescribed.
    #[error(
        "the recording is one of {}; allowed with it: excitation.kind = {}",
        if *.is_motion { "acceleration" } else { "force" },
        if *.is_motion { "motion" } else { "force" }
    )]
    RecordingKind {
        /// Whether it is one of acceleration.
        is_motion: bool,
    },
    /// A recording that is repeated, with samples that follow each other too fast.
    #[error(
        "excitation.fileRepeat = true needs a recording with at least {min:e} s from sample to sample on average; this one \
         has {spacing:e} s"
    )]
    RepeatedTooFast {
        /// Mean time between two samples, s.
        spacing: f64,
        /// Least one allowed, s.
        min: f64,
    },
    /// A state from a run with another recording.
    #[error("the snapshot is of a harvester with another recording, or without one")]
    OtherRecording,
    /// A contact under a Maxwell force that goes deeper than any membrane.
    #[error(
        "at t = {time} s the membrane is pressed in by {deflection} m: with contact.electrostaticFeedback, at {voltage} V, \
         at most {bound} m are resolved"
    )]
    TooDeep {
        /// Time, s.
        time: f64,
        /// Deflection, m.
        deflection: f64,
        /// Largest deflection allowed, m.
        bound: f64,
        /// Voltage across the membrane, V.
        voltage: f64,
    },
    /// Differential equations for an importer's integrator exist for the impulsive law only.
    #[error(
        "contact.law = compliant cannot be run by model exchange: co-simulation resolves its contacts; allowed: impulsive"
    )]
    CompliantExchange,
    /// An input or a time is NaN or infinite.
    #[error("{name} = {value} is not a finite number")]
    NotFinite {
        /// Name of the input.
        name: &'static str,
        /// Value given.
        value: f64,
    },
    /// Time was asked to run backwards.
    #[error("time cannot go back from {from} s to {to} s")]
    Backwards {
        /// Present time, s.
        from: f64,
        /// Time asked for, s.
        to: f64,
    },
    /// A snapshot holds what no harvester can have had.
    #[error("the snapshot is no state of this harvester: {name} {value}")]
    Snapshot {
        /// What is impossible.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An integrator has passed over more samples of the phase noise than can be made up for.
    #[error(
        "t = {time} s is more than {limit} hold intervals of excitation.noiseHold = {hold} s after the sample due at \
         {due} s: an importer must stop at nextEventTime"
    )]
    NoiseLag {
        /// Time reached, s.
        time: f64,
        /// When the next sample was due, s.
        due: f64,
        /// Hold intervals allowed.
        limit: f64,
        /// Length of one, s.
        hold: f64,
    },
    /// More events than the budget within one second of simulated time.
    #[error(
        "more than {limit} events within one second up to t = {time} s, with ball.travel = {travel} m and \
         membrane.restitution = {restitution}: the gap is too narrow for the speed, or bounces die away too slowly, \
         or the membrane is too stiff for the ball's mass under the compliant law"
    )]
    TooManyEvents {
        /// Time of the last event, s.
        time: f64,
        /// Events allowed in one second.
        limit: u64,
        /// s, m.
        travel: f64,
        /// r.
        restitution: f64,
    },
}
