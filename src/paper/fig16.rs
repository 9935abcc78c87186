//! Figure 16: `<U>` over amplitude and frequency of the harmonic excitation.

use super::excitation::{Cylinder, nudge};
use super::statistics::{Summary, rank_correlation};
use super::{Artefact, Finding, PaperError, Picture, Run, Sheet, Study, Verdict, WINDOW};
use videg_report::{Figure, Panel, Series, Style};

/// Nearby starts that are averaged.
fn starts(study: &Study<'_>) -> usize {
    study.effort.of(20, 5)
}

/// One half of the figure.
struct Half {
    /// `a` or `b`.
    letter: char,
    /// Quantity of the x axis, with its unit.
    axis: &'static str,
    /// Its values.
    xs: Vec<f64>,
    /// Parameter of the curves: symbol, values, unit.
    parameter: (&'static str, Vec<f64>, &'static str),
    /// gamma and `f_0`, Hz, from x and that.
    at: fn(f64, f64) -> (f64, f64),
}

/// A curve.
struct Curve {
    label: String,
    points: Vec<(f64, Summary)>,
}

/// Makes the figure.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let mut artefact = Artefact { text: text(starts(study)), ..Artefact::default() };
    let mut panels = Vec::new();
    for half in halves() {
        let curves = half.curves(study, &cylinder)?;
        artefact.findings.extend(curves.iter().map(|curve| finding(&half, curve)));
        artefact.sheets.push(half.sheet(&curves));
        panels.push((half, curves));
    }
    artefact.pictures.push(picture(&panels)?);
    Ok(artefact)
}

fn halves() -> [Half; 2] {
    [
        Half {
            letter: 'a',
            axis: "gamma (1)",
            xs: (2..=20).map(|k| 0.5 * f64::from(k)).collect(),
            parameter: ("f0", vec![1.0, 2.0, 3.0, 4.0, 5.0], " Hz"),
            at: |x, parameter| (x, parameter),
        },
        Half {
            letter: 'b',
            axis: "f0 (Hz)",
            xs: (4..=20).map(|k| 0.25 * f64::from(k)).collect(),
            parameter: ("gamma", vec![1.0, 2.0, 4.0, 7.0, 10.0], ""),
            at: |x, parameter| (parameter, x),
        },
    ]
}

impl Half {
    fn curves(&self, study: &Study<'_>, cylinder: &Cylinder) -> Result<Vec<Curve>, PaperError> {
        let starts = starts(study);
        let (symbol, parameters, unit) = &self.parameter;
        let points = parameters.iter().flat_map(|&parameter| self.xs.iter().map(move |&x| (self.at)(x, parameter)));
        let runs: Vec<Run> = points
            .flat_map(|(gamma, frequency)| {
                (0..starts).map(move |k| cylinder.elastic(gamma, frequency, nudge(k, starts)))
            })
            .map(|settings| Run { settings, window: WINDOW })
            .collect();
        let gains: Vec<f64> = study.averages(&runs)?.iter().map(|average| average.voltage_gain).collect();
        let mut summaries = gains.chunks(starts).map(Summary::new);
        let curve = |parameter: &f64| Curve {
            label: format!("{symbol} = {parameter}{unit}"),
            points: self.xs.iter().copied().zip(summaries.by_ref()).collect(),
        };
        Ok(parameters.iter().map(curve).collect())
    }

    fn sheet(&self, curves: &[Curve]) -> Sheet {
        let of_curve = |curve: &Curve| {
            ["mean <U>", "95 % from", "95 % to", "median"].map(|what| format!("{what} at {} (V/s)", curve.label))
        };
        let columns = std::iter::once(self.axis.to_owned()).chain(curves.iter().flat_map(of_curve));
        let row = |(k, x): (usize, &f64)| {
            let values = curves.iter().filter_map(|curve| curve.points.get(k)).flat_map(|(_, summary)| {
                let Summary { mean, interval: [low, high], median, .. } = *summary;
                [mean, low, high, median]
            });
            std::iter::once(*x).chain(values).collect()
        };
        Sheet::new(format!("fig16{}", self.letter), columns, self.xs.iter().enumerate().map(row))
    }
}

