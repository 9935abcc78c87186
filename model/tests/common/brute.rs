//! Small steps through the motion of any mount under any excitation but noise. They share no code with the model.
#![allow(dead_code)] // each test file uses its part
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::f64::consts::TAU;
use videg_model::{ExcitationKind, Parameters};

/// A straight line up to a time.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub start: f64,
    pub end: f64,
    pub value: f64,
    pub rate: f64,
}

impl Line {
    fn at(&self, time: f64) -> f64 {
        self.value + self.rate * (time - self.start)
    }
}

impl Default for Line {
    fn default() -> Self {
        Self { start: 0.0, end: f64::INFINITY, value: 0.0, rate: 0.0 }
    }
}

/// A recording as it excites the cylinder, and the line between two samples that holds at present.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    pub times: Vec<f64>,
    pub values: Vec<f64>,
    pub scale: f64,
    pub offset: f64,
    pub repeats: bool,
    pub line: Line,
}

impl Recorded {
    /// The line that holds from `time` on.
    pub fn line_from(&self, time: f64) -> Line {
        /// Times closer than this are the same.
        const SAME: f64 = 1e-11;
        let (Some(first), Some(last)) = (self.times.first(), self.times.last()) else { return Line::default() };
        let mut local = time - self.offset;
        if local < first - SAME {
            return Line { end: first + self.offset, ..Line::default() };
        }
        let mut shift = self.offset;
        while self.repeats && local > last - SAME {
            local -= last - first;
            shift += last - first;
        }
        let Some(next) = self.times.iter().position(|sample| *sample > local + SAME) else { return Line::default() };
        let rate = (self.values[next] - self.values[next - 1]) / (self.times[next] - self.times[next - 1]);
        Line {
            start: self.times[next - 1] + shift,
            end: self.times[next] + shift,
            value: self.scale * self.values[next - 1],
            rate: self.scale * rate,
        }
    }
}

/// A step, of length `h`, of the fourth order of Runge and Kutta.
pub fn rk4<const N: usize>(slope: impl Fn(f64, [f64; N]) -> [f64; N], t: f64, s: [f64; N], h: f64) -> [f64; N] {
    let plus = |k: [f64; N], h: f64| -> [f64; N] { std::array::from_fn(|i| s[i] + h * k[i]) };
    let k1 = slope(t, s);
    let k2 = slope(t + 0.5 * h, plus(k1, 0.5 * h));
    let k3 = slope(t + 0.5 * h, plus(k2, 0.5 * h));
    let k4 = slope(t + h, plus(k3, h));
    std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

/// What the ball does, in the brute-force integration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Mode {
    /// It slides, with this sign of dz'.
    Slides(f64),
    /// The cylinder carries it; 0: by friction alone, else by the membrane at dz of this sign.
    Carried(f64),
}

/// Equations of motion, written down again.
#[derive(Clone)]
pub struct Brute {
    p: Parameters,
    recorded: Recorded,
    /// External force, N, at t = 0, and its rate, N/s.
    force: [f64; 2],
    pub dt: f64,
    pub time: f64,
    /// `z_M`, `z_M'`, `z_m`, `z_m'`.
    pub state: [f64; 4],
    mode: Mode,
    pub impacts: Vec<(f64, f64)>,
}

impl Brute {
    pub fn new(p: Parameters, dt: f64) -> Self {
        Self::excited(p, Recorded::default(), [0.0; 2], dt)
    }

    /// The same with a recording and an external force.
    pub fn excited(p: Parameters, recorded: Recorded, force: [f64; 2], dt: f64) -> Self {
        let state = [p.cylinder_position, p.cylinder_velocity, p.ball_position, p.ball_velocity];
        let recorded = Recorded { line: recorded.line_from(0.0), ..recorded };
        let mut brute = Self { p, recorded, force, dt, time: 0.0, state, mode: Mode::Slides(0.0), impacts: Vec::new() };
        brute.mode = brute.mode_of(state[1] - state[3]);
        brute
    }

    fn driven(&self) -> bool {
        self.p.excitation_kind == ExcitationKind::Motion
    }

    fn reacts(&self) -> bool {
        self.p.reaction && !self.driven()
    }

