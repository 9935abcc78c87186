//! Beyond the paper: power and power density against the electromagnetic harvester of Section 5.3, by Eq. (14) and by
//! what a user gains.

use videg_circuit::{Release, Topology};
use videg_model::{Case, Limit, Membrane};

use super::coupled::{Drive, circuit};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study, VOLUME, WINDOW, artefact};
use videg_report::{Figure, Panel, Series, Table};

/// Cases of Table 3, and what the paper calls them.
const CASES: [(&str, &str); 2] = [("table3-2hz", "2 Hz"), ("table3-5hz", "5 Hz")];
/// Largest error of C(t) within a communication step, relative to its value: a thousandfold finer one moves the net
/// gains by 0.2 % at most.
const TOLERANCE: f64 = 1e-2;
/// Power density of the electromagnetic harvester, mW/cm^3 (Section 5.3).
const ELECTROMAGNETIC: f64 = 0.123;

/// `U_in`, V, of all cases.
const BIAS: f64 = 2000.0;

/// Name of the circuit whose voltages the film withstands.
const BEARABLE: &str = "net gain, isolated, switch at what the film stands";
/// Rows that are drawn, those whose voltages the film stands, and their names below the bars.
const DRAWN: [(&str, &str); 3] = [("Eq. (14)", "Eq. (14)"), (NO_LOAD, "paper's circuit"), (BEARABLE, "switch")];
/// The paper's circuit with a load that takes the charge at once.
const NO_LOAD: &str = "net gain, paper's circuit, 10 kohm";
/// Name of the row that is no electrical power.
const LOST: &str = "for comparison: what the membranes take from the ball";

/// One way to count the power of a case.
struct Count {
    name: &'static str,
    /// W.
    power: f64,
    /// Highest voltage that it takes, V.
    voltage: f64,
}

impl Count {
    /// mW/cm^3.
    fn density(&self) -> f64 {
        1e3 * self.power / VOLUME
    }
}

/// Makes the comparison.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let counts = study.each(&CASES, |(case, _)| counts(study, case))?;
    let bearable = |counts: &[Count]| voltage_of(counts, BEARABLE);
    // U_DE4 / U_in = C3 / C2, Eq. (12).
    let highest = counts.iter().flatten().map(|count| count.voltage).fold(0.0, f64::max) / BIAS;
    Ok(Artefact {
        findings: CASES
            .iter()
            .zip(&counts)
            .flat_map(|((_, name), counts)| findings(name, counts, bearable(counts)))
            .collect(),
        text: text(&CASES.iter().zip(&counts).map(|((_, name), c)| (*name, bearable(c))).collect::<Vec<_>>(), highest),
        tables: vec![table(&counts)],
        pictures: vec![picture(&counts)?],
        sheets: vec![sheet(&counts)],
    })
}

fn voltage_of(counts: &[Count], name: &str) -> f64 {
    counts.iter().find(|count| count.name == name).map_or(f64::NAN, |count| count.voltage)
}

/// The highest voltage of release, V, at which the film of `case` does not break down after an impact that multiplies
/// its capacitance by `ratio`, by the bounds commonly quoted for VHB 4910.
///
/// On constant charge U grows as the area falls, U = `U_in` (`A_3` / A)^2, so a switch opens while the film is still
/// stretched; there the field is the highest, as it falls with the area under a voltage that is held.
fn bearable_voltage(case: &str, ratio: f64) -> f64 {
    let Some(case) = Case::find(case) else { return f64::NAN };
    let membrane = Membrane::new(&(case.parameters)());
    let breaks_down = |voltage: f64| {
        let area = (ratio * BIAS / voltage).sqrt().max(1.0);
        membrane.excesses(deflection(&membrane, area), voltage, 0.0).any(|excess| excess.limit == Limit::Field)
    };
    last([BIAS, BIAS * ratio], |voltage| !breaks_down(voltage))
}

/// The last value between `low` and `high` at which `is_below`, by bisection.
fn last([mut low, mut high]: [f64; 2], is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_below(middle) { low = middle } else { high = middle }
    }
    low
}

/// Deflection, m, at which the area of `membrane` has grown by the factor `area`.
fn deflection(membrane: &Membrane, area: f64) -> f64 {
    let is_below = |deflection| membrane.area_ratio(deflection) < area;
    let mut high = membrane.radius();
    while is_below(high) {
        high *= 2.0;
    }
    last([0.0, high], is_below)
}

