//! Motion of the cylinder, Eq. (7), in closed form.

use core::f64::consts::TAU;

use super::mount::Load;
use super::suspended::{Oscillation, Suspension, change, damped_energy};
use crate::numerics::elementary::{ReducedAngle, round, sin_cos};
use crate::numerics::product::{cycle_fraction, product_error};
use crate::paper::excitation;
use crate::parameters::Parameters;
use crate::recording::Segment;

/// Force on the cylinder over its mass: harmonic, plus an external and a recorded part that are linear in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// A / M, m/s^2.
    pub amplitude: f64,
    /// `f_0`, Hz.
    pub frequency: f64,
    /// Phase, rad, the phase noise included.
    pub phase: f64,
    /// External force over M at the start of the motion, m/s^2.
    pub external: f64,
    /// Its rate, m/s^3.
    pub external_rate: f64,
    /// The recorded part.
    pub recorded: Segment,
}

impl Drive {
    /// The force of a harvester with these parameters at this `phase`, rad, with an external part over M, m/s^2, and its rate,
    /// m/s^3.
    pub fn new(p: &Parameters, phase: f64, [external, external_rate]: [f64; 2]) -> Self {
        let amplitude = p.harmonic_acceleration();
        Self { amplitude, frequency: p.frequency, phase, external, external_rate, recorded: Segment::NONE }
    }

    /// Whether there is an external force.
    #[inline]
    pub fn pushes(&self) -> bool {
        self.external != 0.0 || self.external_rate != 0.0
    }

    /// 2 pi `f_0`, rad/s.
    pub fn omega(&self) -> f64 {
        TAU * self.frequency
    }

    /// The part of the acceleration that is linear in time, of a cylinder under `load`, at `start`, s, where this drive begins,
    /// m/s^2, and its rate, m/s^3.
    #[inline]
    pub fn line(&self, load: &Load, start: f64) -> [f64; 2] {
        [
            load.share * (load.give * self.external + self.recorded.at(start) + load.push),
            load.share * (load.give * self.external_rate + self.recorded.rate),
        ]
    }

    /// True if the force never changes.
    pub fn is_constant(&self) -> bool {
        let Segment { rate, end, .. } = self.recorded;
        self.amplitude == 0.0 && self.external_rate == 0.0 && rate == 0.0 && end == f64::INFINITY
    }

    /// 2 pi `f_0` t + phase at `time` t, s, reduced by whole turns before the phase is added, so that a long run loses
    /// no digits.
    pub fn angle(&self, time: f64) -> f64 {
        TAU * cycle_fraction(self.frequency, time) + self.phase
    }

    /// The phase in turns, but for whole ones.
    fn own_turns(&self) -> f64 {
        let own = self.phase / TAU;
        own - round(own)
    }
}

/// The harmonic part of the motion of a cylinder.
#[derive(Debug, Clone, Copy)]
pub struct Harmonic {
    /// Amplitude of the acceleration, m/s^2.
    pub amplitude: f64,
    /// The same over omega, m/s, and over omega^2, m.
    pub speed: f64,
    pub swing: f64,
    /// `f_0`, Hz.
    pub frequency: f64,
    /// The phase of the force, in turns.
    own_turns: f64,
}

impl Harmonic {
    pub fn new(drive: &Drive, load: &Load) -> Self {
        let amplitude = load.share * drive.amplitude;
        let speed = amplitude / drive.omega();
        let swing = speed / drive.omega();
        Self { amplitude, speed, swing, frequency: drive.frequency, own_turns: drive.own_turns() }
    }

    /// Sine and cosine of the angle of the force at `time`, s.
    #[inline]
    pub fn sine(&self, time: f64) -> [f64; 2] {
        angle_at(self.frequency, time, self.own_turns).1
    }
}

/// The angle at `time`, s, of a harmonic force of this `frequency`, Hz, and of so many turns at time 0: in turns but for whole ones, and its
/// sine and cosine.
#[allow(clippy::inline_always)] // at each event
#[inline(always)]
fn angle_at(frequency: f64, time: f64, own_turns: f64) -> (f64, [f64; 2]) {
    let product = frequency * time;
    // What rounding has taken is known later.
    let about = (product - round(product)) + own_turns;
    let turns = about + product_error(frequency, time, product);
    let angle = ReducedAngle::near(turns, about);
    (turns, [angle.sin(), angle.cos()])
}

/// Changes of a harmonic force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DriveChange {
    /// Of A / M, m/s^2.
    pub amplitude: f64,
    /// Of `f_0`, Hz.
    pub frequency: f64,
    /// Of the phase, rad.
    pub phase: f64,
}

