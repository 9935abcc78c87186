//! The solvers that are compared.

/// A solver of the circuit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solver {
    /// The embedded solver with ideal diodes: exact.
    Ideal,
    /// The embedded solver with ngspice's diodes.
    Exponential,
    /// The program ngspice.
    Batch,
    /// ngspice's shared library, step by step.
    Live,
}

impl Solver {
    /// All, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::Ideal, Self::Exponential, Self::Batch, Self::Live];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ideal => "embedded, ideal diodes",
            Self::Exponential => "embedded, exponential diodes",
            Self::Batch => "ngspice, batch",
            Self::Live => "ngspice, live",
        }
    }

    /// Name in CSV columns and keys.
    pub fn key(self) -> &'static str {
        match self {
            Self::Ideal => "embedded_ideal",
            Self::Exponential => "embedded_exponential",
            Self::Batch => "ngspice_batch",
            Self::Live => "ngspice_live",
        }
    }
}