/// Means of a curve and their intervals, kV/s.
type Drawn = (Vec<(f64, f64)>, Vec<(f64, f64, f64)>);

fn drawn(curve: &Curve) -> Drawn {
    let interval = |(x, summary): &(f64, Summary)| (*x, 1e-3 * summary.interval[0], 1e-3 * summary.interval[1]);
    let means = curve.points.iter().map(|(x, summary)| (*x, 1e-3 * summary.mean));
    (means.collect(), curve.points.iter().map(interval).collect())
}

fn picture(halves: &[(Half, Vec<Curve>)]) -> Result<Picture, PaperError> {
    let drawn: Vec<Vec<Drawn>> = halves.iter().map(|(_, curves)| curves.iter().map(drawn).collect()).collect();
    let mut figure = Figure::new("Figure 16: output over amplitude and frequency, r = 1")
        .caption("Average voltage gain over normalised amplitude and over frequency of the harmonic excitation.")
        .columns(2)
        .width(960.0);
    for ((half, curves), drawn) in halves.iter().zip(&drawn) {
        let mut panel = Panel::new(format!("({})", half.letter), half.axis, "<U> (kV/s)").height(300.0);
        for (color, (curve, (means, intervals))) in curves.iter().zip(drawn).enumerate() {
            panel = panel
                .series(Series::points(&curve.label, means).color(color))
                .series(Series::points("", means).style(Style::Crosses).color(color))
                .bars(intervals, color);
        }
        figure = figure.panel(panel);
    }
    let caption = "Voltage gain <U> of Eq. (15) over 50 to 100 s, r = 1, zero start: (a) over gamma of Eq. (16), (b) \
                   over f0. Crosses are means over nearby starts, bars their 95 % confidence intervals.";
    Picture::new("fig16", &figure, caption)
}

/// A correlation from which on a curve rises, but for the scatter of a chaotic motion.
const RISING: f64 = 0.9;

fn finding(half: &Half, curve: &Curve) -> Finding {
    let means: Vec<_> = curve.points.iter().map(|(x, summary)| (*x, summary.mean)).collect();
    let correlation = rank_correlation(&means);
    let falls = falls(&curve.points);
    let reason = if falls == 0 {
        "rises as the paper says; it prints no number".to_owned()
    } else {
        format!("falls between {falls} of {} neighbouring points by more than both intervals", means.len() - 1)
    };
    let verdict = match (correlation >= RISING, falls) {
        (true, 0) => Verdict::Agrees,
        (true, _) => Verdict::Explained,
        (false, _) => Verdict::Differs,
    };
    let axis = half.axis.split(' ').next().unwrap_or_default();
    let quantity = format!("rank correlation of <U> with {axis}");
    Finding::new(format!("Figure 16({}), {}", half.letter, curve.label), quantity, "1", correlation)
        .judged(verdict)
        .reason(reason)
}

/// Number of neighbouring points at which the mean falls and the intervals do not overlap.
fn falls(points: &[(f64, Summary)]) -> usize {
    points.windows(2).filter(|pair| pair[1].1.interval[1] < pair[0].1.interval[0]).count()
}

fn text(starts: usize) -> Vec<String> {
    vec![
        "The paper's text names neither the frequencies and amplitudes of its curves nor the ends of its axes: gamma \
         from 1 to 10 (below 0.5 a membrane never reaches the ball, which starts in the middle) and f0 from 1 to 5 Hz \
         are chosen here."
            .to_owned(),
        format!(
            "With r = 1 the motion is chaotic, and one run is one draw. Each point is the mean over {starts} runs \
             whose balls start at velocities within 1e-6 m/s about zero, with the 95 % bootstrap interval of that \
             mean. Rising is judged by Spearman's rank correlation of the means."
        ),
    ]
}
