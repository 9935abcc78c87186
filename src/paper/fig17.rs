//! Figure 17: `<U>` under phase noise.

use super::excitation::{Cylinder, nudge, set};
use super::statistics::{Summary, TWO_SIDED, mean, slope};
use super::{Artefact, Effort, Finding, PaperError, Picture, Run, Sheet, Study, Verdict, WINDOW};
use crate::cosim::Averages;
use crate::scenario::Setting;
use videg_report::{Figure, Panel, Series, Style};

/// gamma and `f_0`, Hz, of the figure.
const GAMMA: f64 = 5.0;
const FREQUENCY: f64 = 2.0;
/// D = sigma^2: densely where the output falls, some where it stays, and both values of the paper's smaller plots. A point with noise takes
/// 100 runs of 10 million Gaussian numbers each.
const INTENSITIES: [f64; 11] = [0.0, 0.5, 1.0, 2.0, 4.0, 6.0, 10.0, 20.0, 40.0, 81.0, 100.0];
/// D of the paper's smaller plots, which show a voltage pattern each.
const PATTERNS: [f64; 2] = [1.0, 81.0];
/// Window of the patterns, s. The paper does not give that of its plots.
const SHOWN: [f64; 2] = [50.0, 60.0];

/// All samples of one D.
struct Point {
    intensity: f64,
    samples: Vec<Averages>,
    gain: Summary,
}

impl Point {
    fn new(intensity: f64, samples: &[Averages]) -> Self {
        let gains: Vec<f64> = samples.iter().map(|sample| sample.voltage_gain).collect();
        Self { intensity, samples: samples.to_vec(), gain: Summary::new(&gains) }
    }

    /// Impacts a second.
    fn rate(&self) -> f64 {
        mean(self.samples.iter().map(|sample| f64::from(sample.impacts))) / (WINDOW[1] - WINDOW[0])
    }

    /// `U_DE4` - `U_in` of an impact, V: mean over all impacts of all samples.
    fn gain_per_impact(&self) -> f64 {
        self.gain.mean / self.rate()
    }
}

/// Makes the figure.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let count = study.effort.of(100, 10); // the paper has 100
    let settings = |point| (0..count).map(move |sample| settings(&cylinder, point, sample, count));
    let runs: Vec<Run> =
        (0..INTENSITIES.len()).flat_map(settings).map(|settings| Run { settings, window: WINDOW }).collect();
    let averages = study.averages(&runs)?;
    let points: Vec<Point> =
        INTENSITIES.into_iter().zip(averages.chunks(count)).map(|(d, a)| Point::new(d, a)).collect();
    let mut patterns = Vec::new();
    for intensity in PATTERNS {
        let point = INTENSITIES.iter().position(|&d| d == intensity).unwrap_or_default();
        patterns.push(spikes(study, &self::settings(&cylinder, point, 0, count))?);
    }
    Ok(Artefact {
        findings: findings(&points, study.effort),
        text: text(count),
        tables: Vec::new(),
        pictures: vec![curve(&points)?, voltages(&patterns)?],
        sheets: vec![sheet(&points), samples_sheet(&points)],
    })
}

/// Seed of sample number `sample` of point number `point`: no two are alike.
fn seed(point: usize, sample: usize) -> usize {
    1000 * point + sample + 1
}

/// Settings of sample number `sample` of point number `point`. The starts are nudged as in Figure 16, so that the samples
/// without noise are not one and the same run.
fn settings(cylinder: &Cylinder, point: usize, sample: usize, count: usize) -> Vec<Setting> {
    let mut settings = cylinder.elastic(GAMMA, FREQUENCY, nudge(sample, count));
    settings.push(set("excitation.phaseNoise", INTENSITIES[point].sqrt()));
    let seed = seed(point, sample);
    settings.push(Setting::new("excitation.seed", seed.to_string()));
    settings
}

/// Spikes from `U_in` to `U_DE4`, s and kV, of the left and the right membrane.
type Spikes = [Vec<(f64, f64)>; 2];

/// Voltage peaks of some seconds of a run.
fn spikes(study: &Study<'_>, settings: &[Setting]) -> Result<Spikes, PaperError> {
    /// Communication step, s: impacts within one count as one with their mean voltage.
    const STEP: f64 = 1e-3;
    let mut instance = study.start(settings)?;
    let [from, to] = SHOWN;
    instance.do_step(0.0, from)?;
    let mut spikes = [vec![(from, f64::NAN)], vec![(from, f64::NAN)]];
    let mut before = study.gains(&instance)?;
    let mut index = 0.0;
    let mut time = from;
    while time <= to {
        let gains = study.gains(&instance)?;
        if gains.impacts > before.impacts {
            let [displacement, bias] = study.reals(&instance, ["relativeDisplacement", "biasVoltage"])?;
            let peak = bias + (gains.voltage - before.voltage) / f64::from(gains.impacts - before.impacts);
            // Left is the end that the ball meets when z_M - z_m = +s/2.
            let spikes = &mut spikes[usize::from(displacement < 0.0)];
            spikes.extend([(time, 1e-3 * bias), (time, 1e-3 * peak), (time, f64::NAN)]);
        }
        before = gains;
        instance.do_step(time, STEP)?;
        index += 1.0;
        time = from + index * STEP;
    }
    Ok(spikes)
}

