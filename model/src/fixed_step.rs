//! The paper's own method for many nearby starts at once: Runge-Kutta of fourth order with a fixed step, and Eq. (11)
//! where a step ends beyond a membrane. The cylinder does not feel the balls, so one serves them all. Only what the paper has counts: the
//! harmonic force on a free, level cylinder and the impulsive law; other parameters are not looked at.

use std::f64::consts::TAU;

use crate::membrane::Membrane;
use crate::parameters::Parameters;

/// Averages over a window of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stepped {
    /// `<U>`, Eq. (15), V/s.
    pub voltage_gain: f64,
    /// P, Eq. (14), W.
    pub power: f64,
    /// Impacts counted.
    pub impacts: u64,
}

/// What the impacts of a ball gave.
#[derive(Debug, Clone, Copy, Default)]
struct Gain {
    /// Sum of `C_3` / `C_2` - 1.
    excess: f64,
    impacts: u64,
}

/// Most half steps of a period that are kept.
const MOST_HALF_STEPS: f64 = 4e6;

/// A cylinder with many balls that do not feel each other.
pub struct FixedStep {
    parameters: Parameters,
    drive: Drive,
    membrane: Membrane,
    /// s.
    step: f64,
    steps: u64,
    /// `z_M`, m, its rate, m/s, and that of the rate, m/s^2.
    cylinder: [f64; 3],
    /// Of the balls: `z_m`, m, its rate, m/s, and what they gained.
    positions: Vec<f64>,
    velocities: Vec<f64>,
    gains: Vec<Gain>,
}

impl FixedStep {
    /// The paper's time step, s (Section 4.2).
    pub const PAPER: f64 = 1e-5;

    /// Balls that start with `velocities`, m/s, to be followed by a `step`, s. One that starts beyond a membrane starts on it.
    pub fn new(parameters: &Parameters, velocities: &[f64], step: f64) -> Self {
        let p = *parameters;
        let half = p.travel() / 2.0;
        let position = p.ball_position.clamp(p.cylinder_position - half, p.cylinder_position + half);
        Self {
            parameters: p,
            drive: Drive::new(&p, step),
            membrane: Membrane::new(&p),
            step,
            steps: 0,
            cylinder: [p.cylinder_position, p.cylinder_velocity, acceleration(&p, 0.0)],
            positions: vec![position; velocities.len()],
            velocities: velocities.to_vec(),
            gains: vec![Gain::default(); velocities.len()],
        }
    }

    /// Steps on to the point of the grid that is nearest to `time`, s.
    pub fn advance(&mut self, time: f64) {
        while (self.steps as f64 + 0.5) * self.step < time {
            self.step();
        }
    }

    /// `z_M - z_m`, m, and its rate, m/s, for the first ball.
    pub fn first(&self) -> Option<[f64; 2]> {
        let [z, v, _] = self.cylinder;
        self.positions.first().zip(self.velocities.first()).map(|(position, velocity)| [z - position, v - velocity])
    }

    /// Averages of each ball over a window, s.
    pub fn run(mut self, [from, to]: [f64; 2]) -> Vec<Stepped> {
        self.advance(from);
        let before = self.gains.clone();
        self.advance(to);
        let bias = self.parameters.bias_voltage;
        let ended = self.gains.iter().zip(before).map(|(gain, before)| {
            let excess = (gain.excess - before.excess) / (to - from);
            Stepped {
                voltage_gain: bias * excess,
                power: 0.5 * bias * bias * self.membrane.rest_capacitance() * excess,
                impacts: gain.impacts - before.impacts,
            }
        });
        ended.collect()
    }

    fn step(&mut self) {
        let (p, dt) = (&self.parameters, self.step);
        let [z, v, start] = self.cylinder;
        self.steps += 1;
        // The right-hand side depends on time only: the two middle stages of the method are one.
        let [middle, end] = self.drive.next();
        let z = z + dt * v + dt * dt / 6.0 * (start + 2.0 * middle);
        let v = v + dt / 6.0 * (start + 4.0 * middle + end);
        self.cylinder = [z, v, end];
        let half = p.travel() / 2.0;
        // Mostly no ball is at a membrane: one look at all of them, in vectors.
        let mut is_there = false;
        for (position, velocity) in self.positions.iter_mut().zip(&self.velocities) {
            *position += dt * velocity;
            is_there |= (z - *position).abs() >= half;
        }
        if is_there {
            self.impacts(z, v, half);
        }
    }

