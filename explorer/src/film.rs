//! What a run takes of the limits of its films, and where it first leaves them.

use videg_coupled::{Film, Watch};
use videg_model::{Excess, Membrane};

/// What a run takes of the limits.
#[derive(Default)]
pub struct Limits {
    film: Film,
    /// Largest deflection, m.
    pub deepest: f64,
    /// Highest voltage, V.
    pub highest: f64,
}

impl Limits {
    /// The most that was taken of each limit, over the limit.
    pub fn over_limits(&self) -> [f64; 4] {
        self.film.over_limits()
    }
}

impl Watch for Limits {
    fn begin(&mut self, membrane: &Membrane) {
        *self = Self::default();
        self.film.begin(membrane);
    }

    fn look(&mut self, time: f64, deflections: [f64; 2], voltages: [f64; 2]) {
        self.film.look(time, deflections, voltages);
        for (deflection, voltage) in deflections.into_iter().zip(voltages) {
            self.deepest = self.deepest.max(deflection);
            self.highest = self.highest.max(voltage);
        }
    }
}

/// Where each limit is first left, which is more work than [`Limits`].
#[derive(Default)]
pub struct FirstExcesses {
    membrane: Option<Membrane>,
    pub found: Vec<Excess>,
}

impl Watch for FirstExcesses {
    fn begin(&mut self, membrane: &Membrane) {
        *self = Self { membrane: Some(membrane.clone()), found: Vec::new() };
    }

    fn look(&mut self, time: f64, deflections: [f64; 2], voltages: [f64; 2]) {
        let Some(membrane) = &self.membrane else { return };
        for (deflection, voltage) in deflections.into_iter().zip(voltages) {
            for excess in membrane.excesses(deflection, voltage, time) {
                if self.found.iter().all(|known| known.limit != excess.limit) {
                    self.found.push(excess);
                }
            }
        }
    }
}
