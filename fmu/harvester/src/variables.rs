//! The variable table: each name, unit and description stands here once, those of the parameters in the tables of the
//! model.

mod impacts;
mod initial;
mod parameters;

use std::sync::Arc;

use fmu_export::{Variable, concat};
use videg_model::{ForceTable, Recording, Side};

use crate::file::{Content, LONGEST};
use crate::harvester::Harvester;
use impacts::{EFFECTIVE_RESTITUTION, EVENTS, IMPACTS, KNOWN, TWINS};
use initial::{FILM, IMPACT};
use parameters::{choices, reals};

type V = Variable<Harvester>;

/// Inputs by name.
pub(crate) const FORCE: &str = "externalForce";
pub(crate) const VOLTAGES: [&str; 2] = ["left.voltage", "right.voltage"];

/// Partial derivatives that the sensitivities of the model hold.
macro_rules! change {
    ($($path:tt)+) => {
        |slave, known| slave.partial(known, |change| change.shown(|changes| changes.$($path)+))
    };
}
use change;

/// What follows from the parameters.
static CALCULATED: [V; 4] = [
    V::calculated_parameter("membrane.radius", "m", "R_2 = lambda R_1: radius of the membrane in its frame, Table 1")
        .initially_depends_on(&[&["membrane.initialRadius", "membrane.prestretch"]])
        .partial_derivative(|slave, known| {
            slave.partial_by_parameters(known, |p, d| p.prestretch * d.initial_radius + d.prestretch * p.initial_radius)
        })
        .get(|slave| slave.parameters.membrane_radius()),
    V::calculated_parameter("membrane.thickness", "m", "h_2 = h_1 / lambda^2: thickness of the flat membrane, Table 1")
        .initially_depends_on(&[&["membrane.initialThickness", "membrane.prestretch"]])
        .partial_derivative(|slave, known| {
            slave.partial_by_parameters(known, |p, d| {
                let relative = d.initial_thickness / p.initial_thickness - 2.0 * d.prestretch / p.prestretch;
                p.membrane_thickness() * relative
            })
        })
        .get(|slave| slave.parameters.membrane_thickness()),
    V::calculated_parameter("membrane.restCapacitance", "F", "C_2: capacitance of the flat membrane, Eq. (1)")
        .initially_depends_on(&[FILM])
        .partial_derivative(change!(capacitance[0]))
        .get(|slave| slave.read(|model| model.membrane().rest_capacitance())),
    V::calculated_parameter(
        "ball.travel",
        "m",
        "s = d + 2 w - 2 r_b: largest distance that the ball moves, Section 3.2",
    )
    .initially_depends_on(&[&["cylinder.length", "frame.width", "ball.radius"]])
    .partial_derivative(|slave, known| slave.partial_by_parameters(known, |_, d| d.travel()))
    .get(|slave| slave.parameters.travel()),
];

macro_rules! voltage {
    ($index:literal, $which:literal) => {
        V::input(
            VOLTAGES[$index],
            "V",
            2000.0,
            concat!("U_DE: voltage across the ", $which, " membrane; acts with contact.electrostaticFeedback"),
        )
        .input_derivatives(1, |slave, _order, rate| slave.voltage_rates[$index] = rate)
        .access(|slave| slave.voltages[$index], |slave, voltage| slave.voltages[$index] = voltage)
    };
}

static INPUTS: [V; 3] = [
    V::input(FORCE, "N", 0.0, "Force on the cylinder, added to the built-in excitation of Eq. (7); with its first derivative set it runs on over the step and stays at the value reached")
        .input_derivatives(1, |slave, _order, value| slave.external_force_rate = value)
        .access(|slave| slave.external_force, |slave, force| slave.external_force = force),
    voltage!(0, "left"),
    voltage!(1, "right"),
];

// Dependencies, after FMI 2.0.4, section 2.2.8: those "at the current super dense time instant" and "at the current
// Communication Point", on states and inputs. No output depends on an input of the same point, which would make loops of
// connections algebraic, but for the electric fields and the predicted times, which drive nothing, and the force of the mount;
// how the force of a step acts on the outputs at its end is no dependency in this sense, and directional derivatives in co-simulation give
// it all the same.

