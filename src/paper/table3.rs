//! Table 3: power and power density in the size of an electromagnetic flashlight, and what the paper's stepping makes of it.

use videg_model::{Case, FixedStep, Stepped};

use super::{Artefact, Finding, PaperError, Picture, Run, Sheet, Study, VOLUME, Verdict, WINDOW, artefact};
use videg_report::{Figure, Panel, Series, Style, Table};

/// Steps of the paper's method to show, s.
const STEPS: [f64; 10] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6];

/// That of the paper among them.
const OF_THE_PAPER: usize = 6;
const _: () = assert!(STEPS[OF_THE_PAPER] == FixedStep::PAPER);

/// The numbers of the paper for a case.
struct Printed {
    case: &'static str,
    frequency: &'static str,
    /// W.
    power: f64,
    /// mW/cm^3.
    density: f64,
    /// Largest deviation of the power that digits and method allow.
    tolerance: f64,
    /// The explanation.
    text: fn(&Compared) -> String,
}

const PRINTED: [Printed; 2] = [
    Printed {
        case: "table3-2hz",
        frequency: "2 Hz",
        power: 0.061,
        density: 1.447,
        tolerance: 1e-2,
        text: text_at_2_hz,
    },
    Printed {
        case: "table3-5hz",
        frequency: "5 Hz",
        power: 0.132,
        density: 3.128,
        tolerance: 4e-3,
        text: text_at_5_hz,
    },
];

/// A case by both methods.
struct Compared {
    printed: &'static Printed,
    /// P by the FMU, W.
    power: f64,
    /// Impacts in the window by the FMU.
    impacts: i32,
    /// The paper's method, in the order of [`STEPS`], of which a quick look has the first ones.
    stepped: Vec<Stepped>,
}

impl Compared {
    fn of_the_paper(&self) -> Stepped {
        self.stepped[OF_THE_PAPER]
    }
}

/// Makes the table.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let compared = compare(study)?;
    let findings = compared.iter().flat_map(findings).collect();
    let of_each = compared.iter().map(|it| (it.printed.text)(it));
    let text = of_each.chain([OF_MASSES.to_owned(), OF_SIZES.to_owned()]).collect();
    Ok(Artefact {
        findings,
        text,
        tables: vec![table(&compared)],
        pictures: vec![picture(&compared)?],
        sheets: vec![sheet(&compared)],
    })
}

const OF_MASSES: &str = "Both frequencies have a ball of 53 g in a cylinder of 12 g, while Eq. (7) neglects m / M. contact.law = compliant with \
     contact.reaction = true does not: P is then about a third.";

const OF_SIZES: &str = "The capacitance is printed as eps_0 eps_r R_in^2 / h_1 = 2.42e-11 F; that value is eps_0 eps_r pi R_in^2 / h_2. The \
     length of the device is the volume over pi R_in^2. The power density is the power over the printed volume of \
     42.2 cm^3.";

fn text_at_2_hz(compared: &Compared) -> String {
    format!(
        "At 2 Hz the ball comes to rest on a membrane for a part of each cycle. A program that applies Eq. (11) wherever a \
         step ends beyond the membrane counts an impact at nearly every step of the rest: {} of them in 50 s at the \
         paper's step of 1e-5 s, each with its share of W. Impacts that are found and summed to their limit are {}. So \
         the printed 0.061 W depends on the step (the picture), and without the spurious impacts it is {:.4} W.",
        compared.of_the_paper().impacts,
        compared.impacts,
        compared.power,
    )
}

fn text_at_5_hz(compared: &Compared) -> String {
    format!(
        "At 5 Hz the ball never rests ({} impacts in 50 s by both methods at 1e-5 s: {}), and the step does not matter.",
        compared.impacts,
        compared.of_the_paper().impacts,
    )
}

fn compare(study: &Study<'_>) -> Result<Vec<Compared>, PaperError> {
    let runs = PRINTED
        .iter()
        .map(|printed| Ok(Run { settings: Study::case(printed.case)?, window: WINDOW }))
        .collect::<Result<Vec<_>, PaperError>>()?;
    let averages = study.averages(&runs)?;
    // A quick look goes to the paper's step; each after it takes twice as long as the one before.
    let taken = study.effort.of(STEPS.len(), 1 + OF_THE_PAPER);
    // The longest first, so that all cores end together.
    let tasks: Vec<_> = STEPS[..taken].iter().rev().flat_map(|&step| PRINTED.iter().map(move |p| (p, step))).collect();
    let mut stepped = study.each(&tasks, |(printed, step)| {
        let parameters = Case::find(printed.case).map(|case| (case.parameters)());
        Ok(parameters.and_then(|p| FixedStep::new(&p, &[p.ball_velocity], *step).run(WINDOW).pop()))
    })?;
    stepped.reverse();
    let of_case = |k: usize| {
        let back = PRINTED.len() - 1 - k; // reversed with the rest
        stepped.iter().skip(back).step_by(PRINTED.len()).copied().flatten().collect()
    };
    let compared = PRINTED.iter().zip(averages).enumerate().map(|(k, (printed, average))| Compared {
        printed,
        power: average.power,
        impacts: average.impacts,
        stepped: of_case(k),
    });
    Ok(compared.collect())
}

