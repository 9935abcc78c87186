//! How long the membranes are deflected in a run, and how far.

use serde::Serialize;

use crate::cosim::{CosimError, Observer, Row};

/// Smallest deflection that counts, m: the way of a ball of 1 mm/s in a nanosecond. At the end of a contact rounding leaves
/// some 1e-17 m.
const SMALLEST: f64 = 1e-12;

/// Watches the deflections. A contact lasts from the communication point before a membrane is deflected to the one at which
/// it is flat again: the master lands on impacts and ends of pulses, so both are exact where the harvester announces them.
/// Under the impulsive law that is the pulse, under the compliant law the time for which the ball is in the membrane.
/// Impacts within a pulse make one contact.
#[derive(Debug, Default)]
pub struct Contacts {
    shown_from: f64,
    sides: [Side; 2],
    time: f64,
    largest_deflection: f64,
    largest_capacitance: f64,
}

/// The contacts of one membrane.
#[derive(Debug, Default)]
struct Side {
    /// Start of the present contact, s.
    since: Option<f64>,
    /// Contacts that have ended.
    ended: u32,
    /// Time in them, s.
    time: f64,
    /// The longest of them, s.
    longest: f64,
    /// Largest deflection in the present contact, m.
    deflection: f64,
    /// The one to show.
    shown: Option<Shown>,
}

/// A contact to show.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shown {
    /// Its largest deflection, m.
    deflection: f64,
    /// Start and end, s.
    ends: [f64; 2],
}

/// The contacts of a run. Field names are the keys of `--json`; units are SI.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactSummary {
    /// Contacts of both membranes that have ended.
    pub contacts: u32,
    /// Their mean duration, s; none without a contact.
    pub mean_contact_duration: Option<f64>,
    /// The longest of them, s; none without a contact.
    pub largest_contact_duration: Option<f64>,
    /// Time in contact of the left and of the right membrane together, one that has not ended included, s.
    pub time_in_contact: f64,
    /// Largest deflection of a membrane, m.
    pub largest_deflection: f64,
    /// Largest capacitance of a membrane, F.
    pub largest_capacitance: f64,
}

impl Contacts {
    /// Of the contacts that begin at `shown_from`, s, or later, the deepest one is to be shown.
    pub fn new(shown_from: f64) -> Self {
        Self { shown_from, ..Self::default() }
    }

    /// Sums up.
    pub fn summary(&self) -> ContactSummary {
        let [left, right] = &self.sides;
        let (contacts, ended) = (left.ended + right.ended, left.time + right.time);
        let present = self.sides.iter().filter_map(|side| side.since).map(|since| self.time - since);
        ContactSummary {
            contacts,
            mean_contact_duration: (contacts > 0).then(|| ended / f64::from(contacts)),
            largest_contact_duration: (contacts > 0).then(|| left.longest.max(right.longest)),
            time_in_contact: ended + present.sum::<f64>(),
            largest_deflection: self.largest_deflection,
            largest_capacitance: self.largest_capacitance,
        }
    }

    /// Contacts of the left and of the right membrane that have ended.
    pub fn ended(&self) -> [u32; 2] {
        [self.sides[0].ended, self.sides[1].ended]
    }

    /// Start and end of the contact to show of `side` (0 left, 1 right), s.
    pub fn shown(&self, side: usize) -> Option<[f64; 2]> {
        self.sides[side].shown.map(|shown| shown.ends)
    }
}

impl Observer for Contacts {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        for (side, deflection) in self.sides.iter_mut().zip(row.harvester.deflection()) {
            side.observe([self.time, row.time], deflection, self.shown_from);
            self.largest_deflection = self.largest_deflection.max(deflection);
        }
        self.largest_capacitance = row.harvester.capacitance().into_iter().fold(self.largest_capacitance, f64::max);
        self.time = row.time;
        Ok(())
    }
}

impl Side {
    /// Takes the `deflection`, m, at the second of two communication points, s.
    fn observe(&mut self, [before, now]: [f64; 2], deflection: f64, shown_from: f64) {
        if deflection > SMALLEST {
            self.since.get_or_insert(before);
            self.deflection = self.deflection.max(deflection);
        } else if let Some(since) = self.since.take() {
            self.ended += 1;
            self.time += now - since;
            self.longest = self.longest.max(now - since);
            let ended = Shown { deflection: std::mem::take(&mut self.deflection), ends: [since, now] };
            if since >= shown_from && self.shown.is_none_or(|shown| ended.deflection > shown.deflection) {
                self.shown = Some(ended);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_lasts_from_the_last_flat_point_to_the_next_one() {
        let mut side = Side::default();
        let points = [(0.0, 0.0), (1.0, 1e-17), (1.5, 1e-3), (2.0, 2e-3), (3.5, 1e-17), (5.0, 1e-3), (5.5, 0.0)];
        let mut before = 0.0;
        for (time, deflection) in points {
            side.observe([before, time], deflection, 2.0);
            before = time;
        }
        assert_eq!((side.ended, side.time, side.longest), (2, 4.5, 2.5));
        let shown = Shown { deflection: 1e-3, ends: [3.5, 5.5] };
        assert_eq!((side.since, side.shown), (None, Some(shown)), "the deeper one begins too early to be shown");
    }

    #[test]
    fn a_contact_that_has_not_ended_counts_as_time_only() {
        let mut contacts = Contacts { time: 3.0, ..Contacts::default() };
        contacts.sides[1].since = Some(1.0);
        let summary = contacts.summary();
        assert_eq!((summary.contacts, summary.time_in_contact), (0, 2.0));
        assert_eq!((summary.mean_contact_duration, summary.largest_contact_duration), (None, None));
    }
}
