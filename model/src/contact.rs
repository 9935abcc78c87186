//! The compliant contact law: a contact takes time, and the wall moves meanwhile.
//!
//! Here the force of the membrane is K x^n; another law puts its own in that place. A viscous film has no such branches: its dashpot
//! takes the loss, and r is not used (`membrane/viscosity.rs`).
//!
//! With x the deflection, inwards from the membrane's rest plane, the membrane pushes the ball back with K x^n while it is
//! deeper than ever in this contact, and with r^2 K x^n otherwise: unloading and loading again run on the same curve up to
//! the largest deflection of the contact, where the force jumps up to K x^n. Under an unaccelerated wall that gives exactly
//! delta of Eq. (10) and the rebound of Eq. (11).
//!
//! No cycle creates energy. Let E(x) = r^2 K x^(n+1) / (n+1) be the energy that the membrane can give back. On the lower
//! curve the force is E'(x): what goes in comes out. On the upper curve x' >= 0 and the force is K x^n >= E'(x): of the work
//! K x^n x' the part (1 - r^2) K x^n x' >= 0 is lost. So a contact has lost (1 - r^2) K X^(n+1) / (n+1), where X is its
//! largest deflection so far, which never falls, and r <= 1. The jump takes place at one x and does no work.
//!
//! A push between the two forces at X holds the ball there: it would have to exceed the upper one to go deeper and fall
//! below the lower one to let it back. With r = 0 the lower one is 0: a membrane that has been pressed in stays with the
//! ball until the wall recedes from it. A contact ends when x is 0 again; the membrane does not pull.
//!
//! Without reaction the cylinder's motion is known. With reaction, by Newton's third law, that of a free cylinder follows
//! from x: only x and x' are integrated. On a suspended one the mount acts against the recoil q, what the contact adds to
//! the cylinder's motion, so that q is integrated with x. With the force F on the ball, outwards, and the sign s of dz
//!
//! q'' = -s F / M - (c q' + k q) / M and x'' = s (`z_M''` - `z_m''`) - F (1/m + 1/M) - s (c q' + k q) / M,
//!
//! where `z_M''` and `z_m''` are those without the contact.

mod collocation;
mod law;
mod point;
mod step;

pub(crate) use self::law::Law;
pub use self::law::{Phase, Ramp};
pub use self::point::{Creep, Point, Recoil};
pub(crate) use self::step::Work;

use self::step::Step;
use crate::motion::side::Side;
use crate::numerics::chebyshev::Series;

/// A contact at the start of a pass, the motion on one branch of the membrane's force. What comes follows from it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactState {
    /// The membrane that is touched.
    pub side: Side,
    /// The branch of its force.
    pub phase: Phase,
    /// Begin of the contact, s.
    pub since: f64,
    /// Largest deflection up to the start of the pass, m.
    pub largest: f64,
    /// Start of the pass.
    pub start: Point,
    /// `C_3` / `C_2` - 1 of the turning points so far: what the sums of the gains contain of this contact.
    pub credited: f64,
    /// Length of the integrator's first step, s.
    pub proposal: f64,
}

/// Steps of a pass.
const MAX_STEPS: usize = 1000;

/// The present contact.
#[derive(Debug, PartialEq)]
pub(crate) struct Contact {
    pub(crate) state: ContactState,
    pass: Pass,
}

impl Clone for Contact {
    fn clone(&self) -> Self {
        Self { state: self.state, pass: self.pass.clone() }
    }

    /// Takes no memory that is there already.
    fn clone_from(&mut self, source: &Self) {
        self.state = source.state;
        self.pass.steps.clone_from(&source.pass.steps);
        (self.pass.end, self.pass.ending) = (source.pass.end, source.pass.ending);
    }
}

/// The motion on one branch up to where it is left.
#[derive(Debug, Clone, PartialEq, Default)]
struct Pass {
    steps: Vec<Step>,
    end: f64,
    ending: Ending,
}

/// Why a pass ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Ending {
    /// It has been followed long enough.
    #[default]
    Cut,
    /// Loading: the largest deflection, x' = 0.
    Turn,
    /// Unloading: back at the largest deflection so far.
    Return,
    /// Unloading: the ball leaves the membrane.
    Separation,
    /// Held: the push overcomes the loading force.
    Yield,
    /// Held: the push no longer withstands the unloading force.
    Recovery,
    /// Below the largest deflection with friction: x' = 0.
    Halt,
}