/// The outputs of the membrane at one side. They depend on time and past impacts only.
macro_rules! membrane_outputs {
    ($side:expr, $which:literal) => {
        [
            V::output(
                concat!($which, ".capacitance"),
                "F",
                concat!("C: capacitance of the ", $which, " membrane, Eq. (1)"),
            )
            .nominal(1e-11)
            .output_derivatives(1, |slave, _order| slave.read(|model| model.capacitance_rate($side)))
            .depends_on(&[])
            .initially_depends_on(&[FILM])
            .partial_derivative(change!(capacitance[$side.index()]))
            .get(|slave| slave.read(|model| model.capacitance($side))),
            V::output(
                concat!($which, ".deflection"),
                "m",
                concat!(
                    "x: deflection of the ",
                    $which,
                    " membrane; under the impulsive law at most delta of Eq. (10)"
                ),
            )
            .nominal(1e-3)
            .output_derivatives(1, |slave, _order| slave.read(|model| model.deflection($side).rate))
            .depends_on(&[])
            .initially_depends_on(&[])
            .partial_derivative(change!(deflection[$side.index()]))
            .get(|slave| slave.read(|model| model.deflection($side).value)),
            V::output(
                concat!($which, ".areaRatio"),
                "1",
                concat!("A_3 / A_2: area of the ", $which, " membrane over its flat area, Eq. (3)"),
            )
            .depends_on(&[])
            .initially_depends_on(&[])
            .partial_derivative(change!(area_ratio[$side.index()]))
            .get(|slave| slave.read(|model| model.membrane().area_ratio(model.deflection($side).value))),
        ]
    };
}

static LEFT: [V; 3] = membrane_outputs!(Side::Left, "left");
static RIGHT: [V; 3] = membrane_outputs!(Side::Right, "right");

/// The continuous states of the motion.
pub(crate) const STATES: [&str; 4] = ["cylinder.position", "cylinder.velocity", "ball.position", "ball.velocity"];

/// One more continuous state, which acts on nothing but the work of the excitation.
pub(crate) const DAMPING: &str = "energy.damping";

/// These states, and what depends on them.
static MOTION: [V; 5] = [
    V::output("cylinder.position", "m", "z_M: position of the cylinder, Eq. (7)")
        .nominal(1e-2)
        .output_derivatives(1, |slave, _order| slave.read(videg_model::Harvester::cylinder_velocity))
        .depends_on(&["cylinder.position"])
        .initially_depends_on(&[&["initial.cylinderPosition"]])
        .partial_derivative(change!(cylinder[0]))
        .get(|slave| slave.read(videg_model::Harvester::cylinder_position)),
    V::output("cylinder.velocity", "m/s", "z_M': velocity of the cylinder, Eq. (7)")
        .nominal(1e-1)
        .reinit()
        .output_derivatives(1, |slave, _order| slave.read(videg_model::Harvester::cylinder_acceleration))
        .depends_on(&["cylinder.velocity"])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(cylinder[1]))
        .get(|slave| slave.read(videg_model::Harvester::cylinder_velocity)),
    V::output("ball.position", "m", "z_m: position of the ball, Section 3.2")
        .nominal(1e-2)
        .reinit()
        .output_derivatives(1, |slave, _order| slave.read(videg_model::Harvester::ball_velocity))
        .depends_on(&["cylinder.position", "ball.position"])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(ball[0]))
        .get(|slave| slave.read(videg_model::Harvester::ball_position)),
    V::output("ball.velocity", "m/s", "z_m': velocity of the ball, Eq. (11)")
        .nominal(1e-1)
        .reinit()
        .depends_on(&["cylinder.velocity", "ball.velocity"])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(ball[1]))
        .get(|slave| slave.read(videg_model::Harvester::ball_velocity)),
    V::output("relativeDisplacement", "m", "z_M - z_m: relative displacement, Eq. (8)")
        .depends_on(&["cylinder.position", "ball.position"])
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(relative_displacement))
        .get(|slave| slave.read(videg_model::Harvester::relative_displacement)),
];

