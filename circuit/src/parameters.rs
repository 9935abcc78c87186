//! Parameters of the circuit and their defaults. Units, bounds and descriptions are in the table of [`crate::Settings`].

/// Names of parameters and inputs, as an FMU variable table and the error messages spell them.
pub mod names {
    /// Supply voltage `U_in` (V).
    pub const SUPPLY_VOLTAGE: &str = "supply.voltage";
    /// Voltage `U_z` of the release element (V).
    pub const ZENER_VOLTAGE: &str = "zener.voltage";
    /// Voltage `U_out` of the storage (V).
    pub const STORAGE_VOLTAGE: &str = "storage.voltage";
    /// Load resistance `R` (ohm).
    pub const LOAD_RESISTANCE: &str = "load.resistance";
    /// Time constant of the leakage through the film (s).
    pub const LEAKAGE_TIME_CONSTANT: &str = "leakage.timeConstant";
    /// How the membranes are connected.
    pub const TOPOLOGY: &str = "topology";
    /// What releases the charge.
    pub const RELEASE: &str = "release";
    /// Model of the diodes.
    pub const DIODE_MODEL: &str = "diode.model";
    /// Saturation current `IS` of every diode (A).
    pub const SATURATION_CURRENT: &str = "diode.saturationCurrent";
    /// Forward emission coefficient `N` of every diode (1).
    pub const EMISSION_COEFFICIENT: &str = "diode.emissionCoefficient";
    /// Temperature of every diode (K).
    pub const TEMPERATURE: &str = "diode.temperature";
    /// Breakdown current `IBV` of the Zener diodes (A).
    pub const BREAKDOWN_CURRENT: &str = "zener.breakdownCurrent";
    /// Emission coefficient `NBV` in breakdown (1).
    pub const BREAKDOWN_EMISSION: &str = "zener.emissionCoefficient";
    /// Voltage over which the smooth switch turns on (V).
    pub const SWITCH_BAND: &str = "switch.band";
    /// Relative tolerance of the integrator (1).
    pub const RELATIVE_TOLERANCE: &str = "solver.relativeTolerance";
    /// Capacitance of the left membrane (F).
    pub const LEFT_CAPACITANCE: &str = "left.capacitance";
    /// Capacitance of the right membrane (F).
    pub const RIGHT_CAPACITANCE: &str = "right.capacitance";
    /// Voltage of the left membrane (V).
    pub const LEFT_VOLTAGE: &str = "left.voltage";
    /// Voltage of the right membrane (V).
    pub const RIGHT_VOLTAGE: &str = "right.voltage";
    /// Length of a step (s).
    pub const STEP: &str = "step";
}

/// How the two membranes are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Topology {
    /// Fig. 8(a) as drawn: one node with both membranes, one charging diode, one release element.
    #[default]
    SharedNode,
    /// Each membrane has a charging diode and a release element of its own; both feed the one load.
    /// This is what Eq. (12) assumes.
    Isolated,
}

/// What lets the charge out to the load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Release {
    /// A Zener diode in series: conducts when `V_de - V_out` would exceed `U_z`, and burns `U_z I`.
    /// One-way, as with a blocking diode: it never conducts from the load to a membrane.
    #[default]
    Zener,
    /// An ideal lossless switch, the literal reading of Section 4.1: closed while `V_de > U_z`, with
    /// `I = V_de / R`; at `V_de = U_z` it is duty-cycled without hysteresis, and the mean current is what
    /// holds `V_de` there, from 0 to `U_z / R`.
    Switch,
    /// A diode into a storage, say a large capacitor or a battery, that stays at `U_out`: conducts when `V_de` would
    /// exceed `U_out`. What goes in counts as the load's; there is no load resistance. The only one of the three that
    /// gains without a switch to be driven.
    Storage,
}

/// Model of the diodes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Diodes {
    /// Ideal: no drop, no leakage. Solved exactly, event by event.
    #[default]
    Ideal,
    /// Shockley's exponential, as ngspice evaluates it. Integrated with error control.
    Exponential(DiodeParameters),
}

/// Parameters of an exponential diode, with ngspice's meaning; `RS` and `CJO` are zero and `BV` is `U_z`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiodeParameters {
    /// `diode.saturationCurrent`: `IS` (A).
    pub saturation_current: f64,
    /// `diode.emissionCoefficient`: `N` (1).
    pub emission_coefficient: f64,
    /// `diode.temperature` (K).
    pub temperature: f64,
    /// `zener.breakdownCurrent`: `IBV` (A). Below `IS BV / Vt` it has no effect and the current at `U_z` is `IS`, as in
    /// ngspice.
    pub breakdown_current: f64,
    /// `zener.emissionCoefficient`: `NBV` (1).
    pub breakdown_emission: f64,
    /// `switch.band` (V): [`Release::Switch`] turns on linearly between `U_z` and `U_z` + band.
    pub switch_band: f64,
    /// Accuracy and effort of the integrator.
    pub solver: Solver,
}

