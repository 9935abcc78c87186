//! Figure 7: the membrane at its largest deformation, to scale.

use std::f64::consts::PI;

use super::{Artefact, Finding, PaperError, Picture, Sheet, Study, peak, peak::CASE};
use videg_report::{Figure, Panel, Series, Style};

/// Points of each arc.
const POINTS: u32 = 400;

/// The membrane around the ball: half of its profile is the cap that lies on the ball up to the angle alpha, and the cone
/// that touches it there.
struct Shape {
    /// `R_2`, m.
    radius: f64,
    /// `r_b`, m.
    ball: f64,
    /// delta, m.
    deflection: f64,
    /// alpha, rad.
    alpha: f64,
}

impl Shape {
    /// Eqs. (5) and (6).
    fn new(radius: f64, ball: f64, deflection: f64) -> Self {
        let (r, b, d) = (radius, ball, deflection);
        let cos = (b * (b - d) + r * (r * r + d * d - 2.0 * d * b).sqrt()) / (r * r + (d - b) * (d - b));
        Self { radius, ball, deflection, alpha: cos.clamp(-1.0, 1.0).acos() }
    }

    /// Distance from the axis and depth below the rest plane of the ball's surface, `angle` from its lowest point, m.
    fn on_ball(&self, angle: f64) -> (f64, f64) {
        (self.ball * angle.sin(), self.deflection - self.ball * (1.0 - angle.cos()))
    }

    fn arc(&self, from: f64, to: f64) -> Vec<(f64, f64)> {
        (0..=POINTS).map(|k| self.on_ball(from + (to - from) * f64::from(k) / f64::from(POINTS))).collect()
    }

    /// The membrane from the axis to the frame.
    fn half_profile(&self) -> Vec<(f64, f64)> {
        let mut profile = self.arc(0.0, self.alpha);
        profile.push((self.radius, 0.0));
        profile
    }
}

/// Area, m^2, of the surface that `profile` sweeps about the axis.
fn area_of_revolution(profile: &[(f64, f64)]) -> f64 {
    profile
        .windows(2)
        .map(|ends| PI * (ends[0].0 + ends[1].0) * (ends[1].0 - ends[0].0).hypot(ends[1].1 - ends[0].1))
        .sum()
}

/// Makes the figure.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let instance = study.start(&Study::case(CASE)?)?;
    let [radius, ball] = study.reals(&instance, ["membrane.radius", "ball.radius"])?;
    let peak = peak::stage_3(study)?;
    let shape = Shape::new(radius, ball, peak.deflection);
    let drawn = area_of_revolution(&shape.half_profile()) / (PI * radius * radius);
    let findings = vec![
        Finding::new("Figure 7", "alpha at the largest impact of fig14, Eq. (6)", "deg", shape.alpha.to_degrees()),
        Finding::new("Figure 7", "A_3 / A_2 by the FMU, Eqs. (3) and (4)", "1", peak.area_ratio)
            .agrees_if((drawn / peak.area_ratio - 1.0).abs() < 1e-4)
            .reason(format!("the surface drawn here sweeps {drawn:.6} A_2")),
    ];
    let text = vec![
        "In Eq. (4) the area A_32 is printed with r sin(alpha); the radius meant is that of the ball, r_b, as the picture \
         shows: only then does the cone end where the cap begins."
            .to_owned(),
    ];
    let mirrored = mirror(&shape.half_profile());
    let columns = ["distance from the axis (mm)", "depth below the rest plane (mm)"];
    let sheet = Sheet::new("fig7", columns, mirrored.iter().map(|(x, y)| vec![1e3 * x, 1e3 * y]));
    let picture = picture(&shape, &peak)?;
    Ok(Artefact { findings, text, pictures: vec![picture], sheets: vec![sheet], ..Artefact::default() })
}

/// Both halves of a profile, from left to right.
fn mirror(half: &[(f64, f64)]) -> Vec<(f64, f64)> {
    half.iter().rev().map(|&(x, y)| (-x, y)).chain(half.iter().skip(1).copied()).collect()
}

fn picture(shape: &Shape, peak: &peak::Peak) -> Result<Picture, PaperError> {
    // Depth is drawn downwards.
    let scaled = |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (1e3 * x, -1e3 * y)).collect::<Vec<_>>();
    let Shape { radius, alpha, .. } = *shape;
    let rest = scaled(vec![(-radius, 0.0), (radius, 0.0)]);
    let ball = scaled(shape.arc(-PI, PI));
    let cap = scaled(shape.arc(-alpha, alpha));
    let (touch, frame) = (shape.on_ball(alpha), (radius, 0.0));
    let cone = scaled(vec![(-frame.0, 0.0), (-touch.0, touch.1), (f64::NAN, 0.0), touch, frame]);
    let panel = Panel::new("", "distance from the axis (mm)", "height over the rest plane (mm)")
        .equal_aspect()
        .series(Series::points("membrane at rest, R_2", &rest).style(Style::Dashed).color(6))
        .series(Series::points("ball, r_b", &ball).color(5))
        .series(Series::points("A_31, on the ball", &cap).color(1))
        .series(Series::points("A_32, cone", &cone).color(0));
    let figure = Figure::new("Figure 7: membrane at its largest deformation, to scale").panel(panel);
    let caption = format!(
        "The membrane at the largest impact of {CASE}: t = {:.3} s, delta = {:.3} mm, alpha = {:.2} deg, A_3 / A_2 = {:.4}; \
         R_2 = {} mm, r_b = {} mm.",
        peak.time,
        1e3 * peak.deflection,
        alpha.to_degrees(),
        peak.area_ratio,
        1e3 * radius,
        1e3 * shape.ball,
    );
    Picture::new("fig7", &figure, caption)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_shape_is_that_of_the_equations() {
        let membrane = videg_model::Membrane::new(&videg_model::Parameters::default());
        for deflection in [1e-4, 2e-3, 5e-3, 9e-3] {
            let shape = Shape::new(6.3e-3, 5e-3, deflection);
            assert_relative_eq!(shape.alpha.cos(), membrane.cos_alpha(deflection), max_relative = 1e-12);
            let (x, y) = shape.on_ball(shape.alpha);
            assert_relative_eq!(y / (6.3e-3 - x), shape.alpha.tan(), max_relative = 1e-9); // Eq. (5)
            let area = area_of_revolution(&shape.half_profile()) / (PI * 6.3e-3 * 6.3e-3);
            assert_relative_eq!(area, membrane.area_ratio(deflection), max_relative = 1e-5);
        }
    }
}
