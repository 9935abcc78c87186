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

/// Shear modulus, Pa, and limit of a Gent film, commonly quoted for VHB 4910.
const QUOTED: [f64; 2] = [45e3, 270.0];

/// VHB 4910 by Wang et al. (JMPS 2016), as Stewart and Anand give it: an Arruda-Boyce film of this modulus, Pa, and locking stretch,
const EQUILIBRIUM: f64 = 15.36e3;
const LOCKING: f64 = 5.99;
/// and Maxwell branches of these moduli, Pa. None of this was measured on the paper's membranes.
const BRANCHES: [f64; 3] = [26.06e3, 26.53e3, 10.83e3];

/// Shear modulus, Pa, and limit of the Gent film with the small-strain modulus and the largest stretch of that Arruda-Boyce film. Its
/// inverse Langevin function is Cohen's.
fn relaxed() -> [f64; 2] {
    let z = 1.0 / LOCKING;
    let modulus = EQUILIBRIUM * LOCKING / 3.0 * z * (3.0 - z * z) / (1.0 - z * z);
    [modulus, 3.0 * (LOCKING * LOCKING - 1.0)]
}

/// Shear modulus, Pa, of the film while no branch has relaxed: neo-Hookean, an Ogden film of one term.
fn unrelaxed() -> f64 {
    relaxed()[0] + BRANCHES.iter().sum::<f64>()
}

/// Largest deflection of the comparison, m, and its points.
const DEEPEST: f64 = 0.01;
const POINTS: u32 = 200;

/// The membrane of Eq. (2), and those of the films in the paper's frame.
type Films = [(&'static str, Membrane); 4];

fn films() -> Films {
    let p = Parameters::default();
    let gent = |[modulus, limit]: [f64; 2]| {
        Membrane::new(&Parameters {
            membrane_law: MembraneLaw::Gent,
            shear_modulus: modulus,
            stretch_limit: limit,
            ..p
        })
    };
    let law = MembraneLaw::Ogden;
    let ogden = Parameters { membrane_law: law, ogden_modulus_1: unrelaxed(), ogden_exponent_1: 2.0, ..p };
    [
        ("Eq. (2)", Membrane::new(&p)),
        ("Gent, 45 kPa", gent(QUOTED)),
        ("Gent, relaxed", gent(relaxed())),
        ("Ogden, unrelaxed", Membrane::new(&ogden)),
    ]
}

fn places() -> impl Iterator<Item = f64> {
    (0..=POINTS).map(|k| DEEPEST * f64::from(k) / f64::from(POINTS))
}

fn sheet_of_films(films: &Films) -> Sheet {
    let columns = ["deflection (m)"].map(str::to_owned).into_iter();
    let columns = columns.chain(films.iter().map(|(name, _)| format!("{name} (N)")));
    let row = |x: f64| [vec![x], films.iter().map(|(_, membrane)| membrane.force(x)).collect()].concat();
    Sheet::new("fig4-films", columns, places().map(row))
}

/// Where the films agree with Eq. (2), and where not.
fn comparison([(_, printed), films @ ..]: &Films) -> String {
    let ratio = |film: &Membrane, x: f64| film.force(x) / printed.force(x);
    let crossing = |film: &Membrane| {
        let place = places().skip(1).find(|x| ratio(film, *x) < 1.0);
        place.map_or("at no deflection below that".to_owned(), |x| format!("at {:.1} mm", 1e3 * x))
    };
    let compared = films.iter().map(|(name, film)| {
        let [near, far] = [1e-3, DEEPEST].map(|x| ratio(film, x));
        format!("{name}: {near:.0} times Eq. (2) at 1 mm, {far:.2} times at 10 mm, equal {}", crossing(film))
    });
    format!(
        "The second picture has the force of films of VHB 4910 by virtual work in the frame of the paper, pre-stretch included. Gent \
         with {:.0} kPa and J = {} is commonly quoted. The other two have the constants of Wang et al. (JMPS 2016), as Stewart and Anand \
         give them: Arruda-Boyce with {:.2} kPa and a locking stretch of {LOCKING}, and three Maxwell branches of {:.2} kPa together. \
         Relaxed, a Gent film of the same small-strain modulus and limit has {:.2} kPa and J = {:.1}; before any branch relaxes, a \
         neo-Hookean film (Ogden, alpha_1 = 2) has {:.1} kPa. A film that was pre-stretched long ago and is pressed in within \
         milliseconds lies between them. None was measured on the paper's membranes. {}. A pre-stretched film is nearly linear at small deflections, Eq. (2) \
         is not. For a membrane of your own let a table decide (membrane.law = table).",
        1e-3 * QUOTED[0],
        QUOTED[1],
        1e-3 * EQUILIBRIUM,
        1e-3 * BRANCHES.iter().sum::<f64>(),
        1e-3 * relaxed()[0],
        relaxed()[1],
        1e-3 * unrelaxed(),
        compared.collect::<Vec<_>>().join(". "),
    )
}

fn picture_of_films(films: &Films) -> Result<Picture, PaperError> {
    let curve = |membrane: &Membrane| places().map(|x| (1e3 * x, membrane.force(x))).collect::<Vec<_>>();
    let curves = films.each_ref().map(|(name, membrane)| (*name, curve(membrane)));
    let mut panel = Panel::new("", "deflection (mm)", "force (N)").height(300.0);
    for ((name, curve), color) in curves.iter().zip([6, 0, 1, 2]) {
        panel = panel.series(Series::points(*name, curve).color(color));
    }
    let figure = Figure::new("Figure 4: Eq. (2) and the force of films").panel(panel);
    let caption = "Eq. (2), and virtual work of films of VHB 4910, pre-stretched by 2 in a frame of 6.3 mm radius: Gent with \
                   constants commonly quoted, and the film of Wang et al., relaxed (Gent) and before it relaxes (Ogden).";
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
