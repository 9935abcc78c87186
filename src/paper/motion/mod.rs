//! Figures 9 to 15: displacements, velocities, relative displacement and voltage against time.

mod findings;

use super::patterns::Pattern;
use super::recording::{
    BALL, BALL_VELOCITY, CYLINDER, CYLINDER_VELOCITY, DISPLACEMENT, Impact, OUTPUTS, Recording, Sample, record,
};
use super::{Artefact, PaperError, Picture, Sheet, Study};
use videg_report::{Figure, Panel, Series, Style};

/// Distance of samples between corners, s.
const STEP: f64 = 2e-3;

/// A figure of the paper.
pub(super) struct Shown {
    /// Its case.
    pub(super) case: &'static str,
    /// Its number.
    pub(super) number: u32,
    /// Window, s.
    pub(super) window: [f64; 2],
    /// The pattern that the paper circles in it.
    pub(super) circled: Option<Pattern>,
}

/// With r = 1 nothing is damped: a run is as typical at its beginning as later on, and only the beginning of a chaotic
/// one is the same with every method. With r < 1 the steady state is what matters.
const BEGINNING: [f64; 2] = [0.0, 5.0];
const STEADY: [f64; 2] = [50.0, 54.0];

pub(super) const FIG9: Shown = Shown { case: "fig9", number: 9, window: BEGINNING, circled: None };
pub(super) const FIG10: Shown = Shown { case: "fig10", number: 10, window: BEGINNING, circled: None };
pub(super) const FIG11: Shown =
    Shown { case: "fig11", number: 11, window: BEGINNING, circled: Some(Pattern::ShortFlight) };
pub(super) const FIG12: Shown =
    Shown { case: "fig12", number: 12, window: BEGINNING, circled: Some(Pattern::DoubleHit) };
pub(super) const FIG13: Shown = Shown { case: "fig13", number: 13, window: BEGINNING, circled: None };
pub(super) const FIG14: Shown = Shown { case: "fig14", number: 14, window: STEADY, circled: None };
pub(super) const FIG15: Shown = Shown { case: "fig15", number: 15, window: STEADY, circled: None };

/// Parameters that a figure depends on, SI units.
struct Setup {
    /// M, kg.
    mass: f64,
    /// s, m.
    travel: f64,
    /// A, N.
    amplitude: f64,
    /// `f_0`, Hz.
    frequency: f64,
    /// `U_in`, V.
    bias_voltage: f64,
    /// `z_M(0)`, `z_M'(0)`, `z_m(0)`, `z_m'(0)`, as given.
    start: [f64; 4],
    caption: String,
}

impl Setup {
    fn of(study: &Study<'_>, case: &str) -> Result<Self, PaperError> {
        let instance = study.start(&Study::case(case)?)?;
        let lengths = ["membrane.initialRadius", "membrane.initialThickness", "membrane.radius"];
        let start =
            ["initial.cylinderPosition", "initial.cylinderVelocity", "initial.ballPosition", "initial.ballVelocity"];
        let [amplitude, frequency, restitution, bias_voltage, travel] = study.reals(
            &instance,
            ["excitation.amplitude", "excitation.frequency", "membrane.restitution", "biasVoltage", "ball.travel"],
        )?;
        let [mass, ball, length, width, radius] =
            study.reals(&instance, ["cylinder.mass", "ball.mass", "cylinder.length", "frame.width", "ball.radius"])?;
        let [r1, h1, r2] = study.reals(&instance, lengths)?;
        let start = study.reals(&instance, start)?;
        let [z_cylinder, v_cylinder, z_ball, v_ball] = start;
        // Without the last digits, which a change of units upsets.
        let milli = |value: f64| (1e3 * value * 1e9).round() / 1e9;
        let caption = format!(
            "A = {amplitude} N, f_0 = {frequency} Hz, r = {restitution}; M = {} g, m = {} g, d = {} mm, w = {} mm, r_b \
             = {} mm, R_1 = {} mm, R_2 = {} mm, h_1 = {} mm, U_in = U_z = {bias_voltage} V; z_M(0) = {:.4} mm, z_M'(0) \
             = {v_cylinder} m/s, z_m(0) = {:.4} mm, z_m'(0) = {v_ball:.5} m/s.",
            milli(mass),
            milli(ball),
            milli(length),
            milli(width),
            milli(radius),
            milli(r1),
            milli(r2),
            milli(h1),
            1e3 * z_cylinder,
            1e3 * z_ball,
        );
        Ok(Self { mass, travel, amplitude, frequency, bias_voltage, start, caption })
    }

