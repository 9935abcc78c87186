//! Beyond the paper: the load and the net gain of Figure 14 with films that leak.

use videg_circuit::{Ledger, Release, Topology};

use super::coupled::circuit;
use super::tuning::drive;
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study};
use videg_report::{Figure, Panel, Series, Style};

/// Voltage of release, V: the net gain is 1.4 % below that of the best pair, see [`super::tuning`].
const VOLTAGE: f64 = 2000.0;
/// Load resistances, powers of ten of an ohm.
const LOADS: [f64; 2] = [8.0, 12.0];
/// Time constants, powers of ten of a second.
const TIMES: [f64; 2] = [-1.0, 4.0];
/// The best load has changed where it is this part of that without leakage.
const CHANGED: f64 = 0.9;
/// Time constants whose net gain over the load is drawn, powers of ten of a second; both grids have them.
const DRAWN: [f64; 7] = [f64::INFINITY, 2.0, 4.0 / 3.0, 1.0, 2.0 / 3.0, 1.0 / 3.0, 0.0];

/// The best load of films of one time constant.
#[derive(Debug, Clone, Copy)]
struct Best {
    /// s; infinite without leakage
    time_constant: f64,
    /// ohm
    load: f64,
    /// Net gain, W.
    gain: f64,
    /// Into the films, W.
    leakage: f64,
}

/// Net gain over the load, of one time constant.
struct Row {
    /// Power of ten of a second; infinite without leakage.
    exponent: f64,
    power: Vec<Ledger>,
    best: Best,
}

fn spread([from, to]: [f64; 2], count: u32) -> Vec<f64> {
    (0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count - 1)).collect()
}

/// Place of the maximum, in steps from the middle, and its height, on the parabola through three neighbours on a grid.
fn top([a, b, c]: [f64; 3]) -> (f64, f64) {
    let bend = a - 2.0 * b + c;
    let x = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    (x, b - 0.25 * (a - c) * x)
}

impl Row {
    fn new(study: &Study<'_>, loads: &[f64], exponent: f64) -> Result<Self, PaperError> {
        let time_constant = 10.0_f64.powf(exponent);
        let circuits: Vec<_> = loads
            .iter()
            .map(|load| {
                let mut settings = circuit(Topology::Isolated, Release::Switch, VOLTAGE, 10.0_f64.powf(*load));
                settings.circuit.leakage_time_constant = time_constant;
                settings
            })
            .collect();
        let power = drive().run(study, &circuits)?.power;
        let gains: Vec<f64> = power.iter().map(Ledger::surplus).collect();
        let middle = 1..gains.len() - 1;
        let index = middle.max_by(|a, b| gains[*a].total_cmp(&gains[*b])).unwrap_or(1);
        let (shift, gain) = top([gains[index - 1], gains[index], gains[index + 1]]);
        let load = 10.0_f64.powf(loads[index] + shift * (loads[1] - loads[0]));
        Ok(Self { exponent, best: Best { time_constant, load, gain, leakage: power[index].leakage }, power })
    }
}

/// The time constant below which `value` is less than `limit`, by interpolation over its logarithm between `bests`, which
/// fall with their time constants.
fn crossing(bests: &[Best], value: impl Fn(&Best) -> f64, limit: f64) -> Option<f64> {
    let pair = bests.windows(2).find(|pair| value(&pair[0]) >= limit && value(&pair[1]) < limit)?;
    let [(a, x), (b, y)] = [0, 1].map(|k| (value(&pair[k]), pair[k].time_constant.log10()));
    Some(10.0_f64.powf(x + (y - x) * (a - limit) / (a - b)))
}

/// Makes the map of loads and time constants.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let [per_load, per_time] = study.effort.of([41, 31], [21, 16]);
    let loads = spread(LOADS, per_load);
    let mut exponents = spread(TIMES, per_time);
    exponents.reverse();
    exponents.insert(0, f64::INFINITY);
    let rows = study.each(&exponents, |exponent| Row::new(study, &loads, *exponent))?;
    let bests: Vec<Best> = rows.iter().map(|row| row.best).collect();
    Ok(Artefact {
        findings: findings(&bests),
        text: text(&bests),
        tables: Vec::new(),
        pictures: vec![picture(&loads, &rows)?],
        sheets: sheets(&loads, &rows),
    })
}

fn findings(bests: &[Best]) -> Vec<Finding> {
    let finding =
        |quantity: &str, unit: &str, videg: f64| Finding::new("Leakage, case of Figure 14", quantity, unit, videg);
    let Some(tight) = bests.first() else { return Vec::new() };
    let mut findings = vec![
        finding("best load without leakage", "Gohm", 1e-9 * tight.load)
            .reason(format!("net gain {:.1} uW; isolated membranes, ideal switch at 2000 V", 1e6 * tight.gain)),
    ];
    let mut fall = |quantity: &str, value: &dyn Fn(&Best) -> f64, limit: f64| {
        findings.extend(crossing(bests, value, limit).map(|time| finding(quantity, "s", time)));
    };
    fall("time constant at which the best load is 10 % smaller", &|best| best.load / tight.load, CHANGED);
    fall("time constant at which the best load is half", &|best| best.load / tight.load, 0.5);
    fall("time constant at which the net gain is 10 % smaller", &|best| best.gain / tight.gain, CHANGED);
    fall("time constant at which the net gain is half", &|best| best.gain / tight.gain, 0.5);
    fall("time constant below which no load gains", &|best| best.gain, 0.0);
    findings
}

