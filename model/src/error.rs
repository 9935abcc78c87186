//! What the model refuses, with the thing, its value and its bound in each message.

use crate::points::PointFault;

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
    /// A point of a recording, or of a measured membrane, that is none.
    #[error("point {index} (from 0) of the {what}: {fault}")]
    Point {
        /// Number of the point, from 0.
        index: usize,
        /// What it is a point of.
        what: &'static str,
        /// Why it is none.
        fault: PointFault,
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
    /// A table whose columns differ in length.
    #[error(
        "a table of a membrane has {deflections} deflections and {others} values of another column: each point needs all"
    )]
    TablePairs {
        /// Number of deflections.
        deflections: usize,
        /// Number of values in the other column.
        others: usize,
    },
    /// A table with too few or too many points.
    #[error("a table of a membrane has {count} points: at least {min}, at most {max}")]
    TableCount {
        /// Number of points.
        count: usize,
        /// Least number allowed.
        min: usize,
        /// Largest number allowed.
        max: usize,
    },
    /// No table where one is asked for.
    #[error(
        "membrane.law = table needs a table of deflection and force: set membrane.file; allowed without: power, gent, ogden"
    )]
    NoTable,
    /// A table of deflections that no film stands.
    #[error(
        "membrane.file: the last deflection is {end} m; at most {most} m, 20 times the radius of the membrane of {radius} m, are \
         taken; deflections are in m"
    )]
    TableDepth {
        /// m.
        end: f64,
        /// m.
        most: f64,
        /// `R_2`, m.
        radius: f64,
    },
    /// A table under another law.
    #[error("a table of the membrane (membrane.file) needs membrane.law = table")]
    UnusedTable,
    /// A Gent film whose pre-stretch is beyond its limit.
    #[error(
        "membrane.stretchLimit = {limit} must be greater than 2 L^2 + L^-4 - 3 = {invariant} at L = membrane.prestretch = \
         {prestretch}: beyond its limit a film cannot be stretched"
    )]
    Locked {
        /// J.
        limit: f64,
        /// lambda.
        prestretch: f64,
        /// Value of the invariant at lambda.
        invariant: f64,
    },
    /// A term of Ogden's law that would push where others pull.
    #[error(
        "{name} = {modulus} Pa must have the sign of its exponent, {exponent}: otherwise the term gives off energy when it is \
         stretched"
    )]
    OgdenSign {
        /// Name of the modulus.
        name: &'static str,
        /// Its value, Pa.
        modulus: f64,
        /// Its exponent.
        exponent: f64,
    },
    /// An Ogden film without a stiffness.
    #[error(
        "the shear modulus of the Ogden film, half the sum of membrane.ogdenModulus times membrane.ogdenExponent, is {modulus} \
         Pa: at least {least:e} Pa"
    )]
    NoStiffness {
        /// The shear modulus, Pa.
        modulus: f64,
        /// Least one allowed, Pa.
        least: f64,
    },
    /// A contact in which the ball has more energy than the film takes up before it is locked.
    #[error(
        "at t = {time} s the ball presses the film in by {deflection} m and is still {speed} m/s fast: at most {bound} m, where the \
         stretch reaches membrane.stretchLimit = {limit}"
    )]
    HitsLimit {
        /// Time, s.
        time: f64,
        /// Deflection, m.
        deflection: f64,
        /// Its rate, m/s.
        speed: f64,
        /// Deflection at which the film is locked, m.
        bound: f64,
        /// J.
        limit: f64,
    },
    /// A Maxwell branch where there is no film, or a contact takes no time.
    #[error(
        "membrane.viscousModulus = {modulus} Pa and membrane.relaxationTime = {time} s need contact.law = compliant and \
         membrane.law = gent or ogden: a viscous film has a material, and its contacts take time; allowed otherwise: 0"
    )]
    NeedsFilm {
        /// `mu_v`, Pa.
        modulus: f64,
        /// tau, s.
        time: f64,
    },
    /// A film that relaxes faster than is followed.
    #[error("membrane.relaxationTime = {time:e} s must be 0 (no viscosity) or at least {least:e} s")]
    TooFast {
        /// tau, s.
        time: f64,
        /// Least one allowed, s.
        least: f64,
    },
    /// A state from a run with another table of the membrane.
    #[error("the snapshot is of a harvester with another table of its membranes, or without one")]
    OtherTable,
    /// A state from a run with another recording.
    #[error("the snapshot is of a harvester with another recording, or without one")]
    OtherRecording,
    /// An impact that the film cannot take up: it would have to be stretched beyond its limit.
    #[error(
        "at t = {time:.3} s the ball meets the membrane at {speed:.3e} m/s with {energy:.3e} J, but up to membrane.stretchLimit \
         the film takes up {most:.3e} J at most"
    )]
    FilmLocked {
        /// Time, s.
        time: f64,
        /// Relative speed, m/s.
        speed: f64,
        /// Energy of the impact, J.
        energy: f64,
        /// Energy that the film takes up at most, J.
        most: f64,
    },
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
