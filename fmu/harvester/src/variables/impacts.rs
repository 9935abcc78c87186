//! The rows about impacts: how many there were, when the next is, what they gained, and what FMI 3.0 tells of each.

use fmu_export::{EnumerationType, IntegerWidth};
use videg_model::Side;

use super::initial::{FILM, FORCE_LAW, IMPACT, OPTIONS};
use super::{FORCE, V, VOLTAGES, change};
use crate::harvester::Predicted;

/// What the predicted times depend on.
const PREDICTED_FROM: [&str; 7] =
    ["cylinder.position", "cylinder.velocity", "ball.position", "ball.velocity", FORCE, VOLTAGES[0], VOLTAGES[1]];

/// Counts, predictions and gains.
pub(super) static EVENTS: [V; 8] = [
    V::integer_output("impact.count", "Number of impacts since the start; the endless tail of a chattering end is not counted")
        .width(IntegerWidth::UInt64)
        .local()
        .get(|slave| slave.model().map_or(0, |model| as_count(model.totals().impacts))),
    V::output("impact.lastVelocity", "m/s", "abs(v_m - v_M) before the last impact, Eq. (10); 0 before the first")
        .discrete()
        .depends_on(&[])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(last_speed))
        .get(|slave| slave.read(|model| model.totals().last_speed)),
    V::output(
        "impact.nextTime",
        "s",
        "Time of the next impact while externalForce goes on as it is set; of a ball that rests, after its release. The largest double during a contact that lasts, and if none is predicted up to pulse.knownUntil, which is one period ahead (on a suspension a million pieces of its power series if these are shorter; with phase noise 512 hold intervals if these are shorter, or the present one if it is a Wiener process, contacts last or hold intervals are longer than a fiftieth of a period)",
    )
    .discrete()
    .depends_on(&PREDICTED_FROM)
    .initially_depends_on(&[IMPACT, &[FORCE]])
    .partial_derivative(|slave, known| slave.partial(known, |change| change.next(0, |it| it.next_impact)))
        .get(|slave| slave.predicted(Predicted::NextImpact)),
    V::output(
        "pulse.nextKnot",
        "s",
        "Next time at which a capacitance has a kink or an extremum (impact, peak or end of a pulse, or another one that overlaps it becomes larger), a resting ball is released or a contact that lasts changes, while the inputs go on as they are set; the largest double if none is predicted",
    )
    .discrete()
    .depends_on(&PREDICTED_FROM)
    .initially_depends_on(&[IMPACT, &[FORCE], FILM, FORCE_LAW, OPTIONS, &VOLTAGES])
    .partial_derivative(|slave, known| slave.partial(known, |change| change.next(1, |it| it.next_knot)))
        .get(|slave| slave.predicted(Predicted::NextKnot)),
    V::output("gain.voltage", "V", "Sum of U_DE4 - U_in over all impacts, Eqs. (12) and (15)")
        .discrete()
        .depends_on(&[])
        .initially_depends_on(&[IMPACT, FILM, FORCE_LAW, &["biasVoltage"]])
        .partial_derivative(change!(voltage_gain))
        .get(|slave| slave.read(|model| model.totals().voltage_gain)),
    V::output("gain.energyEq13", "J", "Sum of W over all impacts, Eqs. (13) and (14)")
        .discrete()
        .nominal(1e-6)
        .depends_on(&[])
        .initially_depends_on(&[IMPACT, FILM, FORCE_LAW, &["biasVoltage"]])
        .partial_derivative(change!(energy))
        .get(|slave| slave.read(|model| model.totals().energy)),
    V::boolean_output("contact.resting", "The ball rests on a membrane, pressed by the acceleration of the cylinder")
        .local()
        .get(|slave| slave.model().is_some_and(|model| model.resting().is_some())),
    V::integer_output("solver.events", "Number of events computed since the start: impacts and releases")
        .width(IntegerWidth::UInt64)
        .local()
        .get(|slave| slave.model().map_or(0, |model| as_count(model.totals().events()))),
];