fn findings(compared: &Compared) -> Vec<Finding> {
    let Compared { printed, power, .. } = compared;
    let method = compared.of_the_paper().power;
    let close = |videg: f64, paper: f64| (videg / paper - 1.0).abs() <= printed.tolerance;
    let spurious = "as if an impact were counted at each step of a resting ball, see the row below";
    let verdict = |videg: f64, paper: f64| match (close(videg, paper), close(method, printed.power)) {
        (true, _) => (Verdict::Agrees, String::new()),
        // The paper's own method gives the paper's number: what differs is the method.
        (false, true) => (Verdict::Explained, spurious.to_owned()),
        (false, false) => (Verdict::Differs, String::new()),
    };
    let finding = |quantity: &str, unit: &str, paper: f64, videg: f64| {
        let (verdict, reason) = verdict(videg, paper);
        let place = format!("Table 3, {}", printed.frequency);
        Finding::new(place, quantity, unit, videg).printed(paper).judged(verdict).reason(reason)
    };
    let stepping = |quantity: &str, unit, paper, videg| {
        finding(&format!("{quantity} by the paper's stepping at 1e-5 s"), unit, paper, videg)
            .reason("the method of the paper")
    };
    vec![
        finding("P, Eq. (14)", "W", printed.power, *power),
        finding("power density", "mW/cm^3", printed.density, 1e3 * power / VOLUME),
        stepping("P", "W", printed.power, method),
        stepping("power density", "mW/cm^3", printed.density, 1e3 * method / VOLUME),
    ]
}

fn table(compared: &[Compared]) -> Table {
    let numbers = [
        "P, paper (W)",
        "P, videg (W)",
        "P, paper's stepping at 1e-5 s (W)",
        "density, paper (mW/cm^3)",
        "density, videg (mW/cm^3)",
    ];
    let rows = compared.iter().map(|c| {
        [
            format!("proposed device, {}, A = 5 N, U_in = 2000 V", c.printed.frequency),
            format!("{}", c.printed.power),
            format!("{:.5}", c.power),
            format!("{:.5}", c.of_the_paper().power),
            format!("{}", c.printed.density),
            format!("{:.3}", 1e3 * c.power / VOLUME),
        ]
    });
    let electromagnetic = ["curved electromagnetic system, 2 to 5 Hz [35]", "0.005", "", "", "0.123", ""];
    rows.fold(artefact::table("device", numbers), Table::row).row(electromagnetic)
}

fn sheet(compared: &[Compared]) -> Sheet {
    let columns = std::iter::once("step (s)".to_owned()).chain(compared.iter().flat_map(|c| {
        let f = c.printed.frequency;
        [
            format!("P at {f} by the paper's stepping (W)"),
            format!("impacts at {f} by the paper's stepping"),
            format!("P at {f} by videg (W)"),
            format!("impacts at {f} by videg"),
        ]
    }));
    let row = |(k, step): (usize, &f64)| {
        let of = |c: &Compared| [c.stepped[k].power, c.stepped[k].impacts as f64, c.power, f64::from(c.impacts)];
        std::iter::once(*step).chain(compared.iter().flat_map(of)).collect()
    };
    Sheet::new("table3", columns, steps(compared).iter().enumerate().map(row))
}

/// Those of [`STEPS`] that were taken.
fn steps(compared: &[Compared]) -> &'static [f64] {
    &STEPS[..compared.first().map_or(0, |it| it.stepped.len())]
}

fn picture(compared: &[Compared]) -> Result<Picture, PaperError> {
    let steps = steps(compared);
    let ends = [steps[0], steps[steps.len() - 1]];
    let curves: Vec<_> = compared
        .iter()
        .map(|c| {
            let over_steps = |value: fn(&Stepped) -> f64| -> Vec<_> {
                steps.iter().zip(&c.stepped).map(|(&step, stepped)| (step, value(stepped))).collect()
            };
            let exact = |value: f64| ends.map(|step| (step, value));
            let impacts = (over_steps(|stepped| stepped.impacts as f64), exact(f64::from(c.impacts)));
            ((over_steps(|stepped| stepped.power), exact(c.power)), impacts)
        })
        .collect();
    let mut figure = Figure::new("Table 3: what the step of the paper's method does").columns(2).width(960.0);
    for (letter, (c, ((powers, exact), _))) in ["a", "b"].into_iter().zip(compared.iter().zip(&curves)) {
        figure = figure.panel(
            Panel::new(format!("({letter}) {}", c.printed.frequency), "", "P (W)")
                .log_x()
                .share_x_with_next()
                .line("printed", c.printed.power)
                .series(Series::points("paper's stepping", powers).color(1))
                .series(Series::points("", powers).style(Style::Markers).color(1))
                .series(Series::points("videg, through the FMU", exact).color(0)),
        );
    }
    for (title, (_, (impacts, exact))) in ["(c)", "(d)"].into_iter().zip(&curves) {
        figure = figure.panel(
            Panel::new(title, "time step of the paper's method (s)", "impacts in 50 s")
                .log_x()
                .log_y()
                .series(Series::points("", impacts).color(1))
                .series(Series::points("", impacts).style(Style::Markers).color(1))
                .series(Series::points("", exact).style(Style::Dashed).color(0)),
        );
    }
    let caption = "Power by Eq. (14), and impacts counted, by the paper's Runge-Kutta with a fixed step against the step, and \
                   by the event-driven FMU, which has none: (a, c) 2 Hz, where the ball rests on the membrane for a part of \
                   each cycle, (b, d) 5 Hz, where it does not. A = 5 N, r = 0.5, U_in = 2000 V, 50 to 100 s.";
    Picture::new("table3", &figure, caption)
}
