//! Values at which programs break, runs that must end, and what must hold of any harvester.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper fails a test, too")]

use std::sync::mpsc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use videg_model::{
    ContactLaw, ExcitationKind, Harvester, MembraneLaw, ModelError, NoiseModel, Parameters, Quantity, Side,
};

#[path = "../../../tests/support/edges.rs"]
mod edges;

/// A run that takes longer than this hangs: thousands of times what any takes.
const WATCH: Duration = Duration::from_secs(300);

/// Most events in a second of simulated time: `EVENT_BUDGET` of the model.
pub const BUDGET: u64 = 1_000_000;

/// What is being run, for the watchdog to name.
#[derive(Clone, Default)]
pub struct Label(Arc<Mutex<String>>);

impl Label {
    pub fn set(&self, what: String) {
        *self.0.lock().unwrap() = what;
    }
}

/// Runs `body` under a watchdog, which names what hangs.
pub fn watched(body: impl FnOnce(&Label) + Send + 'static) {
    let (label, (done, ended)) = (Label::default(), mpsc::channel());
    let of_body = label.clone();
    let thread = std::thread::spawn(move || {
        body(&of_body);
        done.send(()).unwrap();
    });
    let now = || label.0.lock().unwrap().clone();
    let mut before = None;
    while let Err(mpsc::RecvTimeoutError::Timeout) = ended.recv_timeout(WATCH) {
        // All runs together may take longer.
        let running = Some(now());
        assert!(running != before, "no end after {WATCH:?}: {}", now());
        before = running;
    }
    if let Err(cause) = thread.join() {
        eprintln!("while running {}", now());
        std::panic::resume_unwind(cause);
    }
}

/// What to give to a parameter.
pub fn values(quantity: &Quantity) -> Vec<f64> {
    edges::around(quantity.min, quantity.max)
}

pub fn with(parameters: &Parameters, quantity: &Quantity, value: f64) -> Parameters {
    let mut changed = *parameters;
    (quantity.set)(&mut changed, value);
    changed
}

/// Harvesters of all kinds, by name, to which hostile values are given.
pub fn kinds() -> Vec<(&'static str, Parameters)> {
    let impulsive = Parameters::default();
    let compliant = Parameters { contact_law: ContactLaw::Compliant, ..impulsive };
    let held = Parameters { phase_noise: 1.0, noise_hold: 1e-4, ..impulsive };
    vec![
        ("impulsive", impulsive),
        ("elastic", Parameters { restitution: 1.0, ..impulsive }),
        ("chattering", Parameters { amplitude: 5.0, restitution: 0.3, frequency: 1.0, ..impulsive }),
        ("with held noise", held),
        ("with a Wiener phase", Parameters { noise_model: NoiseModel::Wiener, ..held }),
        ("inclined", Parameters { inclination: 0.1, ..impulsive }),
        ("rubbing", Parameters { friction: 0.1, reaction: true, ..impulsive }),
        ("suspended", Parameters { suspension_stiffness: 20.0, suspension_damping: 0.1, ..impulsive }),
        ("on a shaker", Parameters { excitation_kind: ExcitationKind::Motion, acceleration: 4.0, ..impulsive }),
        ("compliant", compliant),
        ("compliant and rubbing", Parameters { friction: 0.1, inclination: 0.1, ..compliant }),
        ("compliant and suspended", Parameters { suspension_stiffness: 20.0, suspension_damping: 0.1, ..compliant }),
        ("compliant with reaction", Parameters { reaction: true, ..compliant }),
        (
            "compliant and suspended with reaction",
            Parameters { suspension_stiffness: 20.0, suspension_damping: 0.1, reaction: true, ..compliant },
        ),
        (
            "compliant on viscous films",
            Parameters { membrane_law: MembraneLaw::Gent, viscous_modulus: 3e4, relaxation_time: 1e-2, ..compliant },
        ),
        ("compliant with feedback", Parameters { electrostatic_feedback: true, ..compliant }),
        ("a film of Gent", Parameters { membrane_law: MembraneLaw::Gent, ..impulsive }),
        (
            "a film of Ogden",
            Parameters { membrane_law: MembraneLaw::Ogden, ogden_modulus_2: -1e3, ogden_exponent_2: -1.0, ..impulsive },
        ),
        ("a compliant film of Gent", Parameters { membrane_law: MembraneLaw::Gent, ..compliant }),
        ("compliant with noise", Parameters { contact_law: ContactLaw::Compliant, ..held }),
    ]
}

/// How long to run, s: shorter where hold intervals are, of which each is worked out, and on a viscous film, which a long contact
/// follows in steps as small as its fastest change.
pub fn duration(parameters: &Parameters) -> f64 {
    if parameters.phase_noise > 0.0 {
        (2e4 * parameters.noise_hold).min(2.0)
    } else if parameters.viscous_modulus > 0.0 {
        0.5
    } else {
        2.0
    }
}

/// That every output is a finite number.
pub fn assert_finite(harvester: &Harvester, what: &str) {
    let h = harvester;
    let motion = (h.states(), h.derivatives(), h.relative_displacement(), h.mount_force());
    let known = (h.totals(), h.energies(), h.contact_time(), h.next_impact(), h.next_knot());
    let of_membranes =
        Side::BOTH.map(|side| (h.deflection(side), h.capacitance(side), h.capacitance_rate(side), h.voltage(side)));
    let text = format!("{motion:?} {known:?} {of_membranes:?}");
    assert!(!text.contains("NaN") && !text.contains("inf"), "{what}, at {} s: {text}", h.time());
}