impl Contact {
    /// A contact that begins at `time`, s, at relative `speed`, m/s, on a membrane with this `creep`; `proposal`: the length of a
    /// first step, s.
    pub(crate) fn new(side: Side, time: f64, [speed, creep]: [f64; 2], proposal: f64) -> Self {
        let start = Point { time, v: speed, creep, ..Point::default() };
        let state =
            ContactState { side, phase: Phase::Loading, since: time, largest: 0.0, start, credited: 0.0, proposal };
        Self::resumed(state)
    }

    /// The contact that was in this state; its pass is still to be planned.
    pub(crate) fn resumed(state: ContactState) -> Self {
        Self { state, pass: Pass::default() }
    }

    /// Time at which the pass ends, s.
    pub(crate) fn end(&self) -> f64 {
        self.pass.end
    }

    pub(crate) fn ending(&self) -> Ending {
        self.pass.ending
    }

    /// Steps of the pass: what it cost.
    pub(crate) fn steps(&self) -> usize {
        self.pass.steps.len()
    }

    fn step_at(&self, time: f64) -> Option<(usize, &Step)> {
        let index = self.pass.steps.partition_point(|step| step.end() < time);
        let index = index.min(self.pass.steps.len().saturating_sub(1));
        self.pass.steps.get(index).map(|step| (index, step))
    }

    /// Deflection and rate at `time`, s.
    pub(crate) fn at(&self, time: f64) -> Point {
        self.step_at(time).map_or(self.state.start, |(_, step)| step.at(time))
    }

    /// Largest deflection of the contact up to `time`, s.
    pub(crate) fn largest_at(&self, time: f64) -> f64 {
        if self.state.phase == Phase::Loading { self.state.largest.max(self.at(time).x) } else { self.state.largest }
    }

    /// Way of the ball against friction from the start of the pass to `time`, s.
    pub(crate) fn way(&self, time: f64) -> f64 {
        (self.at(time).x - self.state.start.x).abs()
    }

    /// Work on the ball from the start of the pass to `time`, s.
    pub(crate) fn work(&self, time: f64) -> Work {
        let Some((index, step)) = self.step_at(time) else { return Work::default() };
        self.pass.steps[..index].iter().map(|step| step.work(step.end())).fold(step.work(time), |sum, work| Work {
            wall: sum.wall + work.wall,
            electrical: sum.electrical + work.electrical,
            damping: sum.damping + work.damping,
            viscous: sum.viscous + work.viscous,
        })
    }

    /// The contact from `time`, s, on, under forces that may have changed; its pass is still to be planned.
    #[must_use]
    pub(crate) fn continued(&self, time: f64) -> Self {
        let proposal = self.step_at(time).map_or(self.state.proposal, |(_, step)| step.length);
        let (largest, start) = (self.largest_at(time), self.at(time));
        Self::resumed(ContactState { largest, start, proposal, ..self.state })
    }

    /// The contact after the end of its pass, or none if the ball has left the membrane.
    pub(crate) fn next(&self, law: &Law<'_>) -> Option<Self> {
        let mut next = self.continued(self.end());
        next.state.phase = match self.ending() {
            Ending::Cut => return Some(next),
            Ending::Separation => return None,
            Ending::Return => Phase::Loading,
            Ending::Yield if self.state.phase == Phase::Held => Phase::Loading,
            Ending::Yield => Phase::Reloading,
            Ending::Recovery => Phase::Unloading,
            Ending::Halt => {
                next.state.start.v = 0.0;
                next.phase_at_halt(law)
            }
            Ending::Turn => {
                next.state.start.v = 0.0;
                next.phase_at_turn(law)
            }
        };
        Some(next)
    }

    /// Where a ball that has come to a halt at the largest deflection goes.
    fn phase_at_turn(&self, law: &Law<'_>) -> Phase {
        let Point { time, x, .. } = self.state.start;
        let push = law.mass() * law.push_at(&self.state.start) + law.maxwell(time, 0.0, x);
        let friction = law.mass() * law.deceleration();
        let [lower, upper] = self.holding_forces(law, Phase::Held);
        if push < lower - friction {
            Phase::Unloading
        } else if push <= upper + friction {
            Phase::Held
        } else {
            Phase::Loading
        }
    }