impl DriveChange {
    /// Of 2 pi `f_0` t + phase at `time` t, s.
    fn angle(&self, time: f64) -> f64 {
        TAU * self.frequency * time + self.phase
    }
}

/// Motion of the cylinder from one change of the force to the next: position and velocity at `start` and the force
/// since then. Values are evaluated from the start, never accumulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CylinderMotion {
    /// Time from which this motion holds, s.
    pub start: f64,
    /// `z_M` at the start, m.
    pub position: f64,
    /// `z_M'` at the start, m/s.
    pub velocity: f64,
    /// Force over mass.
    pub drive: Drive,
    /// What mount and ball do to the cylinder meanwhile.
    pub load: Load,
    /// Energy that the damper has taken up to the start, over M, J/kg.
    pub damped: f64,
    /// Amplitude of the acceleration, m/s^2, the constant part of the acceleration at the start, m/s^2, and its rate, m/s^3.
    amplitude: f64,
    external: [f64; 2],
    /// The phase of the harmonic force, in turns.
    own_turns: f64,
    /// Sine and cosine of its angle at the start.
    sin_start: f64,
    cos_start: f64,
    /// A / M over omega, m/s, and over omega^2, m: the amplitude of the oscillation under the harmonic force alone.
    speed: f64,
    pub(super) swing: f64,
}

/// The cylinder at one time.
#[derive(Debug, Clone, Copy)]
pub struct CylinderState {
    /// t, s.
    pub time: f64,
    /// `z_M`, m.
    pub position: f64,
    /// `z_M'`, m/s: Eq. (7) integrated once.
    pub velocity: f64,
    /// `z_M''`, m/s^2: Eq. (7).
    pub acceleration: f64,
    /// `z_M'''`, m/s^3.
    pub jerk: f64,
    /// Angle of the harmonic force, in turns, and its sine and cosine.
    pub turns: f64,
    /// Its sine and cosine.
    pub sine: [f64; 2],
    /// Energy that the damper has taken up to then, over M, J/kg.
    pub damped: f64,
}

impl CylinderMotion {
    /// Motion from `position`, m, and `velocity`, m/s, at `start`, s, under `drive` and `load`.
    pub fn new(start: f64, position: f64, velocity: f64, drive: Drive, load: Load) -> Self {
        let harmonic = Harmonic::new(&drive, &load);
        Self::with_sine((start, position, velocity), drive, load, &harmonic, harmonic.sine(start))
    }

    /// The same if sine and cosine of the angle of this `harmonic` force at the start are known.
    #[inline]
    fn with_sine(
        (start, position, velocity): (f64, f64, f64),
        drive: Drive,
        load: Load,
        harmonic: &Harmonic,
        [sin_start, cos_start]: [f64; 2],
    ) -> Self {
        let Harmonic { amplitude, own_turns, speed, swing, .. } = *harmonic;
        let (external, damped) = (drive.line(&load, start), 0.0);
        Self {
            start,
            position,
            velocity,
            drive,
            load,
            damped,
            amplitude,
            external,
            own_turns,
            sin_start,
            cos_start,
            speed,
            swing,
        }
    }

    /// The angle of the harmonic force at `time`, s, in turns, and its sine and cosine.
    #[allow(clippy::inline_always)] // at each event
    #[inline(always)]
    fn angle(&self, time: f64) -> (f64, [f64; 2]) {
        angle_at(self.drive.frequency, time, self.own_turns)
    }

    /// All of the motion at `time`, s.
    #[allow(clippy::inline_always)] // as a copy of what a call returns, sine and cosine would arrive late
    #[inline(always)]
    pub(crate) fn at(&self, time: f64) -> CylinderState {
        let (turns, sine) = self.angle(time);
        self.at_angle(time, turns, sine)
    }

    /// The same at its start.
    #[inline]
    pub(crate) fn at_start(&self) -> CylinderState {
        self.at_angle(self.start, self.angle(self.start).0, [self.sin_start, self.cos_start])
    }

    /// The same where the angle of the harmonic force is so many `turns`, and has this `sine` and cosine.
    #[inline]
    fn at_angle(&self, time: f64, turns: f64, sine: [f64; 2]) -> CylinderState {
        let Self { amplitude, external: [external, external_rate], .. } = *self;
        let ([sin, cos], elapsed) = (sine, time - self.start);
        let acceleration = excitation::acceleration(amplitude, cos, external) + external_rate * elapsed;
        let jerk = external_rate - amplitude * self.drive.omega() * sin;
        if self.is_suspended() {
            return self.suspended_at(CylinderState {
                time,
                position: self.position,
                velocity: self.velocity,
                acceleration,
                jerk,
                turns,
                sine,
                damped: self.damped,
            });
        }
        let drift = self.velocity - self.speed * self.sin_start;
        let displacement = 0.5 * external + elapsed * external_rate * (1.0 / 6.0);
        CylinderState {
            time,
            position: self.position + self.swing * (self.cos_start - cos) + elapsed * (drift + elapsed * displacement),
            velocity: self.velocity
                + self.speed * (sin - self.sin_start)
                + elapsed * (external + 0.5 * external_rate * elapsed),
            acceleration,
            jerk,
            turns,
            sine,
            damped: self.damped,
        }
    }

