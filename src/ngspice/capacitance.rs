//! C(t) as a table, linear between its rows: what the embedded solver and ngspice both get, so that both solve the same
//! problem.

use std::io::Write;

use super::NgspiceError;
use crate::cosim::{HarvesterFmu, HarvesterSample};

/// The tables and nodes of the netlists hold pF.
pub const PICO: f64 = 1e-12;

/// Capacitances of both membranes at rising times from 0 s on, linear in between.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CapacitanceTable {
    time: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl CapacitanceTable {
    /// Most rows that a table may have: 48 MB in memory, about 100 MB as text.
    pub const MAX_ROWS: usize = 2_000_000;

    /// A table from its columns: times in s, capacitances in F.
    ///
    /// # Errors
    /// Columns of different lengths; fewer than two rows or more than [`Self::MAX_ROWS`]; a first time that is not 0;
    /// times that do not rise; a capacitance that is not finite and above 0.
    pub fn new(time: &[f64], left: &[f64], right: &[f64]) -> Result<Self, NgspiceError> {
        let fail = |row, reason| Err(NgspiceError::Table { row, reason });
        if time.len() != left.len() || time.len() != right.len() {
            let lengths = format!("{} times, {} left, {} right: must be as many", time.len(), left.len(), right.len());
            return fail(0, lengths);
        }
        let mut table = Self::default();
        for ((&time, &left), &right) in time.iter().zip(left).zip(right) {
            table.push(time, [left, right])?;
        }
        if table.len() < 2 { fail(table.len(), "there must be two rows at least".to_owned()) } else { Ok(table) }
    }

    /// Appends a row, checked.
    fn push(&mut self, time: f64, [left, right]: [f64; 2]) -> Result<(), NgspiceError> {
        let row = self.len();
        let fail = |reason| Err(NgspiceError::Table { row, reason });
        let in_order = self.time.last().map_or(time == 0.0, |&last| time > last && time.is_finite());
        if !in_order {
            return fail(format!("time = {time} s: must start at 0 s and rise"));
        }
        for (name, value) in [("left", left), ("right", right)] {
            if !(value > 0.0 && value.is_finite()) {
                return fail(format!("{name} capacitance = {value} F: must be finite and above 0"));
            }
        }
        if row == Self::MAX_ROWS {
            return fail(format!("there must be {} rows at most", Self::MAX_ROWS));
        }
        self.time.push(time);
        self.left.push(left);
        self.right.push(right);
        Ok(())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Never true of a table that [`Self::new`] or [`Self::from_harvester`] made.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Times, s.
    pub fn times(&self) -> &[f64] {
        &self.time
    }

    /// Capacitances of the left membrane, F.
    pub fn left(&self) -> &[f64] {
        &self.left
    }

    /// Capacitances of the right membrane, F.
    pub fn right(&self) -> &[f64] {
        &self.right
    }

    /// Time and capacitances (left, right), F, of each row.
    pub fn rows(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        self.time.iter().zip(&self.left).zip(&self.right).map(|((&time, &left), &right)| (time, [left, right]))
    }

    /// Capacitances (left, right) at 0 s, F.
    pub fn initial(&self) -> [f64; 2] {
        [&self.left, &self.right].map(|column| column.first().copied().unwrap_or_default())
    }

    /// Largest ratio of a capacitance to that at 0 s, at least 1: by so much may the voltage rise.
    pub fn growth(&self) -> f64 {
        let [left, right] = self.initial();
        self.rows().map(|(_, c)| (c[0] / left).max(c[1] / right)).fold(1.0, f64::max)
    }

    /// Last time, s.
    pub fn until(&self) -> f64 {
        self.time.last().copied().unwrap_or_default()
    }

    /// Writes the table as ngspice's `filesource` reads it: time in s, left and right in pF. A last row beyond the end
    /// keeps the capacitances where the last step of ngspice may overshoot.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, mut out: impl Write) -> std::io::Result<()> {
        let beyond = self.rows().last().map(|(time, capacitance)| (time + 1.0, capacitance));
        for (time, [left, right]) in self.rows().chain(beyond) {
            writeln!(out, "{time:e} {:e} {:e}", left / PICO, right / PICO)?;
        }
        out.flush()
    }

    /// Runs `harvester` from 0 s to `until`, s, and keeps what C(t) needs: the kinks and extrema that the FMU announces,
    /// and in between as many points as `error` asks for, the largest error of the linear interpolation relative to the
    /// height of the largest pulse so far. Outside the pulses there is nothing to keep.
    ///
    /// # Errors
    /// What the FMU says; an `error` outside `1e-9` to `0.1`; more than [`Self::MAX_ROWS`] rows.
    pub fn from_harvester(harvester: &mut HarvesterFmu, until: f64, error: f64) -> Result<Self, NgspiceError> {
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
        let mut survey = Survey { harvester, rest, height: [0.0; 2], error };
        let mut table = Self::default();
        table.push(0.0, rest)?;
        let mut now = 0.0;
        while now < until {
            let end = sample.next_knot().clamp(now + Survey::SHORTEST, until.max(now + Survey::SHORTEST)).min(until);
            let points = survey.interval(now, end, &mut sample)?;
            thin(&points, survey.tolerance(), &mut table)?;
            now = end;
        }
        Ok(table)
    }
}

/// A time with the capacitances there.
type Point = (f64, [f64; 2]);

/// A run of the harvester from knot to knot.
struct Survey<'a> {
    harvester: &'a mut HarvesterFmu,
    /// Capacitances at the start, F.
    rest: [f64; 2],
    /// Height of the largest pulse so far, F.
    height: [f64; 2],
    error: f64,
}

impl Survey<'_> {
    /// Closest knots, s: a ball that comes to rest has knots without end.
    const SHORTEST: f64 = 1e-6;

    /// Pieces into which the stretch between two knots is cut before it is thinned. A quarter of a sine in n pieces is
    /// off by (pi/2)^2 / (8 n^2) of its height; four times its curvature is allowed for, and half the error.
    fn pieces(&self, length: f64) -> u32 {
        let wanted = (2.0 / self.error.sqrt()).min(length / (0.1 * Self::SHORTEST)).ceil();
        // Bounded by 2 / sqrt(1e-9).
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let pieces = wanted as u32;
        pieces.max(2)
    }

    /// Points of C(t) from `now` to `end`, both included; the harvester stands at `end` then.
    fn interval(&mut self, now: f64, end: f64, sample: &mut HarvesterSample) -> Result<Vec<Point>, NgspiceError> {
        let pieces = self.pieces(end - now);
        let mut points = vec![(now, sample.capacitance())];
        let mut last = now;
        for k in 1..=pieces {
            let part = f64::from(k) / f64::from(pieces);
            let next = if k == pieces { end } else { now + (end - now) * part };
            self.harvester.step(last, next - last)?;
            *sample = self.harvester.sample()?;
            last = next;
            points.push((next, sample.capacitance()));
        }
        for (_, capacitance) in &points {
            for ((height, c), rest) in self.height.iter_mut().zip(capacitance).zip(self.rest) {
                *height = height.max((c - rest).abs());
            }
        }
        Ok(points)
    }

    /// Half of the error, F: the other half is that of the pieces.
    fn tolerance(&self) -> [f64; 2] {
        self.height.map(|height| 0.5 * self.error * height)
    }
}

/// Appends to `table` the last of `points` and as many of those before as it takes to be within `tolerance` of all of
/// them, the first being in the table already: from each point kept to the farthest one that a chord reaches. A chord
/// may reach as far as the slopes that pass all points in between (within the tolerance) leave room for.
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