fn curve(points: &[Point]) -> Result<Picture, PaperError> {
    let of =
        |value: fn(&Summary) -> f64| points.iter().map(|p| (p.intensity, 1e-3 * value(&p.gain))).collect::<Vec<_>>();
    let (means, medians) = (of(|gain| gain.mean), of(|gain| gain.median));
    let interval = |p: &Point| (p.intensity, 1e-3 * p.gain.interval[0], 1e-3 * p.gain.interval[1]);
    let intervals: Vec<_> = points.iter().map(interval).collect();
    let panel = Panel::new("", "D = sigma^2 (rad^2)", "<U> (kV/s)")
        .height(300.0)
        .series(Series::points("mean, with its 95 % interval", &means).style(Style::Crosses).color(0))
        .series(Series::points("median", &medians).style(Style::Dashed).color(1))
        .bars(&intervals, 0);
    let figure = Figure::new("Figure 17: output under phase noise")
        .caption("Average voltage gain over the intensity of the phase noise.")
        .panel(panel);
    let count = points.first().map_or(0, |point| point.samples.len());
    let caption = format!(
        "Voltage gain <U> of Eq. (15) over 50 to 100 s against the intensity D of the phase noise: gamma = 5, f0 = 2 \
         Hz, r = 1, zero start, {count} samples a point. Bars: 95 % bootstrap interval of the mean."
    );
    Picture::new("fig17", &figure, caption)
}

fn voltages(patterns: &[Spikes]) -> Result<Picture, PaperError> {
    let mut figure = Figure::new("Figure 17: voltage patterns")
        .caption("Voltage peaks of both membranes at low and at high intensity of the phase noise.");
    // One scale for both: the point is how much weaker the impacts are.
    let peaks = patterns.iter().flatten().flatten().map(|point| point.1);
    let highest = peaks.filter(|peak| peak.is_finite()).fold(2.0, f64::max);
    for (index, (pattern, intensity)) in patterns.iter().zip(PATTERNS).enumerate() {
        let mut panel = Panel::new(format!("D = {intensity}"), "time (s)", "voltage (kV)")
            .height(150.0)
            .x_range(SHOWN[0], SHOWN[1])
            .y_range(1.9, 1.05 * highest)
            .line("", 2.0);
        for (side, spikes) in ["left", "right"].into_iter().zip(pattern) {
            let label = if index == 0 { side } else { "" };
            panel = panel.series(Series::points(label, spikes));
        }
        if index == 0 {
            panel = panel.share_x_with_next();
        }
        figure = figure.panel(panel);
    }
    let caption = "Each line rises from U_in = 2 kV to U_DE4 of an impact, left and right membrane, made from the \
                   steps of the FMU's output gain.voltage. First sample of the point each, 50 to 60 s; the paper does \
                   not say which seconds it shows.";
    Picture::new("fig17-voltage", &figure, caption)
}

/// Few fast balls make the mean: a tenth of the samples cannot refute the paper.
fn judge(finding: Finding, verdict: Verdict, effort: Effort) -> Finding {
    if verdict == Verdict::Agrees || effort == Effort::Full {
        return finding.judged(verdict);
    }
    let reason = format!("{}; too few samples to tell", finding.reason);
    finding.judged(Verdict::Explained).reason(reason)
}

