//! What a run takes of the limits of its films.

use videg_model::Membrane;

/// Names of [`Film::over_limits`], in the order of [`Membrane::over_limits`].
pub const OVER_LIMITS: [&str; 4] =
    ["area_ratio_over_limit", "field_over_limit", "stress_over_limit", "deflection_over_limit"];

/// Ranges of deflections within a radius of the membrane.
const FINENESS: f64 = 64.0;

/// Ranges; the last one has all that lies beyond.
const RANGES: usize = 1024;

/// What is shown of a run at the end of each straight line of C(t).
pub trait Watch {
    /// Whether anything is looked at.
    fn looks(&self) -> bool {
        true
    }

    /// Before the run: the films are like `membrane`.
    fn begin(&mut self, membrane: &Membrane);

    /// Deflections, m, and voltages, V, of the membranes at a `time`, s.
    fn look(&mut self, time: f64, deflections: [f64; 2], voltages: [f64; 2]);
}

impl Watch for () {
    fn looks(&self) -> bool {
        false
    }

    fn begin(&mut self, _: &Membrane) {}

    fn look(&mut self, _: f64, _: [f64; 2], _: [f64; 2]) {}
}

/// The highest voltage that the films have at each deflection: their limits depend on both.
#[derive(Default)]
pub struct Film {
    membrane: Option<Membrane>,
    /// Ranges over a metre.
    density: f64,
    largest: f64,
    /// Deflection and voltage.
    highest: Vec<[f64; 2]>,
}

impl Film {
    /// The most that was taken of each limit, over the limit: above 1 it was exceeded; NaN before a run.
    pub fn over_limits(&self) -> [f64; 4] {
        let Some(membrane) = &self.membrane else { return [f64::NAN; 4] };
        let charged = self.highest.iter().filter(|point| point[1] > 0.0);
        let deepest = [self.largest, 0.0];
        let points = charged.chain(std::iter::once(&deepest));
        points.fold([0.0; 4], |most, [deflection, voltage]| {
            let here = membrane.over_limits(*deflection, *voltage);
            std::array::from_fn(|k| f64::max(most[k], here[k]))
        })
    }
}

impl Watch for Film {
    fn begin(&mut self, membrane: &Membrane) {
        let density = FINENESS / membrane.radius();
        *self = Self { membrane: Some(membrane.clone()), density, largest: 0.0, highest: vec![[0.0; 2]; RANGES] };
    }

    fn look(&mut self, _: f64, deflections: [f64; 2], voltages: [f64; 2]) {
        for (deflection, voltage) in deflections.into_iter().zip(voltages) {
            self.largest = self.largest.max(deflection);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the ranges")]
            let range = (deflection * self.density).clamp(0.0, RANGES as f64 - 1.0) as usize;
            if voltage.abs() > self.highest[range][1] {
                self.highest[range] = [deflection, voltage.abs()];
            }
        }
    }
}
