//! Where the ball is in a membrane.

/// Deflection x and rate x' at a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Point {
    /// s.
    pub time: f64,
    /// m, inwards.
    pub x: f64,
    /// m/s.
    pub v: f64,
}
