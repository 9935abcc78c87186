//! Table 2: the average voltage gain, and how far nearby starts and the paper's own stepping scatter.

mod output;

use videg_model::{Case, FixedStep};

use super::ensemble::{self, Ensemble, NUDGE, nearby, voltage_gains};
use super::{Artefact, Finding, PaperError, Run, Study, Verdict, WINDOW};
use crate::scenario::Setting;

/// Largest nudge for the paper's method, m/s: what its time step makes of one impact, 2 A/M times 1e-5 s. Smaller ones
/// change no step at which the ball hits a membrane for a long time, so that all starts would be the same.
const STEPPED_NUDGE: f64 = 1e-4;

/// Starts that one core steps at once by the paper's method.
const BATCH: usize = 20;

/// How a case moves, and so how it can be compared.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    /// Nearby starts end in one motion; agreement is a relative difference of at most this.
    Damped(f64),
    /// An orbit that nearby starts leave.
    Unstable,
    /// r = 1: one distribution for all starts.
    Chaotic,
}

/// A column of the table.
struct Printed {
    /// Number of the figure.
    number: u32,
    /// Its case.
    case: &'static str,
    /// `<U>`, V/s.
    gain: f64,
    motion: Motion,
}

const PRINTED: [Printed; 6] = [
    Printed { number: 10, case: "fig10", gain: 1831.0, motion: Motion::Unstable },
    Printed { number: 11, case: "fig11", gain: 6749.0, motion: Motion::Chaotic },
    Printed { number: 12, case: "fig12", gain: 6730.0, motion: Motion::Chaotic },
    Printed { number: 13, case: "fig13", gain: 6989.0, motion: Motion::Chaotic },
    Printed { number: 14, case: "fig14", gain: 8079.0, motion: Motion::Damped(1e-4) },
    Printed { number: 15, case: "fig15", gain: 8652.0, motion: Motion::Damped(2e-3) },
];

/// A column of the table, computed. All values are `<U>`, V/s.
struct Computed {
    printed: &'static Printed,
    /// The start of the paper.
    own: f64,
    /// Nearby starts, in the order of the nudges.
    values: Vec<f64>,
    nearby: Ensemble,
    /// Nearby starts by the paper's method, where one motion does not stand for all.
    stepped: Option<Ensemble>,
}

impl Computed {
    /// A value of `<U>`, V/s, of the case, or of a `variant` of it.
    fn finding(&self, variant: &str, quantity: &str, gain: f64) -> Finding {
        Finding::new(format!("Table 2, Figure {}{variant}", self.printed.number), quantity, "V/s", gain)
    }

    fn deviation(&self) -> f64 {
        self.own / self.printed.gain - 1.0
    }

    fn is_chaotic(&self) -> bool {
        self.printed.motion == Motion::Chaotic
    }
}

/// Everything that the table shows.
struct Computation {
    nudges: Vec<f64>,
    cases: Vec<Computed>,
    /// Figure 12 with a ball that starts free.
    free: Computed,
    /// Nearby starts of all chaotic cases together.
    pooled: Ensemble,
}

/// Makes the table.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let computation = compute(study)?;
    let mut findings: Vec<_> = computation.cases.iter().map(|case| finding(case, &computation.pooled)).collect();
    findings.push(other_rule(&computation.free));
    findings.extend(computation.cases.iter().filter_map(by_the_papers_method));
    output::artefact(&computation, findings)
}

/// Nearby starts of each case.
const STARTS: usize = 200;

fn compute(study: &Study<'_>) -> Result<Computation, PaperError> {
    // Runs of the FMU take no time beside those of the paper's method.
    let stepped_starts = study.effort.of(STARTS, STARTS / 5);
    let nudges = ensemble::nudges(STARTS, NUDGE);
    let coarse = ensemble::nudges(stepped_starts, STEPPED_NUDGE);
    let mut cases = Vec::new();
    for printed in &PRINTED {
        let mut case = computed(study, printed, Study::case(printed.case)?, &nudges)?;
        if !matches!(printed.motion, Motion::Damped(_)) {
            case.stepped = stepped(study, printed, &coarse)?;
        }
        cases.push(case);
    }
    let rule = Setting::new("initial.outsideGap", "free");
    let free = Study::case("fig12")?.into_iter().chain([rule]).collect();
    let free = computed(study, &PRINTED[2], free, &nudges)?;
    let pooled = cases.iter().filter(|case| case.is_chaotic()).flat_map(|case| case.values.iter().copied());
    let pooled = Ensemble::new(pooled.collect());
    Ok(Computation { nudges, cases, free, pooled })
}

