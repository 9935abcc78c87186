//! Statements of Section 4.2 on Figures 9 to 15, beside the motion of the FMU.

use super::{Setup, Shown};
use crate::paper::patterns::{Pattern, mean_falling_row};
use crate::paper::recording::{BALL, DISPLACEMENT, Impact, Recording, Sample, impacts, record};
use crate::paper::{Finding, PaperError, Study, Verdict, WINDOW};
use crate::scenario::Setting;

/// Window of the test whether a motion repeats, s: any transient is long over.
const LATE: [f64; 2] = [990.0, 1000.0];

/// Most cycles after which it may.
const MOST_CYCLES: u32 = 8;

/// Largest difference of a motion that repeats, in units of s.
const REPEATS: f64 = 1e-6;

/// Largest relative difference of what counts as equal.
const EQUAL: f64 = 1e-6;

/// Findings, and paragraphs of text.
pub(super) type Found = (Vec<Finding>, Vec<String>);

/// A quantity of a figure that the paper gives no number for.
fn own(shown: &Shown, quantity: &str, unit: &str, videg: f64) -> Finding {
    Finding::new(format!("Figure {}", shown.number), quantity, unit, videg)
}

/// A quantity that the paper prints or describes as `paper`.
fn said(shown: &Shown, quantity: &str, unit: &str, [paper, videg]: [f64; 2], agrees: bool) -> Finding {
    own(shown, quantity, unit, videg).printed(paper).agrees_if(agrees)
}

