//! Contacts under the compliant law.

use super::input::within;
use super::{Ball, Harvester};
use crate::compliant::{Ending, Law, Phase, Ramp, Recoil, Touch};
use crate::cylinder::{CylinderMotion, Drive};
use crate::error::ModelError;
use crate::flight::{Flight, Side};
use crate::pulse::Deflection;

/// First step to try, in units of the loading time and of the excitation period: the force sets in as x^n.
const FIRST_STEP: f64 = 1e-3;

/// Events of the budget that an internal step counts for: it takes as long as some twenty impacts.
const STEP_COST: usize = 20;

impl Harvester {
    /// Sets the voltages across the left and the right membrane from now on, V, and their rates, V/s. They act with
    /// [`electrostatic_feedback`](crate::Parameters::electrostatic_feedback) only.
    ///
    /// # Errors
    /// A voltage or rate that is not finite, or beyond 1e18 V or V/s.
    #[inline]
    pub fn set_voltages(&mut self, voltages: [f64; 2], rates: [f64; 2]) -> Result<(), ModelError> {
        let [left, right] = &self.voltages;
        if rates == [0.0; 2] && left.stays_at(voltages[0]) && right.stays_at(voltages[1]) {
            return Ok(());
        }
        self.change_voltages(voltages, rates)
    }

    fn change_voltages(&mut self, voltages: [f64; 2], rates: [f64; 2]) -> Result<(), ModelError> {
        for side in [Side::Left, Side::Right] {
            let (value, rate) = (voltages[side.index()], rates[side.index()]);
            within("voltage of a membrane", value, "V")?;
            within("derivative of the voltage of a membrane", rate, "V/s")?;
            let ramp = &mut self.voltages[side.index()];
            if ramp.at(self.time) == value && ramp.rate == rate {
                continue;
            }
            *ramp = Ramp { start: self.time, value, rate };
            let acts = self.touch.as_ref().is_some_and(|touch| touch.side == side);
            if acts && self.parameters.electrostatic_feedback {
                self.replan_touch(self.time);
            }
        }
        Ok(())
    }

    /// Voltage across the membrane at `side`, V.
    pub fn voltage(&self, side: Side) -> f64 {
        self.voltages[side.index()].at(self.time)
    }

    /// The drive as it is at `time`, s, for a motion that starts there.
    fn present_drive(&self, time: f64) -> Drive {
        let drive = self.cylinder.drive;
        Drive { external: drive.external + drive.external_rate * (time - self.cylinder.start), ..drive }
    }

