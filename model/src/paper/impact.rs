//! What an impact does: Eqs. (11) to (13).

/// Relative speed, m/s, below which an impact grazes if the wall recedes from the ball faster and faster, so that a little
/// earlier or later they would just miss each other. The factor by which an impact magnifies changes grows as one over the
/// relative speed; a grazing impact, which penetrates by less than the rounding of the positions, counts as none: changes
/// pass it as they would if the ball missed the membrane. Slow impacts of a ball that the wall pushes are bounces of
/// a chattering sequence, whose changes are as small as they are.
pub const GRAZING_SPEED: f64 = 1e-7;

/// Eq. (11): seen from the wall, the ball leaves it at r times the relative `speed`, m/s, at which it came.
#[inline]
pub fn rebound(restitution: f64, speed: f64) -> f64 {
    restitution * speed
}

/// Eq. (11): `v_m+`, m/s, of a ball that leaves a wall with the velocity `v_M`, m/s, at the relative speed `rebound`, m/s.
/// `sign` is that of dz = `z_M` - `z_m` at the membrane.
#[inline]
pub fn velocity_after(wall: f64, sign: f64, rebound: f64) -> f64 {
    wall + sign * rebound
}

/// `v_M+`, m/s, of a wall with the velocity `v_M`, m/s, after an impulse that takes `change`, m/s, from dz' = `v_M` - `v_m`, if
/// it `takes` the share m / (m + M) of that: 0 where, as in Eq. (11), it is not slowed.
#[inline]
pub fn wall_after(wall: f64, takes: f64, change: f64) -> f64 {
    wall - takes * change
}

/// Eq. (12): `U_DE4` - `U_in`, V, at the bias voltage `U_in`, V, if `C_3` / `C_2` - 1 is `excess`.
#[inline]
pub fn voltage_gain(bias: f64, excess: f64) -> f64 {
    bias * excess
}

/// Eq. (13): W, J, at the bias voltage `U_in`, V, and `C_2`, F, if `C_3` / `C_2` - 1 is `excess`.
#[inline]
pub fn energy(bias: f64, rest_capacitance: f64, excess: f64) -> f64 {
    0.5 * bias * bias * rest_capacitance * excess
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voltage_and_energy_obey_the_second_form_of_equation_14() {
        let (bias, capacitance, excess) = (2000.0, 1.5e-11, 0.8);
        let second = 0.5 * capacitance * bias * voltage_gain(bias, excess);
        approx::assert_relative_eq!(energy(bias, capacitance, excess), second, max_relative = 1e-13);
    }

    #[test]
    fn the_ball_leaves_as_equation_11_has_it() {
        // From the left membrane (dz > 0), r = 0.6: -r v_m- + (r + 1) v_M.
        let (before, wall) = (-0.1, 0.3);
        let after = velocity_after(wall, 1.0, rebound(0.6, wall - before));
        approx::assert_relative_eq!(after, -0.6 * before + 1.6 * wall, max_relative = 1e-15);
    }
}
