//! Where the energy and the charge went.

use crate::error::{Error, finite};

/// Running sums since the start; energies in J, charges in C.
///
/// What the mechanics gave is summed twice, on two paths that share no arithmetic: [`converted`](Self::converted)
/// from the elements and the stored energy, `mechanical` from the work on the capacitances. Their difference,
/// [`residual`](Self::residual), is the error of the sums.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Ledger {
    /// Energy drawn from the supply, `U_in` times its charge (J).
    pub supply: f64,
    /// Energy given to the load resistor or the storage (J).
    pub load: f64,
    /// Energy burnt in the Zener diodes (J); zero with a switch or a storage.
    pub zener: f64,
    /// Energy burnt in the charging diodes and in those into a storage (J); with ideal diodes only by inrush from a
    /// start below `U_in` or above `U_out`.
    pub diode: f64,
    /// Energy burnt by leakage through the films of the membranes (J).
    pub leakage: f64,
    /// Change of the stored energy `1/2 C V^2` since the start (J).
    pub stored: f64,
    /// Work of the mechanics against the electric field, `-integral 1/2 V^2 dC` (J).
    pub mechanical: f64,
    /// Charge drawn from the supply (C).
    pub supply_charge: f64,
    /// Charge through the load or into the storage (C).
    pub load_charge: f64,
}

impl Ledger {
    /// Rejects sums that no run can have given.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let energies = [self.supply, self.load, self.zener, self.diode, self.leakage, self.stored, self.mechanical];
        energies.into_iter().try_for_each(|energy| finite("ledger", energy, "J"))?;
        [self.supply_charge, self.load_charge].into_iter().try_for_each(|charge| finite("ledger", charge, "C"))
    }

    /// Energy that the mechanics gave, from the electrical side (J): load + zener + diode + leakage + stored - supply.
    pub fn converted(&self) -> f64 {
        self.load + self.zener + self.diode + self.leakage + self.stored - self.supply
    }

    /// What a user gains (J): load - supply.
    pub fn surplus(&self) -> f64 {
        self.load - self.supply
    }

    /// Mean flows since the ledger was `before`, `time` seconds ago: powers (W), and currents (A) in place of charges.
    #[must_use]
    pub fn flows_since(&self, before: &Self, time: f64) -> Self {
        let rate = |of: fn(&Self) -> f64| (of(self) - of(before)) / time;
        Self {
            supply: rate(|it| it.supply),
            load: rate(|it| it.load),
            zener: rate(|it| it.zener),
            diode: rate(|it| it.diode),
            leakage: rate(|it| it.leakage),
            stored: rate(|it| it.stored),
            mechanical: rate(|it| it.mechanical),
            supply_charge: rate(|it| it.supply_charge),
            load_charge: rate(|it| it.load_charge),
        }
    }

    /// Difference of the two sums of what the mechanics gave (J): converted - mechanical; zero but for rounding
    /// (ideal diodes) or the integrator's tolerance (exponential diodes).
    pub fn residual(&self) -> f64 {
        self.converted() - self.mechanical
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_user_gains_what_the_load_got_less_what_the_supply_gave() {
        let ledger = Ledger { supply: 3.0, load: 5.0, zener: 7.0, ..Ledger::default() };
        assert_eq!(ledger.surplus(), 2.0);
        assert_eq!(ledger.converted(), 9.0);
    }
}