/// The power of `case` in different circuits.
fn counts(study: &Study<'_>, case: &'static str) -> Result<Vec<Count>, PaperError> {
    let drive = Drive { case, settings: Vec::new(), window: WINDOW, tolerance: TOLERANCE };
    let ahead = drive.run(study, &[])?;
    let best = ahead.impacts.best_voltage(0.0);
    let bearable = bearable_voltage(case, ahead.impacts.highest_voltage() / BIAS);
    let kinds = [
        ("net gain, paper's circuit, 1 Gohm", Topology::SharedNode, Release::Zener, BIAS, 1e9),
        (NO_LOAD, Topology::SharedNode, Release::Zener, BIAS, 1e4),
        ("net gain, isolated, switch at its best voltage", Topology::Isolated, Release::Switch, best, 1e6),
        (BEARABLE, Topology::Isolated, Release::Switch, bearable, 1e6),
    ];
    let circuits = kinds.map(|(_, topology, release, voltage, load)| circuit(topology, release, voltage, load));
    let driven = drive.run(study, &circuits)?;
    let eq14 = Count { name: "Eq. (14)", power: driven.eq14, voltage: driven.impacts.highest_voltage() };
    let net = kinds.iter().zip(driven.power.iter().zip(&driven.peaks));
    let net = net.map(|(kind, (power, peak))| Count { name: kind.0, power: power.surplus(), voltage: *peak });
    let lost = Count { name: LOST, power: loss(study, case)?, voltage: f64::NAN };
    Ok(std::iter::once(eq14).chain(net).chain([lost]).collect())
}

/// Power that the membranes take from the ball, W: the FMU adds up (1 - r^2) m v^2 / 2.
fn loss(study: &Study<'_>, case: &str) -> Result<f64, PaperError> {
    let mut instance = study.start(&Study::case(case)?)?;
    let [from, to] = WINDOW;
    instance.do_step(0.0, from)?;
    let [start] = study.reals(&instance, ["energy.impactLoss"])?;
    instance.do_step(from, to - from)?;
    let [end] = study.reals(&instance, ["energy.impactLoss"])?;
    Ok((end - start) / (to - from))
}

fn findings(case: &str, counts: &[Count], bearable: f64) -> Vec<Finding> {
    let finding = |count: &Count| {
        let over = count.density() / ELECTROMAGNETIC;
        let strength = if count.voltage > 1.001 * bearable { "above" } else { "within" };
        let times = format!("{over:.1} times the electromagnetic {ELECTROMAGNETIC} mW/cm^3, ");
        let (times, voltage) = (if over > 0.0 { times } else { String::new() }, 1e-3 * count.voltage);
        let stands = 1e-3 * bearable;
        let quantity = format!("power density, {}", count.name);
        Finding::new(format!("Section 5.3, {case}"), quantity, "mW/cm^3", count.density())
            .reason(format!("{times}at up to {voltage:.1} kV, {strength} the {stands:.1} kV that the film stands"))
    };
    counts.iter().skip(1).filter(|count| count.name != LOST).map(finding).collect()
}

/// `bearable`: cases and the voltages that their films stand, V; `highest`: the largest C3/C2.
fn text(bearable: &[(&str, f64)], highest: f64) -> Vec<String> {
    let bearable: Vec<_> =
        bearable.iter().map(|(case, voltage)| format!("{:.1} kV at {case}", 1e-3 * voltage)).collect();
    vec![
        format!(
            "Table 3 takes P of Eq. (14) for what the harvester puts out. What a user gains is what the load gets less \
             what the supply gives; here both stand side by side, for a volume of {VOLUME} cm^3, averaged over {} to \
             {} s. C(t) is resolved to {:.0} % by a communication step that adapts.",
            WINDOW[0],
            WINDOW[1],
            100.0 * TOLERANCE
        ),
        format!(
            "Mind the voltages. C3/C2 goes up to {highest:.0}, an area ratio of {:.1}, and constant charge would reach \
             {:.0} kV. A switch opens while the film is still stretched, where the field is the highest: the film stands \
             {} (bounds commonly quoted for VHB 4910; at that area it would have ruptured, which is left aside). With a \
             load of 1 Gohm even the paper's circuit gains, because its membranes rise far above the Zener voltage and \
             what they stand; with one of 10 kohm, which takes the charge at U_z as Section 4.1 has it, it loses.",
            highest.sqrt(),
            1e-3 * BIAS * highest,
            bearable.join(", ")
        ),
        "The circuits do not act back on the ball here (impulsive contacts, as in the paper). The last but one row of \
         the table is what the membranes take from the ball: a circuit that gains as much as that would change the \
         motion, and its number is no more than a bound."
            .to_owned(),
    ]
}

