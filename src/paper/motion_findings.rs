//! What Section 4.2 says of Figures 9 to 15, beside what the FMU does.

use super::motion::{Setup, Shown};
use super::patterns::{Pattern, mean_falling_row};
use super::recording::{BALL, DISPLACEMENT, Impact, Recording, Sample, impacts, record};
use super::{Finding, PaperError, Study, Verdict, WINDOW};
use crate::scenario::Setting;

/// Where it is asked whether a motion repeats, s: any transient is long over.
const LATE: [f64; 2] = [990.0, 1000.0];

/// Most cycles after which it may.
const MOST_CYCLES: u32 = 8;

/// Largest difference of a motion that repeats, in units of s.
const REPEATS: f64 = 1e-6;

/// Largest relative difference of what counts as equal.
const EQUAL: f64 = 1e-6;

/// What is found, and what is said of it.
pub(super) type Found = (Vec<Finding>, Vec<String>);

/// A quantity of one figure, of which the paper prints or says `paper`.
pub(super) struct Fact<'a> {
    /// Number of the figure.
    pub(super) number: u32,
    /// What it is.
    pub(super) quantity: &'a str,
    /// Its unit.
    pub(super) unit: &'a str,
}

impl Fact<'_> {
    /// It agrees with what the paper says if it `holds`.
    fn said(&self, paper: f64, videg: f64, holds: bool, reason: impl Into<String>) -> Finding {
        let verdict = if holds { Verdict::Agrees } else { Verdict::Differs };
        Finding { paper: Some(paper), verdict, ..self.own(videg, reason) }
    }

    /// The paper has no number for it.
    pub(super) fn own(&self, videg: f64, reason: impl Into<String>) -> Finding {
        Finding {
            place: format!("Figure {}", self.number),
            quantity: self.quantity.to_owned(),
            unit: self.unit.to_owned(),
            paper: None,
            videg,
            verdict: Verdict::Beyond,
            reason: reason.into(),
        }
    }
}

fn fact<'a>(shown: &Shown, quantity: &'a str, unit: &'a str) -> Fact<'a> {
    Fact { number: shown.number, quantity, unit }
}

/// Of the figure `shown`.
pub(super) fn findings(
    study: &Study<'_>,
    shown: &Shown,
    setup: &Setup,
    recording: &Recording,
) -> Result<Found, PaperError> {
    let settings = study.case(shown.case)?;
    if shown.number == 9 {
        let whole = record(study, &settings, [0.0, WINDOW[1]], 0.01)?;
        return Ok((without_impacts(shown, setup, &whole), Vec::new()));
    }
    let steady = impacts(study, &settings, WINDOW)?;
    Ok(match shown.number {
        10 => (saw_tooth(shown, setup, &steady), Vec::new()),
        11 => short_flights(shown, setup, recording, &steady),
        12 => double_hits(study, shown, setup, recording)?,
        13 => (counts(shown, setup, recording), Vec::new()),
        _ => damped(shown, setup, &steady, &period(study, setup, &settings)?),
    })
}

/// Figure 9.
fn without_impacts(shown: &Shown, setup: &Setup, run: &Recording) -> Vec<Finding> {
    let largest = |output: usize| run.samples.iter().map(|s| s.values[output].abs()).fold(0.0, f64::max);
    let (count, still) = (run.impacts.len() as f64, 1e3 * largest(BALL));
    let gain: f64 = run.impacts.iter().map(|impact| impact.gain).fold(0.0, f64::max);
    let voltage = 1e-3 * (setup.bias_voltage + gain);
    vec![
        fact(shown, "impacts in 100 s", "1").said(0.0, count, count == 0.0, ""),
        fact(shown, "largest displacement of the ball", "mm").said(0.0, still, still == 0.0, ""),
        fact(shown, "largest voltage", "kV").said(2.0, voltage, voltage == 2.0, ""),
        fact(shown, "amplitude of z_M - z_m", "mm").own(
            1e3 * largest(DISPLACEMENT),
            format!("A / (M (2 pi f_0)^2) of Section 5.1 is {:.6} mm", 1e3 * setup.swing()),
        ),
    ]
}

