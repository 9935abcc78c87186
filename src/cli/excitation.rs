//! The section of a report on the excitation: over time, and its spectrum.

use crate::cosim::{Device, Excitation};
use videg_report::{Figure, Panel, Report, Section, Series, render_svg};

/// Periods of a harmonic excitation that are shown.
const SHOWN: usize = 200;

/// `report` with the section; as it is for an FMU that is not the harvester.
pub fn described(report: Report, device: &Device, until: f64) -> anyhow::Result<Report> {
    let Some(excitation) = Excitation::of(device, until) else { return Ok(report) };
    let (series, spectrum) = (excitation.series(), excitation.spectrum());
    // A recording is shown as a whole, of a harmonic some periods.
    let shown = if excitation.file.is_empty() { &series[..series.len().min(SHOWN)] } else { &series[..] };
    let [quantity, unit] = excitation.quantity();
    let figure = Figure::new("Excitation")
        .panel(
            Panel::new("(a)", "time (s)", format!("{quantity} ({unit})"))
                .height(130.0)
                .series(Series::points(quantity, shown)),
        )
        .panel(
            Panel::new("(b)", "frequency (Hz)", format!("amplitude ({unit})"))
                .height(130.0)
                .series(Series::points("amplitude", &spectrum).color(2)),
        )
        .caption(caption(&excitation));
    let section = Section::new("Excitation").figure(render_svg(&figure)?, caption(&excitation));
    Ok(report.section(section))
}

fn caption(excitation: &Excitation) -> String {
    let [quantity, unit] = excitation.quantity();
    let what = if quantity == "force" { "Force on the cylinder" } else { "Prescribed acceleration of the cylinder" };
    let mut parts = excitation.file.rsplit(['/', '\\']);
    let (recorded, between) = match parts.next() {
        Some(name) if !name.is_empty() => {
            (format!(" with the recording {name}"), ", on straight lines between those of the recording")
        }
        _ => (String::new(), ""),
    };
    let noise = if excitation.has_noise { ", without its phase noise" } else { "" };
    let Excitation { start, spacing, values, .. } = excitation;
    format!(
        "(a) {what}{recorded}{noise}; (b) its one-sided amplitude spectrum in {unit}, from {count} samples, {spacing} s apart, from \
         {start} to {end} s{between}, without their mean, under a Hann window; a harmonic \
         shows with its amplitude.",
        count = values.len(),
        spacing = rounded(*spacing),
        start = rounded(*start),
        end = rounded(excitation.end()),
    )
}

fn rounded(seconds: f64) -> String {
    super::format::significant(seconds, 4)
}
