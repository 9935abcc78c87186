//! What impacts come to.

/// Sums over all impacts so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// Impacts resolved one by one; under the compliant law, contacts begun. Of a chattering sequence, the endless tail that is summed in closed form is not
    /// counted here; its gains are contained below.
    pub impacts: u64,
    /// Chattering sequences that ended with the ball at rest on a membrane.
    pub chatters: u64,
    /// Times that a resting ball left a membrane.
    pub releases: u64,
    /// Relative speed of the last impact, m/s.
    pub last_speed: f64,
    /// Sum of `U_DE4` - `U_in`, V: the numerator of Eq. (15).
    pub voltage_gain: f64,
    /// Sum of W, J, Eq. (13): the numerator of Eq. (14).
    pub energy: f64,
}

impl Totals {
    /// Events processed: what the run cost.
    pub fn events(&self) -> u64 {
        self.impacts + self.releases
    }
}
