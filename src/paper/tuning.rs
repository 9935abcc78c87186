//! Beyond the paper: what the circuit should be tuned to. Maps of the net power over voltage of release and load.

use videg_circuit::{Release, Topology};

use super::coupled::{Drive, Driven, circuit};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study};
use crate::map::{self, Layers, Map, Plan};
use crate::scenario::{Request, Setting};
use crate::sweep::{Options, Range, Scale, Spread, Vary, system_description};
use videg_report::{Figure, Panel, Series, Style};
use videg_system::temporary::TemporaryFolder;

/// Window of the averages, s: Figure 14 is periodic by then.
const WINDOW: [f64; 2] = [20.0, 60.0];
/// Largest error of C(t) within a communication step, relative to its value: a thousandfold finer one moves the net
/// gain of the better circuit by less than 0.2 %.
const TOLERANCE: f64 = 1e-2;
/// The paper's voltage of release, V (Section 4.1), and a load: the paper gives none.
const PAPER: [f64; 2] = [2000.0, 1e9];
/// Voltages of release, V: up to where no charge is released any more.
const VOLTAGES: [f64; 2] = [2000.0, 4300.0];
/// Load resistances, ohm.
const LOADS: [f64; 2] = [1e7, 1e12];

/// The circuits: the paper's, and the better one. Name, and settings.
const CIRCUITS: [(&str, [(&str, &str); 2]); 2] = [
    ("shared node, Zener: the paper's", [("topology", "sharedNode"), ("release", "zener")]),
    ("isolated membranes, ideal switch", [("topology", "isolated"), ("release", "switch")]),
];

pub(super) fn drive() -> Drive {
    Drive { case: "fig14", settings: Vec::new(), window: WINDOW, tolerance: TOLERANCE }
}

/// The map of a circuit.
struct Tuned {
    name: &'static str,
    plan: Plan,
    map: Map,
}

impl Tuned {
    fn new(study: &Study<'_>, (name, settings): (&'static str, [(&str, &str); 2])) -> Result<Self, PaperError> {
        let description = system_description()?;
        let request = Request {
            case: Some("fig14".to_owned()),
            settings: settings.map(|(name, value)| Setting::new(name, value)).to_vec(),
            until: Some(WINDOW[1]),
            window: Some(WINDOW),
            ..Request::default()
        };
        let [columns, rows] = study.effort.of([47, 26], [24, 11]);
        let axes =
            [axis("zener.voltage", VOLTAGES, columns, Scale::Linear), axis("load.resistance", LOADS, rows, Scale::Log)];
        let plan = Plan::new(map::Request::of_case(&description, request.resolve()?, axes, "net_power"))?;
        let engine = plan.engine()?;
        let folder = TemporaryFolder::new("tuning").map_err(PaperError::Folder)?;
        let options = Options::new(&plan.sweep, &engine, folder.path());
        let map = map::run(&plan, &options, study.observer)?.map.ok_or(PaperError::Stopped)?;
        Ok(Self { name, plan, map })
    }

    /// Net power, uW, of the cells of a row, from the smallest load on.
    fn row(&self, row: usize) -> impl Iterator<Item = f64> {
        let columns = self.plan.axes[0].count;
        let cells = self.map.cells.iter().skip(row * columns).take(columns);
        cells.map(|cell| 1e6 * self.plan.number(cell, "net_power"))
    }

    /// Voltage, V, and net power, uW, of the best cell at the smallest load: the load of the closed form.
    fn quick(&self) -> [f64; 2] {
        let cells = self.plan.axes[0].values().into_iter().zip(self.row(0));
        cells.max_by(|a, b| a.1.total_cmp(&b.1)).map_or([f64::NAN; 2], |(voltage, gain)| [voltage, gain])
    }

    /// Cut through the map at the last load of the grid that is not above `load`, ohm: kV and uW.
    fn cut(&self, load: f64) -> Vec<(f64, f64)> {
        let row = self.plan.axes[1].values().iter().rposition(|other| *other <= 1.001 * load).unwrap_or_default();
        self.plan.axes[0].values().into_iter().map(|voltage| 1e-3 * voltage).zip(self.row(row)).collect()
    }
}

fn axis(name: &str, [from, to]: [f64; 2], count: u64, scale: Scale) -> Vary {
    Vary::new(name, Spread::Range(Range { from, to, count: Some(count), scale }))
}

/// Makes the maps.
pub fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let maps = [Tuned::new(study, CIRCUITS[0])?, Tuned::new(study, CIRCUITS[1])?];
    let at_paper = circuit(Topology::SharedNode, Release::Zener, PAPER[0], PAPER[1]);
    let driven = drive().run(study, &[at_paper])?;
    Ok(Artefact {
        findings: findings(&maps, &driven),
        text: text(&maps, &driven),
        tables: Vec::new(),
        pictures: vec![picture(&maps)?, cuts(&maps, &driven)?],
        sheets: maps.iter().zip(["paper", "isolated-switch"]).map(|(map, name)| sheet(map, name)).collect(),
    })
}