    /// A / (M (2 pi `f_0`)^2), m: amplitude of the cylinder.
    fn swing(&self) -> f64 {
        let omega = std::f64::consts::TAU * self.frequency;
        self.amplitude / (self.mass * omega * omega)
    }
}

/// Makes a figure.
pub(super) fn make(study: &Study<'_>, shown: &Shown) -> Result<Artefact, PaperError> {
    let setup = Setup::of(study, shown.case)?;
    let recording = record(study, &Study::case(shown.case)?, shown.window, STEP)?;
    let (findings, text) = findings::findings(study, shown, &setup, &recording)?;
    let picture = picture(shown, &setup, &recording)?;
    let sheets = vec![samples(shown, &setup, &recording), impacts(shown, &setup, &recording)];
    Ok(Artefact { findings, text, pictures: vec![picture], sheets, ..Artefact::default() })
}

type Points = Vec<(f64, f64)>;

fn points(recording: &Recording, output: usize) -> Points {
    let factor = OUTPUTS[output].2;
    recording.samples.iter().map(|sample| (sample.time, factor * sample.values[output])).collect()
}

/// Voltage of one membrane, kV: `U_in`, and a peak to `U_DE4` at each of its impacts.
fn peaks(setup: &Setup, recording: &Recording, left: bool, [from, to]: [f64; 2]) -> Points {
    let rest = 1e-3 * setup.bias_voltage;
    let impacts = recording.impacts.iter().filter(|impact| impact.left == left);
    let peaks = impacts.flat_map(|impact| {
        let (time, peak) = (impact.time, rest + 1e-3 * impact.gain);
        [(time, rest), (time, peak), (time, rest)]
    });
    [(from, rest)].into_iter().chain(peaks).chain([(to, rest)]).collect()
}

/// The curves of the six panels, and what is circled in two of them.
struct Curves {
    /// In the order of the first five [`OUTPUTS`], (a) to (e).
    motion: [Points; 5],
    /// Left and right membrane, (f).
    voltages: [Points; 2],
    /// In (c) and (e).
    circled: [Points; 2],
    half_travel: f64,
}

impl Curves {
    fn new(shown: &Shown, setup: &Setup, recording: &Recording) -> Self {
        let outputs = [CYLINDER, CYLINDER_VELOCITY, BALL, BALL_VELOCITY, DISPLACEMENT];
        let circled = shown.circled.map_or_else(Vec::new, |rule| rule.members(&recording.impacts, setup.travel));
        let at = |place: fn(&Impact) -> f64| circled.iter().map(|impact| (impact.time, 1e3 * place(impact))).collect();
        Self {
            motion: outputs.map(|output| points(recording, output)),
            voltages: [true, false].map(|left| peaks(setup, recording, left, shown.window)),
            circled: [at(|impact| impact.ball), at(|impact| impact.displacement)],
            half_travel: 500.0 * setup.travel,
        }
    }

