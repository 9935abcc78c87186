//! Figure 10 and the stability of its orbit: multipliers, growth of small perturbations, and the paper's stepping.

use videg_model::{Case, FixedStep};

use super::excitation::set;
use super::motion;
use super::orbit::{Phase, SawTooth};
use super::statistics::slope;
use super::{Artefact, Finding, PaperError, Picture, Run, Sheet, Study};
use crate::dynamics::orbits::Multipliers;
use crate::scenario::Setting;
use videg_report::{Figure, Panel, Series, Style};

const CASE: &str = "fig10";

/// How long perturbations are followed, s: the length of the paper's runs.
const UNTIL: f64 = 100.0;

/// Nudges of the ball's velocity at the start, m/s.
const NUDGES: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// A frequency, Hz, whose period doubles cannot hold exactly.
const INEXACT: f64 = 2.1;

/// Distance from the orbit, in units of s/2 and its speed, beyond which it has been left.
const LEFT: f64 = 1e-2;

/// Distances from an orbit, once a period.
struct Track {
    label: String,
    /// Time, s, and distance in units of s/2 and V.
    points: Vec<(f64, f64)>,
}

impl Track {
    /// When the orbit is left, s.
    fn leaves(&self) -> Option<f64> {
        self.points.iter().find(|(_, distance)| *distance > LEFT).map(|(time, _)| *time)
    }

    /// Rate at which the distance grows, 1/s, by least squares, from ten times the first distance until the orbit is
    /// left.
    fn growth(&self) -> f64 {
        let first = self.points.first().map_or(f64::NAN, |point| point.1);
        let end = self.leaves().unwrap_or(UNTIL);
        let straight = self.points.iter().filter(|(time, distance)| *distance > 10.0 * first && *time < end);
        let logs: Vec<_> = straight.map(|(time, distance)| (*time, distance.ln())).collect();
        slope(&logs).0
    }
}

/// All results for the orbit.
struct Stability {
    orbit: SawTooth,
    closed_form: Multipliers,
    by_differences: Multipliers,
    opposite: SawTooth,
    opposite_by_differences: Multipliers,
    /// `<U>` of the orbit of the opposite phase, V/s.
    opposite_gain: f64,
    /// One for each of [`NUDGES`].
    nudged: Vec<Track>,
    exact: Track,
    inexact: Track,
    stepped: Option<Track>,
    /// `<U>` of that run, V/s.
    stepped_gain: Option<f64>,
    opposite_nudged: Track,
}

/// Makes Figure 10.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let mut artefact = motion::make(study, &motion::FIG10)?;
    let stability = Stability::of(study)?;
    artefact.findings.extend(stability.findings());
    artefact.text.extend(stability.text());
    artefact.pictures.push(stability.picture()?);
    artefact.sheets.push(stability.sheet());
    Ok(artefact)
}

impl Stability {
    fn of(study: &Study<'_>) -> Result<Self, PaperError> {
        let settings = Study::case(CASE)?;
        let orbit = SawTooth::of(study, &settings, Phase::Paper)?;
        let opposite = SawTooth { phase: Phase::Opposite, ..orbit };
        let nudged =
            study.each(&NUDGES, |nudge| track(study, &settings, &orbit, *nudge, format!("nudged by {nudge:e} m/s")))?;
        let at_other_frequency = SawTooth { frequency: INEXACT, ..orbit };
        let window = [50.0, UNTIL];
        let run = Run { settings: [settings.as_slice(), &opposite.at_impact()].concat(), window };
        let gain = study.averages(&[run])?.first().map_or(f64::NAN, |averages| averages.voltage_gain);
        Ok(Self {
            orbit,
            closed_form: orbit.closed_form(),
            by_differences: orbit.by_differences(study, &settings)?,
            opposite,
            opposite_by_differences: opposite.by_differences(study, &settings)?,
            opposite_gain: gain,
            nudged,
            exact: track(study, &settings, &orbit, 0.0, "not nudged".to_owned())?,
            inexact: track(study, &settings, &at_other_frequency, 0.0, format!("not nudged, f_0 = {INEXACT} Hz"))?,
            stepped: stepped(&orbit),
            stepped_gain: stepped_gain(window),
            opposite_nudged: track(
                study,
                &settings,
                &opposite,
                NUDGES[2],
                format!("opposite phase, nudged by {:e} m/s", NUDGES[2]),
            )?,
        })
    }

