//! Pulses of one shape, which is worked out once.

use std::collections::HashMap;

use videg_model::{ContactLaw, MembraneLaw, Parameters, Pulse, PulseChange, PulseShape};

/// Pulses of one shape: deflections at even times, by their number.
pub(crate) struct SharedPulses {
    shape: PulseShape,
    deflections: HashMap<u32, Vec<f64>>,
}

impl SharedPulses {
    /// Those of the power law under the impulsive law; under other laws no two pulses share a shape.
    pub fn of(p: &Parameters) -> Option<Self> {
        let is_shared = p.contact_law == ContactLaw::Impulsive && p.membrane_law == MembraneLaw::Power;
        let shape = PulseShape::new(p.stiffness_exponent, p.restitution);
        is_shared.then(|| Self { shape, deflections: HashMap::new() })
    }

    pub fn shape(&self) -> &PulseShape {
        &self.shape
    }

    /// Deflections over the largest one from the begin to the peak, `count` times later: from 0 to 1.
    pub fn deflections(&mut self, count: u32) -> &[f64] {
        let Self { shape, deflections } = self;
        deflections.entry(count).or_insert_with(|| {
            let unit = Pulse { start: 0.0, speed: 1.0, peak: 1.0, change: PulseChange::default() };
            let time = shape.loading_time(&unit);
            let inner = (1..count).map(|k| shape.at(&unit, time * (f64::from(k) / f64::from(count))).value);
            std::iter::once(0.0).chain(inner).chain([1.0]).collect()
        })
    }
}