/// Books of the mechanical energy: name, what is read of the model's, typical magnitude, dependencies at a communication point and
/// at the start.
macro_rules! energies {
    ($($name:literal $field:ident $nominal:literal [$($now:literal),*] [$($initially:expr),*] $description:literal;)*) => {
        [$(V::output($name, "J", $description)
            .nominal($nominal)
            .depends_on(&[$($now),*])
            .initially_depends_on(&[$($initially),*])
            .partial_derivative(change!(energies.$field))
            .get(|slave| slave.read(|model| model.energies().$field))),*]
    };
}

static ENERGIES: [V; 7] = energies! {
    "energy.kinetic" ball 1e-4 ["cylinder.velocity", "ball.velocity"] [IMPACT]
        "1/2 m z_m'^2: kinetic energy of the ball in the laboratory frame. Balance at any time: energy.kinetic + energy.elastic + energy.impactLoss + energy.viscous + energy.friction = their sum at the start + energy.wall + energy.electrical + energy.gravity";
    "energy.cylinderKinetic" cylinder 1e-3 ["cylinder.velocity"] [IMPACT]
        "1/2 M z_M'^2: kinetic energy of the cylinder in the laboratory frame. Balance: its change + that of energy.suspension + energy.damping = energy.excitation, less energy.wall with contact.reaction";
    "energy.elastic" elastic 1e-4 [] []
        "r^2 K x^(n+1) / (n+1), or r^2 times the work of another membrane.law: energy that the membranes can give back, with what viscous films have stored; 0 under the impulsive law";
    "energy.impactLoss" impact_loss 1e-4 [] [IMPACT]
        "Energy lost in the membranes since the start: (1 - r^2) K X^(n+1) / (n+1) for each contact, X its largest deflection so far; under the impulsive law (1 - r^2) m v^2 / 2 for each impact, with contact.reaction m M / (m + M) for m";
    "energy.excitation" excitation 1e-3 ["cylinder.position", "cylinder.velocity", "energy.damping"] [IMPACT]
        "Work of excitation and external force on the cylinder since the start, or of the shaker that moves it: the change of energy.cylinderKinetic and energy.suspension, plus energy.damping, plus energy.wall with contact.reaction";
    "energy.electrical" electrical 1e-6 [] []
        "Work of the Maxwell force on the ball since the start: the integral of 1/2 U^2 dC";
    "energy.wall" wall 1e-4 ["cylinder.position", "cylinder.velocity"] [IMPACT]
        "Work of the cylinder, membranes and friction included, on the ball since the start, with the cylinder's own velocity; without contact.reaction the cylinder gives it without being slowed";
};

/// What an inclined, rubbing or held cylinder adds to these books.
static OTHER_ENERGIES: [V; 4] = energies! {
    "energy.friction" friction 1e-4 ["cylinder.position", "ball.position"] [IMPACT]
        "Energy lost by friction between ball and cylinder since the start";
    "energy.gravity" gravity 1e-3 ["ball.position"] [IMPACT]
        "Work of gravity on the ball since the start: -m g sin(beta) times its way along the axis";
    "energy.suspension" suspension 1e-3 ["cylinder.position"] [&["cylinder.suspensionStiffness", "initial.cylinderPosition"]]
        "k z_M^2 / 2: energy in the spring that holds the cylinder";
    "energy.damping" damping 1e-3 ["energy.damping"] []
        "Energy lost in the damper that holds the cylinder since the start; in model exchange a continuous state";
};