/// Of the figure `shown`.
pub(super) fn findings(
    study: &Study<'_>,
    shown: &Shown,
    setup: &Setup,
    recording: &Recording,
) -> Result<Found, PaperError> {
    let settings = Study::case(shown.case)?;
    if shown.number == 9 {
        let whole = record(study, &settings, [0.0, WINDOW[1]], 0.01)?;
        return Ok((without_impacts(shown, setup, &whole), Vec::new()));
    }
    let steady = impacts(study, &settings, WINDOW)?;
    Ok(match shown.number {
        10 => (saw_tooth(shown, setup, &steady), Vec::new()),
        11 => short_flights(shown, setup, recording, &steady),
        12 => double_hits(study, shown, setup, recording)?,
        13 => (counts(shown, setup, recording).into(), Vec::new()),
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
        said(shown, "impacts in 100 s", "1", [0.0, count], count == 0.0),
        said(shown, "largest displacement of the ball", "mm", [0.0, still], still == 0.0),
        said(shown, "largest voltage", "kV", [2.0, voltage], voltage == 2.0),
        own(shown, "amplitude of z_M - z_m", "mm", 1e3 * largest(DISPLACEMENT))
            .reason(format!("A / (M (2 pi f_0)^2) of Section 5.1 is {:.6} mm", 1e3 * setup.swing())),
    ]
}

/// Figure 10.
fn saw_tooth(shown: &Shown, setup: &Setup, steady: &[Impact]) -> Vec<Finding> {
    let each = impacts_in_a_cycle(setup, steady);
    let [low, high] = extremes(steady);
    let spread = high / low - 1.0;
    let [.., ball_velocity] = setup.start;
    let speed = steady.iter().map(|impact| impact.speed).fold(0.0, f64::max);
    vec![
        said(shown, "impacts in each cycle", "1", [2.0, each], each == 2.0),
        said(shown, "spread of the voltage peaks, largest / smallest - 1", "1", [0.0, spread], spread < EQUAL),
        own(shown, "relative speed of the impacts", "m/s", speed)
            .reason(format!("4 f_0 z_m(0) of Section 4.2 is {:.7} m/s", -ball_velocity)),
        own(shown, "U_DE4, Eq. (12)", "V", setup.bias_voltage + high),
    ]
}

/// Smallest and largest peak of the steady impacts.
fn peak_voltages(shown: &Shown, setup: &Setup, steady: &[Impact]) -> [Finding; 2] {
    let [low, high] = extremes(steady).map(|gain| setup.bias_voltage + gain);
    [("smallest U_DE4", low), ("largest U_DE4", high)]
        .map(|(quantity, voltage)| own(shown, quantity, "V", voltage).reason("50 to 100 s"))
}

fn impacts_in_a_cycle(setup: &Setup, steady: &[Impact]) -> f64 {
    steady.len() as f64 / ((WINDOW[1] - WINDOW[0]) * setup.frequency)
}

/// Figure 11.
fn short_flights(shown: &Shown, setup: &Setup, recording: &Recording, steady: &[Impact]) -> Found {
    // An amplitude of s/2.
    let limit = setup.amplitude * (setup.travel / 2.0) / setup.swing();
    let quantity = "A above which the saw-tooth is destroyed, M (2 pi f_0)^2 s/2";
    let mut findings = vec![said(shown, quantity, "N", [0.4325, limit], (limit - 0.4325).abs() < 5e-5)];
    findings.extend(peak_voltages(shown, setup, steady));
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
    let mut free = Study::case(shown.case)?;
    free.push(Setting::new("initial.outsideGap", "free"));
    let free = impacts(study, &free, shown.window)?;
    let hits = Pattern::DoubleHit.count(&free, setup.travel);
    let [cylinder, _, ball, _] = setup.start;
    let (start, half) = (1e3 * (cylinder - ball).abs(), 500.0 * setup.travel);
    let mut findings = vec![
        own(shown, "abs(z_M(0) - z_m(0)) as given", "mm", start)
            .reason(format!("beyond s/2 = {half:.3} mm: the paper starts outside the gap")),
    ];
    findings.extend(counts(shown, setup, recording));
    findings.push(
        own(shown, "double hits if the ball starts free", "1", hits as f64)
            .reason("initial.outsideGap = free, 0 to 5 s"),
    );
    let projected = Pattern::DoubleHit.count(&recording.impacts, setup.travel);
    let text = format!(
        "The start lies outside the gap; the paper does not say what happens there. Put on the membrane \
         (initial.outsideGap = project, shown here) the ball hits one membrane twice in a row {projected} times in the \
         first 5 s, as the paper describes it; let free (free) it does so {hits} times."
    );
    Ok((findings, vec![text]))
}

/// How often the paper's patterns occur in what is shown.
fn counts(shown: &Shown, setup: &Setup, recording: &Recording) -> [Finding; 2] {
    let [from, to] = shown.window;
    [("short flights", Pattern::ShortFlight), ("double hits", Pattern::DoubleHit)].map(|(quantity, pattern)| {
        let circled = if shown.circled == Some(pattern) { ", circled in the paper" } else { "" };
        let of = recording.impacts.len();
        own(shown, quantity, "1", pattern.count(&recording.impacts, setup.travel) as f64)
            .reason(format!("{}, of {of} impacts from {from} to {to} s{circled}", pattern.words()))
    })
}

/// Figures 14 and 15: "a high peak is followed by a moderate peak and then a very small one".
fn damped(shown: &Shown, setup: &Setup, steady: &[Impact], period: &Period) -> Found {
    let left = steady.iter().filter(|impact| impact.left).count() as f64 / steady.len() as f64;
    let row = mean_falling_row(steady);
    let (verdict, reason) = if (row - 3.0).abs() < 0.05 {
        (Verdict::Agrees, "high, moderate, small")
    } else {
        let verdict = if row > 2.0 && row < 3.0 { Verdict::Explained } else { Verdict::Differs };
        (verdict, "the paper takes three peaks as typical of r < 1; here some rows have two")
    };
    let mut findings = vec![
        own(shown, "mean length of a row of falling peaks", "1", row).printed(3.0).judged(verdict).reason(reason),
        own(shown, "impacts in each cycle", "1", impacts_in_a_cycle(setup, steady)),
    ];
    findings.extend(peak_voltages(shown, setup, steady));
    findings.push(
        own(shown, "share of impacts on the left membrane", "1", left)
            .reason("1/2 would be symmetric; the paper sees an asymmetry"),
    );
    let ([from, to], difference) = (LATE, 1e3 * period.difference);
    if period.difference < REPEATS * setup.travel {
        let most = if difference == 0.0 { "0".to_owned() } else { format!("{difference:.0e}") };
        findings.push(
            own(shown, "cycles after which the motion repeats", "1", f64::from(period.cycles))
                .reason(format!("z_M - z_m differs by at most {most} mm, {from} to {to} s")),
        );
        return (findings, Vec::new());
    }
    let quantity = format!("least difference of z_M - z_m after 1 to {MOST_CYCLES} cycles");
    findings.push(
        own(shown, &quantity, "mm", difference)
            .reason(format!("{from} to {to} s: the motion does not repeat, however long the run")),
    );
    let text = "Though it is damped, this motion is not periodic: it stays within narrow bands but does not return to \
                where it was, and nearby starts move away from it (see Table 2).";
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
    /// Largest difference of `z_M - z_m` after this number of cycles, m.
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
