//! What a caller is shown on the way.

use super::Harvester;
use super::events::Event;
use crate::compliant::Ending;
use crate::flight::Side;
use crate::parameters::ContactLaw;
use crate::pulse::{Pulse, PulseChange};

/// One impact, as [`Harvester::advance_with`] shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Time, s.
    pub time: f64,
    /// The membrane.
    pub side: Side,
    /// Relative speed before the impact, m/s.
    pub speed: f64,
    /// The ball comes to rest on the membrane.
    pub rests: bool,
}

/// A largest deflection, as [`Harvester::advance_with`] shows it: under the impulsive law with the impact that it follows,
/// under the compliant law when it is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// When the membrane is there, s.
    pub time: f64,
    /// The membrane.
    pub side: Side,
    /// Its deflection, m.
    pub deflection: f64,
    /// Voltage across it when this is shown, V.
    pub voltage: f64,
}

/// What [`Harvester::advance_with`] shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Occurrence {
    /// An impact; under the compliant law the begin of a contact.
    Impact(Impact),
    /// A largest deflection.
    Peak(Peak),
}

impl Harvester {
    /// The last impact, of a harvester whose present time is that of this impact: one that is just made, if its ball started on
    /// a membrane and approached it, or whose [`Harvester::handle_events`] has just counted one.
    pub fn present_impact(&self) -> Option<Impact> {
        let side = if self.relative_displacement() > 0.0 { Side::Left } else { Side::Right };
        let (time, speed, rests) = (self.time, self.totals.last_speed, self.resting().is_some());
        (self.totals.impacts > 0).then_some(Impact { time, side, speed, rests })
    }

    /// The impact that the `event`, just processed, was.
    pub(super) fn impact_of(&self, event: Event) -> Option<Impact> {
        let Event::Impact { time, side } = event else { return None };
        Some(Impact { time, side, speed: self.totals.last_speed, rests: self.ball.resting.is_some() })
    }

    /// The largest deflection that follows from the impact under the impulsive law that the `event`, just processed, was.
    pub(super) fn peak_after(&self, event: Event) -> Option<Peak> {
        let Impact { time, side, speed, .. } = self.impact_of(event)?;
        if self.parameters.contact_law == ContactLaw::Compliant {
            return None;
        }
        let deflection = self.membrane.deflection(speed);
        let pulse = Pulse { start: time, speed, peak: deflection, change: PulseChange::default() };
        let voltage = self.voltages[side.index()].at(time);
        Some(Peak { time: self.shape.peak_time(&pulse), side, deflection, voltage })
    }

    /// The largest deflection at which the contact turns, if that is the `event`.
    pub(super) fn turn_at(&self, event: Event) -> Option<Peak> {
        let Event::Touch { time } = event else { return None };
        let touch = self.touch.as_ref().filter(|touch| touch.ending() == Ending::Turn)?;
        let voltage = self.voltages[touch.side.index()].at(time);
        Some(Peak { time, side: touch.side, deflection: touch.largest_at(time), voltage })
    }
}
