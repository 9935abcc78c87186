//! Poincare sections: the motion once a period, in the plane of relative displacement and velocity.

use super::excitation::preset;
use super::stroboscope::{Orbit, Stroboscope};
use super::{Effort, Finding, PaperError, Picture, Sheet, Verdict, Workshop};
use crate::report::{Figure, Panel, Series, Style};

/// `f_0` of the cases, Hz.
const FREQUENCY: f64 = 2.0;
/// Periods that pass first: 100 s.
const TRANSIENT: u32 = 200;
/// Largest distance, m, after a recurrence.
const TOLERANCE: f64 = 1e-6;

/// A case of the paper.
pub struct Section {
    case: &'static str,
    title: &'static str,
    orbit: Orbit,
}

/// The sections of the chaotic and of the periodic case.
///
/// # Errors
/// What the FMU says.
pub fn sections(workshop: &Workshop<'_>) -> Result<Vec<Section>, PaperError> {
    let many = match workshop.effort {
        Effort::Full => 4000,
        Effort::Quick => 400,
    };
    let cases = [("fig13", "Figure 13, r = 1", many), ("fig14", "Figure 14, r = 0.6", 100)];
    workshop.each(&cases, |&(case, title, periods)| {
        let orbit = Stroboscope::new(workshop, &preset(case)?, FREQUENCY)?.take(TRANSIENT, periods)?;
        Ok(Section { case, title, orbit })
    })
}

/// Displacement against velocity, mm and m/s.
///
/// # Errors
/// A figure that makes no sense.
pub fn picture(sections: &[Section]) -> Result<Picture, PaperError> {
    let dots: Vec<Vec<(f64, f64)>> = sections
        .iter()
        .map(|section| section.orbit.flashes.iter().map(|flash| (1e3 * flash.displacement, flash.velocity)).collect())
        .collect();
    let mut figure = Figure::new("Poincare sections")
        .caption("Relative displacement against relative velocity, once a period.")
        .columns(2)
        .width(960.0);
    for (section, dots) in sections.iter().zip(&dots) {
        let style = if section.orbit.recurrence(TOLERANCE).is_some() { Style::Markers } else { Style::Dots };
        let panel = Panel::new(section.title, "z_M - z_m (mm)", "z_M' - z_m' (m/s)")
            .height(300.0)
            .x_range(-22.5, 22.5)
            .series(Series::points("", dots).style(style));
        figure = figure.panel(panel);
    }
    let caption = "Relative displacement and velocity at the start of each period, when the force has its largest value, from 100 s \
                   on: 4000 periods of the chaotic motion of Figure 13 (400 where little work is asked for) and 100 of that of \
                   Figure 14, which meets the same points again and again.";
    Ok(Picture::new("poincare", &figure, caption)?)
}

/// After how many periods the motions come back.
pub fn findings(sections: &[Section]) -> Vec<Finding> {
    let finding = |section: &Section| {
        let recurrence = section.orbit.recurrence(TOLERANCE);
        let (claim, verdict) = match (section.case, recurrence) {
            ("fig13", None) => ("the paper: almost chaotic; no recurrence", Verdict::Agrees),
            ("fig13", Some(_)) => ("the paper: almost chaotic", Verdict::Differs),
            (_, Some(_)) => ("the paper: periodic peaks", Verdict::Agrees),
            (_, None) => ("the paper: periodic peaks; no recurrence", Verdict::Differs),
        };
        Finding {
            place: section.title.to_owned(),
            quantity: "periods after which the motion comes back".to_owned(),
            unit: "1".to_owned(),
            paper: None,
            videg: recurrence.map_or(f64::NAN, |n| n as f64),
            verdict,
            reason: claim.to_owned(),
        }
    };
    sections.iter().map(finding).collect()
}

/// The points.
pub fn sheet(section: &Section) -> Sheet {
    let columns = ["period (1)", "displacement (m)", "velocity (m/s)"].map(str::to_owned).to_vec();
    let flashes = section.orbit.flashes.iter().enumerate();
    let rows = flashes.map(|(k, flash)| vec![f64::from(TRANSIENT) + k as f64, flash.displacement, flash.velocity]);
    Sheet { name: format!("poincare-{}", section.case), columns, rows: rows.collect() }
}
