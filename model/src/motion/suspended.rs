//! The motion of a suspended cylinder as a power series in time, Eq. (7) with a spring and a damper to ground:
//! `z_M''` = a cos(omega t + phase) + e + e' t - c `z_M'` - k `z_M`, all over the mass that moves.
//!
//! The equation gives each derivative from the two below it. A series is used on a piece of time so short that its first
//! [`ORDER`] terms leave out less than rounding; there the next one begins. Pieces follow one another from the last event on, so
//! that no step of a caller moves them.

/// Order of the last term.
pub const ORDER: usize = 15;

/// Length of a piece in units of one over the largest rate of the equation: what a series leaves out is below
/// `REACH`^16 / 16! = 5e-17 of the motion.
const REACH: f64 = 0.65;

/// 1 / n.
const INVERSES: Series = {
    let mut inverses = [0.0; ORDER + 1];
    let mut n = 1;
    while n <= ORDER {
        inverses[n] = 1.0 / n as f64;
        n += 1;
    }
    inverses
};

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

    /// Whether there is neither spring nor damper, of which none is negative.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.stiffness + self.damping <= 0.0
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
        // Forces and factors first: they do not wait for the term before.
        let mut forces = [0.0; ORDER - 1];
        let mut power = 1.0;
        for (n, force) in forces.iter_mut().enumerate() {
            *force = signs[n % 4] * power;
            power *= turn * INVERSES[n + 1];
        }
        forces[0] += self.external[0] * square;
        forces[1] += self.external[1] * square * tau;
        for n in 0..ORDER - 1 {
            let (once, twice) = (INVERSES[n + 2], INVERSES[n + 1] * INVERSES[n + 2]);
            terms[n + 2] = (forces[n] * twice - (stiff * twice) * terms[n]) - (damped * once) * terms[n + 1];
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
    // Four sums of each go side by side, so that one need not wait for the other.
    let [_, _, second, third, rest @ ..] = terms;
    let (mut position, mut velocity) = ([0.0, 0.0, *second, *third], [0.0, 0.0, 2.0 * second, 3.0 * third]);
    let mut orders = [4.0, 5.0, 6.0, 7.0];
    for four in rest.chunks_exact(4) {
        for k in 0..4 {
            position[k] += four[k];
            velocity[k] += orders[k] * four[k];
            orders[k] += 4.0;
        }
    }
    let [position, velocity] = [position, velocity].map(|[a, b, c, d]| (a + b) + (c + d));
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
    /// Places and weights of Gauss and Legendre on [0, 1]: with six, an integral over a piece is exact to rounding.
    const PLACES: [f64; 6] = [
        0.033_765_242_898_423_99,
        0.169_395_306_766_867_73,
        0.380_690_406_958_401_56,
        0.619_309_593_041_598_5,
        0.830_604_693_233_132_2,
        0.966_234_757_101_576,
    ];
    const SQUARES: [f64; 6] = {
        let mut squares = PLACES;
        let mut k = 0;
        while k < squares.len() {
            squares[k] *= squares[k];
            k += 1;
        }
        squares
    };
    const WEIGHTS: [f64; 3] = [0.085_662_246_189_585_18, 0.180_380_786_524_069_3, 0.233_956_967_286_345_52];
    if damping == 0.0 || tau == 0.0 {
        return 0.0;
    }
    // All places at once, and even powers beside odd ones, which become vector instructions.
    let (mut even, mut odd) = ([0.0; 6], [0.0; 6]);
    for n in (0..=ORDER / 2).rev() {
        for k in 0..6 {
            even[k] = even[k] * SQUARES[k] + (2 * n + 1) as f64 * terms[2 * n + 1];
            odd[k] = odd[k] * SQUARES[k] + (2 * n + 2) as f64 * terms.get(2 * n + 2).copied().unwrap_or(0.0);
        }
    }
    let squares: [f64; 6] = core::array::from_fn(|k| {
        let velocity = even[k] + PLACES[k] * odd[k];
        velocity * velocity
    });
    let sum: f64 = WEIGHTS.iter().enumerate().map(|(k, weight)| weight * (squares[k] + squares[5 - k])).sum();
    sum * damping / tau
}
