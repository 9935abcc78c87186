//! Beyond the paper: what the circuit should be tuned to. Net gain over voltage of release and load.

use videg_circuit::{Release, Settings, Topology};

use super::coupled::{Drive, Driven, circuit};
use super::{Artefact, Effort, Finding, PaperError, Picture, Sheet, Study};
use videg_report::{Figure, HeatMap, Panel, Scale, Series, Style};

/// Window of the averages, s: Figure 14 is periodic by then.
const WINDOW: [f64; 2] = [20.0, 60.0];
/// Largest error of C(t) within a communication step, relative to its value: a thousandfold finer one moves the net
/// gain of the better circuit by less than 0.2 %.
const TOLERANCE: f64 = 1e-2;
/// The paper's voltage of release, V (Section 4.1), and a load: the paper gives none.
const PAPER: [f64; 2] = [2000.0, 1e9];
/// Voltages of release, V: up to where no charge is released any more.
const VOLTAGES: [f64; 2] = [2000.0, 4300.0];
/// Load resistances, powers of ten of an ohm.
const DECADES: [f64; 2] = [7.0, 12.0];

/// The circuits: the paper's, and the better one.
const CIRCUITS: [(&str, Topology, Release); 2] = [
    ("shared node, Zener: the paper's", Topology::SharedNode, Release::Zener),
    ("isolated membranes, ideal switch", Topology::Isolated, Release::Switch),
];

/// The axes of the maps.
struct Grid {
    voltages: Vec<f64>,
    loads: Vec<f64>,
}

impl Grid {
    fn new(effort: Effort) -> Self {
        let [columns, rows] = effort.of([47_u32, 26], [24, 11]);
        let spread = |[from, to]: [f64; 2], count: u32| {
            (0..count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count - 1))
        };
        let loads = spread(DECADES, rows).map(|exponent| 10.0_f64.powf(exponent)).collect();
        Self { voltages: spread(VOLTAGES, columns).collect(), loads }
    }

    /// Net gain, uW, of each cell, row by row from the smallest load.
    fn gains(&self, study: &Study<'_>, kind: (Topology, Release)) -> Result<Vec<f64>, PaperError> {
        let rows: Vec<Vec<Settings>> = self
            .loads
            .iter()
            .map(|&load| self.voltages.iter().map(|&voltage| circuit(kind.0, kind.1, voltage, load)).collect())
            .collect();
        let driven = study.each(&rows, |circuits| drive().run(study, circuits))?;
        Ok(driven.iter().flat_map(|driven| &driven.power).map(|power| 1e6 * power.surplus()).collect())
    }
}

pub(super) fn drive() -> Drive {
    Drive { case: "fig14", settings: Vec::new(), window: WINDOW, tolerance: TOLERANCE }
}

/// A map and its best point.
struct Map {
    name: &'static str,
    topology: Topology,
    gains: Vec<f64>,
    /// Voltage, V, load, ohm, and net gain, uW.
    best: [f64; 3],
    /// The same of the quickest release alone, the load that the closed form stands for.
    quick: [f64; 3],
}

impl Map {
    fn new(study: &Study<'_>, grid: &Grid, index: usize) -> Result<Self, PaperError> {
        let (name, topology, release) = CIRCUITS[index];
        let gains = grid.gains(study, (topology, release))?;
        let columns = grid.voltages.len();
        let cell = |(k, gain): (usize, &f64)| [grid.voltages[k % columns], grid.loads[k / columns], *gain];
        let top = |gains: &[f64]| {
            gains.iter().enumerate().map(cell).max_by(|a, b| a[2].total_cmp(&b[2])).unwrap_or([f64::NAN; 3])
        };
        let (best, quick) = (top(&gains), top(&gains[..columns]));
        Ok(Self { name, topology, gains, best, quick })
    }
}

