//! The impulsive law in 128 bits: positions and velocities of both bodies as they are, contacts in steps that bounds of
//! acceleration and jerk show to be safe, Eqs. (4), (6), (10) and (12) as the paper prints them.

use std::f64::consts::{PI, TAU};

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use videg_model::Parameters;

type Wide = FBig<HalfEven, 2>;

const PRECISION: usize = 128;

/// A bounce lower than this, in units of s/2, is a rest.
const LOWEST_BOUNCE: f64 = 1e-18;

fn wide(value: f64) -> Wide {
    Wide::try_from(value).unwrap().with_precision(PRECISION).value()
}

fn narrow(value: &Wide) -> f64 {
    value.to_f64().value()
}

/// The motion from a start at t = 0 with a cylinder at rest at 0.
pub struct Reference {
    p: Parameters,
    half: Wide,
    /// A / M over omega^2, m, and over omega, m/s.
    swing: Wide,
    speed: Wide,
    frequency: Wide,
    time: Wide,
    /// The ball's last event, s; its position, m, and velocity, m/s, then.
    ball: [Wide; 3],
    /// Side, with the sign of dz, that the ball cannot come back to before a time, s.
    left: Option<(f64, f64)>,
    gain: f64,
}

/// Relative motion at one time, m, m/s and m/s^2.
struct Relative {
    wall: [Wide; 2],
    dz: Wide,
    rate: Wide,
    acceleration: f64,
}

impl Reference {
    pub fn new(p: Parameters) -> Self {
        let omega = Wide::pi(PRECISION) * wide(2.0) * wide(p.frequency);
        let acceleration = wide(p.amplitude) / wide(p.cylinder_mass);
        let speed = acceleration / &omega;
        Self {
            half: wide(p.travel() / 2.0),
            swing: &speed / &omega,
            speed,
            frequency: wide(p.frequency),
            time: wide(0.0),
            ball: [wide(0.0), wide(p.ball_position), wide(p.ball_velocity)],
            left: None,
            gain: 0.0,
            p,
        }
    }

    fn relative(&self, time: &Wide) -> Relative {
        let (sin, cos) = (wide(2.0) * &self.frequency * time).sin_cos_pi();
        let wall = [&self.swing * (wide(1.0) - &cos), &self.speed * &sin];
        let [since, position, velocity] = &self.ball;
        let ball = position + velocity * (time - since);
        let acceleration = self.p.amplitude / self.p.cylinder_mass * narrow(&cos);
        Relative { dz: &wall[0] - &ball, rate: &wall[1] - velocity, wall, acceleration }
    }

    /// How long the ball cannot meet the membrane at `side`, s, and whether it meets it within twice its gap over its speed.
    fn safe(&self, side: f64, here: &Relative) -> (f64, Option<f64>) {
        let jerk = self.p.amplitude / self.p.cylinder_mass * TAU * self.p.frequency;
        let gap = narrow(&(&self.half - wide(side) * &here.dz)).max(0.0);
        let (speed, push) = (side * narrow(&here.rate), side * here.acceleration);
        let by_gap = (gap / (3.0 * speed.max(0.0)))
            .min((2.0 * gap / (3.0 * push.max(0.0))).sqrt())
            .min((2.0 * gap / jerk).cbrt());
        let by_speed = if speed < 0.0 { (-speed / push.max(0.0)).min((-3.0 * speed / jerk).sqrt()) } else { 0.0 };
        let by_push = if speed <= 0.0 && push < 0.0 { -3.0 * push / jerk } else { 0.0 };
        let left = self.left.filter(|(from, _)| *from == side);
        let by_release = left.map_or(0.0, |(_, until)| until - narrow(&self.time));
        let within = 2.0 * gap / speed;
        let is_straight = speed > 0.0 && push.abs() * within <= 0.2 * speed && jerk * within * within <= 0.2 * speed;
        let safe = by_gap.max(0.9 * by_speed).max(0.9 * by_push).max(by_release);
        (safe, (is_straight && by_release <= 0.0).then_some(within))
    }

    /// Newton's method for the contact at `side`.
    fn contact(&self, side: f64) -> Wide {
        let mut time = self.time.clone();
        for _ in 0..8 {
            let there = self.relative(&time);
            let gap = &self.half - wide(side) * &there.dz;
            time += gap / (wide(side) * &there.rate);
        }
        time
    }

    pub fn voltage_gain(mut self, until: f64) -> f64 {
        while narrow(&self.time) < until {
            let here = self.relative(&self.time);
            let [(left, soon_left), (right, soon_right)] = [1.0, -1.0].map(|side| self.safe(side, &here));
            let met = [(1.0, soon_left, right), (-1.0, soon_right, left)];
            let met = met.into_iter().find(|(_, within, other)| within.is_some_and(|within| within < *other));
            match met {
                Some((side, ..)) => {
                    let time = self.contact(side);
                    if narrow(&time) > until {
                        break;
                    }
                    self.impact(side, time);
                }
                None => self.time += wide(left.min(right)),
            }
        }
        self.gain
    }

    fn impact(&mut self, side: f64, time: Wide) {
        let there = self.relative(&time);
        let speed = narrow(&there.rate) * side;
        self.gain += self.p.bias_voltage * excess(&self.p, speed);
        let rebound = wide(self.p.restitution) * &there.rate;
        let push = side * there.acceleration;
        let [position, velocity] = there.wall;
        self.ball = [time.clone(), position - wide(side) * &self.half, velocity + &rebound];
        self.time = time;
        self.left = None;
        if push > 0.0 && narrow(&rebound).powi(2) < 2.0 * push * LOWEST_BOUNCE * narrow(&self.half) {
            self.rest(side);
        }
    }

    /// Rests up to where the force next changes its sign, at an odd quarter of a period.
    fn rest(&mut self, side: f64) {
        let turns = &self.frequency * &self.time;
        let quarter = (narrow(&turns) * 2.0 - 0.5).floor() + 1.0;
        self.time = (wide(0.5 * quarter + 0.25)) / &self.frequency;
        let [position, velocity] = self.relative(&self.time).wall;
        self.ball = [self.time.clone(), position - wide(side) * &self.half, velocity];
        self.left = Some((side, narrow(&self.time) + 0.45 / self.p.frequency));
    }
}

/// `C_3` / `C_2` - 1 of an impact at relative `speed`, m/s.
fn excess(p: &Parameters, speed: f64) -> f64 {
    let (n, k, ball, radius) = (p.stiffness_exponent, p.stiffness, p.ball_radius, p.membrane_radius());
    let delta = ((n + 1.0) / (2.0 * k) * p.ball_mass * speed * speed).powf(1.0 / (n + 1.0));
    let root = (radius * radius + delta * delta - 2.0 * delta * ball).sqrt();
    let cos = (radius * root - ball * (delta - ball)) / (radius * radius + (delta - ball).powi(2));
    let segment = 2.0 * PI * ball * ball * (1.0 - cos);
    let cone = PI * (radius * radius - ball * ball * (1.0 - cos * cos)) / cos;
    ((segment + cone) / (PI * radius * radius)).powi(2) - 1.0
}