fn findings(points: &[Point], effort: Effort) -> Vec<Finding> {
    let at = |d: f64| points.iter().find(|point| point.intensity == d);
    let finding = |quantity: &str, unit: &str, videg: f64, reason: String| {
        Finding::new("Figure 17", quantity, unit, videg).reason(reason)
    };
    let mut findings = Vec::new();
    if let Some((pure, best)) = at(0.0).zip(points.iter().max_by(|a, b| a.gain.mean.total_cmp(&b.gain.mean))) {
        let reason = format!(
            "the paper: most at D = 0; here the largest mean is {:.0} V/s at D = {}, undecided where their intervals \
             overlap; the median falls from {:.0} to {:.0} V/s",
            best.gain.mean, best.intensity, pure.gain.median, best.gain.median
        );
        let verdict = match best {
            best if best.intensity == 0.0 => Verdict::Agrees,
            best if best.gain.interval[0] > pure.gain.interval[1] => Verdict::Differs,
            _ => Verdict::Explained,
        };
        findings.push(judge(finding("<U> without noise", "V/s", pure.gain.mean, reason), verdict, effort));
    }
    let if_true = |agrees: bool| if agrees { Verdict::Agrees } else { Verdict::Differs };
    for (from, to) in [(0.5, 4.0), (0.0, 10.0)] {
        let Some((weak, strong)) = at(from).zip(at(to)) else { continue };
        let reason = format!(
            "the paper: drops significantly; mean {:.0} to {:.0} V/s, median {:.0} to {:.0} V/s; judged by intervals",
            weak.gain.mean, strong.gain.mean, weak.gain.median, strong.gain.median
        );
        let ratio = strong.gain.mean / weak.gain.mean;
        let drops = strong.gain.interval[1] < weak.gain.interval[0];
        let quantity = format!("<U> at D = {to} over that at D = {from}");
        findings.push(judge(finding(&quantity, "1", ratio, reason), if_true(drops), effort));
    }
    findings.push(plateau(points, effort));
    if let Some((weak, strong)) = at(PATTERNS[0]).zip(at(PATTERNS[1])) {
        let fewer = strong.rate() / weak.rate();
        let reason = format!("the paper: visibly fewer; {:.2} against {:.2} a second", strong.rate(), weak.rate());
        let rates = finding("impacts at D = 81 over those at D = 1", "1", fewer, reason);
        let [low, high] = [strong, weak].map(Point::gain_per_impact);
        let reason = format!("the paper: significantly weaker; {low:.0} against {high:.0} V an impact");
        let gains = finding("gain of an impact at D = 81 over that at D = 1", "1", low / high, reason);
        findings.extend([judge(rates, if_true(fewer < 1.0), effort), judge(gains, if_true(low < high), effort)]);
    }
    findings
}

/// From D = 10 to 100 the paper sees no change: the slope of all samples over D.
fn plateau(points: &[Point], effort: Effort) -> Finding {
    let samples = points.iter().filter(|point| point.intensity >= 10.0);
    let all: Vec<_> =
        samples.flat_map(|point| point.samples.iter().map(|sample| (point.intensity, sample.voltage_gain))).collect();
    let (slope, error) = slope(&all);
    let is_flat = slope.abs() <= TWO_SIDED * error;
    let trend = if is_flat { "no trend beyond 1.96 of them" } else { "a trend beyond that" };
    let finding = Finding::new("Figure 17", "slope of <U> over D, D = 10 to 100", "V/s", slope)
        .reason(format!("the paper: almost the same; standard error of the slope {error:.1}, {trend}"));
    judge(finding, if is_flat { Verdict::Agrees } else { Verdict::Explained }, effort)
}

fn sheet(points: &[Point]) -> Sheet {
    let columns = [
        "D (rad^2)",
        "mean <U> (V/s)",
        "95 % from (V/s)",
        "95 % to (V/s)",
        "standard error (V/s)",
        "median (V/s)",
        "impacts (1/s)",
    ];
    let row = |point: &Point| {
        let Summary { mean, interval: [low, high], standard_error, median } = point.gain;
        vec![point.intensity, mean, low, high, standard_error, median, point.rate()]
    };
    Sheet::new("fig17", columns, points.iter().map(row))
}

fn samples_sheet(points: &[Point]) -> Sheet {
    let rows = points.iter().enumerate().flat_map(|(index, point)| {
        point.samples.iter().enumerate().map(move |(sample, averages)| {
            let seed = seed(index, sample) as f64;
            vec![point.intensity, sample as f64, seed, averages.voltage_gain, f64::from(averages.impacts)]
        })
    });
    Sheet::new("fig17-samples", ["D (rad^2)", "sample (1)", "seed (1)", "<U> (V/s)", "impacts (1)"], rows)
}

fn text(samples: usize) -> Vec<String> {
    vec![
        format!(
            "F = A cos(2 pi f0 t + sigma xi), a fresh Gaussian xi every 10 us (the paper's time step), D = sigma^2. \
             {samples} samples a point; the paper has 100. Sample k of point j (both from 0) runs with excitation.seed \
             = 1000 j + k + 1."
        ),
        "A held sample multiplies the mean force by exp(-D/2): at D = 10 less than 1 % of the harmonic is left, and \
         the rest is noise that no longer depends on D. The cylinder then drifts as in a random walk, and with r = 1 \
         nothing slows the ball: few samples with fast balls make the mean, so the median stands beside it."
            .to_owned(),
    ]
}