/// Twins of variables that are no Reals. Many importers read every output as a Real, and connect nothing else: so these are the
/// outputs, and the variables of the types that fit are local.
pub(super) static TWINS: [V; 2] = [
    V::output("impact.countReal", "1", "impact.count as a Real, for connections and tools that read Reals alone")
        .discrete()
        .depends_on(&[])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(|slave, known| slave.partial(known, |_| 0.0))
        .get(|slave| slave.model().map_or(0.0, |model| as_real(model.totals().impacts))),
    V::output(
        "contact.restingReal",
        "1",
        "contact.resting as a Real, for connections and tools that read Reals alone: 1 or 0",
    )
    .discrete()
    .depends_on(&[])
    .initially_depends_on(&[IMPACT])
    .partial_derivative(|slave, known| slave.partial(known, |_| 0.0))
    .get(|slave| slave.model().map_or(0.0, |model| f64::from(u8::from(model.resting().is_some())))),
];

/// What the last impact left of the speed.
pub(super) static EFFECTIVE_RESTITUTION: [V; 1] = [V::output(
    "impact.effectiveRestitution",
    "1",
    "Rebound speed over impact speed of the last impact that is over: membrane.restitution under the impulsive law, under the compliant law that of the contact, of wall and viscous film; 0 before the first",
)
.discrete()
.depends_on(&[])
.initially_depends_on(&[IMPACT])
.partial_derivative(change!(rebound))
.get(|slave| slave.read(videg_model::Harvester::effective_restitution))];

/// The name of the clock of impacts.
const CLOCK: &str = "impact.clock";

static IMPACT_SIDE: EnumerationType = EnumerationType {
    name: "ImpactSide",
    description: "Membrane that the ball hits",
    items: &[("none", "No impact yet"), ("left", "The left one"), ("right", "The right one")],
};

/// Impacts as FMI 3.0 tells of them.
pub(super) static IMPACTS: [V; 4] = [
    V::output_clock(CLOCK, "Ticks at each impact; under the compliant law at the begin of each contact")
        .depends_on(&[])
        .get(|slave| slave.has_hit),
    V::enumeration_output("impact.side", &IMPACT_SIDE, "Membrane that the ball hits")
        .clocked_by(&[CLOCK])
        .depends_on(&[CLOCK])
        .get(|slave| slave.last_impact.map_or(1, |(side, _)| if side == Side::Left { 2 } else { 3 })),
    V::output("impact.speed", "m/s", "abs(v_m - v_M) before the impact, Eq. (10)")
        .discrete()
        .clocked_by(&[CLOCK])
        .depends_on(&[CLOCK])
        .partial_derivative(change!(last_speed))
        .get(|slave| slave.last_impact.map_or(0.0, |(_, speed)| speed)),
    V::output("impact.energy", "J", "W: energy gain of the impact, Eq. (13) at the deflection of Eq. (10)")
        .discrete()
        .clocked_by(&[CLOCK])
        .depends_on(&[CLOCK])
        .nominal(1e-6)
        .partial_derivative(|slave, known| {
            slave.partial(known, |change| change.shown(|changes| changes.last_speed)) * slave.energy_slope()
        })
        .get(|slave| slave.last_impact.map_or(0.0, |(_, speed)| slave.impact_energy(speed))),
];

/// How far the predictions reach.
pub(super) static KNOWN: [V; 1] = [V::output(
    "pulse.knownUntil",
    "s",
    "Time up to which impact.nextTime and pulse.nextKnot know all that comes while the inputs go on as they are set: a master that goes no further passes over nothing",
)
.discrete()
.local()
.get(|slave| slave.predicted(Predicted::KnownUntil))];

/// A count as an Integer.
fn as_count(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

/// A count as a Real: exact up to 2^53, which no run reaches.
#[allow(clippy::cast_precision_loss)]
const fn as_real(count: u64) -> f64 {
    count as f64
}