fn findings(maps: &[Tuned; 2], driven: &Driven) -> Vec<Finding> {
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
    for Tuned { name, map, .. } in maps {
        let (gain, [voltage, load]) = (1e6 * map.best.value, map.best.at);
        let released = if gain > 0.01 { "the best point of the map" } else { "where hardly anything is released" };
        findings.push(
            finding(&format!("largest net gain, {name}"), "uW", gain)
                .reason(format!("at {voltage:.0} V and {load:.1e} ohm, {released}")),
        );
    }
    let [_, better] = maps;
    let [voltage, gain] = better.quick();
    let best = driven.impacts.best_voltage(0.0);
    let largest = driven.impacts.largest_gain(0.0);
    findings.extend([
        finding("best voltage of a quick release, isolated membranes", "V", voltage).reason(format!(
            "closed form U_in (C3/C2 + 1)/2: {best:.0} V, where it gives {:.2} uW; the map: {gain:.2} uW",
            1e6 * driven.impacts.quick_release(best, 0.0)
        )),
        finding("largest net gain, isolated, over the bound of the closed form", "1", better.map.best.value / largest)
            .reason(format!(
                "bound: {:.1} uW, constant charge up to U_DE4, then slow discharge at C2, for each impact",
                1e6 * largest
            )),
    ]);
    findings
}

fn text(maps: &[Tuned; 2], driven: &Driven) -> Vec<String> {
    let [_, better] = maps;
    let (gain, [voltage, load]) = (1e6 * better.map.best.value, better.map.best.at);
    vec![
        "Net gain is the net power: what the load gets less what the supply gives, and the change of what is stored. The maps are those \
         of videg map for the case of Figure 14, averaged over 20 to 60 s; diodes and switches are ideal. The best point is refined \
         beyond the grid."
            .to_owned(),
        "The paper's circuit gains next to nothing anywhere: its Zener burns U_z for each charge that passes, for which the supply gave \
         U_in, and U_z is at least U_in. What is left for the load, U_DE4 - U_z, would have to exceed U_in. The best \
         that can be done with it is not to release at all."
            .to_owned(),
        format!(
            "The closed form U_in (C3/C2 + 1)/2 = {:.0} V is for a load that takes the charge as fast as the \
             membrane gives it, at the voltage of release. A larger load lets the voltage rise to U_DE4 first and \
             takes the charge slowly, from above: with {load:.1e} ohm, behind a switch at {voltage:.0} V, the gain is \
             {gain:.1} uW in place of {:.1} uW. A still larger load does not get the charge before the next impact.",
            driven.impacts.best_voltage(0.0),
            better.quick()[1]
        ),
    ]
}

fn picture(maps: &[Tuned; 2]) -> Result<Picture, PaperError> {
    let [paper, better] = maps.each_ref().map(|tuned| Layers::new(&tuned.plan, &tuned.map));
    let at_paper = [(PAPER[0], PAPER[1])];
    // Where a circuit gains nothing, no point is the best.
    let marked = Series::points("2000 V, 1 Gohm", &at_paper).style(Style::Pins).color(1);
    let figure = Figure::new("Net power over voltage of release and load")
        .caption("Maps of the net power of two circuits over voltage of release and load resistance.")
        .columns(2)
        .width(1000.0)
        .panel(paper.ground(maps[0].name).height(300.0).series(marked))
        .panel(better.panel(maps[1].name).height(300.0));
    let caption = "Net power of the paper's circuit and of the better one, case of Figure 14, 20 to 60 s. The paper's voltage of release \
                   is 2000 V; it gives no load.";
    Picture::new("tuning", &figure, caption)
}

/// Cuts through the maps beside the closed form.
fn cuts(maps: &[Tuned; 2], driven: &Driven) -> Result<Picture, PaperError> {
    let closed: Vec<_> = (0..=230)
        .map(|k| 2000.0 + 10.0 * f64::from(k))
        .map(|voltage| (1e-3 * voltage, 1e6 * driven.impacts.quick_release(voltage, 0.0)))
        .collect();
    let [paper, better] = maps;
    let curves = [
        ("isolated, switch, best load", better.cut(better.map.grid_best.at[1]), Style::Line),
        ("isolated, switch, 10 Mohm", better.cut(LOADS[0]), Style::Markers),
        ("closed form of a quick release", closed, Style::Dashed),
        ("paper's circuit, 1 Gohm", paper.cut(PAPER[1]), Style::Line),
    ];
    let panel = curves.iter().fold(
        Panel::new("", "voltage of release (kV)", "net power (uW)").height(260.0).line("", 0.0),
        |panel, (label, points, style)| panel.series(Series::points(*label, points).style(*style)),
    );
    let figure = Figure::new("Net power over the voltage of release")
        .caption("Cuts through the maps of the net power, beside the closed form.")
        .panel(panel);
    let caption = "Net power over the voltage of release, case of Figure 14, 20 to 60 s. The closed form (C3 U_in - C2 \
                   U_r)(U_r - U_in), summed over the impacts, is that of a load that takes the charge at once.";
    Picture::new("tuning-cuts", &figure, caption)
}

fn sheet(tuned: &Tuned, name: &str) -> Sheet {
    let [voltages, loads] = tuned.plan.axes.each_ref().map(map::Axis::values);
    let cells = loads.iter().flat_map(|&load| voltages.iter().map(move |&voltage| (voltage, load)));
    let gain = |cell| 1e6 * tuned.plan.number(cell, "net_power");
    let rows = cells.zip(&tuned.map.cells).map(|((voltage, load), cell)| vec![voltage, load, gain(cell)]);
    Sheet::new(format!("tuning-{name}"), ["voltage of release (V)", "load (ohm)", "net gain (uW)"], rows)
}