    fn panels(&self, [from, to]: [f64; 2]) -> [Panel<'_>; 6] {
        let [cylinder, cylinder_velocity, ball, ball_velocity, displacement] = &self.motion;
        let curve = |points| Series::points("", points).color(0);
        let panel = |title: &str, y: &str| Panel::new(title, "", y).x_range(from, to).share_x_with_next();
        let last = |title: &str, y: &str| Panel::new(title, "time (s)", y).x_range(from, to);
        let [mut positions, mut relative] = [
            panel("(c)", "z_m (mm)").series(curve(ball)),
            last("(e)", "z_M - z_m (mm)")
                .series(curve(displacement))
                .line("membranes, +-s/2", self.half_travel)
                .line("", -self.half_travel),
        ];
        let [in_positions, in_relative] = &self.circled;
        if !in_positions.is_empty() {
            let marked = |label: &str, points| Series::points(label, points).style(Style::Markers).color(1);
            positions = positions.series(marked("of the kind circled in the paper", in_positions));
            relative = relative.series(marked("", in_relative));
        }
        [
            panel("(a)", "z_M (mm)").series(curve(cylinder)),
            panel("(b)", "z_M' (m/s)").series(curve(cylinder_velocity)),
            positions,
            panel("(d)", "z_m' (m/s)").series(curve(ball_velocity)),
            relative,
            last("(f)", "voltage (kV)")
                .series(Series::points("left membrane", &self.voltages[0]).color(0))
                .series(Series::points("right membrane", &self.voltages[1]).color(1)),
        ]
    }
}

fn picture(shown: &Shown, setup: &Setup, recording: &Recording) -> Result<Picture, PaperError> {
    let curves = Curves::new(shown, setup, recording);
    let caption = caption(shown, setup);
    let figure = Figure::new(format!("Figure {}", shown.number)).columns(2).width(960.0).caption(caption.clone());
    let figure = curves.panels(shown.window).into_iter().fold(figure, Figure::panel);
    Picture::new(shown.case, &figure, caption)
}

fn caption(shown: &Shown, setup: &Setup) -> String {
    let [from, to] = shown.window;
    let circled = shown.circled.map(|rule| format!(" Dots in (c) and (e): {}.", rule.words())).unwrap_or_default();
    format!(
        "Displacement and velocity of the cylinder (a, b) and of the ball (c, d), relative displacement (e) and \
         voltage (f). {} Shown are {from} to {to} s, every {} ms and at both sides of each corner. The voltage is U_in \
         with a peak to U_DE4 = U_in + the jump of gain.voltage at each impact, Eq. (12), as the paper draws it: how \
         it falls is not shown.{circled}",
        setup.caption,
        1e3 * STEP,
    )
}

fn samples(shown: &Shown, setup: &Setup, recording: &Recording) -> Sheet {
    let headings = OUTPUTS.iter().map(|(_, heading, _)| (*heading).to_owned());
    let voltages = ["left", "right"].map(|side| format!("voltage of the {side} membrane (kV)"));
    let voltage = |sample: &Sample, left: bool| {
        let here = |impact: &&Impact| impact.time == sample.time && impact.left == left;
        // Impacts lie in the order of time.
        let first = recording.impacts.partition_point(|impact| impact.time < sample.time);
        let gain = recording.impacts[first..].first().filter(here).map_or(0.0, |impact| impact.gain);
        1e-3 * (setup.bias_voltage + gain)
    };
    let row = |sample: &Sample| {
        let values = OUTPUTS.iter().zip(sample.values).map(|((.., factor), value)| factor * value);
        let voltages = [true, false].map(|left| voltage(sample, left));
        std::iter::once(sample.time).chain(values).chain(voltages).collect()
    };
    let columns = std::iter::once("time (s)".to_owned()).chain(headings).chain(voltages);
    Sheet::new(shown.case, columns, recording.samples.iter().map(row))
}

fn impacts(shown: &Shown, setup: &Setup, recording: &Recording) -> Sheet {
    let columns = ["time (s)", "membrane (1 left, 2 right)", "relative speed (m/s)", "U_DE4 (V)", "z_m (mm)"];
    let row = |i: &Impact| {
        let side = if i.left { 1.0 } else { 2.0 };
        vec![i.time, side, i.speed, setup.bias_voltage + i.gain, 1e3 * i.ball]
    };
    Sheet::new(format!("{}-impacts", shown.case), columns, recording.impacts.iter().map(row))
}