fn text(bests: &[Best]) -> Vec<String> {
    let Some(tight) = bests.first() else { return Vec::new() };
    vec![
        "Each membrane has the conductance C over the time constant beside its capacitance: a film of this product of \
         resistivity and permittivity. The harvester FMU drives all loads of a time constant in one co-simulation of \
         the case of Figure 14, averaged over 20 to 60 s, with isolated membranes and an ideal switch at 2000 V. Best \
         loads are tops of parabolas through three points of the grid."
            .to_owned(),
        format!(
            "What leaks at U_in, U_in^2 C over the time constant for each membrane, the supply has to give. For a time \
             constant of a second this alone is more than the net gain of a tight film, {:.1} uW. Charge that waits for a \
             slow load leaks as well, so that the best load falls together with the net gain.",
            1e6 * tight.gain
        ),
    ]
}

fn picture(loads: &[f64], rows: &[Row]) -> Result<Picture, PaperError> {
    let ohms: Vec<f64> = loads.iter().map(|load| 10.0_f64.powf(*load)).collect();
    let drawn =
        |exponent: &f64| rows.iter().find(|row| row.exponent == *exponent || (row.exponent - exponent).abs() < 1e-9);
    let gains: Vec<(String, Vec<(f64, f64)>)> = DRAWN
        .iter()
        .filter_map(drawn)
        .map(|row| {
            let time = row.best.time_constant;
            let label = if time.is_finite() { format!("{time:.1} s") } else { "no leakage".to_owned() };
            (label, ohms.iter().zip(&row.power).map(|(load, power)| (*load, 1e6 * power.surplus())).collect())
        })
        .collect();
    let over_time = |value: fn(&Best) -> f64| -> Vec<(f64, f64)> {
        let leaking = rows.iter().map(|row| row.best).filter(|best| best.time_constant.is_finite());
        leaking.map(|best| (best.time_constant, value(&best))).collect()
    };
    let (load, gain) = (over_time(|best| 1e-9 * best.load), over_time(|best| 1e6 * best.gain));
    let leakage = over_time(|best| 1e6 * best.leakage);
    let tops: Vec<_> = DRAWN.iter().filter_map(drawn).map(|row| (row.best.load, 1e6 * row.best.gain)).collect();
    let lines = gains.iter().fold(
        Panel::new("(a)", "load (ohm)", "net gain (uW)").height(240.0).log_x().y_range(-200.0, 120.0).line("", 0.0),
        |panel, (label, points)| panel.series(Series::points(label.clone(), points)),
    );
    let figure = Figure::new("Net gain and best load with films that leak")
        .caption("Net gain over the load for several time constants, and the best load and its net gain over the time constant.")
        .panel(lines.series(Series::points("best load", &tops).style(Style::Markers).color(6)))
        .panel(
            Panel::new("(b)", "time constant of the film (s)", "best load (Gohm)")
                .height(160.0)
                .log_x()
                .series(Series::points("", &load)),
        )
        .panel(
            Panel::new("(c)", "time constant of the film (s)", "power (uW)")
                .height(200.0)
                .log_x()
                .y_range(-200.0, 200.0)
                .line("", 0.0)
                .series(Series::points("net gain at the best load", &gain))
                .series(Series::points("into the films", &leakage).style(Style::Dashed)),
        );
    let caption = "Case of Figure 14, 20 to 60 s, isolated membranes, ideal switch at 2000 V: (a) net gain, load less supply, over \
                   the load resistance, (b) the best load and (c) its net gain and leakage over the time constant of the film.";
    Picture::new("leakage", &figure, caption)
}

fn sheets(loads: &[f64], rows: &[Row]) -> Vec<Sheet> {
    let cells = rows.iter().flat_map(|row| {
        let cell = |(load, power): (&f64, &Ledger)| {
            vec![row.best.time_constant, 10.0_f64.powf(*load), 1e6 * power.surplus(), 1e6 * power.leakage]
        };
        loads.iter().zip(&row.power).map(cell).collect::<Vec<_>>()
    });
    let best = rows.iter().map(|row| {
        let Best { time_constant, load, gain, leakage } = row.best;
        vec![time_constant, load, 1e6 * gain, 1e6 * leakage]
    });
    let headings = ["time constant (s)", "load (ohm)", "net gain (uW)", "leakage (uW)"];
    vec![Sheet::new("leakage", headings, cells), Sheet::new("leakage-best", headings, best)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_parabola_is_its_own() {
        let parabola = |x: f64| 3.0 - 2.0 * (x - 0.3) * (x - 0.3);
        let (place, height) = top([parabola(-1.0), parabola(0.0), parabola(1.0)]);
        assert!((place - 0.3).abs() < 1e-12 && (height - 3.0).abs() < 1e-12, "{place} {height}");
    }

    #[test]
    fn a_crossing_lies_between_its_neighbours_in_proportion_to_the_logarithm() {
        let best = |time_constant, gain| Best { time_constant, load: 1.0, gain, leakage: 0.0 };
        let bests = [best(f64::INFINITY, 5.0), best(100.0, 4.0), best(1.0, 0.0)];
        assert!((crossing(&bests, |best| best.gain, 2.0).unwrap() - 10.0).abs() < 1e-9);
        assert!(crossing(&bests, |best| best.gain, -1.0).is_none());
    }
}
