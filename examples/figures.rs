//! A report with every kind of figure, for `tests/browser`: `cargo run --example figures -- report.html`.

use videg_report::{
    Cell, Column, Drawing, Figure, HeatMap, Panel, Report, ReportError, Scale, Section, Series, Style, Table, Tone,
    render_html, render_png,
};

type Curve = Vec<(f64, f64)>;

fn curve(count: u32, step: f64, value: impl Fn(f64) -> f64) -> Curve {
    (0..count).map(|k| f64::from(k) * step).map(|t| (t, value(t))).collect()
}

fn series() -> Result<Drawing, ReportError> {
    let beat = curve(30_000, 1e-3, |t| (12.0 * t).sin() * (0.7 * t).sin());
    let pulses = curve(30_000, 1e-3, |t| 100.0 + 60.0 * (-((t % 0.5) - 0.25).powi(2) / 2e-4).exp());
    let held = curve(31, 1.0, |t| (t * 0.4).cos());
    let few = curve(16, 2.0, |t| (t * 0.4).cos() + 0.1);
    let band: Vec<_> = held.iter().map(|&(t, y)| (t, y - 0.3, y + 0.25)).collect();
    let bars: Vec<_> = few.iter().map(|&(t, y)| (t, y - 0.2, y + 0.2)).collect();
    Drawing::new(
        &Figure::new("Lines, steps, marks, a band and bars")
            .panel(
                Panel::new("(a)", "", "z_M - z_m (mm)")
                    .series(Series::points("beat", &beat).color(6))
                    .share_x_with_next(),
            )
            .panel(
                Panel::new("(b)", "", "capacitance (pF)")
                    .series(Series::points("<C(t)> & more", &pulses))
                    .line("at rest", 100.0)
                    .share_x_with_next(),
            )
            .panel(
                Panel::new("(c)", "time (s)", "value")
                    .band("5 to 95 %", &band, 0)
                    .bars(&bars, 1)
                    .series(Series::points("steps", &held).style(Style::Steps).color(0))
                    .series(Series::points("samples", &few).style(Style::Markers).color(1))
                    .series(Series::points("trend", &few).style(Style::Dashed).color(2)),
            ),
    )
}

fn clouds() -> Result<Drawing, ReportError> {
    let mut logistic = Vec::new();
    for k in 0..600 {
        let (r, mut x) = (2.8 + f64::from(k) * 2e-3, 0.3);
        for step in 0..160 {
            x = r * x * (1.0 - x);
            if step >= 100 {
                logistic.push((r, x));
            }
        }
    }
    let decay = curve(60, 1.0, |t| 10_f64.powf(2.0 - t / 9.0));
    let rough: Curve = decay.iter().map(|&(t, y)| (t, y * (1.0 + 0.4 * (9.0 * t).sin()))).collect();
    let circle = curve(200, 0.0316, f64::sin);
    let circle: Curve = circle.iter().map(|&(t, y)| (22.0 * t.cos(), 22.0 * y)).collect();
    let power = curve(40, 1.0, |t| 1e-6 * (1.0 + t).powf(2.5));
    let power: Curve = power.iter().map(|&(t, y)| (1.0 + t, y)).collect();
    Drawing::new(
        &Figure::new("Dots, logarithms and a drawing to scale, side by side")
            .columns(2)
            .panel(
                Panel::new("(a)", "parameter", "x")
                    .height(200.0)
                    .series(Series::points("long run", &logistic).style(Style::Dots)),
            )
            .panel(
                Panel::new("(b)", "time (s)", "error")
                    .height(200.0)
                    .log_y()
                    .series(Series::points("bound", &decay))
                    .series(Series::points("found", &rough).style(Style::Crosses)),
            )
            .panel(Panel::new("(c)", "x (mm)", "y (mm)").equal_aspect().series(Series::points("membrane", &circle)))
            .panel(
                Panel::new("(d)", "frequency (Hz)", "P (W)")
                    .height(180.0)
                    .log_x()
                    .log_y()
                    .series(Series::points("power", &power)),
            ),
    )
}

fn maps() -> Result<Drawing, ReportError> {
    let axis: Vec<f64> = (0..200).map(|k| -1.0 + f64::from(k) / 100.0).collect();
    let over = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        axis.iter().flat_map(|&y| axis.iter().map(move |&x| (x, y))).map(|(x, y)| value(x, y)).collect()
    };
    let both = over(&|x, y| (7.0 * x).sin() * (5.0 * y).cos());
    let positive = over(&|x, y| if x * x + y * y > 0.9 { f64::NAN } else { (3.0 * x * y).exp() });
    let kinds = over(&|x, y| ((x * x + y * y) * 2.0).floor().min(2.0));
    let names = ["1 impact a cycle", "2 impacts", "chaos"].map(str::to_owned).to_vec();
    let map = |values, scale| HeatMap { xs: &axis, ys: &axis, values, scale };
    Drawing::new(
        &Figure::new("Maps")
            .columns(2)
            .panel(
                Panel::new("(a)", "x", "y").height(220.0).map(map(&both, Scale::Quantity("deviation (%)".to_owned()))),
            )
            .panel(
                Panel::new("(b)", "x", "y").height(220.0).map(map(&positive, Scale::Quantity("<P> (mW)".to_owned()))),
            )
            .panel(Panel::new("(c)", "x", "y").height(220.0).map(map(&kinds, Scale::Kinds(names)))),
    )
}

fn verdicts() -> Table {
    let columns = [Column::words("paper"), Column::numbers("value"), Column::words("verdict"), Column::words("reason")];
    let rows = [
        ("fig14", "8079", "agrees", Tone::Good, ""),
        ("fig11", "6749", "within ensemble", Tone::Near, "chaotic: 5 to 95 % of nearby starts"),
        ("table3", "0.061", "explained", Tone::Noted, "a resting ball counted as impacts at every step"),
        ("fig12", "6730", "differs", Tone::Bad, "the start lies outside the gap"),
        ("maps", "", "beyond the paper", Tone::Neutral, ""),
    ];
    rows.into_iter().fold(Table::new(columns), |table, (id, value, verdict, tone, reason)| {
        let place = Cell::link(format!("Section {id}"), id);
        table.row([place, value.into(), Cell::badge(verdict, tone), reason.into()])
    })
}

fn report() -> Result<Report, ReportError> {
    let caption = "Made up, to show what a figure can hold.";
    let section = |id: &str| Section::new(format!("Section {id}")).id(id);
    Ok(Report::new("Every kind of figure", "Made-up numbers in all the forms that a report can take.")
        .command("cargo run --example figures -- report.html")
        .generated_by(concat!("videg ", env!("CARGO_PKG_VERSION")))
        .section(Section::new("Summary").table(verdicts()).warning("No number on this page means anything."))
        .section(section("fig14").drawing(series()?, caption))
        .section(section("fig11").drawing(clouds()?, caption))
        .section(section("table3").text("A still picture:").figure(series()?.svg, caption))
        .section(section("fig12").note("A long word: ").text("aVeryLongWordThatHasNoPlaceToBreak".repeat(4)))
        .section(section("maps").drawing(maps()?, caption)))
}

fn main() -> anyhow::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "report.html".to_owned());
    std::fs::write(&path, render_html(&report()?)?)?;
    for (name, drawing) in [("series", series()?), ("clouds", clouds()?), ("maps", maps()?)] {
        let file = std::path::Path::new(&path).with_file_name(format!("{name}.png"));
        std::fs::write(file, render_png(&drawing.svg, 2.0)?)?;
    }
    Ok(())
}
