//! A run of the harvester FMU in detail: samples that show every corner of the motion, and its impacts.

use super::{PaperError, Study};
use crate::scenario::Setting;
use fmu_import::Instance;

/// Outputs of a sample, in the order of its values: name, heading and factor in a data sheet.
pub(super) const OUTPUTS: [(&str, &str, f64); 10] = [
    ("cylinder.position", "z_M (mm)", 1e3),
    ("cylinder.velocity", "z_M' (m/s)", 1.0),
    ("ball.position", "z_m (mm)", 1e3),
    ("ball.velocity", "z_m' (m/s)", 1.0),
    ("relativeDisplacement", "z_M - z_m (mm)", 1e3),
    ("left.deflection", "deflection of the left membrane (mm)", 1e3),
    ("right.deflection", "deflection of the right membrane (mm)", 1e3),
    ("left.capacitance", "capacitance of the left membrane (pF)", 1e12),
    ("right.capacitance", "capacitance of the right membrane (pF)", 1e12),
    ("gain.voltage", "sum of U_DE4 - U_in (V)", 1.0),
];
pub(super) const CYLINDER: usize = 0;
pub(super) const CYLINDER_VELOCITY: usize = 1;
pub(super) const BALL: usize = 2;
pub(super) const BALL_VELOCITY: usize = 3;
pub(super) const DISPLACEMENT: usize = 4;
/// Left and right.
pub(super) const DEFLECTIONS: [usize; 2] = [5, 6];
const GAIN: usize = 9;

/// Outputs that look ahead, and the speed of the last impact.
const EVENTS: [&str; 4] = ["impact.nextTime", "pulse.nextKnot", "pulse.knownUntil", "impact.lastVelocity"];

/// How long before an impact a sample is taken, s: short against anything that can be drawn, long against the spacing
/// of doubles at 100 s.
const BEFORE: f64 = 1e-9;

/// Outputs at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// s.
    pub(super) time: f64,
    /// In the order of [`OUTPUTS`], SI units.
    pub(super) values: [f64; OUTPUTS.len()],
}

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Impact {
    /// s.
    pub(super) time: f64,
    /// On the left membrane, which the ball meets at `z_M - z_m` = +s/2.
    pub(super) left: bool,
    /// Relative speed, m/s.
    pub(super) speed: f64,
    /// `U_DE4` - `U_in`, V, Eq. (12).
    pub(super) gain: f64,
    /// `z_m`, m.
    pub(super) ball: f64,
    /// `z_M - z_m`, m.
    pub(super) displacement: f64,
}

/// Samples and impacts of a run.
#[derive(Debug, Clone)]
pub(super) struct Recording {
    /// By ascending time: on a grid, at the knots of C(t), and right before and at each impact.
    pub(super) samples: Vec<Sample>,
    /// In their order.
    pub(super) impacts: Vec<Impact>,
}

/// Runs the FMU with `settings` and records it from `from` to `to`, s, at every multiple of `step`, s, and at all
/// corners.
pub(super) fn record(
    study: &Study<'_>,
    settings: &[Setting],
    [from, to]: [f64; 2],
    step: f64,
) -> Result<Recording, PaperError> {
    let recording = Recording { samples: Vec::new(), impacts: Vec::new() };
    let mut recorder = Recorder { study, instance: study.start(settings)?, time: 0.0, recording };
    if from > 0.0 {
        recorder.go_to(from)?;
        recorder.note()?;
    } else {
        recorder.note()?;
        recorder.note_impact(0.0)?; // of a ball that starts on a membrane
    }
    while recorder.time < to {
        let target = (((recorder.time + BEFORE) / step).floor() + 1.0) * step;
        recorder.follow(target.min(to))?;
    }
    recorder.instance.terminate()?;
    Ok(recorder.recording)
}

/// Impacts between `from` and `to`, s.
pub(super) fn impacts(study: &Study<'_>, settings: &[Setting], window: [f64; 2]) -> Result<Vec<Impact>, PaperError> {
    Ok(record(study, settings, window, window[1] - window[0])?.impacts)
}

struct Recorder<'a> {
    study: &'a Study<'a>,
    instance: Instance,
    time: f64,
    recording: Recording,
}

impl Recorder<'_> {
    /// Steps on; the time is kept as the FMU keeps it, as a sum.
    fn go_to(&mut self, time: f64) -> Result<(), PaperError> {
        let step = time - self.time;
        self.instance.do_step(self.time, step)?;
        self.time += step;
        Ok(())
    }

    fn note(&mut self) -> Result<(), PaperError> {
        let values = self.study.reals(&self.instance, OUTPUTS.map(|(name, ..)| name))?;
        self.recording.samples.push(Sample { time: self.time, values });
        Ok(())
    }

    fn events(&self) -> Result<[f64; EVENTS.len()], PaperError> {
        self.study.reals(&self.instance, EVENTS)
    }

    /// To `target`, or to what comes before it, or as far as that is known.
    fn follow(&mut self, target: f64) -> Result<(), PaperError> {
        let [impact, knot, known, _] = self.events()?;
        let next = target.min(knot).min(known);
        if impact > next {
            self.go_to(next)?;
            return self.note();
        }
        if impact - BEFORE > self.time {
            self.go_to(impact - BEFORE)?;
            self.note()?;
        }
        let before = self.recording.samples.last().map_or(0.0, |sample| sample.values[GAIN]);
        self.go_to(impact)?;
        self.note()?;
        self.note_impact(before)
    }

    fn note_impact(&mut self, gain_before: f64) -> Result<(), PaperError> {
        let [.., speed] = self.events()?;
        let Some(Sample { time, values }) = self.recording.samples.last().copied() else { return Ok(()) };
        // A step that rounding ends just before the impact is followed by one that has it.
        if values[GAIN] > gain_before {
            self.recording.impacts.push(Impact {
                time,
                left: values[DISPLACEMENT] > 0.0,
                speed,
                gain: values[GAIN] - gain_before,
                ball: values[BALL],
                displacement: values[DISPLACEMENT],
            });
        }
        Ok(())
    }
}
