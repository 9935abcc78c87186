//! Table 1: the stages of a membrane, with numbers.

use std::f64::consts::PI;

use videg_model::VACUUM_PERMITTIVITY;

use super::peak::{self, CASE, WHEN};
use super::{Artefact, Finding, PaperError, Picture, Sheet, Study, artefact};
use videg_report::{Figure, Panel, Series, Style, Table};

/// A stage in numbers, SI.
struct Stage {
    /// NaN where the membrane is no disc.
    radius: f64,
    area: f64,
    thickness: f64,
    capacitance: f64,
    voltage: f64,
}

/// Makes the table.
pub(super) fn make(study: &Study<'_>) -> Result<Artefact, PaperError> {
    let stages = stages(study)?;
    let [first, second, third, fourth] = &stages;
    let printed = |quantity: &str, paper: f64, videg: f64| {
        Finding::new("Section 2.2", quantity, "mm", videg).printed(paper).agrees_if((videg - paper).abs() < 1e-9)
    };
    let findings = vec![
        printed("R_2 = lambda R_1", 6.3, 1e3 * second.radius),
        printed("h_2 = h_1 / lambda^2", 0.25, 1e3 * second.thickness),
        Finding::new("Table 1", "largest U_DE4 of fig14, Eq. (12)", "V", fourth.voltage)
            .reason("the paper's table has symbols only"),
    ];
    let volume_kept =
        [second, third].iter().all(|s| (s.area * s.thickness / (first.area * first.thickness) - 1.0).abs() < 1e-9);
    let text = vec![
        format!(
            "Stage 3 is the largest impact of {CASE} between {} and {} s, as the FMU gives it (deflection, area ratio and \
             capacitance at the peak). The volume A h is the same in all stages{}.",
            WHEN[0],
            WHEN[1],
            if volume_kept { " to nine digits" } else { ", but not here" },
        ),
        format!(
            "Capacitances use the vacuum permittivity of CODATA 2022, {VACUUM_PERMITTIVITY:e} F/m, where the paper has \
             8.85e-12 F/m (0.05 % less), and the relative permittivity 3.4 that it gives in Section 5.3 only. Voltages do \
             not depend on either."
        ),
    ];
    Ok(Artefact {
        findings,
        text,
        tables: vec![table(&stages)],
        pictures: vec![picture(&stages)?],
        sheets: vec![sheet(&stages)],
    })
}

fn stages(study: &Study<'_>) -> Result<[Stage; 4], PaperError> {
    let instance = study.start(&Study::case(CASE)?)?;
    let [r1, h1, r2, h2, c2, permittivity, bias] = study.reals(
        &instance,
        [
            "membrane.initialRadius",
            "membrane.initialThickness",
            "membrane.radius",
            "membrane.thickness",
            "membrane.restCapacitance",
            "membrane.relativePermittivity",
            "biasVoltage",
        ],
    )?;
    let peak = peak::stage_3(study)?;
    let (a1, a2) = (PI * r1 * r1, PI * r2 * r2);
    let stages = [
        [r1, a1, h1, VACUUM_PERMITTIVITY * permittivity * a1 / h1, 0.0],
        [r2, a2, h2, c2, bias],
        [f64::NAN, peak.area_ratio * a2, h2 / peak.area_ratio, peak.capacitance, bias],
        [r2, a2, h2, c2, peak.capacitance / c2 * bias],
    ];
    Ok(stages.map(|[radius, area, thickness, capacitance, voltage]| Stage {
        radius,
        area,
        thickness,
        capacitance,
        voltage,
    }))
}

/// A heading with unit, and the value under it.
type StageColumn = (&'static str, fn(&Stage) -> f64);

const COLUMNS: [StageColumn; 6] = [
    ("radius (mm)", |s| 1e3 * s.radius),
    ("area (mm^2)", |s| 1e6 * s.area),
    ("thickness (mm)", |s| 1e3 * s.thickness),
    ("capacitance (pF)", |s| 1e12 * s.capacitance),
    ("voltage (V)", |s| s.voltage),
    ("charge (nC)", |s| 1e9 * (s.capacitance * s.voltage)),
];

fn table(stages: &[Stage; 4]) -> Table {
    let names = ["1: as made", "2: pre-stretched, at U_in", "3: pressed in, at U_in", "4: recovered, charge kept"];
    stages.iter().zip(names).fold(artefact::table("stage", COLUMNS.map(|(name, _)| name)), |table, (stage, name)| {
        let cell = |value: f64| if value.is_nan() { String::new() } else { format!("{value:.4}") };
        table.row(std::iter::once(name.to_owned()).chain(COLUMNS.iter().map(|(_, value)| cell(value(stage)))))
    })
}

fn sheet(stages: &[Stage; 4]) -> Sheet {
    let columns = std::iter::once("stage").chain(COLUMNS.iter().map(|(name, _)| *name));
    let row = |(k, stage): (usize, &Stage)| {
        std::iter::once(k as f64 + 1.0).chain(COLUMNS.iter().map(|(_, value)| value(stage))).collect()
    };
    Sheet::new("table1", columns, stages.iter().enumerate().map(row))
}

fn picture(stages: &[Stage; 4]) -> Result<Picture, PaperError> {
    let points = COLUMNS.map(|(_, value)| {
        stages.iter().enumerate().map(|(k, stage)| (k as f64 + 1.0, value(stage))).collect::<Vec<_>>()
    });
    let panels = [2, 3, 4, 5];
    let mut figure = Figure::new("Table 1: the stages of a membrane").columns(2);
    for (k, column) in panels.into_iter().enumerate() {
        let letter = ["(a)", "(b)", "(c)", "(d)"][k];
        figure = figure.panel(
            Panel::new(letter, "stage", COLUMNS[column].0)
                .x_range(0.5, 4.5)
                .series(Series::points("", &points[column]).style(Style::Dashed).color(0))
                .series(Series::points("", &points[column]).style(Style::Markers).color(0)),
        );
    }
    let caption = format!(
        "Thickness, capacitance, voltage and charge of a membrane at the stages of Table 1; stage 3 is the largest impact \
         of {CASE}. Between 3 and 4 the charge is kept, so the voltage rises as the capacitance falls: Eq. (12)."
    );
    Picture::new("table1", &figure, caption)
}
