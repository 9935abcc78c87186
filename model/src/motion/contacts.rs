//! Contacts under the compliant law as part of the motion.

use super::cylinder::{CylinderMotion, CylinderState, Drive};
use super::flight::Flight;
use super::mount::Mount;
use super::pulse::Deflection;
use super::side::Side;
use super::{Ball, Motion, Start};
use crate::accounting::budget::Budget;
use crate::accounting::ledger::Ledger;
use crate::contact::{Contact, Creep, Ending, Law, Point, Ramp, Recoil, Work};
use crate::error::ModelError;
use crate::membrane::Membrane;
use crate::membrane::viscosity::Viscosity;
use crate::parameters::Parameters;

/// First step to try, in units of the loading time and of the excitation period: the force sets in as x^n.
const FIRST_STEP: f64 = 1e-3;

/// Part of the deflection at which a film is locked in which the last step of a ball that goes on fails.
const AT_LIMIT: f64 = 1e-6;

/// Events of the budget that an internal step counts for: it takes as long as some twenty impacts.
const STEP_COST: usize = 20;

/// What the forces of a contact depend on besides the motion.
#[derive(Clone, Copy)]
pub struct Forces<'a> {
    pub parameters: &'a Parameters,
    pub membrane: &'a Membrane,
    /// Voltages across the membranes.
    pub voltages: &'a [Ramp; 2],
}

impl<'a> Forces<'a> {
    fn law(self, (cylinder, mount): (&'a CylinderMotion, &'a Mount), flight: &'a Flight, side: Side) -> Law<'a> {
        let Self { parameters, membrane, voltages } = self;
        Law { parameters, membrane, cylinder, mount, flight, side, voltage: voltages[side.index()] }
    }
}

impl Motion {
    fn law<'a>(&'a self, forces: Forces<'a>, side: Side) -> Law<'a> {
        forces.law((&self.cylinder, &self.mount), &self.flight, side)
    }

    /// Force on the ball in the direction of z, N, at `time`, s.
    pub fn contact_force(&self, forces: Forces<'_>, time: f64) -> f64 {
        self.ball.contact().map_or(0.0, |contact| {
            let side = contact.state.side;
            side.sign() * self.law(forces, side).total(contact.state.phase, &contact.at(time))
        })
    }

    /// Deflection of the `membrane` at `side` by the present contact, or of a viscous film that has not recovered yet, at `time`, s.
    pub fn contact_deflection(&self, membrane: &Membrane, side: Side, time: f64) -> Deflection {
        let here = self.ball.contact().filter(|contact| contact.state.side == side);
        let point = here.map(|contact| contact.at(time));
        if let Some(viscosity) = &membrane.viscosity {
            let [x, v] = point.map_or([0.0; 2], |point| [point.x, point.v]);
            let [value, rate] = membrane.film_deflection(viscosity, [x, v], self.creep_at(viscosity, side, time));
            return Deflection { value, rate };
        }
        point.map_or(Deflection::default(), |Point { x, v, .. }| Deflection { value: x.max(0.0), rate: v })
    }

    /// Works on the ball in the present pass of the contact, the elastic energy and the energy lost in this contact, J, up to
    /// `time`, s.
    pub fn contact_energies(&self, forces: Forces<'_>, time: f64) -> Option<(Work, f64, f64)> {
        let contact = self.ball.contact()?;
        let law = self.law(forces, contact.state.side);
        Some((contact.work(time), law.elastic(&contact.at(time)), law.loss(contact.largest_at(time))))
    }

    /// Creep of the viscous film at `side` at `time`, s.
    pub fn creep_at(&self, viscosity: &Viscosity, side: Side, time: f64) -> f64 {
        match self.ball.contact().filter(|contact| contact.state.side == side) {
            Some(contact) => contact.at(time).creep,
            None => self.relaxed_at(viscosity, side, time),
        }
    }

    /// The same of a film that no ball presses.
    fn relaxed_at(&self, viscosity: &Viscosity, side: Side, time: f64) -> f64 {
        self.resting_films[side.index()].creep_at(viscosity, time)
    }

