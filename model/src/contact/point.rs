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
    /// What the contact has added to the motion of a suspended cylinder; that of a free one follows from x.
    pub recoil: Recoil,
    /// ln(`L_v` / lambda) of a viscous film: how far its dashpot has given way.
    pub creep: f64,
}

/// The creep of a membrane that no ball has pressed since a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Creep {
    /// s.
    pub since: f64,
    /// ln(`L_v` / lambda) at that time.
    pub value: f64,
}

/// Position, m, and velocity, m/s, that the contact adds to the cylinder's.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Recoil {
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
}
