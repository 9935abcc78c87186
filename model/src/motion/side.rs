//! The ends of the cylinder.

/// End of the cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Side {
    /// The end that the ball meets at `z_M` - `z_m` = +s/2.
    Left,
    /// The end that the ball meets at `z_M` - `z_m` = -s/2.
    Right,
}

impl Side {
    /// Both, in the order of all lists.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The end that is nearer to a ball at this `z_M` - `z_m`, m.
    pub fn of(dz: f64) -> Self {
        if dz > 0.0 { Self::Left } else { Self::Right }
    }

    /// Sign of `z_M` - `z_m` at this end.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// 0 for left, 1 for right.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }
}