    /// Energy, J, that a viscous film at `side` has stored, and the energy, J, that it has lost since a ball last pressed it, at `time`,
    /// s; of a film that a ball presses both are those of the contact.
    pub fn relaxation_energies(&self, membrane: &Membrane, side: Side, time: f64) -> [f64; 2] {
        let is_pressed = self.ball.contact().is_some_and(|contact| contact.state.side == side);
        let Some(viscosity) = membrane.viscosity.as_ref().filter(|_| !is_pressed) else { return [0.0; 2] };
        let stored = |creep: f64| membrane.strained(viscosity, 0.0, creep).stored;
        let now = stored(self.relaxed_at(viscosity, side, time));
        [now, stored(self.resting_films[side.index()].creep.value) - now]
    }

    /// A contact begins at `time`, s, at relative `speed`, m/s.
    pub fn begin_contact(
        &mut self,
        forces: Forces<'_>,
        limit: Option<f64>,
        ledger: &mut Ledger,
        (time, side, speed): (f64, Side, f64),
    ) {
        let [_, lost] = self.relaxation_energies(forces.membrane, side, time);
        ledger.works.viscous += lost;
        let creep = forces.membrane.viscosity.as_ref().map_or(0.0, |viscosity| self.relaxed_at(viscosity, side, time));
        let mut here = self.cylinder.at(time);
        self.change_ball(Ball::Free, 0.0, &mut here);
        self.new_flight(&here, [self.half_travel, speed].map(|value| side.sign() * value));
        let period = 1.0 / forces.parameters.frequency;
        let loading = if speed > 0.0 { forces.membrane.deflection(speed) / speed } else { period };
        self.ball = Ball::InContact(Contact::new(side, time, [speed, creep], FIRST_STEP * loading.min(period)));
        self.plan_contact(forces, limit);
    }

    /// Works out the present pass, which reaches one excitation period or to the next noise sample, `limit`, at most.
    pub fn plan_contact(&mut self, forces: Forces<'_>, limit: Option<f64>) {
        let Self { cylinder, mount, flight, ball, .. } = self;
        let Ball::InContact(contact) = ball else { return };
        let period_end = contact.state.start.time + 1.0 / forces.parameters.frequency;
        let limit = limit.map_or(period_end, |limit| limit.min(period_end));
        // The motion of the cylinder is known to the end of its piece.
        let limit = limit.min(flight.end_of_series()).min(cylinder.drive.recorded.end);
        contact.plan(&forces.law((cylinder, mount), flight, contact.state.side), limit);
    }

    /// The pass of the contact has ended.
    pub fn follow_contact(
        &mut self,
        forces: Forces<'_>,
        limit: Option<f64>,
        (ledger, budget): (&mut Ledger, &mut Budget),
    ) -> Result<(), ModelError> {
        let Some(contact) = self.ball.contact() else { return Ok(()) };
        let (time, steps) = (contact.end(), contact.steps());
        let law = self.law(forces, contact.state.side);
        let deflection = contact.at(time).x;
        if law.is_too_deep(deflection) {
            let voltage = law.voltage.at(time);
            return Err(ModelError::TooDeep { time, deflection, bound: law.deepest(), voltage });
        }
        let is_at_end = self.end_of_piece() <= time;
        if steps == 0 && !is_at_end {
            let (bound, limit) = (forces.membrane.deepest(), forces.parameters.stretch_limit);
            if deflection > bound * (1.0 - AT_LIMIT) {
                let speed = contact.at(time).v;
                return Err(ModelError::HitsLimit { time, deflection, speed, bound, limit });
            }
            return Err(budget.exceeded(time)); // no step is short enough
        }
        (0..STEP_COST * steps).try_for_each(|_| budget.spend(time))?;
        self.book_pass(forces, ledger, time);
        if is_at_end {
            self.restart_contact_booked(forces, limit, (time, self.drive_after(&self.cylinder, time)));
            return Ok(());
        }
        let Some(contact) = self.ball.contact() else { return Ok(()) };
        match contact.next(&self.law(forces, contact.state.side)) {
            Some(next) => {
                self.ball = Ball::InContact(next);
                self.plan_contact(forces, limit);
            }
            None => self.separate(forces, ledger, time),
        }
        Ok(())
    }

