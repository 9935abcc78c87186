//! Restitution that follows from a viscous film, over the speed of the impact.

use super::excitation::set;
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study};
use crate::scenario::Setting;
use videg_report::{Figure, Panel, Series};

/// Shear modulus, Pa, and limit of the elastic Gent film, commonly quoted for VHB 4910.
const FILM: [f64; 2] = [45e3, 270.0];

/// Slowest and fastest impact, m/s.
const SPEEDS: [f64; 2] = [0.05, 2.0];

/// What r of Eq. (11) is in the paper's figures: 1 in the theory, 0.6 in Fig. 14.
const PAPER: [f64; 2] = [1.0, 0.6];

/// A Maxwell branch.
struct Branch {
    name: &'static str,
    /// Shear modulus, Pa, and relaxation time, s.
    constants: [f64; 2],
    source: &'static str,
}

/// The branches of the figure. The first two were fitted to measurements: of the first, 33.3 kPa in uniaxial tension are a shear modulus of a third.
const BRANCHES: [Branch; 4] = [
    Branch {
        name: "11.1 kPa, 22.1 s (fitted)",
        constants: [11.1e3, 22.1],
        source: "P. Miles, pymcmcstat viscoelasticity example: fit of a Maxwell branch to loading and unloading of VHB 4910",
    },
    Branch {
        name: "26.1 kPa, 0.61 s (fitted)",
        constants: [26.06e3, 0.6074],
        source: "Wang et al. (JMPS 2016), as Stewart and Anand give it: the fastest of three branches fitted to VHB 4910",
    },
    Branch { name: "11.1 kPa, 5 ms", constants: [11.1e3, 5e-3], source: "as fast as a contact, for comparison" },
    Branch { name: "5 MPa, 5 ms", constants: [5e6, 5e-3], source: "as fast, and much stiffer than the film" },
];

/// Makes the figure.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let count = study.effort.of(25_u32, 9);
    let ratio = SPEEDS[1] / SPEEDS[0];
    let speeds: Vec<f64> = (0..count).map(|k| SPEEDS[0] * ratio.powf(f64::from(k) / f64::from(count - 1))).collect();
    let mut curves = Vec::new();
    for branch in &BRANCHES {
        let curve = speeds.iter().map(|speed| restitution(study, branch.constants, *speed).map(|r| (*speed, r)));
        curves.push(curve.collect::<Result<Vec<_>, _>>()?);
    }
    let findings = BRANCHES.iter().zip(&curves).map(|(branch, curve)| {
        let least = curve.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
        let quantity = format!("least restitution of a film with {}", branch.name);
        Finding::new("Eq. (11)", quantity, "1", least).reason(branch.source)
    });
    let columns = ["impact speed (m/s)"].into_iter().chain(BRANCHES.iter().map(|branch| branch.name));
    let rows = (0..speeds.len())
        .map(|k| [vec![speeds[k]], curves.iter().map(|curve| curve[k].1).collect::<Vec<_>>()].concat());
    let sheet = Sheet::new("restitution", columns, rows);
    let text = vec![
        "The paper puts the restitution in: r = 1 in its theory, 0.6 in Fig. 14. A film with a Maxwell branch gives it. The branches \
         that were fitted to loading of VHB 4910 relax over a second or many; within a contact of some ten milliseconds they are \
         nearly elastic, and the ball rebounds with its speed. Even a branch that is as fast as the contact takes little, because the \
         force of a pre-stretched film is mostly that of its pre-stretch, in which the branch has relaxed. A branch a hundred times as \
         stiff as the film, and as fast as the contact, still leaves more than 0.6. These constants do not explain r = 0.6."
            .to_owned(),
    ];
    let findings = findings.collect();
    Ok(Artefact { findings, text, pictures: vec![picture(&curves)?], sheets: vec![sheet], ..Artefact::default() })
}

/// Rebound speed over impact speed, m/s, of a ball that meets a viscous film of a cylinder at rest.
fn restitution(study: &Study<'_>, [modulus, time]: [f64; 2], speed: f64) -> Result<f64, PaperError> {
    let instance = &mut study.start(&[
        Setting::new("contact.law", "compliant"),
        Setting::new("membrane.law", "gent"),
        set("membrane.shearModulus", FILM[0]),
        set("membrane.stretchLimit", FILM[1]),
        set("membrane.viscousModulus", modulus),
        set("membrane.relaxationTime", time),
        set("excitation.amplitude", 0.0),
        set("initial.ballPosition", 0.0),
        set("initial.ballVelocity", speed),
    ])?;
    let [travel] = study.reals(instance, ["ball.travel"])?;
    // The contact is over before the ball is back in the middle at a tenth of its speed.
    let step = travel / 2.0 / speed;
    let mut reached = 0.0;
    let mut found = 0.0;
    for _ in 0..12 {
        instance.do_step(reached, step)?;
        reached += step;
        [found] = study.reals(instance, ["impact.effectiveRestitution"])?;
        if found > 0.0 {
            break;
        }
    }
    instance.terminate()?;
    Ok(found)
}

fn picture(curves: &[Vec<(f64, f64)>]) -> Result<Picture, PaperError> {
    let lines = PAPER.map(|r| SPEEDS.map(|speed| (speed, r)));
    let mut panel = Panel::new("", "impact speed (m/s)", "rebound speed / impact speed (1)").height(300.0);
    for (k, (branch, curve)) in BRANCHES.iter().zip(curves).enumerate() {
        panel = panel.series(Series::points(branch.name, curve).color(k));
    }
    for (k, (r, line)) in PAPER.iter().zip(&lines).enumerate() {
        panel = panel.series(Series::points(format!("paper, r = {r}"), line).color(4 + k));
    }
    let figure = Figure::new("Restitution of viscous films").panel(panel);
    let caption = format!(
        "Rebound speed over impact speed of the paper's ball on a Gent film of {} kPa and J = {} with a Maxwell branch, against a wall \
         at rest, and r as the paper puts it in.",
        FILM[0] / 1e3,
        FILM[1]
    );
    Picture::new("restitution", &figure, caption)
}