    /// Accelerations of cylinder and ball.
    fn accelerations(&self, time: f64, state: [f64; 4], mode: Mode) -> [f64; 2] {
        let p = &self.p;
        let (big, small) = (p.cylinder_mass, p.ball_mass);
        let cosine = (TAU * p.frequency * time + p.phase).cos();
        let weight = -small * p.gravity * p.inclination.sin();
        let recorded = self.recorded.line.at(time);
        let given = recorded + self.force[0] + self.force[1] * time;
        let force = p.amplitude * cosine + given - p.suspension_stiffness * state[0] - p.suspension_damping * state[1];
        match mode {
            Mode::Slides(slip) => {
                let friction = slip * p.friction * small * p.gravity * p.inclination.cos();
                let back = if self.reacts() { -friction } else { 0.0 };
                let of_cylinder = if self.driven() { p.acceleration * cosine + recorded } else { (force + back) / big };
                [of_cylinder, (weight + friction) / small]
            }
            Mode::Carried(_) => {
                let of_both = if self.driven() {
                    p.acceleration * cosine + recorded
                } else if p.reaction {
                    (force + weight) / (big + small)
                } else {
                    force / big
                };
                [of_both, of_both]
            }
        }
    }

    fn after(&self, h: f64) -> [f64; 4] {
        let slope = |time: f64, s: [f64; 4]| {
            let [a, b] = self.accelerations(time, s, self.mode);
            [s[1], a, s[3], b]
        };
        rk4(slope, self.time, self.state, h)
    }

    /// Force over m on a ball that moves with the cylinder.
    fn needed(&self) -> f64 {
        let [_, of_ball] = self.accelerations(self.time, self.state, Mode::Carried(0.0));
        of_ball + self.p.gravity * self.p.inclination.sin()
    }

    fn limit(&self) -> f64 {
        self.p.friction * self.p.gravity * self.p.inclination.cos()
    }

    /// Mode of a ball with this rate of dz, off the membranes.
    fn mode_of(&self, rate: f64) -> Mode {
        if self.p.friction == 0.0 {
            Mode::Slides(0.0)
        } else if rate != 0.0 {
            Mode::Slides(rate.signum())
        } else if self.needed().abs() <= self.limit() {
            Mode::Carried(0.0)
        } else {
            Mode::Slides(self.needed().signum())
        }
    }

    fn step(&mut self) {
        let half = self.p.travel() / 2.0;
        // Whether a ball that is carried leaves is looked at between steps: a jump of the recording has some, too.
        let Line { start, end: line_end, .. } = self.recorded.line;
        let left = line_end - self.time;
        let piece = self.dt.min(0.05 * (line_end - start));
        let mut rest = if left < 1.5 * piece { left } else { piece };
        let end = if rest == left { line_end } else { self.time + rest };
        for _ in 0..50 {
            if let Mode::Carried(side) = self.mode {
                let leaves =
                    if side == 0.0 { self.needed().abs() > self.limit() } else { side * self.needed() < -self.limit() };
                if leaves {
                    let slip = if side == 0.0 { self.needed().signum() } else { -side };
                    self.mode = Mode::Slides(if self.p.friction == 0.0 { 0.0 } else { slip });
                }
            }
            let dz = |s: &[f64; 4]| s[0] - s[2];
            let rate = |s: &[f64; 4]| s[1] - s[3];
            let over = |s: &Self, h: f64| -> f64 {
                // Positive: beyond a membrane, or sliding back.
                let there = s.after(h);
                let beyond = dz(&there).abs() - half;
                let outward = dz(&there) * rate(&there) > 0.0;
                let turned = match s.mode {
                    Mode::Slides(slip) if slip != 0.0 => -slip * rate(&there),
                    _ => -1.0,
                };
                (if outward { beyond } else { -1.0 }).max(turned)
            };
            if matches!(self.mode, Mode::Carried(_)) || over(self, rest) <= 0.0 {
                self.state = self.after(rest);
                self.time = end;
                if end == self.recorded.line.end {
                    self.recorded.line = self.recorded.line_from(end);
                }
                return;
            }
            let (mut a, mut b) = (0.0, rest);
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                if over(self, middle) > 0.0 { b = middle } else { a = middle }
            }
            (self.state, rest) = (self.after(b), rest - b);
            self.time += b;
            let side = dz(&self.state).signum();
            if dz(&self.state).abs() >= half - 1e-13 && side * rate(&self.state) > 0.0 {
                self.bounce(side);
            } else {
                self.state[3] = self.state[1];
                self.mode = self.mode_of(0.0);
            }
        }
    }

    fn bounce(&mut self, side: f64) {
        let (p, half) = (self.p, self.p.travel() / 2.0);
        let rate = self.state[1] - self.state[3];
        self.impacts.push((self.time, rate.abs()));
        let ratio = if self.reacts() { p.ball_mass / p.cylinder_mass } else { 0.0 };
        let change = (1.0 + p.restitution) * rate / (1.0 + ratio);
        self.state[1] -= ratio * change;
        self.state[3] += change;
        let rebound = (self.state[1] - self.state[3]).abs();
        let push = side * self.needed() * (1.0 + ratio);
        let friction = self.limit() * (1.0 + ratio);
        self.mode = self.mode_of(-side * rebound);
        let is_short = push > -friction && 2.0 * rebound / (push + friction) < 2.0 * self.dt;
        if is_short && push > friction {
            let both =
                (p.cylinder_mass * self.state[1] + p.ball_mass * self.state[3]) / (p.cylinder_mass + p.ball_mass);
            if self.reacts() {
                self.state[1] = both;
            }
            self.state[3] = self.state[1];
            self.state[2] = self.state[0] - side * half;
            self.mode = Mode::Carried(side);
        }
    }

    pub fn run(&mut self, until: f64) {
        while self.time < until - 0.5 * self.dt {
            self.step();
        }
    }
}