static MOUNT: [V; 2] = [V::output(
    "mount.force",
    "N",
    "Force of the mount on the cylinder: of spring and damper, -k z_M - c z_M', or of the shaker that prescribes the motion (excitation.kind = motion), which bears externalForce and, with contact.reaction, the ball, but for impacts that take no time",
)
.depends_on(&["cylinder.position", "cylinder.velocity", "ball.velocity", FORCE])
.initially_depends_on(&[IMPACT, &[FORCE]])
.partial_derivative(change!(mount_force))
.get(|slave| slave.read(videg_model::Harvester::mount_force)),
    V::boolean_output("ball.sticks", "Friction holds the ball on the cylinder, between the membranes")
        .local()
        .get(|slave| slave.model().is_some_and(videg_model::Harvester::is_stuck)),
];

static CONTACT_TIME: [V; 1] = [V::output(
    "contact.time",
    "s",
    "Time in contact since the start under the compliant law; impacts of the impulsive law take none",
)
.depends_on(&[])
.initially_depends_on(&[])
.partial_derivative(change!(contact_time))
.get(|slave| slave.read(videg_model::Harvester::contact_time))];

/// What the film of a membrane bears. `U` is the voltage at the communication point.
macro_rules! membrane_loads {
    ($side:expr, $which:literal) => {
        [
            V::output(
                concat!($which, ".electricField"),
                "V/m",
                concat!(
                    "U / h_3: electric field in the ",
                    $which,
                    " membrane, Table 1; U is ",
                    $which,
                    ".voltage, which does not follow biasVoltage"
                ),
            )
            .nominal(1e7)
            .depends_on(&[concat!($which, ".voltage")])
            .initially_depends_on(&[&[concat!($which, ".voltage"), "membrane.initialThickness", "membrane.prestretch"]])
            .partial_derivative(|slave, known| slave.partial(known, |change| change.field($side)))
            .get(|slave| {
                let voltage = slave.voltages[$side.index()];
                slave.read(|model| model.membrane().field(model.deflection($side).value, voltage))
            }),
            V::output(
                concat!($which, ".stretch"),
                "1",
                concat!(
                    "lambda sqrt(A_3 / A_2): stretch of the ",
                    $which,
                    " membrane's film, as if equal in both directions"
                ),
            )
            .depends_on(&[])
            .initially_depends_on(&[&["membrane.prestretch"]])
            .partial_derivative(change!(stretch[$side.index()]))
            .get(|slave| slave.read(|model| model.membrane().stretch(model.deflection($side).value))),
        ]
    };
}

static LEFT_LOADS: [V; 2] = membrane_loads!(Side::Left, "left");
static RIGHT_LOADS: [V; 2] = membrane_loads!(Side::Right, "right");

/// Time derivatives of the continuous states of the motion, for model exchange.
static DERIVATIVES: [V; 4] = [
    V::output("der(cylinder.position)", "m/s", "z_M': time derivative of cylinder.position")
        .local()
        .alias_of("cylinder.velocity")
        .depends_on(&["cylinder.velocity"])
        .derivative_of("cylinder.position")
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(cylinder[1]))
        .get(|slave| slave.read(videg_model::Harvester::cylinder_velocity)),
    V::output("der(cylinder.velocity)", "m/s2", "z_M'': time derivative of cylinder.velocity, Eq. (7)")
        .local()
        .depends_on(&["cylinder.position", "cylinder.velocity", "externalForce"])
        .derivative_of("cylinder.velocity")
        .initially_depends_on(&[IMPACT, &[FORCE]])
        .partial_derivative(change!(cylinder[2]))
        .get(|slave| slave.read(videg_model::Harvester::cylinder_acceleration)),
    V::output("der(ball.position)", "m/s", "z_m': time derivative of ball.position")
        .local()
        .alias_of("ball.velocity")
        .depends_on(&["cylinder.velocity", "ball.velocity"])
        .derivative_of("ball.position")
        .initially_depends_on(&[IMPACT])
        .partial_derivative(change!(ball[1]))
        .get(|slave| slave.read(videg_model::Harvester::ball_velocity)),
    V::output(
        "der(ball.velocity)",
        "m/s2",
        "z_m'': time derivative of ball.velocity; that of the cylinder while the ball rests",
    )
    .local()
    .depends_on(&["cylinder.position", "cylinder.velocity", "externalForce"])
    .derivative_of("ball.velocity")
    .initially_depends_on(&[IMPACT, &[FORCE]])
    .partial_derivative(change!(ball[2]))
    .get(|slave| slave.read(videg_model::Harvester::ball_acceleration)),
];

