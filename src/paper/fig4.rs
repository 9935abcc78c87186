//! Figure 4: the fitted force law, Eq. (2), the force that the ball feels in the FMU, and that of films by virtual work.

use super::excitation::set;
use super::statistics::{mean, slope};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study};
use crate::scenario::Setting;
use videg_model::{Membrane, MembraneLaw, Parameters};
use videg_report::{Figure, Panel, Series, Style};

/// Speed of the ball when it meets the membrane, m/s: it presses it in by some 7 mm.
const SPEED: f64 = 1.0;
/// Distance in time of the samples, s.
const SAMPLING: f64 = 2e-4;
/// K and n as printed under Eq. (2).
const PRINTED: [f64; 2] = [4.0847e5, 2.6];

/// Deflection, m, and force, N.
type Point = (f64, f64);

/// Makes the figure.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let elastic = contact(study, 1.0)?;
    let lossy = contact(study, 0.6)?;
    let fitted = fit(&elastic);
    let law = |(x, _): &Point| (*x, PRINTED[0] * x.powf(PRINTED[1]));
    let fit = |quantity: &str, unit: &str, paper: f64, fitted: f64| {
        Finding::new("Eq. (2)", format!("{quantity}, fitted to the force in the FMU"), unit, fitted)
            .printed(paper)
            .agrees_if((fitted / paper - 1.0).abs() < 1e-6)
            .reason("self-check: the force in the FMU is made of the printed K and n")
    };
    let findings = vec![fit("K", "N/m^n", PRINTED[0], fitted[0]), fit("n", "1", PRINTED[1], fitted[1])];
    let text = vec![
        "The paper's measured points are not printed, so the picture shows its fit, and the force on the ball in the FMU \
         under contact.law = compliant in a cylinder at rest: ball.mass times der(ball.velocity) against the deflection. \
         Loading follows Eq. (2); unloading follows r^2 K x^n, which gives the rebound of Eq. (11). The paper itself uses \
         Eq. (2) for the depth of an impact only, whose time it neglects."
            .to_owned(),
    ];
    let columns = ["deflection (m)", "force, r = 1 (N)", "K x^n (N)"];
    let loading = Sheet::new("fig4", columns, elastic.iter().map(|point| vec![point.0, point.1, law(point).1]));
    let columns = ["deflection (m)", "force, r = 0.6 (N)"];
    let hysteresis = Sheet::new("fig4-hysteresis", columns, lossy.iter().map(|point| vec![point.0, point.1]));
    let films = films();
    let pictures = vec![picture(&elastic, &lossy, law)?, picture_of_films(&films)?];
    let sheets = vec![loading, hysteresis, sheet_of_films(&films)];
    let text = [text, vec![comparison(&films)]].concat();
    Ok(Artefact { findings, text, pictures, sheets, ..Artefact::default() })
}

/// Shear modulus, Pa, and limit of the Gent film; shear modulus of the neo-Hookean one, an Ogden film of one term. Commonly quoted for
/// VHB 4910; none was measured on the paper's membranes.
const GENT: [f64; 2] = [45e3, 270.0];
const NEO_HOOKEAN: f64 = 68e3;

/// Largest deflection of the comparison, m, and its points.
const DEEPEST: f64 = 0.01;
const POINTS: u32 = 200;