/// The start of the paper and those nearby, through the FMU.
fn computed(
    study: &Study<'_>,
    printed: &'static Printed,
    settings: Vec<Setting>,
    nudges: &[f64],
) -> Result<Computed, PaperError> {
    let values = voltage_gains(study, nearby(study, &settings, nudges)?, WINDOW)?;
    let own = study.averages(&[Run { settings, window: WINDOW }])?;
    let own = own.first().map_or(f64::NAN, |averages| averages.voltage_gain);
    Ok(Computed { printed, own, nearby: Ensemble::new(values.clone()), values, stepped: None })
}

/// Nearby starts by the paper's method.
fn stepped(study: &Study<'_>, printed: &Printed, nudges: &[f64]) -> Result<Option<Ensemble>, PaperError> {
    let Some(case) = Case::find(printed.case) else { return Ok(None) };
    let parameters = (case.parameters)();
    let batches: Vec<Vec<f64>> = nudges
        .chunks(BATCH)
        .map(|batch| batch.iter().map(|nudge| parameters.ball_velocity + nudge).collect())
        .collect();
    let gains =
        study.each(&batches, |velocities| Ok(FixedStep::new(&parameters, velocities, FixedStep::PAPER).run(WINDOW)))?;
    Ok(Some(Ensemble::new(gains.concat().iter().map(|run| run.voltage_gain).collect())))
}

fn finding(case: &Computed, pooled: &Ensemble) -> Finding {
    let (verdict, reason) = judge(case, pooled);
    case.finding("", "<U>, Eq. (15)", case.own).printed(case.printed.gain).judged(verdict).reason(reason)
}

fn judge(case: &Computed, pooled: &Ensemble) -> (Verdict, String) {
    let (paper, nearby) = (case.printed.gain, &case.nearby);
    let [low, high] = nearby.range();
    let range = format!("{} starts nudged by up to {NUDGE:e} m/s give {low:.0} to {high:.0} V/s", nearby.len());
    match case.printed.motion {
        Motion::Damped(tolerance) if case.deviation().abs() <= tolerance => {
            let spread = (high - low) / case.own;
            let reason = if spread > tolerance / 10.0 { format!("weakly chaotic: {range}") } else { String::new() };
            (Verdict::Agrees, reason)
        }
        Motion::Unstable if case.deviation().abs() <= 1e-3 && nearby.contains(paper) => {
            (Verdict::Explained, format!("unstable orbit, kept here as its impacts fall on doubles; {range}"))
        }
        Motion::Chaotic => judge_chaotic(paper, nearby, pooled),
        Motion::Damped(_) | Motion::Unstable => (Verdict::Differs, range),
    }
}

fn judge_chaotic(paper: f64, nearby: &Ensemble, pooled: &Ensemble) -> (Verdict, String) {
    let (below, count) = (nearby.below(paper), nearby.len());
    let spread = format!(
        "mean {:.0}, 5 to 95 %: {:.0} to {:.0} V/s",
        nearby.mean(),
        nearby.quantile(0.05),
        nearby.quantile(0.95)
    );
    let reason = format!("chaotic: {below} of {count} nearby starts lie below the paper's value ({spread})");
    if (nearby.quantile(0.025)..=nearby.quantile(0.975)).contains(&paper) {
        return (Verdict::WithinEnsemble, reason);
    }
    let share = format!("{} of {} of Figures 11 to 13 together", pooled.below(paper), pooled.len());
    (Verdict::Tail, format!("{reason}; {share}"))
}

/// Figure 12 under the rule that is not the default.
fn other_rule(free: &Computed) -> Finding {
    let [low, high] = free.nearby.range();
    free.finding(", initial.outsideGap = free", "<U>, Eq. (15)", free.own).reason(format!(
        "the other reading of a start outside the gap, another motion: {} nearby starts give {low:.1} to {high:.1} V/s",
        free.nearby.len()
    ))
}

/// Whether the paper's way of stepping explains its value.
fn by_the_papers_method(case: &Computed) -> Option<Finding> {
    let stepped = case.stepped.as_ref()?;
    let ([low, high], paper) = (stepped.range(), case.printed.gain);
    let quantity = "<U> by the paper's stepping, median of nearby starts";
    Some(case.finding("", quantity, stepped.quantile(0.5)).reason(format!(
        "{} starts nudged by up to {STEPPED_NUDGE:e} m/s give {low:.0} to {high:.0} V/s; below {paper}: {}",
        stepped.len(),
        stepped.below(paper)
    )))
}