/// Parameters of the paper and of contacts that last.
const PARAMETERS: &[V] = reals("cylinder.mass", "biasVoltage");
const CHOICES: &[V] = choices("excitation.seed", "contact.reaction");

/// How the cylinder is held and driven, and gravity and friction.
const MOUNT_PARAMETERS: &[V] = reals("cylinder.inclination", "excitation.acceleration");
const MOUNT_CHOICES: &[V] = choices("excitation.kind", "excitation.kind");

/// The recorded part of the excitation.
static RECORDING_FILE: [V; 1] = [V::string_parameter(
    Recording::VARIABLE,
    "",
    "CSV file of a recorded excitation, added to the harmonic one: time,acceleration in s and m/s2 (excitation.kind = motion) or time,force in s and N, straight lines between the samples and 0 outside; looked for in the resources of the FMU and then from the working folder; none if empty",
)
.longest(LONGEST)
.access(|slave| slave.files.excitation.to_string(), |slave, file| Arc::make_mut(&mut slave.files).excitation = file.into())];
const RECORDING_PARAMETERS: &[V] = reals("excitation.fileScale", "excitation.fileOffset");
const RECORDING_CHOICES: &[V] = choices("excitation.fileRepeat", "excitation.fileRepeat");

/// The membrane of the user's own.
const FILM_CHOICES: &[V] = choices("membrane.law", "membrane.law");
static MEMBRANE_FILE: [V; 1] = [V::string_parameter(
    ForceTable::VARIABLE,
    "",
    "CSV file of a measured membrane (membrane.law = table): deflection,force in m and N, or deflection,force,capacitance in m, N and F, monotone cubic between the points and straight lines beyond the last; looked for in the resources of the FMU and then from the working folder",
)
.longest(LONGEST)
.access(|slave| slave.files.membrane.to_string(), |slave, file| Arc::make_mut(&mut slave.files).membrane = file.into())];
const FILM_PARAMETERS: &[V] = reals("membrane.shearModulus", "membrane.ogdenExponent3");

/// The viscosity of a film, and what follows from it.
const VISCOUS_PARAMETERS: &[V] = reals("membrane.viscousModulus", "membrane.relaxationTime");
static VISCOUS_ENERGY: [V; 1] = energies! {
    "energy.viscous" viscous 1e-5 [] []
        "Energy lost in viscous films (membrane.viscousModulus) since the start";
};

/// The derivative of a continuous state that came later.
static DAMPING_POWER: [V; 1] = [V::output("der(energy.damping)", "W", "c z_M'^2: time derivative of energy.damping")
    .local()
    .depends_on(&["cylinder.velocity"])
    .derivative_of(DAMPING)
    .initially_depends_on(&[IMPACT])
    .partial_derivative(change!(damping_power))
    .get(|slave| slave.read(videg_model::Harvester::damping_power))];

/// The table of these groups, in this order.
macro_rules! table {
    ($($group:ident)*) => {
        /// The table; the value reference of a variable is its index.
        pub static VARIABLES: [V; 0 $(+ $group.len())*] = concat(&[$(&$group),*]);
    };
}
table! {
    PARAMETERS CHOICES CALCULATED INPUTS LEFT RIGHT MOTION EVENTS ENERGIES CONTACT_TIME LEFT_LOADS RIGHT_LOADS
    DERIVATIVES TWINS MOUNT_PARAMETERS MOUNT_CHOICES OTHER_ENERGIES MOUNT RECORDING_FILE RECORDING_PARAMETERS
    RECORDING_CHOICES FILM_CHOICES MEMBRANE_FILE FILM_PARAMETERS VISCOUS_PARAMETERS EFFECTIVE_RESTITUTION VISCOUS_ENERGY
    DAMPING_POWER KNOWN IMPACTS
}
