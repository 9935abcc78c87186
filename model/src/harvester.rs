//! The vibro-impact harvester: from event to event, exactly under the impulsive law.

mod contact;
mod copy;
mod course;
mod dues;
mod energy;
mod events;
mod exchange;
mod foreseen;
mod input;
mod occurrence;
mod output;
mod phase;
mod position;
mod snapshot;
mod start;
mod tangent;
mod totals;

pub use self::energy::Energies;
pub use self::occurrence::{Impact, Occurrence, Peak};
pub use self::snapshot::Snapshot;
pub use self::tangent::{Direction, GRAZING_SPEED, Sensitivities};
pub use self::totals::Totals;

use self::dues::Dues;
use self::energy::Ledger;
use self::events::Search;
use self::input::finite;
use self::phase::Noise;
use self::tangent::Tangent;
use crate::compliant::{Ramp, Touch};
use crate::cylinder::CylinderMotion;
use crate::error::ModelError;
use crate::flight::Side;
use crate::holds::Holds;
use crate::membrane::Membrane;
use crate::parameters::Parameters;
use crate::pulse::{PulseShape, Pulses};

/// The ball since its last event: straight on while free, carried by the membrane while resting.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    since: f64,
    position: f64,
    velocity: f64,
    resting: Option<Side>,
}

/// The harvester: state at one time, moved forward by [`Harvester::advance`].
#[derive(Debug, PartialEq)]
pub struct Harvester {
    parameters: Parameters,
    membrane: Membrane,
    shape: PulseShape,
    time: f64,
    cylinder: CylinderMotion,
    ball: Ball,
    noise: Noise,
    holds: Holds,
    search: Search,
    pulses: [Pulses; 2],
    /// The present contact, under the compliant law.
    touch: Option<Touch>,
    /// Voltages across the membranes, V, for the Maxwell force.
    voltages: [Ramp; 2],
    totals: Totals,
    ledger: Ledger,
    tangent: Tangent,
    /// Its states are placed by an integrator.
    placed: bool,
    /// Up to here, s, nothing happens and nothing more is to be foreseen: on the way only the time changes.
    calm_until: f64,
    /// Second in which events are being counted, and their number: the budget.
    second: f64,
    second_events: u64,
}

impl Harvester {
    /// Moves on to `time`, s, through every event up to and including it. How a run is split into calls changes nothing.
    ///
    /// # Errors
    /// A time that is not finite or lies in the past; more events than can be resolved.
    #[inline]
    pub fn advance(&mut self, time: f64) -> Result<(), ModelError> {
        self.advance_with(time, |_| {})
    }

    /// Moves on as [`Harvester::advance`] does, and shows each impact and each largest deflection to `show`; not that of
    /// the start, [`Harvester::present_impact`].
    ///
    /// # Errors
    /// As [`Harvester::advance`].
    #[inline]
    pub fn advance_with(&mut self, time: f64, show: impl FnMut(&Occurrence)) -> Result<(), ModelError> {
        if self.time <= time && time < self.calm_until {
            self.time = time;
            return Ok(());
        }
        self.advance_through_events(time, show)
    }

    fn advance_through_events(&mut self, time: f64, mut show: impl FnMut(&Occurrence)) -> Result<(), ModelError> {
        finite("time", time)?;
        if time < self.time {
            return Err(ModelError::Backwards { from: self.time, to: time });
        }
        self.go_to(time, &mut show)?;
        self.look_ahead();
        Ok(())
    }

    /// Moves on to `time`, s; what comes after it is not known yet.
    fn go_to(&mut self, time: f64, show: &mut impl FnMut(&Occurrence)) -> Result<(), ModelError> {
        self.calm_until = f64::NEG_INFINITY; // until it is known anew; an error on the way leaves nothing foreseen
        let mut dues = Dues::NONE;
        let passed = self.pass_events(time, &mut dues, show);
        self.settle_dues(&mut dues);
        passed?;
        self.follow_noise(time);
        self.time = time;
        Ok(())
    }

    /// Does what events up to `time`, s, do, but for the credit of impacts in `dues`.
    fn pass_events(
        &mut self,
        time: f64,
        dues: &mut Dues,
        show: &mut impl FnMut(&Occurrence),
    ) -> Result<(), ModelError> {
        while let Some(event) = self.next_event(time, true).filter(|event| event.time() <= time) {
            let turn = self.turn_at(event);
            self.process(event, dues)?;
            let (impact, peak) = (self.impact_of(event), turn.or_else(|| self.peak_after(event)));
            impact.map(Occurrence::Impact).iter().chain(&peak.map(Occurrence::Peak)).for_each(&mut *show);
        }
        Ok(())
    }

    /// Makes the next impact known, beyond a release, too; what is found does not depend on the steps.
    fn look_ahead(&mut self) {
        self.next_event(self.time + self.horizon(), false);
        self.look_beyond_release();
        self.calm_until = self.calm();
    }
}
