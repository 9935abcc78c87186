//! Vibro-impact dielectric elastomer generator: the mechanics of the paper "Energy harvesting from a DE-based dynamic
//! vibro-impact system", and the membrane capacitances C(t) that follow from it.
//!
//! A ball slides in a shaken cylinder and hits a pre-stretched membrane at either end. Between impacts both bodies have
//! closed forms, a cylinder on a suspension power series, so the motion is computed from event to event, not stepped: no impact is
//! missed, and the result does not depend on how a run is split. Contacts that take time are integrated with a bound on the error.
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

mod accounting;
mod cases;
mod contact;
mod error;
mod fingerprint;
mod fixed_step;
mod harvester;
mod limits;
mod membrane;
mod motion;
mod noise;
mod numerics;
mod paper;
mod parameters;
mod points;
mod recording;
mod sensitivity;
mod setup;
mod shared;

pub use accounting::ledger::{Energies, Totals, Works};
pub use cases::{Case, saw_tooth_limit};
pub use contact::{ContactState, Creep, Phase, Point, Ramp, Recoil};
pub use error::ModelError;
pub use fixed_step::{FixedStep, Stepped};
pub use harvester::{Event, Harvester, Impact, Peak, Snapshot};
pub use limits::{Excess, Limit, NeglectedMass};
pub use membrane::Membrane;
pub use membrane::table::ForceTable;
pub use motion::Start;
pub use motion::pulse::{Deflection, Pulse, PulseChange, PulseShape};
pub use motion::side::Side;
pub use paper::impact::GRAZING_SPEED;
pub use parameters::{
    Choice, ContactLaw, ExcitationKind, MembraneLaw, NoiseModel, OutsideGap, Parameters, Quantity, VACUUM_PERMITTIVITY,
};
pub use points::{PointFault, PointQuantity};
pub use recording::Recording;
pub use sensitivity::{Changes, Direction, Sensitivities};
pub use setup::Setup;