/// Small steps through membranes that are pressed in, with friction.
pub fn small_steps(p: &Parameters, recorded: &Recorded, until: f64, dt: f64) -> SmallSteps {
    let mut largest = 0.0_f64;
    small_steps_in(p, recorded, until, dt, |_, x, _| {
        let is_deepest = x >= largest;
        largest = if x == 0.0 { 0.0 } else { largest.max(x) };
        let upper = p.stiffness * x.powf(p.stiffness_exponent);
        let lower = p.restitution * p.restitution * upper;
        [lower, if is_deepest { upper } else { lower }]
    })
}

/// The same through membranes of any law: the least and the largest force at `side` and the depth x, m, of a ball with this rate.
pub fn small_steps_in(
    p: &Parameters,
    recorded: &Recorded,
    until: f64,
    dt: f64,
    mut membrane: impl FnMut(f64, f64, f64) -> [f64; 2],
) -> SmallSteps {
    let half = p.travel() / 2.0;
    let mut s = [p.cylinder_position, p.cylinder_velocity, p.ball_position, p.ball_velocity];
    let (mut was_free, mut contacts) = (true, Vec::new());
    let ratio = if p.reaction { p.ball_mass / p.cylinder_mass } else { 0.0 };
    let friction = p.friction * p.gravity * p.inclination.cos() * (1.0 + ratio);
    let mut line = recorded.line_from(0.0);
    let steps = (until / dt).round() as u64;
    for k in 0..steps {
        let time = (k as f64 + 0.5) * dt;
        let (dz, rate) = (s[0] + 0.5 * dt * s[1] - s[2] - 0.5 * dt * s[3], s[1] - s[3]);
        let (side, x) = (dz.signum(), (dz.abs() - half).max(0.0));
        if was_free && x > 0.0 {
            contacts.push((time, rate.abs()));
        }
        was_free = x == 0.0;
        let [lower, upper] = membrane(side, x, side * rate);
        if time > line.end {
            line = recorded.line_from(time);
        }
        let excitation = line.at(time) + p.amplitude * (TAU * p.frequency * time + p.phase).cos();
        let of_cylinder =
            (excitation - p.suspension_stiffness * (s[0] + 0.5 * dt * s[1]) - p.suspension_damping * s[1])
                / p.cylinder_mass;
        let push = side * (of_cylinder + p.gravity * p.inclination.sin());
        let v = side * rate;
        // Relative accelerations that the membrane can give; at the largest depth anything between both.
        let [low, high] = [lower, upper].map(|force| force / p.ball_mass * (1.0 + ratio));
        let membrane = if x == 0.0 {
            0.0
        } else if v > 0.0 {
            high
        } else if v == 0.0 {
            push.clamp(low, high)
        } else {
            low
        };
        let free = v + dt * (push - membrane);
        let next = if free > dt * friction {
            free - dt * friction
        } else if free < -dt * friction {
            free + dt * friction
        } else {
            0.0
        };
        // A ball that would turn within the step stops, so that the next one decides.
        let next = if v * next < 0.0 { 0.0 } else { next };
        let internal = (push - (next - v) / dt) / (1.0 + ratio);
        let before = s;
        s[1] += dt * (of_cylinder - ratio * side * internal);
        s[3] = s[1] - side * next;
        s[0] += 0.5 * dt * (before[1] + s[1]);
        s[2] += 0.5 * dt * (before[3] + s[3]);
    }
    let [z, v, b, w] = s;
    SmallSteps { positions: [z, b, v, w], contacts }
}

/// Where small steps come.
pub struct SmallSteps {
    /// Positions of cylinder and ball, and their velocities.
    pub positions: [f64; 4],
    /// Begins of contacts, s, and relative speeds there, m/s.
    pub contacts: Vec<(f64, f64)>,
}
