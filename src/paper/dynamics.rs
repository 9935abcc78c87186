//! Beyond the paper: what the motion is like, by Poincare sections and bifurcation diagrams.

use super::bifurcation::{Diagram, Path};
use super::excitation::{Cylinder, FORCE, FREQUENCY};
use super::stroboscope::Start;
use super::{Artefact, PaperError, Study, poincare};

/// r of Figure 14.
const RESTITUTION: f64 = 0.6;

const PATHS: [Path; 2] = [
    Path {
        name: "bifurcation-restitution",
        axis: "r (1)",
        range: [0.0, 1.0],
        caption: "Over the coefficient of restitution, A = 0.5 N, f0 = 2 Hz.",
        start: |cylinder, r| Start::saw_tooth(cylinder, r, cylinder.gamma(FORCE, FREQUENCY), FREQUENCY),
    },
    Path {
        name: "bifurcation-amplitude",
        axis: "gamma (1)",
        range: [0.3, 4.3],
        caption: "Over the normalised amplitude of Eq. (16), r = 0.6, f0 = 2 Hz; Figure 14 has gamma = 1.156.",
        start: |cylinder, gamma| Start::saw_tooth(cylinder, RESTITUTION, gamma, FREQUENCY),
    },
];

/// Makes the pictures.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let cylinder = Cylinder::new(study)?;
    let sections = poincare::sections(study)?;
    let mut artefact = Artefact {
        findings: poincare::findings(&sections),
        text: text(),
        pictures: vec![poincare::picture(&sections)?],
        sheets: sections.iter().map(poincare::sheet).collect(),
        ..Artefact::default()
    };
    for path in &PATHS {
        let diagram = Diagram::new(study, &cylinder, path)?;
        artefact.findings.push(diagram.finding());
        artefact.tables.push(diagram.table());
        artefact.pictures.push(diagram.picture()?);
        artefact.sheets.push(diagram.sheet());
    }
    Ok(artefact)
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