/// The membrane of Eq. (2), and those of the two films in the paper's frame.
fn films() -> [(&'static str, Membrane); 3] {
    let p = Parameters::default();
    let gent = Parameters { membrane_law: MembraneLaw::Gent, shear_modulus: GENT[0], stretch_limit: GENT[1], ..p };
    let ogden =
        Parameters { membrane_law: MembraneLaw::Ogden, ogden_modulus_1: NEO_HOOKEAN, ogden_exponent_1: 2.0, ..p };
    [("Eq. (2)", Membrane::new(&p)), ("Gent", Membrane::new(&gent)), ("Ogden", Membrane::new(&ogden))]
}

fn places() -> impl Iterator<Item = f64> {
    (0..=POINTS).map(|k| DEEPEST * f64::from(k) / f64::from(POINTS))
}

fn sheet_of_films(films: &[(&'static str, Membrane); 3]) -> Sheet {
    let columns = ["deflection (m)", "K x^n (N)", "Gent film (N)", "Ogden film (N)"];
    let row = |x: f64| [vec![x], films.iter().map(|(_, membrane)| membrane.force(x)).collect()].concat();
    Sheet::new("fig4-films", columns, places().map(row))
}

/// Where the films agree with Eq. (2), and where not.
fn comparison([(_, printed), (_, gent), (_, ogden)]: &[(&'static str, Membrane); 3]) -> String {
    let ratio = |film: &Membrane, x: f64| film.force(x) / printed.force(x);
    let crossing = |film: &Membrane| {
        let place = places().skip(1).find(|x| ratio(film, *x) < 1.0);
        place.map_or(format!("beyond {} mm", 1e3 * DEEPEST), |x| format!("at {:.1} mm", 1e3 * x))
    };
    format!(
        "The second picture has the force of a film by virtual work in the frame of the paper, pre-stretch included: Gent with \
         mu = {:.0} kPa and J = {}, and Ogden with one term, mu_1 = {:.0} kPa and alpha_1 = 2, which is neo-Hookean. Both are commonly \
         quoted for VHB 4910 and were not measured on the paper's membranes. A pre-stretched film is nearly linear at small \
         deflections, Eq. (2) is not: at 1 mm the Gent film pushes {:.0} times as hard, at 10 mm {:.2} times; the Ogden film {:.0} and \
         {:.2} times. They agree with Eq. (2) in one point each, {} and {}. For a membrane of your own let a table decide \
         (membrane.law = table).",
        1e-3 * GENT[0],
        GENT[1],
        1e-3 * NEO_HOOKEAN,
        ratio(gent, 1e-3),
        ratio(gent, 1e-2),
        ratio(ogden, 1e-3),
        ratio(ogden, 1e-2),
        crossing(gent),
        crossing(ogden),
    )
}

fn picture_of_films(films: &[(&'static str, Membrane); 3]) -> Result<Picture, PaperError> {
    let curve = |membrane: &Membrane| places().map(|x| (1e3 * x, membrane.force(x))).collect::<Vec<_>>();
    let curves = films.each_ref().map(|(name, membrane)| (*name, curve(membrane)));
    let mut panel = Panel::new("", "deflection (mm)", "force (N)").height(300.0);
    for ((name, curve), color) in curves.iter().zip([6, 0, 1]) {
        panel = panel.series(Series::points(*name, curve).color(color));
    }
    let figure = Figure::new("Figure 4: Eq. (2) and the force of films").panel(panel);
    let caption = "Eq. (2), and virtual work of films of Gent and Ogden with constants commonly quoted for VHB 4910, pre-stretched by \
                   2 in a frame of 6.3 mm radius.";
    Picture::new("fig4-films", &figure, caption)
}

/// The contact of a ball that flies into the membrane of a cylinder at rest, sampled.
fn contact(study: &Study<'_>, restitution: f64) -> Result<Vec<Point>, PaperError> {
    let instance = &mut study.start(&[
        Setting::new("contact.law", "compliant"),
        set("excitation.amplitude", 0.0),
        set("initial.ballPosition", 0.0),
        set("initial.ballVelocity", SPEED),
        set("membrane.restitution", restitution),
    ])?;
    let [travel, mass] = study.reals(instance, ["ball.travel", "ball.mass"])?;
    let mut time = travel / 2.0 / SPEED;
    instance.do_step(0.0, time)?;
    let mut points = Vec::new();
    loop {
        instance.do_step(time, SAMPLING)?;
        time += SAMPLING;
        let [deflection, acceleration] = study.reals(instance, ["right.deflection", "der(ball.velocity)"])?;
        if deflection <= 0.0 {
            break;
        }
        points.push((deflection, mass * acceleration.abs()));
    }
    instance.terminate()?;
    Ok(points)
}

/// K and n of F = K x^n by least squares of the logarithms.
fn fit(points: &[Point]) -> [f64; 2] {
    let logs: Vec<Point> = points.iter().map(|(x, force)| (x.ln(), force.ln())).collect();
    let (exponent, _) = slope(&logs);
    let intercept = mean(logs.iter().map(|log| log.1)) - exponent * mean(logs.iter().map(|log| log.0));
    [intercept.exp(), exponent]
}

fn picture(elastic: &[Point], lossy: &[Point], law: impl Fn(&Point) -> Point) -> Result<Picture, PaperError> {
    let in_mm = |points: &[Point]| points.iter().map(|(x, force)| (1e3 * x, *force)).collect::<Vec<_>>();
    let deepest = elastic.iter().map(|point| point.0).fold(0.0, f64::max);
    let curve: Vec<_> = (0..=200).map(|k| law(&(deepest * f64::from(k) / 200.0, 0.0))).collect();
    let (curve, elastic, lossy) = (in_mm(&curve), in_mm(elastic), in_mm(lossy));
    let panel = Panel::new("", "deflection (mm)", "force (N)")
        .height(300.0)
        .series(Series::points("Eq. (2)", &curve).color(6))
        .series(Series::points("in the FMU, r = 1", &elastic).style(Style::Markers).color(0))
        .series(Series::points("in the FMU, r = 0.6", &lossy).style(Style::Crosses).color(1));
    let figure = Figure::new("Figure 4: force against deflection of the membrane").panel(panel);
    let caption = format!(
        "Eq. (2), f(x) = K x^n with K = {:e} N/m^n and n = {}, and the force on the ball in the FMU under the compliant law; \
         m = 3.5 g at {SPEED} m/s against a wall at rest.",
        PRINTED[0], PRINTED[1]
    );
    Picture::new("fig4", &figure, caption)
}