    /// The same of a suspended cylinder, from what the forces alone would make of acceleration and jerk.
    #[inline(never)] // what a free cylinder does stays small
    fn suspended_at(&self, forced: CylinderState) -> CylinderState {
        let (suspension, elapsed) = (self.suspension(), forced.time - self.start);
        let ([mut position, mut velocity], mut damped) = ([self.position, self.velocity], forced.damped);
        if elapsed != 0.0 {
            let terms = self.oscillation().terms(elapsed);
            [position, velocity] = self.after(elapsed, change(&terms, elapsed));
            damped += damped_energy(self.load.suspension.damping, &terms, elapsed);
        }
        let acceleration = forced.acceleration + suspension.acceleration(position, velocity);
        let jerk = forced.jerk + suspension.acceleration(velocity, acceleration);
        CylinderState { position, velocity, acceleration, jerk, damped, ..forced }
    }

    /// First-order changes of position, m, and velocity, m/s, at `time`, s, with the harmonic force; the values at the start
    /// stay.
    pub fn change(&self, time: f64, drive: &DriveChange) -> [f64; 2] {
        let (elapsed, omega) = (time - self.start, self.drive.omega());
        let stiffer = TAU * drive.frequency / omega;
        let speed = self.amplitude / omega;
        let speed_change = self.load.share * drive.amplitude / omega - speed * stiffer;
        let swing_change = (speed_change - speed * stiffer) / omega;
        let (_, [sin, cos]) = self.angle(time);
        let [from, to] = [self.start, time].map(|time| drive.angle(time));
        let position = swing_change * (self.cos_start - cos) + speed / omega * (sin * to - self.sin_start * from);
        let drift = speed_change * self.sin_start + speed * self.cos_start * from;
        let velocity = speed_change * (sin - self.sin_start) + speed * (cos * to - self.cos_start * from);
        [position - elapsed * drift, velocity]
    }

    /// First-order change of the acceleration, m/s^2, at `time`, s, with the harmonic force.
    pub fn acceleration_change(&self, time: f64, drive: &DriveChange) -> f64 {
        let (_, [sin, cos]) = self.angle(time);
        self.load.share * drive.amplitude * cos - self.amplitude * sin * drive.angle(time)
    }

    /// Position and velocity `elapsed`, s, after the start, of a suspended cylinder to which that adds this.
    pub(super) fn after(&self, elapsed: f64, [farther, faster]: [f64; 2]) -> [f64; 2] {
        [self.position + (self.velocity * elapsed + farther), self.velocity + faster]
    }

    /// The drive as it is at `time`, s, for a motion that starts there.
    pub fn drive_at(&self, time: f64) -> Drive {
        let drive = self.drive;
        Drive { external: drive.external + drive.external_rate * (time - self.start), ..drive }
    }

    /// The same motion described from `time`, s, on, under another drive.
    #[must_use]
    pub fn continued(&self, time: f64, drive: Drive) -> Self {
        let here = self.at(time);
        Self::from_state(&here, drive, self.load)
    }

    /// The motion that goes on from `here` under this drive and load.
    pub fn from_state(here: &CylinderState, drive: Drive, load: Load) -> Self {
        Self { damped: here.damped, ..Self::new(here.time, here.position, here.velocity, drive, load) }
    }

    /// The motion that goes on from `here`, a place of this one, under another load.
    #[must_use]
    pub fn loaded(&self, here: &CylinderState, load: Load) -> Self {
        let CylinderState { time, position, velocity, sine, damped, .. } = *here;
        let drive = self.drive_at(time);
        let harmonic = Harmonic::new(&drive, &load);
        Self { damped, ..Self::with_sine((time, position, velocity), drive, load, &harmonic, sine) }
    }

    /// Whether spring or damper hold it.
    #[inline]
    pub fn is_suspended(&self) -> bool {
        !self.load.suspension.is_none()
    }

    /// Spring and damper over the mass that moves.
    fn suspension(&self) -> Suspension {
        self.load.suspension.over(self.load.share)
    }

