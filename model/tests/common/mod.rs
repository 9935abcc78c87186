//! The paper's own method, as a baseline: fourth-order Runge-Kutta with a fixed step.
#![allow(dead_code)] // each test file uses its part

use std::f64::consts::TAU;
use videg_model::{Harvester, Membrane, Parameters};

/// One impact.
#[derive(Debug, Clone, Copy)]
pub struct Impact {
    pub time: f64,
    pub speed: f64,
}

/// Steps Eq. (7) with RK4. Impacts are located inside the step, so that the method is of high order; with
/// `as_the_paper`, Eq. (11) is applied at the end of each step that ends beyond a membrane, as a plain program would.
pub struct Stepper {
    pub p: Parameters,
    pub dt: f64,
    pub as_the_paper: bool,
    pub time: f64,
    pub cylinder: [f64; 2],
    pub ball: [f64; 2],
    pub impacts: Vec<Impact>,
    /// Side on which the ball rests, with the sign of dz.
    pub resting: Option<f64>,
}

impl Stepper {
    pub fn new(p: Parameters, dt: f64) -> Self {
        Self {
            p,
            dt,
            as_the_paper: false,
            time: 0.0,
            cylinder: [p.cylinder_position, p.cylinder_velocity],
            ball: [p.ball_position, p.ball_velocity],
            impacts: Vec::new(),
            resting: None,
        }
    }

    fn acceleration(&self, time: f64) -> f64 {
        self.p.amplitude / self.p.cylinder_mass * (TAU * self.p.frequency * time + self.p.phase).cos()
    }

    /// Cylinder after a step of RK4.
    fn cylinder_after(&self, h: f64) -> [f64; 2] {
        let [z, v] = self.cylinder;
        let (a0, a1, a2) =
            (self.acceleration(self.time), self.acceleration(self.time + 0.5 * h), self.acceleration(self.time + h));
        [z + h * v + h * h / 6.0 * (a0 + 2.0 * a1), v + h / 6.0 * (a0 + 4.0 * a1 + a2)]
    }

    fn advance_by(&mut self, h: f64) {
        self.cylinder = self.cylinder_after(h);
        self.ball[0] += h * self.ball[1];
        self.time += h;
    }

    pub fn dz(&self) -> f64 {
        self.cylinder[0] - self.ball[0]
    }

    fn bounce(&mut self) {
        let side = self.dz().signum();
        let speed = side * (self.cylinder[1] - self.ball[1]);
        self.impacts.push(Impact { time: self.time, speed });
        self.ball[1] = self.cylinder[1] + self.p.restitution * side * speed;
    }

    pub fn step(&mut self, n: u64) {
        if self.as_the_paper {
            self.advance_by(self.dt);
            let outward = self.dz() * (self.cylinder[1] - self.ball[1]) > 0.0;
            if self.dz().abs() >= self.p.travel() / 2.0 && outward {
                self.bounce();
            }
        } else {
            self.located_step();
        }
        self.time = n as f64 * self.dt; // the grid is the product, not the sum
    }

    /// A step in which impacts are located; a ball whose bounces are shorter than the step rests.
    fn located_step(&mut self) {
        let half = self.p.travel() / 2.0;
        if let Some(side) = self.resting {
            if side * self.acceleration(self.time) >= 0.0 {
                self.advance_by(self.dt);
                self.ball = [self.cylinder[0] - side * half, self.cylinder[1]];
                return;
            }
            self.resting = None;
        }
        let mut rest = self.dt;
        for _ in 0..20 {
            let ahead = self.cylinder_after(rest)[0] - (self.ball[0] + rest * self.ball[1]);
            let outward = ahead * (self.cylinder_after(rest)[1] - self.ball[1]) > 0.0;
            if ahead.abs() < half || !outward {
                return self.advance_by(rest);
            }
            let side = ahead.signum();
            // Within a step dz is a parabola to far better than the tolerance: two secant steps suffice.
            let gap = |s: &Self, h: f64| half - side * (s.cylinder_after(h)[0] - (s.ball[0] + h * s.ball[1]));
            let (mut a, mut b) = (0.0, rest);
            for _ in 0..60 {
                let mid = 0.5 * (a + b);
                if gap(self, mid) > 0.0 { a = mid } else { b = mid }
            }
            self.advance_by(b);
            self.bounce();
            rest -= b;
            let rebound = (self.cylinder[1] - self.ball[1]).abs();
            let push = side * self.acceleration(self.time);
            if push > 0.0 && 2.0 * rebound / push < 2.0 * self.dt {
                self.resting = Some(side);
                self.advance_by(rest);
                self.ball = [self.cylinder[0] - side * half, self.cylinder[1]];
                return;
            }
        }
        panic!("more than 20 impacts in one step at {} s", self.time);
    }

    pub fn run(&mut self, until: f64) {
        let (mut n, end) = ((self.time / self.dt).round() as u64, (until / self.dt).round() as u64);
        while n < end {
            n += 1;
            self.step(n);
        }
    }

    /// Power of the impacts from `from` on, W, Eq. (14).
    pub fn power(&self, from: f64, until: f64) -> f64 {
        let membrane = Membrane::new(&self.p);
        let counted = self.impacts.iter().filter(|impact| impact.time > from && impact.time <= until);
        let energy: f64 = counted
            .map(|i| {
                0.5 * self.p.bias_voltage.powi(2)
                    * membrane.rest_capacitance()
                    * membrane.capacitance_excess(membrane.deflection(i.speed))
            })
            .sum();
        energy / (until - from)
    }
}

/// Voltage gain, V/s (Eq. 15), and power, W (Eq. 14), between `from` and `until`, s.
pub fn averages(parameters: &Parameters, from: f64, until: f64) -> (f64, f64) {
    let mut harvester = Harvester::new(parameters, 0.0).unwrap();
    harvester.advance(from).unwrap();
    let start = *harvester.totals();
    harvester.advance(until).unwrap();
    let end = harvester.totals();
    let duration = until - from;
    ((end.voltage_gain - start.voltage_gain) / duration, (end.energy - start.energy) / duration)
}
