//! Beyond the paper: what the motion is like, by Poincare sections and bifurcation diagrams.

use videg_model::Parameters;

use super::excitation::{Cylinder, FORCE, FREQUENCY};
use super::{Artefact, Finding, PaperError, Sheet, Study, Verdict};
use crate::dynamics::{Diagram, Files, Motion, Periods, Problem, exponent, periods, pictures, sheets};
use videg_report::{Column, Table};

/// r of Figure 14.
const RESTITUTION: f64 = 0.6;
/// Periods that pass first: 100 s.
const TRANSIENT: u32 = 200;
/// Periods of each motion of a diagram.
const PERIODS: Periods = Periods { transient: TRANSIENT, taken: 60 };

/// A parameter and where it goes.
struct Path {
    /// Name of the files.
    name: &'static str,
    /// Axis label: symbol and unit.
    axis: &'static str,
    range: [f64; 2],
    /// Parameters that stay the same.
    caption: &'static str,
    /// The saw-tooth start at a value of the parameter.
    start: fn(&Cylinder, f64) -> Parameters,
}

const PATHS: [Path; 2] = [
    Path {
        name: "bifurcation-restitution",
        axis: "r (1)",
        range: [0.0, 1.0],
        caption: "Over the coefficient of restitution, A = 0.5 N, f0 = 2 Hz.",
        start: |cylinder, r| cylinder.saw_tooth(r, cylinder.gamma(FORCE, FREQUENCY), FREQUENCY),
    },
    Path {
        name: "bifurcation-amplitude",
        axis: "gamma (1)",
        range: [0.3, 4.3],
        caption: "Over the normalised amplitude of Eq. (16), r = 0.6, f0 = 2 Hz; Figure 14 has gamma = 1.156.",
        start: |cylinder, gamma| cylinder.saw_tooth(RESTITUTION, gamma, FREQUENCY),
    },
];

/// Makes the pictures.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let sections = sections(study, &cylinder)?;
    let motions: Vec<_> = sections.iter().map(|section| (section.title, &section.motion)).collect();
    let mut artefact = Artefact {
        findings: sections.iter().map(Section::finding).collect(),
        text: text(),
        pictures: vec![pictures::sections("poincare", &motions, &caption(&sections))?],
        sheets: sections.iter().map(Section::sheet).collect(),
        ..Artefact::default()
    };
    for path in &PATHS {
        let count = study.effort.of(400_u32, 100);
        let [from, to] = path.range;
        let xs: Vec<f64> = (0..=count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)).collect();
        let diagram = Diagram::new(xs, (|x| (path.start)(&cylinder, x), &Files::default()), PERIODS, study.observer)?;
        artefact.findings.push(path.finding(&diagram));
        artefact.tables.push(path.table(&diagram));
        artefact.pictures.push(pictures::diagram(path.name, path.axis, &diagram, &[], &path.long_caption())?);
        artefact.sheets.push(sheets::diagram(path.name, path.axis, &diagram));
    }
    Ok(artefact)
}

/// A case of the paper.
struct Section {
    case: &'static str,
    title: &'static str,
    motion: Motion,
    /// Largest Lyapunov exponent, 1/s.
    exponent: f64,
}

/// The sections of the elastic and of the inelastic cases.
fn sections(study: &Study<'_>, cylinder: &Cylinder) -> Result<Vec<Section>, PaperError> {
    let many = study.effort.of(4000, 400);
    let cases = [
        ("fig13", "Figure 13, r = 1", 1.0, many),
        ("fig14", "Figure 14, r = 0.6", 0.6, 100),
        ("fig15", "Figure 15, r = 0.3", 0.3, many),
    ];
    study.each(&cases, |&(case, title, restitution, periods)| {
        let Problem { parameters, .. } = Problem::new(&Study::case(case)?, None)?;
        let start = cylinder.saw_tooth(restitution, cylinder.gamma(FORCE, FREQUENCY), FREQUENCY);
        let take = || -> Result<Section, crate::dynamics::DynamicsError> {
            let motion = Motion::take(&parameters, TRANSIENT, periods)?;
            let exponent = exponent(&start, motion.last(), many / 4)?.unwrap_or(f64::NAN);
            Ok(Section { case, title, motion, exponent })
        };
        Ok(take()?)
    })
}

