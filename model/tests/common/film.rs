//! A viscous film on the paper's cone, written down again as its equations are printed.
#![allow(dead_code, clippy::allow_attributes)] // each test file uses its part

use proptest::prelude::*;
use std::f64::consts::PI;
use videg_model::{ContactLaw, MembraneLaw, Parameters};

prop_compose! {
    /// A film of either law with a Maxwell branch, some nearly relaxed in a contact and some nearly elastic.
    pub fn any_film()(
        is_ogden in any::<bool>(),
        modulus in 2e4..1e5_f64,
        limit in 200.0..1e3_f64,
        second in prop_oneof![Just(0.0), -2e4..-1e2_f64],
        prestretch in prop_oneof![Just(2.0), 1.0..3.0_f64],
        part in -2.0..1.0_f64,
        time in prop_oneof![-6.0..3.0_f64, -3.0..-1.0_f64],
    ) -> Parameters {
        Parameters {
            contact_law: ContactLaw::Compliant,
            membrane_law: if is_ogden { MembraneLaw::Ogden } else { MembraneLaw::Gent },
            shear_modulus: modulus,
            stretch_limit: limit,
            ogden_modulus_1: modulus,
            ogden_exponent_1: 2.5,
            ogden_modulus_2: second,
            ogden_exponent_2: -1.5,
            prestretch,
            initial_radius: 0.0063 / prestretch,
            initial_thickness: 0.00025 * prestretch * prestretch,
            viscous_modulus: modulus * 10_f64.powf(part),
            relaxation_time: 10_f64.powf(time),
            ..Parameters::default()
        }
    }
}

/// Both membranes.
pub struct Film {
    pub p: Parameters,
}

impl Film {
    /// L/2 dW/dL, `scale` times as large.
    fn stress(&self, stretch: f64, scale: f64) -> f64 {
        let p = &self.p;
        let pull = |alpha: f64| stretch.powf(alpha) - stretch.powf(-2.0 * alpha);
        if p.membrane_law == MembraneLaw::Gent {
            let room = 1.0 - (2.0 * stretch.powi(2) + stretch.powi(-4) - 3.0) / p.stretch_limit;
            scale * p.shear_modulus * pull(2.0) / room
        } else {
            scale * (p.ogden_modulus_1 * pull(p.ogden_exponent_1) + p.ogden_modulus_2 * pull(p.ogden_exponent_2))
        }
    }

    /// Modulus of the branch over that of the film.
    fn part(&self) -> f64 {
        let p = &self.p;
        let film = if p.membrane_law == MembraneLaw::Gent {
            p.shear_modulus
        } else {
            0.5 * (p.ogden_modulus_1 * p.ogden_exponent_1 + p.ogden_modulus_2 * p.ogden_exponent_2)
        };
        p.viscous_modulus / film
    }

    /// Area ratio at the depth x, Eqs. (3) to (6), and its derivative.
    fn area(&self, x: f64) -> [f64; 2] {
        let (r2, rb) = (self.p.membrane_radius(), self.p.ball_radius);
        let root = (r2 * r2 + x * x - 2.0 * x * rb).sqrt();
        let tangent = x / (r2 + root); // of half the angle
        let (sin, cos) =
            (2.0 * tangent / (1.0 + tangent * tangent), (1.0 - tangent * tangent) / (1.0 + tangent * tangent));
        let excess = tangent * sin * (rb * rb + (r2 * r2 - rb * rb) / cos) / (r2 * r2);
        let slope = (rb * rb + (r2 * r2 - rb * rb) / (cos * cos)) / (r2 * r2) * sin * cos / root;
        [excess, slope]
    }

    /// Stress of film and branch, Pa, at the logarithmic stretch `log` from the flat film.
    fn tension(&self, log: f64, creep: f64) -> f64 {
        self.stress(self.p.prestretch * log.exp(), 1.0) + self.stress((log - creep).exp(), self.part())
    }

    /// Whether the film would be slack where nothing presses it.
    pub fn is_slack(&self, creep: f64) -> bool {
        self.tension(0.0, creep) < 0.0
    }

    /// Force on the ball at the depth x, N, and rate of the creep, 1/s.
    pub fn film(&self, x: f64, creep: f64) -> [f64; 2] {
        let p = &self.p;
        let part = self.part();
        let [excess, slope] = if x > 0.0 { self.area(x) } else { [0.0; 2] };
        let tension = |log: f64| self.tension(log, creep);
        let mut log = 0.5 * excess.ln_1p();
        let pull = tension(log);
        if pull < 0.0 {
            let (mut low, mut high) = (log, creep);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if tension(middle) < 0.0 { low = middle } else { high = middle }
            }
            log = high;
        }
        let volume = PI * p.membrane_radius().powi(2) * p.membrane_thickness();
        let flow = self.stress((log - creep).exp(), part) / (6.0 * p.viscous_modulus * p.relaxation_time);
        [volume * pull.max(0.0) * slope / (1.0 + excess), flow]
    }
}