/// That the books of the ball's energy close, relative to what may have gone through them: a wall that moves on its own gives
/// and takes its energy over and over.
pub fn assert_balanced(harvester: &Harvester, parameters: &Parameters, what: &str) {
    let e = harvester.energies();
    let start = 0.5 * parameters.ball_mass * parameters.ball_velocity * parameters.ball_velocity;
    let residual =
        e.ball + e.elastic + e.impact_loss + e.friction + e.viscous - (start + e.wall + e.electrical + e.gravity);
    let swing = 2.0 * parameters.cylinder_amplitude() * std::f64::consts::TAU * parameters.frequency;
    let held = parameters.cylinder_position * (parameters.suspension_stiffness / parameters.cylinder_mass).sqrt();
    let fastest = parameters.cylinder_velocity.abs() + swing + held.abs() + harvester.cylinder_velocity().abs();
    let of_wall = 0.5 * parameters.ball_mass * fastest * fastest;
    let moved = e.ball + e.elastic + e.impact_loss + start + e.wall.abs() + e.electrical.abs() + of_wall;
    let moved = moved + e.friction + e.viscous + e.gravity.abs();
    let tolerance = 2e-9 + digits_of_time(harvester, parameters, fastest);
    let time = harvester.time();
    // Gravity and friction work along differences of positions, which may be large.
    let pull = parameters.ball_mass * (parameters.incline().abs() + parameters.friction_acceleration());
    let far = harvester.ball_position().abs().max(parameters.initial_ball_position().abs());
    // Each event puts the ball where it is at the double next to the time of the event.
    let totals = harvester.totals();
    let speed = totals.last_speed
        + fastest
        + parameters.ball_velocity.abs()
        + (pull / parameters.ball_mass * parameters.travel()).sqrt();
    let moved_by_events = (1 + totals.impacts) as f64 * speed * (time.abs().next_up() - time.abs());
    let rounding = 16.0 * pull * (f64::EPSILON * far + moved_by_events);
    assert!(
        residual.abs() <= tolerance * moved + rounding,
        "{what}: the books miss {residual} of {moved} J at {time} s"
    );
}

/// What the digits of time are worth: events are put at doubles, by the rounding of which a wall turns on, or a contact at
/// `speed`, m/s.
fn digits_of_time(harvester: &Harvester, parameters: &Parameters, speed: f64) -> f64 {
    let (time, speed) = (harvester.time().abs(), speed + parameters.ball_velocity.abs());
    let deflection = harvester.membrane().deflection(speed);
    let of_contact = if deflection > 0.0 { speed / deflection } else { 0.0 };
    let rate = match parameters.contact_law {
        ContactLaw::Impulsive => std::f64::consts::TAU * parameters.frequency,
        ContactLaw::Compliant => of_contact + std::f64::consts::TAU * parameters.frequency,
    };
    let pull = parameters.incline().abs() + parameters.friction_acceleration();
    let by_pull = if pull > 0.0 { pull / (speed + (pull * parameters.travel()).sqrt()) } else { 0.0 };
    // A suspension turns the wall, too, and its pieces are rounded one by one.
    let of_mount = (parameters.suspension_stiffness / parameters.cylinder_mass).sqrt()
        + parameters.suspension_damping / parameters.cylinder_mass;
    16.0 * (time.next_up() - time) * (rate + of_mount + by_pull) + 64.0 * f64::EPSILON * of_mount * duration(parameters)
}

/// Events after which a run has shown what it can.
const ENOUGH: u64 = 100_000;

/// Runs a harvester from `start`, s, in a few steps: every output stays finite, the books close and the events keep to the
/// budget; or an error says why it ends.
pub fn run(parameters: &Parameters, start: f64, what: &str) -> Result<Harvester, ModelError> {
    let mut harvester = Harvester::new(parameters, start)?;
    assert_finite(&harvester, what);
    let until = duration(parameters);
    for part in [1e-9, 1e-3, 0.02, 0.1, 0.25, 0.5, 1.0] {
        if harvester.totals().events() > ENOUGH {
            break;
        }
        let before = harvester.totals().events();
        let advanced = harvester.advance(start + part * until);
        assert!(harvester.totals().events() - before <= 3 * BUDGET, "{what}: more events than the budget");
        advanced?;
        assert_finite(&harvester, what);
        assert_balanced(&harvester, parameters, what);
    }
    Ok(harvester)
}

/// That a run which ends early says so in words that name a thing, its value and a bound.
pub fn assert_explained(error: &ModelError, what: &str) {
    let text = error.to_string();
    let explained = match error {
        ModelError::Bounds { name, min, max, .. } => text.contains(name) && text.contains(&format!("[{min}, {max}]")),
        ModelError::Order { name, bound_name, .. } => text.contains(name) && text.contains(bound_name),
        ModelError::TooManyEvents { limit, .. } => text.contains(&limit.to_string()),
        ModelError::TooDeep { bound, .. } | ModelError::HitsLimit { bound, .. } => {
            text.contains(&format!("at most {bound} m"))
        }
        ModelError::FilmLocked { energy, most, .. } => energy > most && text.contains("membrane.stretchLimit"),
        ModelError::TooStiff { name, limit, .. } => text.contains(name) && text.contains(&limit.to_string()),
        ModelError::NeedsFilm { .. } => text.contains("allowed otherwise: 0"),
        ModelError::TooFast { least, .. } => text.contains(&format!("at least {least:e} s")),
        ModelError::NeedsForce { name, .. } => text.contains(name) && text.contains("allowed: 0"),
        ModelError::Locked { limit, invariant, .. } => {
            text.contains(&limit.to_string()) && text.contains(&invariant.to_string())
        }
        ModelError::OgdenSign { name, exponent, .. } => text.contains(name) && text.contains(&exponent.to_string()),
        ModelError::NoStiffness { modulus, .. } => text.contains(&modulus.to_string()) && text.contains("at least"),
        _ => false,
    };
    assert!(explained, "{what}: {text}");
}