/// Figure 10.
fn saw_tooth(shown: &Shown, setup: &Setup, steady: &[Impact]) -> Vec<Finding> {
    let periods = (WINDOW[1] - WINDOW[0]) * setup.frequency;
    let each = steady.len() as f64 / periods;
    let [low, high] = extremes(steady);
    let spread = high / low - 1.0;
    let [.., ball_velocity] = setup.start;
    let speed = steady.iter().map(|impact| impact.speed).fold(0.0, f64::max);
    vec![
        fact(shown, "impacts in each cycle", "1").said(2.0, each, each == 2.0, ""),
        fact(shown, "spread of the voltage peaks, largest / smallest - 1", "1").said(0.0, spread, spread < EQUAL, ""),
        fact(shown, "relative speed of the impacts", "m/s")
            .own(speed, format!("4 f_0 z_m(0) of Section 4.2 is {:.7} m/s", -ball_velocity)),
        fact(shown, "U_DE4, Eq. (12)", "V").own(setup.bias_voltage + high, ""),
    ]
}

/// Figure 11.
fn short_flights(shown: &Shown, setup: &Setup, recording: &Recording, steady: &[Impact]) -> Found {
    // An amplitude of s/2.
    let limit = setup.amplitude * (setup.travel / 2.0) / setup.swing();
    let [low, high] = extremes(steady).map(|gain| setup.bias_voltage + gain);
    let mut findings = vec![
        fact(shown, "A above which the saw-tooth is destroyed, M (2 pi f_0)^2 s/2", "N").said(
            0.4325,
            limit,
            (limit - 0.4325).abs() < 5e-5,
            "",
        ),
        fact(shown, "smallest U_DE4", "V").own(low, "50 to 100 s"),
        fact(shown, "largest U_DE4", "V").own(high, "50 to 100 s"),
    ];
    findings.extend(counts(shown, setup, recording));
    let [.., ball, _] = setup.start;
    let text = format!(
        "The start of the saw-tooth, z_m(0) = s/2 - A/(M (2 pi f_0)^2), is meant for z_m(0) > 0, as the paper says of \
         Figure 10; with A = {} N it is {:.2} mm. It is taken as it stands.",
        setup.amplitude,
        1e3 * ball
    );
    (findings, vec![text])
}

/// Figure 12.
fn double_hits(study: &Study<'_>, shown: &Shown, setup: &Setup, recording: &Recording) -> Result<Found, PaperError> {
    let mut free = study.case(shown.case)?;
    free.push(Setting::new("initial.outsideGap", "free"));
    let free = impacts(study, &free, shown.window)?;
    let hits = Pattern::DoubleHit.count(&free, setup.travel);
    let [cylinder, _, ball, _] = setup.start;
    let (start, half) = (1e3 * (cylinder - ball).abs(), 500.0 * setup.travel);
    let mut findings = vec![
        fact(shown, "abs(z_M(0) - z_m(0)) as given", "mm")
            .own(start, format!("beyond s/2 = {half:.3} mm: the paper starts outside the gap")),
    ];
    findings.extend(counts(shown, setup, recording));
    findings.push(
        fact(shown, "double hits if the ball starts free", "1").own(hits as f64, "initial.outsideGap = free, 0 to 5 s"),
    );
    let own = Pattern::DoubleHit.count(&recording.impacts, setup.travel);
    let text = format!(
        "The start lies outside the gap, of which the paper says nothing. Put on the membrane (initial.outsideGap = \
         project, shown here) the ball hits one membrane twice in a row {own} times in the first 5 s, as the paper \
         describes it; let free (free) it does so {hits} times."
    );
    Ok((findings, vec![text]))
}

/// How often the paper's patterns occur in what is shown.
fn counts(shown: &Shown, setup: &Setup, recording: &Recording) -> Vec<Finding> {
    let count = |rule: Pattern| rule.count(&recording.impacts, setup.travel) as f64;
    let [from, to] = shown.window;
    let of = format!("of {} impacts from {from} to {to} s", recording.impacts.len());
    let reason = |rule: Pattern| {
        let circled = if shown.circled == Some(rule) { ", circled in the paper" } else { "" };
        format!("{}, {of}{circled}", rule.words())
    };
    vec![
        fact(shown, "short flights", "1").own(count(Pattern::ShortFlight), reason(Pattern::ShortFlight)),
        fact(shown, "double hits", "1").own(count(Pattern::DoubleHit), reason(Pattern::DoubleHit)),
    ]
}