/// Accuracy and effort of the integrator of the exponential diodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// `solver.relativeTolerance` (1): largest error of an internal step, charges relative to `C U_in` or the charge that
    /// is there, energies to that charge at its voltage, and the energy of a load behind a Zener diode to that charge at
    /// the voltage of the load. Below some 1e-13 it asks for more than the last bits of a charge hold.
    ///
    /// Where `N Vt` comes near the last bit of a voltage (6e-11 V at 300 kV, against `N Vt` = 2.6e-4 V by default), currents
    /// are taken from the balance of charge instead of the exponential, and keep this accuracy.
    pub relative_tolerance: f64,
    /// Internal steps, rejected ones included, in one call.
    pub maximum_steps: usize,
}

/// Parameters of the circuit of Fig. 8(a). The default is the paper's (Section 4.1) with a load of 1 Gohm,
/// which the paper does not give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// `supply.voltage`: `U_in` (V).
    pub supply_voltage: f64,
    /// `zener.voltage`: `U_z` (V), at least `U_in`. Without effect on a storage.
    pub zener_voltage: f64,
    /// `storage.voltage`: `U_out` (V), at least `U_in`; the default is near the best for Fig. 14 on a shared node.
    /// Effective with [`Release::Storage`] only.
    pub storage_voltage: f64,
    /// `load.resistance`: `R` (ohm), from 0 to infinity with both ends. Without effect on a storage.
    pub load_resistance: f64,
    /// `leakage.timeConstant`: resistivity times permittivity of the film (s), at least [`Self::FASTEST_LEAKAGE`]. The
    /// conductance of a membrane is its capacitance over this; 0 and infinity mean none.
    pub leakage_time_constant: f64,
    /// `topology`
    pub topology: Topology,
    /// `release`
    pub release: Release,
    /// Model of the diodes.
    pub diodes: Diodes,
}

impl DiodeParameters {
    /// Near-ideal diodes.
    pub(crate) const DEFAULT: Self = Self {
        saturation_current: 1e-13,
        emission_coefficient: 0.01,
        temperature: 300.15,
        breakdown_current: 1e-13,
        breakdown_emission: 0.01,
        switch_band: 0.02,
        solver: Solver { relative_tolerance: 1e-9, maximum_steps: 100_000 },
    };
}

impl Parameters {
    /// The paper's circuit.
    pub(crate) const DEFAULT: Self = Self {
        supply_voltage: 2000.0,
        zener_voltage: 2000.0,
        storage_voltage: 2450.0,
        load_resistance: 1e9,
        leakage_time_constant: 0.0,
        topology: Topology::SharedNode,
        release: Release::Zener,
        diodes: Diodes::Ideal,
    };
}

impl Default for Solver {
    fn default() -> Self {
        DiodeParameters::DEFAULT.solver
    }
}

impl Default for DiodeParameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Default for Parameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Parameters {
    /// Shortest time constant of the leakage but 0 (s).
    pub const FASTEST_LEAKAGE: f64 = 1e-6;

    /// Whether the films leak.
    pub fn leaks(&self) -> bool {
        self.leakage_rate() > 0.0
    }

    /// Part of its charge that a membrane loses in a second by leakage (1/s).
    pub fn leakage_rate(&self) -> f64 {
        /// A leakage that takes longer (s) is below rounding in any run.
        const NONE: f64 = 1e30;
        let time_constant = self.leakage_time_constant;
        // Compilers divide before they ask, and a host may trap a division by zero.
        let rate = 1.0 / time_constant.clamp(Self::FASTEST_LEAKAGE, NONE);
        if time_constant > 0.0 && time_constant < NONE { rate } else { 0.0 }
    }

    /// Resistance of the load, ohm: -0 is 0.
    pub(crate) fn resistance(&self) -> f64 {
        self.load_resistance.abs()
    }

    /// Conductance of the load, S: infinite at 0 ohm, without a division by zero, which a host may trap.
    pub(crate) fn conductance(&self) -> f64 {
        let resistance = self.resistance();
        if resistance == 0.0 { f64::INFINITY } else { 1.0 / resistance }
    }

    /// Voltage at which a node begins to release its charge (V): `U_out` of a storage, else `U_z`.
    pub fn release_voltage(&self) -> f64 {
        match self.release {
            Release::Zener | Release::Switch => self.zener_voltage,
            Release::Storage => self.storage_voltage,
        }
    }

    /// Number of nodes: 1 shared or 2 isolated.
    pub(crate) fn nodes(&self) -> usize {
        match self.topology {
            Topology::SharedNode => 1,
            Topology::Isolated => 2,
        }
    }
}