    /// Eq. (11) for the balls that are beyond a membrane and go on.
    fn impacts(&mut self, z: f64, v: f64, half: f64) {
        let balls = self.positions.iter().zip(&mut self.velocities).zip(&mut self.gains);
        for ((position, velocity), gain) in balls {
            let (gap, closing) = (z - position, v - *velocity);
            if gap.abs() >= half && gap * closing > 0.0 {
                *velocity = v + self.parameters.restitution * closing;
                gain.excess += self.membrane.capacitance_excess(self.membrane.deflection(closing.abs()));
                gain.impacts += 1;
            }
        }
    }
}

/// Eq. (7) at the middles and the ends of steps.
struct Drive {
    parameters: Parameters,
    /// s.
    step: f64,
    /// Half steps that are over: of all, or of the present period if that is kept.
    over: u64,
    /// A period, which begins with the first middle, if it is a whole number of steps.
    period: Vec<f64>,
}

impl Drive {
    fn new(p: &Parameters, step: f64) -> Self {
        let steps = 1.0 / (p.frequency * step);
        let is_whole = (steps / steps.round() - 1.0).abs() < 1e-12 && 2.0 * steps <= MOST_HALF_STEPS;
        let at = |half: u64| acceleration(p, half as f64 * 0.5 * step);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and at most MOST_HALF_STEPS"
        )]
        let period = if is_whole { (1..=2 * steps.round() as u64).map(at).collect() } else { Vec::new() };
        Self { parameters: *p, step, over: 0, period }
    }

    /// m/s^2 at the middle and at the end of the next step.
    fn next(&mut self) -> [f64; 2] {
        self.over += 2;
        let kept = usize::try_from(self.over).ok().and_then(|end| self.period.get(end - 2..end));
        let Some(&[middle, end]) = kept else {
            return [1, 0].map(|back| acceleration(&self.parameters, (self.over - back) as f64 * 0.5 * self.step));
        };
        if self.over == self.period.len() as u64 {
            self.over = 0;
        }
        [middle, end]
    }
}

/// Eq. (7).
fn acceleration(p: &Parameters, time: f64) -> f64 {
    p.amplitude / p.cylinder_mass * (TAU * p.frequency * time + p.phase).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Case, Harvester};

    fn parameters(case: &str) -> Parameters {
        (Case::find(case).unwrap().parameters)()
    }

    #[test]
    fn a_period_that_is_kept_is_the_one_that_is_worked_out() {
        let p = parameters("fig14");
        let mut kept = Drive::new(&p, 1e-3);
        assert_eq!(kept.period.len(), 1000);
        let mut other = Drive { parameters: p, step: 1e-3, over: 0, period: Vec::new() };
        for _ in 0..10_000 {
            for (a, b) in kept.next().into_iter().zip(other.next()) {
                assert!((a - b).abs() < 1e-12 * p.amplitude / p.cylinder_mass, "{a} and {b} m/s^2");
            }
        }
        assert!(Drive::new(&p, 0.7e-3).period.is_empty());
        assert!(Drive::new(&Parameters { frequency: 0.0, ..p }, 1e-3).period.is_empty());
    }

    #[test]
    #[cfg_attr(miri, ignore = "half a million steps of safe code or more")]
    fn a_ball_goes_its_own_way_whoever_else_is_there() {
        let p = parameters("fig13");
        let velocities = [0.0, 1e-4, -1e-4];
        let together = FixedStep::new(&p, &velocities, FixedStep::PAPER).run([1.0, 5.0]);
        let alone = velocities.map(|velocity| FixedStep::new(&p, &[velocity], FixedStep::PAPER).run([1.0, 5.0])[0]);
        assert!(together[0].impacts > 0);
        assert_eq!(together, alone);
    }

    #[test]
    #[cfg_attr(miri, ignore = "half a million steps of safe code or more")]
    fn a_damped_motion_is_that_of_the_model_to_the_first_order_of_the_step() {
        let p = parameters("fig14");
        let stepped = FixedStep::new(&p, &[p.ball_velocity], FixedStep::PAPER).run([0.0, 10.0])[0].voltage_gain;
        let mut model = Harvester::new(&p, 0.0).unwrap();
        model.advance(10.0).unwrap();
        let exact = model.totals().voltage_gain / 10.0;
        assert!((stepped / exact - 1.0).abs() < 1e-2, "{stepped} V/s against {exact} V/s");
    }

    #[test]
    #[cfg_attr(miri, ignore = "half a million steps of safe code or more")]
    fn a_ball_that_rests_counts_an_impact_at_every_step() {
        let p = parameters("table3-2hz");
        let found = FixedStep::new(&p, &[p.ball_velocity], FixedStep::PAPER).run([50.0, 100.0])[0];
        // Without these impacts it is 0.0530 W.
        assert!((found.power / 0.0612 - 1.0).abs() < 2e-3, "{found:?}");
        assert!(found.impacts > 1_000_000, "{found:?}");
    }
}
