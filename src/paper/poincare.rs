//! Poincare sections: the motion once a period, in the plane of relative displacement and velocity.

use super::excitation::{Cylinder, FORCE, FREQUENCY};
use super::stroboscope::{Orbit, Start, Stroboscope};
use super::{Finding, PaperError, Picture, Sheet, Study, Verdict, lyapunov};
use videg_report::{Figure, Panel, Series, Style};

/// Periods that pass first: 100 s.
const TRANSIENT: u32 = 200;

/// A case of the paper.
pub struct Section {
    case: &'static str,
    title: &'static str,
    orbit: Orbit,
    /// Largest Lyapunov exponent, 1/s.
    exponent: f64,
}

/// The sections of the elastic and of the inelastic cases.
pub fn sections(study: &Study<'_>) -> Result<Vec<Section>, PaperError> {
    let many = study.effort.of(4000, 400);
    let cylinder = Cylinder::new(study)?;
    let cases = [
        ("fig13", "Figure 13, r = 1", 1.0, many),
        ("fig14", "Figure 14, r = 0.6", 0.6, 100),
        ("fig15", "Figure 15, r = 0.3", 0.3, many),
    ];
    study.each(&cases, |&(case, title, restitution, periods)| {
        let orbit = Stroboscope::new(study, &Study::case(case)?, FREQUENCY)?.take(TRANSIENT, periods)?;
        let start = Start::saw_tooth(&cylinder, restitution, cylinder.gamma(FORCE, FREQUENCY), FREQUENCY);
        let exponent = lyapunov::exponent(study, &cylinder, start, &orbit, many / 4)?;
        Ok(Section { case, title, orbit, exponent })
    })
}

/// Displacement against velocity, mm and m/s.
pub fn picture(sections: &[Section]) -> Result<Picture, PaperError> {
    let dots: Vec<Vec<(f64, f64)>> = sections
        .iter()
        .map(|section| section.orbit.flashes.iter().map(|flash| (1e3 * flash.displacement, flash.velocity)).collect())
        .collect();
    let mut figure = Figure::new("Poincare sections")
        .caption("Relative displacement against relative velocity, once a period.")
        .columns(3)
        .width(1080.0);
    for (section, dots) in sections.iter().zip(&dots) {
        let style = if section.orbit.recurrence().is_some() { Style::Markers } else { Style::Dots };
        let panel = Panel::new(section.title, "z_M - z_m (mm)", "z_M' - z_m' (m/s)")
            .height(300.0)
            .series(Series::points("", dots).style(style));
        figure = figure.panel(panel);
    }
    let periods: Vec<_> =
        sections.iter().map(|section| format!("{} ({})", section.orbit.flashes.len() - 1, section.title)).collect();
    let caption = format!(
        "Relative displacement and velocity at the start of each period, when the force has its largest value, after \
         {TRANSIENT} periods, over so many periods: {}. The panels have scales of their own.",
        periods.join(", ")
    );
    Picture::new("poincare", &figure, caption)
}

/// Whether the motions come back, and whether they are chaotic.
pub fn findings(sections: &[Section]) -> Vec<Finding> {
    sections.iter().map(Section::finding).collect()
}

impl Section {
    fn finding(&self) -> Finding {
        let comes_back = match self.orbit.recurrence() {
            Some(n) => format!("the motion comes back after {n} periods"),
            None => format!("the motion does not come back within {} periods", (self.orbit.flashes.len() - 1) / 2),
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
}

/// The points.
pub fn sheet(section: &Section) -> Sheet {
    let flashes = section.orbit.flashes.iter().enumerate();
    let rows = flashes.map(|(k, flash)| vec![f64::from(TRANSIENT) + k as f64, flash.displacement, flash.velocity]);
    Sheet::new(format!("poincare-{}", section.case), ["period (1)", "displacement (m)", "velocity (m/s)"], rows)
}
