//! The motion of a suspended cylinder as a power series in time, Eq. (7) with a spring and a damper to ground:
//! `z_M''` = a cos(omega t + phase) + e + e' t - c `z_M'` - k `z_M`, all over the mass that moves.
//!
//! The equation gives each derivative from the two below it. A series is used on a piece of time so short that its first
//! [`ORDER`] terms leave out less than rounding; there the next one begins. Pieces follow one another from the last event on, so
//! that no step of a caller moves them.

/// Order of the last term.
pub const ORDER: usize = 14;

/// Length of a piece in units of one over the largest rate of the equation: what a series leaves out is below
/// `REACH`^15 / 15! = 1e-16 of the motion.
const REACH: f64 = 0.55;

/// Coefficients of the powers of the time over the length of a piece.
pub type Series = [f64; ORDER + 1];

/// Spring and damper over a mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspension {
    /// k, 1/s^2.
    pub stiffness: f64,
    /// c, 1/s.
    pub damping: f64,
}

impl Suspension {
    /// The cylinder is free.
    pub const NONE: Self = Self { stiffness: 0.0, damping: 0.0 };

    /// Whether there is neither spring nor damper.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The same over a mass that is 1 / `share` times as large.
    #[must_use]
    pub fn over(&self, share: f64) -> Self {
        Self { stiffness: share * self.stiffness, damping: share * self.damping }
    }

    /// `z_M''`, m/s^2, that spring and damper give at this position, m, and velocity, m/s.
    pub fn acceleration(&self, position: f64, velocity: f64) -> f64 {
        -(self.damping * velocity + self.stiffness * position)
    }

    /// Length of a piece, s, under a force with omega, rad/s.
    pub fn piece(&self, omega: f64) -> f64 {
        REACH / omega.max(self.damping).max(self.stiffness.sqrt())
    }
}

/// A suspended cylinder at the begin of a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    pub suspension: Suspension,
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// Amplitude of the harmonic force over the mass, m/s^2.
    pub amplitude: f64,
    /// Sine and cosine of its angle.
    pub sine: [f64; 2],
    /// rad/s.
    pub omega: f64,
    /// The other forces over the mass, m/s^2, and their rate, m/s^3.
    pub external: [f64; 2],
}

impl Oscillation {
    /// The terms of `z_M` after `tau`, s: their sum is the position, and the first two are that without forces.
    pub fn terms(&self, tau: f64) -> Series {
        let Self { suspension: Suspension { stiffness, damping }, amplitude, sine: [sin, cos], omega, .. } = *self;
        let (square, turn) = (tau * tau, omega * tau);
        let (stiff, damped) = (stiffness * square, damping * tau);
        let mut terms = [0.0; ORDER + 1];
        (terms[0], terms[1]) = (self.position, self.velocity * tau);
        // The derivatives of the cosine, one after the other, with the power of the angle and its factorial.
        let harmonic = amplitude * square;
        let signs = [harmonic * cos, -harmonic * sin, -harmonic * cos, harmonic * sin];
        let mut power = 1.0;
        for n in 0..ORDER - 1 {
            let external = if n < 2 { self.external[n] * square * if n == 0 { 1.0 } else { tau } } else { 0.0 };
            let force = signs[n % 4] * power + external;
            let over = (n + 2) as f64;
            terms[n + 2] =
                (force - stiff * terms[n]) * (1.0 / ((n + 1) as f64 * over)) - damped * terms[n + 1] * (1.0 / over);
            power *= turn * (1.0 / (n + 1) as f64);
        }
        terms
    }

    /// What `tau`, s, add to position, m, beyond the way of the first velocity, and to velocity, m/s.
    pub fn change(&self, tau: f64) -> [f64; 2] {
        if tau > 0.0 { change(&self.terms(tau), tau) } else { [0.0; 2] }
    }
}

/// The same from the terms after `tau`, s.
pub fn change(terms: &Series, tau: f64) -> [f64; 2] {
    if tau == 0.0 {
        return [0.0; 2];
    }
    let (mut position, mut velocity) = (0.0, 0.0);
    for n in (2..=ORDER).rev() {
        position += terms[n];
        velocity += n as f64 * terms[n];
    }
    [position, velocity / tau]
}

/// Value and first derivative of a series at `place`. Four parts go side by side, so that a sum need not wait for the one before.
pub fn value_and_slope(series: &Series, place: f64) -> [f64; 2] {
    let square = place * place;
    let fourth = square * square;
    let (mut values, mut slopes) = ([0.0; 4], [0.0; 4]);
    for n in (0..=ORDER / 4).rev() {
        for k in 0..4 {
            let (value, slope) = (series.get(4 * n + k), series.get(4 * n + k + 1));
            values[k] = values[k] * fourth + value.copied().unwrap_or(0.0);
            slopes[k] = slopes[k] * fourth + (4 * n + k + 1) as f64 * slope.copied().unwrap_or(0.0);
        }
    }
    let sum = |[a, b, c, d]: [f64; 4]| (a + place * b) + square * (c + place * d);
    [sum(values), sum(slopes)]
}

/// The derivative of a series with its own variable.
pub fn derivative(series: &Series) -> Series {
    core::array::from_fn(|n| series.get(n + 1).map_or(0.0, |next| (n + 1) as f64 * next))
}

/// Energy that the damper takes on a piece of length `tau`, s, over the mass: the integral of c v^2.
pub fn damped_energy(damping: f64, terms: &Series, tau: f64) -> f64 {
    /// Places and weights of Gauss and Legendre on [0, 1]: with eight, an integral over a piece is exact to rounding.
    const PLACES: [f64; 8] = [
        0.019_855_071_751_231_884,
        0.101_666_761_293_186_63,
        0.237_233_795_041_835_5,
        0.408_282_678_752_175_1,
        0.591_717_321_247_825,
        0.762_766_204_958_164_5,
        0.898_333_238_706_813_4,
        0.980_144_928_248_768_1,
    ];
    const WEIGHTS: [f64; 4] =
        [0.050_614_268_145_188_13, 0.111_190_517_226_687_24, 0.156_853_322_938_943_64, 0.181_341_891_689_181];
    if damping == 0.0 || tau == 0.0 {
        return 0.0;
    }
    // All places at once, which becomes vector instructions.
    let mut velocities = [0.0; 8];
    for n in (1..=ORDER).rev() {
        for (velocity, place) in velocities.iter_mut().zip(PLACES) {
            *velocity = *velocity * place + n as f64 * terms[n];
        }
    }
    let squares = velocities.map(|velocity| velocity * velocity);
    let sum: f64 = WEIGHTS.iter().enumerate().map(|(k, weight)| weight * (squares[k] + squares[7 - k])).sum();
    sum * damping / tau
}
