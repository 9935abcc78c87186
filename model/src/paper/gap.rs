//! The gap between ball and membranes: Eq. (8).

/// Section 3.2: s = d + 2 w - 2 `r_b`, m, the largest distance that the ball moves inside the cylinder.
pub fn travel(cylinder_length: f64, frame_width: f64, ball_radius: f64) -> f64 {
    cylinder_length + 2.0 * frame_width - 2.0 * ball_radius
}

/// Eq. (8): the gap, m, between the ball and the membrane at the end with this `sign` of dz = `z_M` - `z_m`, m. There is an impact
/// where it is 0: |dz| = s/2.
#[inline]
pub fn gap(half_travel: f64, sign: f64, dz: f64) -> f64 {
    half_travel - sign * dz
}
