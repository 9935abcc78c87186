//! The force of the membrane and the deflection that it allows: Eqs. (2), (9) and (10).

/// Eq. (2): f = K x^n, N, at the deflection `x`, m; odd in x, so that it is smooth where an integrator passes zero.
pub fn force(stiffness: f64, exponent: f64, x: f64) -> f64 {
    (stiffness * x.abs().powf(exponent)).copysign(x)
}

/// Eq. (9): work, J, of this `force`, N, from 0 to `x`, m: K x^(n+1) / (n+1).
pub fn work(force: f64, exponent: f64, x: f64) -> f64 {
    force * x / (exponent + 1.0)
}

/// Constants of Eq. (10), delta = (`loading` v^2)^`power`: (n + 1) m / (2 K) and 1 / (n + 1).
pub fn deflection_constants(stiffness: f64, exponent: f64, ball_mass: f64) -> [f64; 2] {
    [0.5 * (exponent + 1.0) * ball_mass / stiffness, 1.0 / (exponent + 1.0)]
}

/// Eq. (10): largest deflection delta, m, after an impact at the relative `speed`, m/s.
pub fn deflection([loading, power]: [f64; 2], speed: f64) -> f64 {
    (loading * speed * speed).powf(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_deflection_turns_the_kinetic_energy_into_the_work_of_the_force() {
        let delta = deflection(deflection_constants(4.0847e5, 2.6, 0.0035), 0.4);
        let work = work(force(4.0847e5, 2.6, delta), 2.6, delta);
        assert_relative_eq!(work, 0.5 * 0.0035 * 0.16, max_relative = 1e-13);
    }
}