/// Figures 14 and 15: "a high peak is followed by a moderate peak and then a very small one".
fn damped(shown: &Shown, setup: &Setup, steady: &[Impact], period: &Period) -> Found {
    let periods = (WINDOW[1] - WINDOW[0]) * setup.frequency;
    let [low, high] = extremes(steady).map(|gain| setup.bias_voltage + gain);
    let left = steady.iter().filter(|impact| impact.left).count() as f64 / steady.len() as f64;
    let row = mean_falling_row(steady);
    let rows = fact(shown, "mean length of a row of falling peaks", "1");
    let rows = if (row - 3.0).abs() < 0.05 {
        rows.said(3.0, row, true, "high, moderate, small")
    } else {
        let reason = "the paper's three peaks are what is typical of r < 1; here some rows have two";
        let verdict = if row > 2.0 && row < 3.0 { Verdict::Explained } else { Verdict::Differs };
        Finding { verdict, ..rows.said(3.0, row, false, reason) }
    };
    let mut findings = vec![
        rows,
        fact(shown, "impacts in each cycle", "1").own(steady.len() as f64 / periods, ""),
        fact(shown, "smallest U_DE4", "V").own(low, "50 to 100 s"),
        fact(shown, "largest U_DE4", "V").own(high, "50 to 100 s"),
        fact(shown, "share of impacts on the left membrane", "1")
            .own(left, "1/2 would be symmetric; the paper sees an asymmetry"),
    ];
    let (from, to) = (LATE[0], LATE[1]);
    if period.difference < REPEATS * setup.travel {
        let cycles = fact(shown, "cycles after which the motion repeats", "1");
        let difference = 1e3 * period.difference;
        let shown = if difference == 0.0 { "0".to_owned() } else { format!("{difference:.0e}") };
        let reason = format!("z_M - z_m differs by at most {shown} mm, {from} to {to} s");
        findings.push(cycles.own(f64::from(period.cycles), reason));
        return (findings, Vec::new());
    }
    let reason = format!("{from} to {to} s: the motion does not repeat, however long one waits");
    let quantity = format!("least difference of z_M - z_m after 1 to {MOST_CYCLES} cycles");
    findings.push(fact(shown, &quantity, "mm").own(1e3 * period.difference, reason));
    let text = "Damped as it is, this motion is no periodic one: it stays within narrow bands but does not come back \
                to where it was, and nearby starts part from it (see Table 2).";
    (findings, vec![text.to_owned()])
}

/// Smallest and largest gain.
fn extremes(impacts: &[Impact]) -> [f64; 2] {
    let gains = impacts.iter().map(|impact| impact.gain);
    [gains.clone().fold(f64::INFINITY, f64::min), gains.fold(0.0, f64::max)]
}

/// How a motion repeats.
struct Period {
    cycles: u32,
    /// Largest difference of `z_M - z_m` after so many cycles, m.
    difference: f64,
}

/// The number of cycles, at most [`MOST_CYCLES`], after which the relative displacement at the beginning of a cycle
/// comes back best; of several that are as good as equal the smallest.
fn period(study: &Study<'_>, setup: &Setup, settings: &[Setting]) -> Result<Period, PaperError> {
    let run = record(study, settings, LATE, 1.0 / setup.frequency)?;
    let starts_cycle =
        |sample: &&Sample| ((sample.time * setup.frequency).round() - sample.time * setup.frequency).abs() < 1e-9;
    let cycles: Vec<f64> = run.samples.iter().filter(starts_cycle).map(|sample| sample.values[DISPLACEMENT]).collect();
    let difference = |lag: usize| {
        let pairs = cycles.iter().zip(cycles.iter().skip(lag));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let lags = (1..=MOST_CYCLES).map(|cycles| Period { cycles, difference: difference(cycles as usize) });
    let best = lags.reduce(|best, next| if next.difference < 0.5 * best.difference { next } else { best });
    Ok(best.unwrap_or(Period { cycles: 0, difference: f64::NAN }))
}