    pub(super) fn law(&self, side: Side) -> Law<'_> {
        Law {
            parameters: &self.parameters,
            membrane: &self.membrane,
            cylinder: &self.cylinder,
            flight: &self.search.flight,
            side,
            voltage: self.voltages[side.index()],
        }
    }

    fn recoil(&self, time: f64) -> Recoil {
        self.touch.as_ref().map_or(Recoil::default(), |touch| {
            let point = touch.at(time);
            self.law(touch.side).recoil(time, point.x, point.v)
        })
    }

    pub(super) fn cylinder_position_at(&self, time: f64) -> f64 {
        self.cylinder.position(time) + self.recoil(time).position
    }

    pub(super) fn cylinder_velocity_at(&self, time: f64) -> f64 {
        self.cylinder.velocity(time) + self.recoil(time).velocity
    }

    /// Force on the ball in the direction of z, N.
    fn contact_force(&self) -> f64 {
        self.touch
            .as_ref()
            .map_or(0.0, |touch| touch.side.sign() * self.law(touch.side).total(touch.phase, &touch.at(self.time)))
    }

    /// `z_m''` during a contact, m/s^2.
    pub(super) fn touch_acceleration(&self) -> f64 {
        self.contact_force() / self.parameters.ball_mass
    }

    /// What the contact adds to `z_M''`, m/s^2.
    pub(super) fn recoil_acceleration(&self) -> f64 {
        if self.parameters.reaction { -self.contact_force() / self.parameters.cylinder_mass } else { 0.0 }
    }

    pub(super) fn touch_deflection(&self, side: Side) -> Deflection {
        let here = self.touch.as_ref().filter(|touch| touch.side == side);
        here.map_or(Deflection::default(), |touch| {
            let point = touch.at(self.time);
            Deflection { value: point.x.max(0.0), rate: point.v }
        })
    }

    pub(super) fn held(&self) -> Option<Side> {
        // The optimiser would read the phase before it knows that there is a contact; harmless, but memory checkers object.
        let touch = core::hint::black_box(self.touch.as_ref())?;
        (touch.phase == Phase::Held).then_some(touch.side)
    }

    /// Up to where the contact is foreseen, s: to where the membrane's force changes its branch, if that is within a period.
    /// With phase noise a contact is followed hold interval by hold interval, whose ends are no knots.
    pub(super) fn touch_knot(&self) -> Option<f64> {
        let is_hold = |touch: &&Touch| touch.ending() == Ending::Cut && self.noise_limit().is_some();
        self.touch.as_ref().filter(|touch| !is_hold(touch)).map(Touch::end)
    }

    /// A contact begins at `time`, s, at relative `speed`, m/s.
    pub(super) fn touch(&mut self, time: f64, side: Side, speed: f64) {
        self.totals.impacts += 1;
        self.totals.last_speed = speed;
        self.new_flight(&self.cylinder.at(time), [self.half_travel(), speed].map(|value| side.sign() * value));
        let period = 1.0 / self.parameters.frequency;
        let loading = if speed > 0.0 { self.membrane.deflection(speed) / speed } else { period };
        self.touch = Some(Touch::new(side, time, speed, FIRST_STEP * loading.min(period)));
        self.plan_touch();
    }

    /// Works out the present pass, which reaches one excitation period or to the next noise sample at most.
    pub(super) fn plan_touch(&mut self) {
        let Some(mut touch) = self.touch.take() else { return };
        let period_end = touch.start.time + 1.0 / self.parameters.frequency;
        let limit = self.noise_limit().map_or(period_end, |limit| limit.min(period_end));
        touch.plan(&self.law(touch.side), limit);
        self.touch = Some(touch);
    }

    /// The pass of the contact has ended.
    pub(super) fn follow_touch(&mut self) -> Result<(), ModelError> {
        let Some(touch) = &self.touch else { return Ok(()) };
        let (time, steps) = (touch.end(), touch.steps());
        let law = self.law(touch.side);
        let deflection = touch.at(time).x;
        if law.is_too_deep(deflection) {
            let voltage = law.voltage.at(time);
            return Err(ModelError::TooDeep { time, deflection, bound: law.deepest(), voltage });
        }
        if steps == 0 {
            return Err(self.too_many_events(time)); // no step is short enough
        }
        (0..STEP_COST * steps).try_for_each(|_| self.spend(time))?;
        self.book_pass(time);
        let Some(touch) = &self.touch else { return Ok(()) };
        match touch.next(&self.law(touch.side)) {
            Some(next) => {
                self.touch = Some(next);
                self.plan_touch();
            }
            None => self.separate(time),
        }
        Ok(())
    }

    /// Books the works of the pass up to `time`, s, and, at a turning point, what Eqs. (12) and (13) give for the largest
    /// deflection.
    fn book_pass(&mut self, time: f64) {
        let Some(touch) = &self.touch else { return };
        let work = touch.work(time);
        let turned = touch.ending() == Ending::Turn && time == touch.end();
        let gained = turned.then(|| (touch.largest_at(time), touch.credited));
        self.ledger.wall += work.wall;
        self.ledger.electrical += work.electrical;
        if let Some((largest, credited)) = gained {
            let excess = self.membrane.capacitance_excess(largest);
            self.credit((excess - credited).max(0.0));
            if let Some(touch) = &mut self.touch {
                touch.credited = excess.max(credited);
            }
        }
    }

    /// The ball leaves the membrane at `time`, s.
    fn separate(&mut self, time: f64) {
        let (position, velocity) = (self.cylinder_position_at(time), self.ball_velocity_at(time));
        let cylinder = self.cylinder_from(time, self.present_drive(time));
        let Some(touch) = self.touch.take() else { return };
        let (sign, rate) = (touch.side.sign(), touch.at(time).v);
        self.ledger.loss += self.law(touch.side).loss(touch.largest_at(time));
        self.ledger.contact_time += time - touch.since;
        if self.parameters.reaction {
            self.cylinder = cylinder;
        }
        self.ball = Ball { since: time, position: position - sign * self.half_travel(), velocity, resting: None };
        self.new_flight(&self.cylinder.at(time), [sign * self.half_travel(), sign * rate]);
    }

    /// The cylinder's motion from `time`, s, on, the recoil of the contact included.
    fn cylinder_from(&self, time: f64, drive: Drive) -> CylinderMotion {
        CylinderMotion::new(time, self.cylinder_position_at(time), self.cylinder_velocity_at(time), drive)
    }

    /// The contact goes on from `time`, s, under another voltage.
    fn replan_touch(&mut self, time: f64) {
        self.book_pass(time);
        self.touch = self.touch.as_ref().map(|touch| touch.continued(time));
        self.plan_touch();
        self.look_ahead();
    }

    /// The contact goes on from `time`, s, under another force.
    pub(super) fn restart_touch(&mut self, time: f64, drive: Drive) {
        let Some(touch) = &self.touch else { return };
        let next = touch.continued(time);
        let sign = touch.side.sign();
        let velocity = self.ball_velocity_at(time);
        let cylinder = self.cylinder_from(time, drive);
        self.book_pass(time);
        self.cylinder = cylinder;
        let [dz, rate] = [self.half_travel() + next.start.x, next.start.v].map(|value| sign * value);
        self.search.flight = Flight::new(&self.cylinder, &self.cylinder.at(time), [dz, rate], self.half_travel());
        self.ball = Ball { since: time, position: self.cylinder.position - dz, velocity, resting: None };
        self.touch = Some(next);
        self.plan_touch();
    }
}
