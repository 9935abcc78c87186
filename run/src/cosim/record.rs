//! Observers of a run: the impacts, the data of a figure in memory, and progress.

use super::{CircuitSample, CosimError, HarvesterSample, Observer, Row};
use crate::progress::Progress;
use crate::scenario::Scenario;

/// An impact of the ball on a membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MembraneImpact {
    /// s
    pub time: f64,
    /// The membrane: 0 left, 1 right.
    pub side: usize,
    /// `C_3` / `C_2`.
    pub ratio: f64,
}

/// Finds the impacts from the running sum of their gains. Impacts within one communication step count as one.
#[derive(Debug)]
pub struct ImpactLog {
    bias_voltage: f64,
    gain: f64,
    /// In order.
    pub impacts: Vec<MembraneImpact>,
}

impl ImpactLog {
    /// A log for a harvester of `bias_voltage`, V.
    pub fn new(bias_voltage: f64) -> Self {
        Self { bias_voltage, gain: 0.0, impacts: Vec::new() }
    }
}

impl Observer for ImpactLog {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        let gain = row.harvester.voltage_gain();
        if gain > self.gain {
            // Left is the end that the ball meets when z_M - z_m = +s/2.
            let side = usize::from(row.harvester.relative_displacement() < 0.0);
            let ratio = 1.0 + (gain - self.gain) / self.bias_voltage;
            self.impacts.push(MembraneImpact { time: row.time, side, ratio });
            self.gain = gain;
        }
        Ok(())
    }
}

/// One point of a [`Trace`].
#[derive(Debug, Clone)]
pub struct TracePoint {
    /// Time, s.
    pub time: f64,
    /// The harvester.
    pub harvester: HarvesterSample,
    /// The circuits.
    pub circuits: Vec<CircuitSample>,
    /// The waveforms that were asked for.
    pub probes: Vec<f64>,
}

impl TracePoint {
    /// The point of `row`.
    pub fn of(row: &Row<'_>) -> Self {
        let (circuits, probes) = (row.circuits.to_vec(), row.probes.to_vec());
        Self { time: row.time, harvester: *row.harvester, circuits, probes }
    }
}

/// Tells the time reached to a [`Progress`], in thousandths of the run, and ends the run if that wants it.
pub struct TimeProgress<'a> {
    progress: &'a dyn Progress,
    until: f64,
    told: u64,
}

impl<'a> TimeProgress<'a> {
    /// Parts into which a run is divided.
    const PARTS: u64 = 1000;

    /// Follows a run up to `until`, s.
    pub fn new(progress: &'a dyn Progress, until: f64) -> Self {
        Self { progress, until, told: 0 }
    }

    /// Tells that `time`, s, is reached.
    pub fn tell(&mut self, time: f64) -> Result<(), CosimError> {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to PARTS
        let part = (time / self.until * Self::PARTS as f64) as u64;
        if part > self.told {
            self.told = part;
            self.progress.advance(part, Self::PARTS, &[]);
        }
        if self.progress.is_stopped() { Err(CosimError::Stopped { time }) } else { Ok(()) }
    }
}

impl Observer for TimeProgress<'_> {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        self.tell(row.time)
    }
}

/// Data of a figure: the end of the run in detail, and an overview of the run. Memory does not grow with the number of points.
#[derive(Debug, Clone)]
pub struct Trace {
    until: f64,
    detail_from: f64,
    /// Distance of the points kept, s, and when the next is due: of the detail and of the overview.
    spacing: [f64; 2],
    due: [f64; 2],
    /// Communication points near the end of the run, without those too close to the one before to be seen.
    pub detail: Vec<TracePoint>,
    /// Points of the run, about evenly spaced.
    pub overview: Vec<TracePoint>,
}

impl Trace {
    /// Most points of the detail: several for each pixel.
    const DETAIL: f64 = 40_000.0;
    /// Points of the overview.
    const OVERVIEW: f64 = 1000.0;

    /// Length of the detail, s: some periods of the paper's 2 Hz.
    const LENGTH: f64 = 2.0;

    /// Start of the detail, s.
    pub fn detail_from(&self) -> f64 {
        self.detail_from
    }

    /// A trace of a run of `scenario`.
    pub fn of(scenario: &Scenario) -> Self {
        let until = scenario.until;
        let detail = Self::LENGTH.min(until);
        let spacing = [detail / Self::DETAIL, until / Self::OVERVIEW];
        let detail_from = until - detail;
        Self { until, detail_from, spacing, due: [detail_from, 0.0], detail: Vec::new(), overview: Vec::new() }
    }
}

impl Observer for Trace {
    fn observe(&mut self, row: &Row<'_>) -> Result<(), CosimError> {
        let [detail_due, due] = &mut self.due;
        if row.time >= *detail_due || row.time >= self.until {
            self.detail.push(TracePoint::of(row));
            *detail_due = row.time + self.spacing[0];
        }
        if row.time >= *due {
            self.overview.push(TracePoint::of(row));
            *due += self.spacing[1];
        }
        Ok(())
    }
}
