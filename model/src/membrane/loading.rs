//! How a membrane is pressed in over time under its own law: m x'' = -f(x) from x = 0 to its largest deflection.
//!
//! With x = delta cos(phi) the time that is left to the largest deflection is an integral over phi whose integrand has no
//! singularity: T = integral of delta sin(phi) / sqrt(2 (E(delta) - E(x)) / m) from 0 to phi. It is divided until two rules of Gauss
//! and Legendre agree: first at the points of a table, between which the force is smooth, then in halves.

use core::f64::consts::FRAC_PI_2;

use super::Membrane;
use crate::numerics::quadrature::{gauss_4, gauss_8};
use crate::numerics::roots::short_root_near;
use crate::shared::Shared;

/// Error of a piece, in units of the whole time.
const TOLERANCE: f64 = 1e-13;

/// Smallest width of a piece, and the largest number of pieces: beyond, it is rounding that does not agree.
const NARROWEST: f64 = 1e-6;
const MAX_PIECES: usize = 1 << 16;

/// Deflection, m, below which motions are no longer told apart.
const SMALLEST: f64 = 1e-60;

/// The way of a membrane to one largest deflection.
#[derive(Debug, PartialEq)]
pub(crate) struct Loading {
    membrane: Shared<Membrane>,
    /// delta, m.
    peak: f64,
    /// Speed at the begin, m/s.
    speed: f64,
    /// Ends of the pieces, the angle phi, and the time from there to the largest deflection, s; rising.
    pieces: Vec<[f64; 2]>,
}

impl Loading {
    /// The way of `membrane` to the deflection `peak`, m.
    pub(crate) fn new(membrane: &Shared<Membrane>, peak: f64) -> Self {
        let peak = peak.clamp(SMALLEST, membrane.deepest());
        let speed = (2.0 * membrane.work(peak) / membrane.mass).sqrt();
        let mut loading = Self { membrane: membrane.clone(), peak, speed, pieces: vec![[0.0; 2]] };
        // About the time that a spring takes.
        let tolerance = TOLERANCE * FRAC_PI_2 * peak / speed;
        let kinks = loading.kinks();
        loading.divide(&kinks, tolerance);
        loading
    }

    /// Time from the begin to the largest deflection, s.
    pub(crate) fn time(&self) -> f64 {
        self.pieces.last().map_or(0.0, |[_, time]| *time)
    }

    /// x over delta, and x' over the speed at the begin, at `fraction` (0 to 1) of the time.
    pub(crate) fn at(&self, fraction: f64) -> (f64, f64) {
        let left = (1.0 - fraction).clamp(0.0, 1.0) * self.time();
        let k = self.pieces.partition_point(|[_, time]| *time < left).clamp(1, self.pieces.len() - 1);
        let ([from, before], [to, after]) = (self.pieces[k - 1], self.pieces[k]);
        let share = ((left - before) / (after - before)).clamp(0.0, 1.0);
        let angle = short_root_near(from + share * (to - from), from, to, |angle| {
            let time = before + gauss_8(from, angle, |angle| self.pace(angle));
            (left - time, -self.pace(angle))
        });
        let rate = self.peak * angle.sin() / self.pace(angle);
        (angle.cos(), rate / self.speed)
    }

    /// dT/dphi, s.
    fn pace(&self, angle: f64) -> f64 {
        let membrane = &self.membrane;
        let half = (0.5 * angle).sin();
        let way = 2.0 * self.peak * half * half;
        let work = membrane.last_work(self.peak, way);
        if work > 0.0 {
            self.peak * angle.sin() / (2.0 * work / membrane.mass).sqrt()
        } else {
            // At the largest deflection the force is as good as constant.
            (self.peak * membrane.mass / membrane.force(self.peak)).sqrt()
        }
    }

    /// Angles of the points of a table, at which the force may have a kink; rising.
    fn kinks(&self) -> Vec<f64> {
        let points = self.membrane.table().map_or(&[][..], |table| table.deflections());
        let inner = points.get(1..points.partition_point(|x| *x < self.peak)).unwrap_or_default();
        inner.iter().rev().map(|x| 2.0 * ((self.peak - x) / (2.0 * self.peak)).sqrt().asin()).collect()
    }

    /// Adds all pieces.
    fn divide(&mut self, kinks: &[f64], tolerance: f64) {
        // Ends of what is still to be added, the next one last, with the kinks on the way there.
        let mut pending = vec![(FRAC_PI_2, kinks)];
        let [mut from, mut time] = [0.0; 2];
        while let Some((to, kinks)) = pending.pop() {
            let sum = gauss_8(from, to, |angle| self.pace(angle));
            let agree = (gauss_4(from, to, |angle| self.pace(angle)) - sum).abs() <= tolerance;
            if agree || to - from <= NARROWEST || self.pieces.len() >= MAX_PIECES {
                (from, time) = (to, time + sum);
                self.pieces.push([from, time]);
                continue;
            }
            let (before, after) = kinks.split_at(kinks.len() / 2);
            let halves = match after.split_first() {
                Some((kink, after)) => [(to, after), (*kink, before)],
                None => [(to, after), (from + 0.5 * (to - from), before)],
            };
            pending.extend(halves);
        }
    }
}