    /// Least and largest force of the membrane, N, on a ball that rests in this `phase` where the pass begins.
    fn holding_forces(&self, law: &Law<'_>, phase: Phase) -> [f64; 2] {
        let lower = law.pull_of(Phase::Stuck, &self.state.start);
        let may_rise = phase == Phase::Held && law.membrane.viscosity.is_none();
        [lower, if may_rise { law.loading(self.state.start.x) } else { lower }]
    }

    /// Where a ball that friction has brought to a halt below the largest deflection goes.
    fn phase_at_halt(&self, law: &Law<'_>) -> Phase {
        let Point { time, x, .. } = self.state.start;
        let excess = law.push_at(&self.state.start)
            + (law.maxwell(time, 0.0, x) - law.pull_of(Phase::Stuck, &self.state.start)) / law.mass();
        if excess.abs() <= law.deceleration() {
            Phase::Stuck
        } else if excess > 0.0 {
            Phase::Reloading
        } else {
            Phase::Unloading
        }
    }

    /// Follows the motion from the start of the pass to its end, at `limit`, s, at the latest.
    pub(crate) fn plan(&mut self, law: &Law<'_>, limit: f64) {
        self.pass = Pass { steps: Vec::new(), end: self.state.start.time, ending: Ending::Cut };
        let (mut from, mut length) = (self.state.start, self.state.proposal);
        while self.pass.steps.len() < MAX_STEPS && from.time < limit && !law.is_too_deep(from.x) {
            let rest = limit - from.time;
            // Below this, time has no digits left.
            let shortest = 16.0 * f64::EPSILON * from.time.abs().max(f64::MIN_POSITIVE);
            let step = match Step::new(law, self.state.phase, &from, length.max(shortest).min(rest)) {
                Ok(step) => step,
                Err(too_long) if too_long.proposal > shortest => {
                    length = too_long.proposal;
                    continue;
                }
                Err(_) => break,
            };
            let end = if step.length == rest { limit } else { step.end() };
            let crossing = self.crossing(law, &step);
            (length, from) = (step.proposal, Point { time: end, ..step.at(end) });
            self.pass.end = end;
            self.pass.steps.push(step);
            if let Some((time, ending)) = crossing {
                (self.pass.end, self.pass.ending) = (time, ending);
                return;
            }
        }
    }

    /// Where `step` first leaves the branch.
    fn crossing(&self, law: &Law<'_>, step: &Step) -> Option<(f64, Ending)> {
        let fall = |series: Series, scale: f64, ending: Ending| {
            series.first_fall(scale).map(|place| (step.time(place), ending))
        };
        let friction = law.deceleration();
        let crossings = match self.state.phase {
            Phase::Loading => [fall(step.rate, step.rate.bound(), Ending::Turn), None],
            Phase::Unloading | Phase::Reloading => {
                let scale = step.deflection.bound() + self.state.largest;
                let room = step.deflection.times(-1.0).plus(self.state.largest);
                let separation = fall(step.deflection, scale, Ending::Separation);
                let back = step.rate.times(self.state.phase.direction());
                match self.state.phase {
                    _ if friction == 0.0 => [separation, fall(room, scale, Ending::Return)],
                    Phase::Unloading => [separation, fall(back, step.rate.bound(), Ending::Halt)],
                    _ => [fall(room, scale, Ending::Return), fall(back, step.rate.bound(), Ending::Halt)],
                }
            }
            Phase::Held | Phase::Stuck => {
                let [lower, upper] = self.holding_forces(law, self.state.phase).map(|force| force / law.mass());
                let mut push = step.push;
                if let Some(relaxing) = step.relaxing {
                    push = push.minus(&relaxing.plus(-lower));
                }
                let scale = push.bound() + upper + friction;
                let excess = push.plus(friction - lower);
                let rest = push.times(-1.0).plus(upper + friction);
                // After a jump of force or voltage it may be beyond from the begin.
                let is_beyond = |series: &Series| series.value(-1.0) < -16.0 * f64::EPSILON * scale;
                if is_beyond(&excess) {
                    return Some((step.time(-1.0), Ending::Recovery));
                }
                if is_beyond(&rest) {
                    return Some((step.time(-1.0), Ending::Yield));
                }
                [fall(excess, scale, Ending::Recovery), fall(rest, scale, Ending::Yield)]
            }
        };
        crossings.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