fn caption(sections: &[Section]) -> String {
    let periods: Vec<_> =
        sections.iter().map(|section| format!("{} ({})", section.motion.flashes.len() - 1, section.title)).collect();
    format!(
        "Relative displacement and velocity at the start of each period, when the force has its largest value, after \
         {TRANSIENT} periods, over so many periods: {}. The panels have scales of their own.",
        periods.join(", ")
    )
}

impl Section {
    /// Whether the motion comes back, and whether it is chaotic.
    fn finding(&self) -> Finding {
        let comes_back = match self.motion.recurrence() {
            Some(n) => format!("the motion comes back after {n} periods"),
            None => format!("the motion does not come back within {} periods", (self.motion.flashes.len() - 1) / 2),
        };
        let (claim, holds) = match self.case {
            "fig13" => ("almost chaotic", self.exponent > 0.0),
            _ => ("periodic peaks", self.exponent < 0.0),
        };
        let (verdict, judged) = match (holds, self.exponent > 0.0) {
            (true, _) => (Verdict::Agrees, ""),
            (false, true) => (Verdict::Explained, "; chaos in so narrow a band that the peaks look alike"),
            (false, false) => (Verdict::Differs, ""),
        };
        Finding::new(self.title, "largest Lyapunov exponent", "1/s", self.exponent)
            .judged(verdict)
            .reason(format!("the paper: {claim}; {comes_back}{judged}"))
    }

    fn sheet(&self) -> Sheet {
        sheets::section(&format!("poincare-{}", self.case), &self.motion, TRANSIENT)
    }
}

impl Path {
    /// Symbol of the parameter, without its unit.
    fn symbol(&self) -> &str {
        self.axis.split(' ').next().unwrap_or_default()
    }

    /// How often starts of different history end in different periodic motions.
    fn finding(&self, diagram: &Diagram) -> Finding {
        let coexisting = diagram.coexisting();
        let reason = match (coexisting.first(), coexisting.last()) {
            (Some(first), Some(last)) => {
                format!("of the {} looked at; between {first:.4} and {last:.4}", diagram.xs.len())
            }
            _ => "one <U> wherever the motions are periodic".to_owned(),
        };
        let place = format!("Bifurcation diagram over {}", self.symbol());
        let quantity = "values at which two periodic motions of different <U> exist";
        Finding::new(place, quantity, "1", coexisting.len() as f64).reason(reason)
    }

    /// The longer stretches as a table.
    fn table(&self, diagram: &Diagram) -> Table {
        let symbol = self.symbol();
        let columns = [
            Column::numbers(format!("{symbol} from")),
            Column::numbers(format!("{symbol} to")),
            Column::words("motion comes back after"),
        ];
        diagram.stretches().into_iter().fold(Table::new(columns), |table, (from, to, recurrence)| {
            let never = format!("more than {} periods: chaos, or a slow transient", PERIODS.taken / 2);
            table.row([format!("{from:.4}"), format!("{to:.4}"), periods(recurrence, never)])
        })
    }

    fn long_caption(&self) -> String {
        let Periods { transient, taken } = PERIODS;
        format!(
            "{} Relative displacement at the start of each period, when the cylinder is at the end of its swing: \
             {taken} periods after {transient}; (a) from the saw-tooth start, (b) each motion going on from the one \
             before along the parameter, upwards and downwards; (c) <U> of Eq. (15) over the {taken} periods. Where the ways \
             differ, several attractors coexist, and the start decides.",
            self.caption
        )
    }
}

fn text() -> Vec<String> {
    vec![
        "The motion is looked at once a period, when the force has its largest value. It counts as periodic if it \
         comes back to within 1 um after at most 30 periods, all through 60 periods; what does not is chaotic, \
         quasi-periodic or still on its way. The tables list the stretches that at least four neighbouring values of \
         the parameter share."
            .to_owned(),
        "Each diagram is followed three times: from the saw-tooth start of Section 4.2 at each value, and upwards and \
         downwards with each motion going on from the last state of the one before. Where the three are periodic and differ, several \
         motions exist side by side, and it depends on the start which of them comes about: where <U> is the same, \
         they are mirror images of each other."
            .to_owned(),
        "The largest Lyapunov exponent says how fast neighbouring motions part. It is above 0 for Figure 15, too: with \
         r = 0.3 the motion does not settle, however long one waits, but wanders in a narrow band, which looks like a \
         slow transient."
            .to_owned(),
    ]
}