/// Makes the maps.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let grid = Grid::new(study.effort);
    let maps = [Map::new(study, &grid, 0)?, Map::new(study, &grid, 1)?];
    let at_paper = CIRCUITS.map(|(_, topology, release)| circuit(topology, release, PAPER[0], PAPER[1]));
    let driven = drive().run(study, &at_paper)?;
    Ok(Artefact {
        findings: findings(&maps, &driven),
        text: text(&maps, &driven),
        tables: Vec::new(),
        pictures: vec![picture(&grid, &maps)?, cuts(&grid, &maps, &driven)?],
        sheets: maps.iter().map(|map| sheet(&grid, map)).collect(),
    })
}

fn findings(maps: &[Map; 2], driven: &Driven) -> Vec<Finding> {
    let finding =
        |quantity: &str, unit: &str, videg: f64| Finding::new("Tuning, case of Figure 14", quantity, unit, videg);
    let mut findings = Vec::new();
    if let Some(power) = driven.power.first() {
        findings.push(finding("net gain of the paper's circuit", "uW", 1e6 * power.surplus()).reason(format!(
            "at U_z = 2000 V and 1 Gohm; P of Eq. (14) is {:.1} uW, but the Zener burns {:.1} uW of the supply's",
            1e6 * driven.eq14,
            1e6 * power.zener
        )));
    }
    for map in maps {
        let [voltage, load, gain] = map.best;
        let released = if gain > 0.01 { "the best point of the map" } else { "where hardly anything is released" };
        findings.push(
            finding(&format!("largest net gain, {}", map.name), "uW", gain)
                .reason(format!("at {voltage:.0} V and {load:.1e} ohm, {released}")),
        );
    }
    let [_, better] = maps;
    let best = driven.best_voltage(0.0);
    let largest = 1e6 * driven.largest_gain();
    findings.extend([
        finding("best voltage of a quick release, isolated membranes", "V", better.quick[0]).reason(format!(
            "closed form U_in (C3/C2 + 1)/2: {best:.0} V, where it gives {:.2} uW; the map: {:.2} uW",
            1e6 * driven.quick_release(best, 0.0),
            better.quick[2]
        )),
        finding("largest net gain, isolated, over the bound of the closed form", "1", better.best[2] / largest).reason(
            format!("bound: {largest:.1} uW, constant charge up to U_DE4, then slow discharge at C2, for each impact"),
        ),
    ]);
    findings
}

fn text(maps: &[Map; 2], driven: &Driven) -> Vec<String> {
    let [_, better] = maps;
    let ([voltage, load, gain], closed) = (better.best, driven.best_voltage(0.0));
    vec![
        "Net gain is what the load gets less what the supply gives. The harvester FMU drives all circuits of a row of \
         the map in one co-simulation of the case of Figure 14, averaged over 20 to 60 s; diodes and switches are \
         ideal. C(t) does not depend on the circuit."
            .to_owned(),
        "The paper's circuit gains next to nothing anywhere: its Zener burns U_z for each charge that passes, for which the supply gave \
         U_in, and U_z is at least U_in. What is left for the load, U_DE4 - U_z, would have to exceed U_in. The best \
         that can be done with it is not to release at all."
            .to_owned(),
        format!(
            "The closed form U_in (C3/C2 + 1)/2 = {closed:.0} V is for a load that takes the charge as fast as the \
             membrane gives it, at the voltage of release. A larger load lets the voltage rise to U_DE4 first and \
             takes the charge slowly, from above: with {load:.1e} ohm, behind a switch at {voltage:.0} V, the gain is \
             {gain:.1} uW in place of {:.1} uW. A still larger load does not get the charge before the next impact.",
            better.quick[2]
        ),
    ]
}

