//! Where a run first leaves the limits of its films.

use videg_coupled::{Film, Watch};
use videg_model::{Excess, Membrane};

/// What a run takes of the limits, and where each was first left.
#[derive(Default)]
pub struct Limits {
    film: Film,
    membrane: Option<Membrane>,
    pub first: Vec<Excess>,
    pub deepest: f64,
    pub highest: f64,
}

impl Limits {
    /// The most that was taken of each limit, over the limit.
    pub fn over_limits(&self) -> [f64; 4] {
        self.film.over_limits()
    }
}

impl Watch for Limits {
    const LOOKS: bool = true;

    fn begin(&mut self, membrane: &Membrane) {
        *self = Self { membrane: Some(membrane.clone()), ..Self::default() };
        self.film.begin(membrane);
    }

    fn look(&mut self, time: f64, deflections: [f64; 2], voltages: [f64; 2]) {
        self.film.look(time, deflections, voltages);
        let Some(membrane) = &self.membrane else { return };
        for (deflection, voltage) in deflections.into_iter().zip(voltages) {
            self.deepest = self.deepest.max(deflection);
            self.highest = self.highest.max(voltage);
            for excess in membrane.excesses(deflection, voltage, time) {
                if self.first.iter().all(|known| known.limit != excess.limit) {
                    self.first.push(excess);
                }
            }
        }
    }
}
