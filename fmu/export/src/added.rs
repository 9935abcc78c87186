//! Variables that FMI 3.0 wants and a table need not have: time, and one for each event indicator. Their value references follow
//! those of the table.

use crate::slave::Slave;
use crate::variable::{Causality, Variable};

/// A variable that the exporter adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Added {
    /// The independent variable, unless the table has one.
    Time,
    /// An event indicator of model exchange, counted from 0.
    Indicator(usize),
}

impl Added {
    /// The name of the independent variable that is added.
    pub(crate) const TIME: &str = "time";

    /// All of them with their value references, in the order of these.
    pub(crate) fn all<S: Slave>() -> impl Iterator<Item = (u32, Self)> {
        let table = S::variables();
        let time = !table.iter().any(|row| row.causality() == Causality::Independent);
        let indicators = 0..S::INFO.model_exchange.unwrap_or(0);
        let added = time.then_some(Self::Time).into_iter().chain(indicators.map(Self::Indicator));
        (u32::try_from(table.len()).unwrap_or(u32::MAX)..).zip(added)
    }

    /// The one with this value reference.
    pub(crate) fn of<S: Slave>(reference: u32) -> Option<Self> {
        let last = u32::try_from(S::variables().len()).unwrap_or(u32::MAX);
        if reference < last {
            return None;
        }
        Self::all::<S>().find(|(own, _)| *own == reference).map(|(_, added)| added)
    }
}

/// Whether FMI 3.0 has event mode in co-simulation: its steps stop at events, or it has clocks.
pub(crate) fn has_events<S: Slave>() -> bool {
    S::INFO.stops_at_events || S::variables().iter().any(Variable::is_clock)
}