    /// Books the works of the pass up to `time`, s, and, at a turning point, what Eqs. (12) and (13) give for the largest
    /// deflection.
    fn book_pass(&mut self, Forces { parameters, membrane, .. }: Forces<'_>, ledger: &mut Ledger, time: f64) {
        let Ball::InContact(contact) = &mut self.ball else { return };
        let work = contact.work(time);
        ledger.works.wall += work.wall;
        ledger.works.electrical += work.electrical;
        ledger.works.viscous += work.viscous;
        self.cylinder.damped += work.damping / parameters.cylinder_mass;
        ledger.rub(contact.way(time));
        if contact.ending() == Ending::Turn && time == contact.end() {
            let (excess, credited) = (membrane.capacitance_excess(contact.largest_at(time)), contact.state.credited);
            ledger.credit((excess - credited).max(0.0));
            contact.state.credited = excess.max(credited);
        }
    }

    /// The ball leaves the membrane at `time`, s.
    fn separate(&mut self, forces: Forces<'_>, ledger: &mut Ledger, time: f64) {
        let (position, velocity) = (self.cylinder_position_at(time), self.ball_velocity_at(time));
        let cylinder = self.recoiling_cylinder(time, self.drive_at(time));
        let Ball::InContact(contact) = core::mem::replace(&mut self.ball, Ball::Free) else { return };
        let side = contact.state.side;
        let (sign, Point { v: rate, creep, .. }) = (side.sign(), contact.at(time));
        self.resting_films[side.index()] = Creep { since: time, value: creep.max(0.0) }.into();
        ledger.end_contact(rate.abs());
        ledger.works.loss += self.law(forces, side).loss(contact.largest_at(time));
        ledger.works.contact_time += time - contact.state.since;
        if self.mount.ratio > 0.0 {
            self.cylinder = cylinder;
        }
        self.last = Start { time, position: position - sign * self.half_travel, velocity };
        let slip = if self.mount.friction > 0.0 { -sign } else { 0.0 };
        let mut here = self.cylinder.at(time);
        self.change_ball(Ball::Free, slip, &mut here);
        self.new_flight(&here, [sign * self.half_travel, sign * rate]);
    }

    /// The cylinder's motion from `time`, s, on, the recoil of the contact included.
    fn recoiling_cylinder(&self, time: f64, drive: Drive) -> CylinderMotion {
        let here = self.cylinder.at(time);
        let (position, velocity) = (self.cylinder_position_at(time), self.cylinder_velocity_at(time));
        CylinderMotion::from_state(&CylinderState { position, velocity, ..here }, drive, self.mount.sliding(0.0))
    }

    /// The contact goes on from `time`, s, under other voltages.
    pub fn change_voltages_in_contact(
        &mut self,
        forces: Forces<'_>,
        limit: Option<f64>,
        ledger: &mut Ledger,
        time: f64,
    ) {
        self.book_pass(forces, ledger, time);
        if let Ball::InContact(contact) = &mut self.ball {
            *contact = contact.continued(time);
        }
        self.plan_contact(forces, limit);
    }

    /// The contact goes on from `time`, s, under another `drive`.
    pub fn restart_contact(
        &mut self,
        forces: Forces<'_>,
        limit: Option<f64>,
        ledger: &mut Ledger,
        (time, drive): (f64, Drive),
    ) {
        self.book_pass(forces, ledger, time);
        self.restart_contact_booked(forces, limit, (time, drive));
    }

    /// The same after the works of the pass are booked.
    fn restart_contact_booked(&mut self, forces: Forces<'_>, limit: Option<f64>, (time, drive): (f64, Drive)) {
        let Some(contact) = self.ball.contact() else { return };
        let mut next = contact.continued(time);
        next.state.start.recoil = Recoil::default(); // it becomes part of the cylinder's motion
        let sign = contact.state.side.sign();
        let velocity = self.ball_velocity_at(time);
        self.cylinder = self.recoiling_cylinder(time, drive);
        let [dz, rate] = [self.half_travel + next.state.start.x, next.state.start.v].map(|value| sign * value);
        self.flight =
            Flight::new(&self.cylinder, &self.cylinder.at(time), [dz, rate], self.half_travel, self.mount.incline);
        self.last = Start { time, position: self.cylinder.position - dz, velocity };
        self.ball = Ball::InContact(next);
        self.plan_contact(forces, limit);
    }
}