    fn findings(&self) -> Vec<Finding> {
        let finding = |quantity: &str, unit: &str, videg: f64, reason: String| {
            Finding::new("Figure 10", quantity, unit, videg).reason(reason)
        };
        let closed = self.closed_form.largest();
        let opposite = match self.opposite_by_differences.0.first() {
            Some(one) if one.im != 0.0 => {
                format!("a pair at an angle of +-{:.3} rad: neutrally stable", one.arg().abs())
            }
            _ => "real".to_owned(),
        };
        let multiplier = self.by_differences.largest();
        let unstable = format!("above 1: the orbit is unstable; closed form {closed:.6}, the other is its inverse");
        let growth = format!("ln(multiplier) / T is {:.4} 1/s", self.rate());
        let modulus = self.opposite_by_differences.largest();
        let mut findings = vec![
            finding("largest multiplier of the orbit over a period", "1", multiplier, unstable),
            finding("growth of a nudge of 1e-12 m/s", "1/s", self.nudged[0].growth(), growth),
            finding("modulus of the multipliers with the force of opposite sign", "1", modulus, opposite),
            finding("<U> with the force of opposite sign", "V/s", self.opposite_gain, "50 to 100 s".to_owned()),
        ];
        // How long the orbit lasts where nothing is nudged.
        let time = |quantity: &str, track: &Track, reason: String| {
            finding(&format!("time on the orbit {quantity}"), "s", track.leaves().unwrap_or(UNTIL), reason)
        };
        let exact = format!("of {UNTIL} s: impacts fall on multiples of T/2 = 1/4 s, which doubles represent exactly");
        let rounding = "rounding alone: T/2 is no double".to_owned();
        findings.extend([
            time("from the exact start", &self.exact, exact),
            time("from the exact start at f_0 = 2.1 Hz", &self.inexact, rounding),
        ]);
        let method = "Runge-Kutta of fourth order at 1e-5 s, Eq. (11) at the end of a step".to_owned();
        findings.extend(self.stepped.as_ref().map(|track| time("by the paper's stepping", track, method)));
        let quantity = "<U> by the paper's stepping from the exact start";
        let off = "50 to 100 s, off the orbit; the paper prints 1831".to_owned();
        findings.extend(self.stepped_gain.map(|gain| finding(quantity, "V/s", gain, off)));
        findings
    }

    /// Growth by the closed form, 1/s.
    fn rate(&self) -> f64 {
        self.closed_form.largest().ln() / self.orbit.period()
    }

    fn text(&self) -> Vec<String> {
        let mut text = vec![
            format!(
                "The orbit is a saddle: to first order an impact that is late by dt changes the ball's speed by -2 \
                 (A/M) dt, and half a period takes (delay, speed) through a matrix of determinant 1 and trace 2 + A/(M \
                 f_0 V), V = {:.5} m/s. A small distance grows {:.3} times in each period, tenfold in {:.2} s. At f_0 \
                 = 2.1 Hz rounding alone takes the run of the FMU off the orbit in {:.1} s; at 2 Hz it makes no error, \
                 since all impact times are doubles, and keeps the orbit.",
                self.orbit.speed(),
                self.closed_form.largest(),
                10.0_f64.ln() / self.rate(),
                self.inexact.leaves().unwrap_or(UNTIL),
            ),
            format!(
                "With the force of opposite sign (excitation.phase = pi) the same motion, started at z_M(0) = +A/(M (2 \
                 pi f_0)^2) with V = {:.5} m/s, is neutrally stable: its multipliers lie on the unit circle, a nudge \
                 stays about as small as it is, and the gain is {:.1} V/s.",
                self.opposite.speed(),
                self.opposite_gain,
            ),
        ];
        let stepped = self.stepped.as_ref().and_then(Track::leaves);
        text.extend(stepped.map(|time| {
            format!(
                "The paper's own stepping keeps the orbit as long as each impact falls on its own step, and leaves it \
                 ({time:.1} s here) once rounding has one fall on the next, 1e-5 s late. When that happens depends on \
                 nothing but how a program rounds. The value that the paper prints is that of the orbit to 0.03 %; how \
                 stepping would come to it is open."
            )
        }));
        text
    }

