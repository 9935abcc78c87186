//! C(t) of a run of the harvester as a table for other solvers.

use super::{HarvesterFmu, HarvesterSample, TimeProgress};
use crate::ngspice::{CapacitanceTable, NgspiceError};
use crate::progress::Progress;

impl CapacitanceTable {
    /// Runs `harvester` from 0 s to `until`, s, and keeps the kinks and extrema of C(t) that the FMU announces, and in
    /// between the points that `error` requires, the largest error of the linear interpolation relative to the height of
    /// the largest pulse so far. Outside the pulses it keeps no points.
    ///
    /// # Errors
    /// Errors of the FMU; an `error` outside `1e-9` to `0.1`; more than [`Self::MAX_ROWS`] rows.
    pub fn from_harvester(
        harvester: &mut HarvesterFmu,
        until: f64,
        error: f64,
        progress: &dyn Progress,
    ) -> Result<Self, NgspiceError> {
        if !(1e-9..=0.1).contains(&error) {
            let value = error.to_string();
            return Err(NgspiceError::Value {
                name: "error of C(t)".to_owned(),
                value,
                bound: "must lie from 1e-9 to 0.1",
            });
        }
        let mut sample = harvester.sample()?;
        let rest = sample.capacitance();
        let mut sampler = Sampler { harvester, rest, height: [0.0; 2], error };
        let mut table = Self::default();
        table.push(0.0, rest)?;
        let (mut now, mut time) = (0.0, TimeProgress::new(progress, until));
        // Those since the last knot, when that was, and whether it is now.
        let (mut points, mut last_knot, mut is_at_knot) = (vec![(now, rest)], now, true);
        let mut impacts = sampler.impacts()?;
        while now < until {
            time.tell(now)?;
            let knot = sample.next_knot();
            let end = knot.min(sample.known_until());
            let end = end.clamp(now + Sampler::SHORTEST, until.max(now + Sampler::SHORTEST)).min(until);
            // A pulse begins at a knot and announces its peak and end.
            let is_flat = !is_at_knot && sample.deflection() == [0.0; 2];
            // From knot to knot as far as is known, of which this is a part.
            let whole_end = if knot < f64::MAX { knot.min(until).max(end) } else { end };
            let pieces = if is_flat { 1 } else { sampler.pieces(end - now, whole_end - last_knot) };
            sampler.interval(now, end, pieces, &mut sample, &mut points)?;
            now = end;
            // What was not known may come where that ends.
            let before = std::mem::replace(&mut impacts, sampler.impacts()?);
            is_at_knot = end >= knot || impacts != before;
            if is_at_knot {
                last_knot = now;
            }
            if is_at_knot || now == until || points.len() > Sampler::MOST_POINTS {
                thin(&points, sampler.tolerance(), &mut table)?;
                points.drain(..points.len() - 1);
            }
        }
        Ok(table)
    }
}

/// A time with the capacitances there.
type Point = (f64, [f64; 2]);

/// A run of the harvester from knot to knot.
struct Sampler<'a> {
    harvester: &'a mut HarvesterFmu,
    /// Capacitances at the start, F.
    rest: [f64; 2],
    /// Height of the largest pulse so far, F.
    height: [f64; 2],
    error: f64,
}

impl Sampler<'_> {
    /// Closest knots, s: a ball that comes to rest has knots without end.
    const SHORTEST: f64 = 1e-6;

    /// Points between two knots after which they are thinned.
    const MOST_POINTS: usize = 1_000_000;

    /// Impacts so far.
    fn impacts(&self) -> Result<i32, NgspiceError> {
        let [impacts, _] = self.harvester.counts()?;
        Ok(impacts)
    }

    /// Pieces into which this length, s, of the `whole` stretch between two knots is cut before it is thinned. A quarter of a sine in
    /// n pieces is off by (pi/2)^2 / (8 n^2) of its height; four times its curvature is allowed for, and half the error.
    fn pieces(&self, length: f64, whole: f64) -> u32 {
        let wanted = (2.0 / self.error.sqrt() * (length / whole)).min(length / (0.1 * Self::SHORTEST)).ceil();
        // Bounded by 2 / sqrt(1e-9).
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let pieces = wanted as u32;
        pieces.max(if length < whole { 1 } else { 2 })
    }

    /// Adds points of C(t) behind `now` up to `end`, at which the harvester stands then.
    fn interval(
        &mut self,
        now: f64,
        end: f64,
        pieces: u32,
        sample: &mut HarvesterSample,
        points: &mut Vec<Point>,
    ) -> Result<(), NgspiceError> {
        let mut last = now;
        for k in 1..=pieces {
            let part = f64::from(k) / f64::from(pieces);
            let next = if k == pieces { end } else { now + (end - now) * part };
            self.harvester.step(last, next - last)?;
            last = next;
            let capacitance = self.harvester.capacitance()?;
            for ((height, c), rest) in self.height.iter_mut().zip(capacitance).zip(self.rest) {
                *height = height.max((c - rest).abs());
            }
            // On a level nothing but its ends is needed.
            if let [.., (_, before), (_, here)] = points[..]
                && before == here
                && here == capacitance
            {
                points.pop();
            }
            points.push((next, capacitance));
        }
        *sample = self.harvester.sample()?;
        Ok(())
    }

    /// Half of the error, F: the other half is that of the pieces.
    fn tolerance(&self) -> [f64; 2] {
        self.height.map(|height| 0.5 * self.error * height)
    }
}

/// Appends to `table` the last of `points` and those before it that keep straight lines within `tolerance` of all points. The table
/// already has the first point. From each point in the table a line goes to the farthest point for which some slope passes all points
/// in between within the tolerance.
fn thin(points: &[Point], tolerance: [f64; 2], table: &mut CapacitanceTable) -> Result<(), NgspiceError> {
    let mut anchor = 0;
    while anchor + 1 < points.len() {
        let (start, from) = points[anchor];
        let mut room = [(f64::NEG_INFINITY, f64::INFINITY); 2];
        let mut reached = anchor + 1;
        for (index, &(time, capacitance)) in points.iter().enumerate().skip(anchor + 1) {
            let fits = (0..2).all(|j| {
                let slope = (capacitance[j] - from[j]) / (time - start);
                room[j].0 <= slope && slope <= room[j].1
            });
            if fits {
                reached = index;
            }
            for j in 0..2 {
                let rise = capacitance[j] - from[j];
                let (low, high) = ((rise - tolerance[j]) / (time - start), (rise + tolerance[j]) / (time - start));
                room[j] = (room[j].0.max(low), room[j].1.min(high));
            }
            if room.iter().any(|(low, high)| low > high) {
                break;
            }
        }
        let (time, capacitance) = points[reached];
        table.push(time, capacitance)?;
        anchor = reached;
    }
    Ok(())
}
