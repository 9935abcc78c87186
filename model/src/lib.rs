//! Vibro-impact dielectric elastomer generator: the mechanics of the paper "Energy harvesting from a DE-based dynamic
//! vibro-impact system", and the membrane capacitances C(t) that follow from it.
//!
//! A ball slides in a shaken cylinder and hits a pre-stretched membrane at either end. Between impacts both bodies have
//! closed forms, so the motion is computed from event to event, not stepped: no impact is missed, and the result does
//! not depend on how a run is split.
//!
//! ```
//! use videg_model::{Harvester, Parameters, Side};
//!
//! let mut harvester = Harvester::new(&Parameters::default(), 0.0)?;
//! harvester.advance(100.0)?;
//! println!("{} impacts, C_left = {:e} F", harvester.totals().impacts, harvester.capacitance(Side::Left));
//! # Ok::<(), videg_model::ModelError>(())
//! ```
#![deny(unsafe_code)]

mod cases;
mod compliant;
mod cylinder;
mod elementary;
mod error;
mod flight;
mod harvester;
mod holds;
mod limits;
mod membrane;
mod noise;
mod parameters;
mod pulse;

pub use cases::{Case, saw_tooth_limit};
pub use compliant::{ContactSnapshot, Phase};
pub use cylinder::{CylinderMotion, Drive};
pub use error::ModelError;
pub use flight::Side;
pub use harvester::{
    Direction, Energies, GRAZING_SPEED, Harvester, Impact, Occurrence, Peak, Sensitivities, Snapshot, Totals,
};
pub use limits::{Excess, Limit, NeglectedMass};
pub use membrane::Membrane;
pub use parameters::{Choice, ContactLaw, NoiseModel, OutsideGap, Parameters, Quantity, VACUUM_PERMITTIVITY};
pub use pulse::{Deflection, Pulse, PulseChange, PulseShape};