    fn tracks(&self) -> Vec<&Track> {
        let mut tracks: Vec<_> = self.nudged.iter().collect();
        tracks.push(&self.inexact);
        tracks.extend(&self.stepped);
        tracks.push(&self.opposite_nudged);
        tracks
    }

    fn picture(&self) -> Result<Picture, PaperError> {
        let start = self.nudged[0].points.first().map_or(f64::NAN, |point| point.1);
        let end = (1.0 / start).ln() / self.rate();
        let slope = [(0.0, start), (end, 1.0)];
        let mut panel = Panel::new("", "time (s)", "distance from the orbit (units of s/2 and of the ball's speed)")
            .log_y()
            .x_range(0.0, 50.0)
            .y_range(1e-17, 10.0)
            .height(320.0)
            .series(Series::points("multiplier, closed form", &slope).style(Style::Dashed).color(6));
        for (color, track) in self.tracks().into_iter().enumerate() {
            panel = panel.series(Series::points(track.label.as_str(), &track.points).color(color));
        }
        let caption = format!(
            "Distance from the orbit of Figure 10 once a period, in units of s/2 and of the ball's speed, after a \
             nudge of the ball's velocity at the start; the run that is not nudged stays at a distance of {:.0e} at \
             most for {UNTIL} s.",
            self.exact.points.iter().map(|point| point.1).fold(0.0, f64::max)
        );
        let figure =
            Figure::new("How long the saw-tooth orbit lasts").width(960.0).panel(panel).caption(caption.clone());
        Picture::new("fig10-stability", &figure, caption)
    }

    fn sheet(&self) -> Sheet {
        let mut tracks = self.tracks();
        tracks.insert(0, &self.exact);
        let columns = tracks
            .iter()
            .flat_map(|track| [format!("time (s), {0}", track.label), format!("distance (1), {0}", track.label)]);
        let longest = tracks.iter().map(|track| track.points.len()).max().unwrap_or(0);
        let row = |index: usize| {
            let cells = |track: &&Track| track.points.get(index).map_or([f64::NAN; 2], |point| [point.0, point.1]);
            tracks.iter().flat_map(cells).collect()
        };
        Sheet::new("fig10-stability", columns, (0..longest).map(row))
    }
}

/// A run of the FMU from the orbit's start with the ball's velocity nudged, m/s.
fn track(
    study: &Study<'_>,
    settings: &[Setting],
    orbit: &SawTooth,
    nudge: f64,
    label: String,
) -> Result<Track, PaperError> {
    let velocity = set("initial.ballVelocity", nudge - orbit.speed());
    let mut instance = study.start(&[settings, &orbit.at_impact(), &[velocity]].concat())?;
    let mut points = Vec::new();
    let mut now = 0.0;
    for time in middles(orbit) {
        instance.do_step(now, time - now)?;
        now += time - now;
        points.push((time, orbit.distance(study.relative_motion(&instance)?)));
    }
    instance.terminate()?;
    Ok(Track { label, points })
}

/// Times, s, at which the ball passes the middle of the cylinder from the right membrane on.
fn middles(orbit: &SawTooth) -> impl Iterator<Item = f64> + use<> {
    let period = orbit.period();
    (0..).map(move |cycle| (f64::from(cycle) + 0.25) * period).take_while(|time| *time < UNTIL)
}

/// `<U>`, V/s, by the paper's method from the paper's start.
fn stepped_gain(window: [f64; 2]) -> Option<f64> {
    let parameters = (Case::find(CASE)?.parameters)();
    FixedStep::new(&parameters, &[parameters.ball_velocity], FixedStep::PAPER)
        .run(window)
        .pop()
        .map(|run| run.voltage_gain)
}

/// The paper's method from the paper's start.
fn stepped(orbit: &SawTooth) -> Option<Track> {
    let parameters = (Case::find(CASE)?.parameters)();
    let mut run = FixedStep::new(&parameters, &[parameters.ball_velocity], FixedStep::PAPER);
    let points = middles(orbit).filter_map(|time| {
        run.advance(time);
        run.first().map(|state| (time, orbit.distance(state)))
    });
    Some(Track { label: "paper's stepping, not nudged".to_owned(), points: points.collect() })
}