    /// Time, s, for which the series of a suspended cylinder holds; infinite if it is free.
    #[inline]
    pub fn piece(&self) -> f64 {
        if self.is_suspended() { self.suspension().piece(self.drive.omega()) } else { f64::INFINITY }
    }

    /// The oscillation of a suspended cylinder, at the start.
    pub fn oscillation(&self) -> Oscillation {
        let Self { position, velocity, amplitude, external, .. } = *self;
        let (suspension, sine) = (self.suspension(), [self.sin_start, self.cos_start]);
        Oscillation { suspension, position, velocity, amplitude, sine, omega: self.drive.omega(), external }
    }

    /// `z_M''`, m/s^2, of a suspended cylinder `elapsed`, s, after the start.
    pub fn suspended_acceleration(&self, elapsed: f64) -> f64 {
        let terms = self.oscillation().terms(elapsed);
        let sums = terms
            .iter()
            .enumerate()
            .rev()
            .fold([0.0; 2], |[value, slope], (n, term)| [value + term, slope + n as f64 * term]);
        let velocity = if elapsed > 0.0 { sums[1] / elapsed } else { self.velocity };
        let [external, rate] = self.external;
        let [sin, cos] = sin_cos(cycle_fraction(self.drive.frequency, elapsed));
        let cosine = self.cos_start * cos - self.sin_start * sin;
        excitation::acceleration(self.amplitude, cosine, external)
            + rate * elapsed
            + self.suspension().acceleration(sums[0], velocity)
    }

    /// The constant part of `z_M''` at `time`, s, in m/s^2, and its rate, m/s^3.
    pub fn external_at(&self, time: f64) -> [f64; 2] {
        let [external, rate] = self.external;
        [external + rate * (time - self.start), rate]
    }

    /// Sum of the absolute terms of `z_M''`, m/s^2, where the cylinder is `here`.
    pub fn size_at(&self, here: &CylinderState) -> f64 {
        let (Suspension { stiffness, damping }, [external, _]) = (self.suspension(), self.external_at(here.time));
        self.amplitude + external.abs() + (stiffness * here.position).abs() + (damping * here.velocity).abs()
    }

    /// Sum of the absolute terms of `z_M''`, m/s^2, of spring and damper within `length`, s, from `time`, s, on.
    pub fn size_of_mount(&self, time: f64, length: f64) -> f64 {
        if !self.is_suspended() {
            return 0.0;
        }
        let (Suspension { stiffness, damping }, here) = (self.suspension(), self.at(time));
        let [velocity, acceleration] = [here.velocity, here.acceleration].map(f64::abs);
        stiffness * (here.position.abs() + length * velocity) + damping * (velocity + length * acceleration)
    }

    /// What `acceleration`, `z_M''`, m/s^2, would be if the ball did not act on the cylinder.
    pub fn unloaded(&self, acceleration: f64) -> f64 {
        acceleration * self.load.mass - self.load.push
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn velocity_and_acceleration_are_the_derivatives_of_position() {
        let drive = Drive {
            amplitude: 4.0,
            frequency: 2.0,
            phase: 0.3,
            external: 0.7,
            external_rate: -0.2,
            recorded: Segment::NONE,
        };
        let motion =
            CylinderMotion::new(0.37, 0.01, -0.2, drive, Load { mass: 1.25, share: 0.8, push: 0.3, ..Load::NONE });
        for k in 0..50 {
            let (t, h) = (0.4 + 0.06 * f64::from(k), 1e-4);
            let slope =
                |f: &dyn Fn(f64) -> f64| (8.0 * (f(t + h) - f(t - h)) - (f(t + 2.0 * h) - f(t - 2.0 * h))) / (12.0 * h);
            assert_relative_eq!(slope(&|t| motion.at(t).position), motion.at(t).velocity, epsilon = 1e-10);
            assert_relative_eq!(slope(&|t| motion.at(t).velocity), motion.at(t).acceleration, epsilon = 1e-9);
            assert_relative_eq!(slope(&|t| motion.at(t).acceleration), motion.at(t).jerk, epsilon = 1e-8);
        }
    }

    #[test]
    fn a_motion_continued_with_the_same_force_goes_on_as_before() {
        let drive = Drive {
            amplitude: 4.0,
            frequency: 2.0,
            phase: 0.3,
            external: 0.7,
            external_rate: 0.0,
            recorded: Segment::NONE,
        };
        let motion = CylinderMotion::new(0.0, 0.01, -0.2, drive, Load::NONE);
        let continued = motion.continued(1.3, drive);
        assert_relative_eq!(motion.at(2.9).position, continued.at(2.9).position, max_relative = 1e-13);
        assert_relative_eq!(motion.at(2.9).velocity, continued.at(2.9).velocity, max_relative = 1e-13);
    }
}