fn picture(grid: &Grid, maps: &[Map; 2]) -> Result<Picture, PaperError> {
    let kilovolts: Vec<f64> = grid.voltages.iter().map(|voltage| 1e-3 * voltage).collect();
    let at = |voltage: f64, load: f64| vec![(1e-3 * voltage, load)];
    let paper = at(PAPER[0], PAPER[1]);
    let best: Vec<_> = maps.iter().map(|map| at(map.best[0], map.best[1])).collect();
    let mut figure = Figure::new("Net gain over voltage of release and load")
        .caption("Maps of the net gain of two circuits over voltage of release and load resistance.")
        .columns(2)
        .width(960.0);
    for (map, best) in maps.iter().zip(&best) {
        let scale = Scale::Quantity("net gain (uW)".to_owned());
        let mut panel = Panel::new(map.name, "voltage of release (kV)", "load (ohm)")
            .height(300.0)
            .log_y()
            .map(HeatMap { xs: &kilovolts, ys: &grid.loads, values: &map.gains, scale });
        // Where a circuit gains nothing, no point is the best.
        panel = match map.topology {
            Topology::SharedNode => {
                panel.series(Series::points("2000 V, 1 Gohm", &paper).style(Style::Crosses).color(1))
            }
            Topology::Isolated => panel.series(Series::points("best", best).style(Style::Markers).color(0)),
        };
        figure = figure.panel(panel);
    }
    let caption = "Net gain, load less supply, of the paper's circuit and of the better one, case of Figure 14, 20 to \
                   60 s. The paper's voltage of release is 2000 V; it gives no load.";
    Picture::new("tuning", &figure, caption)
}

/// Cuts through the maps beside the closed form.
fn cuts(grid: &Grid, maps: &[Map; 2], driven: &Driven) -> Result<Picture, PaperError> {
    let columns = grid.voltages.len();
    let cut = |map: &Map, load: f64| -> Vec<(f64, f64)> {
        let row = grid.loads.iter().position(|&other| other >= load).unwrap_or_default();
        let gains = map.gains.chunks(columns).nth(row).unwrap_or_default();
        grid.voltages.iter().zip(gains).map(|(voltage, gain)| (1e-3 * voltage, *gain)).collect()
    };
    let closed: Vec<_> = (0..=230)
        .map(|k| 2000.0 + 10.0 * f64::from(k))
        .map(|voltage| (1e-3 * voltage, 1e6 * driven.quick_release(voltage, 0.0)))
        .collect();
    let [paper, better] = maps;
    let curves = [
        ("isolated, switch, best load", cut(better, better.best[1]), Style::Line),
        ("isolated, switch, 10 Mohm", cut(better, grid.loads[0]), Style::Markers),
        ("closed form of a quick release", closed, Style::Dashed),
        ("paper's circuit, 1 Gohm", cut(paper, PAPER[1]), Style::Line),
    ];
    let panel = curves.iter().fold(
        Panel::new("", "voltage of release (kV)", "net gain (uW)").height(260.0).line("", 0.0),
        |panel, (label, points, style)| panel.series(Series::points(*label, points).style(*style)),
    );
    let figure = Figure::new("Net gain over the voltage of release")
        .caption("Cuts through the maps of the net gain, beside the closed form.")
        .panel(panel);
    let caption = "Net gain over the voltage of release, case of Figure 14, 20 to 60 s. The closed form (C3 U_in - C2 \
                   U_r)(U_r - U_in), summed over the impacts, is that of a load that takes the charge at once.";
    Picture::new("tuning-cuts", &figure, caption)
}

fn sheet(grid: &Grid, map: &Map) -> Sheet {
    let cells = grid.loads.iter().flat_map(|&load| grid.voltages.iter().map(move |&voltage| (voltage, load)));
    let rows = cells.zip(&map.gains).map(|((voltage, load), gain)| vec![voltage, load, *gain]);
    let kind = if map.topology == Topology::Isolated { "isolated-switch" } else { "paper" };
    Sheet::new(format!("tuning-{kind}"), ["voltage of release (V)", "load (ohm)", "net gain (uW)"], rows)
}