fn table(counts: &[Vec<Count>]) -> Table {
    let numbers = CASES.iter().flat_map(|(_, case)| {
        ["power (mW)", "density (mW/cm^3)", "highest voltage (kV)"].map(|what| format!("{case}: {what}"))
    });
    let rows = (0..counts.first().map_or(0, Vec::len)).map(|row| {
        let name = counts.first().and_then(|counts| counts.get(row)).map_or("", |count| count.name);
        let cells = counts.iter().filter_map(|counts| counts.get(row)).flat_map(|count| {
            let voltage = if count.voltage.is_nan() { String::new() } else { format!("{:.1}", 1e-3 * count.voltage) };
            [format!("{:.2}", 1e3 * count.power), format!("{:.3}", count.density()), voltage]
        });
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>()
    });
    let density = ELECTROMAGNETIC.to_string();
    let electromagnetic = ["electromagnetic harvester, as the paper quotes it", "", &density, "", "", &density, ""];
    rows.fold(artefact::table("counted as", numbers), Table::row).row(electromagnetic)
}

/// Two limits of a bar's area, and the corners of its outline.
type Bar = ([(f64, f64, f64); 2], [(f64, f64); 5]);

/// A bar from 0 to `height` at place number `place`.
fn bar(place: usize, height: f64) -> Bar {
    let [left, right] = [-0.35, 0.35].map(|offset| place as f64 + 1.0 + offset);
    let area = [left, right].map(|x| (x, height.min(0.0), height.max(0.0)));
    (area, [(left, 0.0), (left, height), (right, height), (right, 0.0), (left, 0.0)])
}

fn picture(counts: &[Vec<Count>]) -> Result<Picture, PaperError> {
    let drawn = |counts: &Vec<Count>| {
        let density = |name: &str| counts.iter().find(|count| count.name == name).map_or(f64::NAN, Count::density);
        DRAWN.iter().enumerate().map(|(place, (name, _))| bar(place, density(name))).collect::<Vec<_>>()
    };
    let bars: Vec<_> = counts.iter().map(drawn).collect();
    let mut figure = Figure::new("Power density")
        .caption("Bars of the power density, counted in three ways, for both cases of Table 3.")
        .columns(2)
        .width(960.0);
    for ((_, name), bars) in CASES.iter().zip(&bars) {
        let mut panel = Panel::new(*name, "", "power density (mW/cm^3)")
            .height(260.0)
            .x_range(0.4, DRAWN.len() as f64 + 0.6)
            .x_names(DRAWN.iter().enumerate().map(|(place, (_, label))| (place as f64 + 1.0, *label)))
            .line("electromagnetic", ELECTROMAGNETIC);
        for (color, (area, outline)) in bars.iter().enumerate() {
            panel = panel.band("", area, color).series(Series::points("", outline).color(color));
        }
        figure = figure.panel(panel);
    }
    let caption = "Power density of the cases of Table 3 by Eq. (14), and as net gain in circuits whose voltages the film \
                   stands: the paper's into 10 kohm, and isolated membranes with a switch that opens just below the voltage \
                   at which the film breaks down; dashed: the electromagnetic harvester of the paper's comparison, 0.123 \
                   mW/cm^3. The other circuits stand in the table.";
    Picture::new("power", &figure, caption)
}

fn sheet(counts: &[Vec<Count>]) -> Sheet {
    let columns = ["f0 (Hz)", "row of the table (1)", "power (W)", "density (mW/cm^3)", "highest voltage (V)"];
    let rows = counts.iter().zip([2.0, 5.0]).flat_map(|(counts, frequency)| {
        let row = move |(index, count): (usize, &Count)| {
            vec![frequency, (index + 1) as f64, count.power, count.density(), count.voltage]
        };
        counts.iter().enumerate().map(row)
    });
    Sheet::new("power", columns, rows)
}
