//! Checks of a figure before it is drawn.

use super::error::ReportError;
use super::figure::{Figure, HeatMap, Panel, Scale};

const WIDTHS: (f64, f64) = (200.0, 4000.0);
const HEIGHTS: (f64, f64) = (30.0, 2000.0);
const COLUMNS: usize = 6;

type Result = std::result::Result<(), String>;

pub(super) fn check(figure: &Figure) -> std::result::Result<(), ReportError> {
    let refuse = |reason| Err(ReportError::Figure { figure: figure.title.clone(), reason });
    if figure.panels.is_empty() {
        return refuse("has no panels".to_owned());
    }
    if !(1..=COLUMNS).contains(&figure.columns) {
        return refuse(format!("has {} columns, allowed are 1 to {COLUMNS}", figure.columns));
    }
    check_size("figure width", figure.width, WIDTHS)?;
    figure.panels.iter().try_for_each(|panel| {
        check_height(panel, panel.height)?;
        check_panel(panel).map_err(|reason| ReportError::Panel { panel: panel.title.clone(), reason })
    })
}

/// Heights that follow from the data are known once the figure is laid out.
pub(super) fn check_height(panel: &Panel, height: f64) -> std::result::Result<(), ReportError> {
    check_size(&format!("height of panel `{}`", panel.title), height, HEIGHTS)
}

fn check_panel(panel: &Panel) -> Result {
    for series in &panel.series {
        let (xs, ys) = series.data.lengths();
        if xs != ys {
            return Err(format!("series `{}`: {xs} x values for {ys} y values", series.label));
        }
    }
    if let Some(line) = panel.lines.iter().find(|line| !line.value.is_finite()) {
        return Err(format!("reference line `{}` at {} is not finite", line.label, line.value));
    }
    if panel.equal_aspect && (panel.log_x || panel.log_y) {
        return Err("a drawing to scale has no logarithmic axes".to_owned());
    }
    panel.map.iter().try_for_each(check_map)?;
    let cells = panel.map.as_ref().map_or(0, |map| map.values.len());
    if let Some(hatch) = panel.hatches.iter().find(|hatch| hatch.values.len() != cells || !hatch.above.is_finite()) {
        let (label, values) = (&hatch.label, hatch.values.len());
        return Err(format!("hatch `{label}`: {values} values above {} for a map of {cells} cells", hatch.above));
    }
    check_limits(panel)?;
    check_logarithms(panel)
}

fn check_map(map: &HeatMap) -> Result {
    let (columns, rows, values) = (map.xs.len(), map.ys.len(), map.values.len());
    if columns == 0 || rows == 0 || columns.checked_mul(rows) != Some(values) {
        return Err(format!("{values} values for a map of {columns} x {rows} cells"));
    }
    check_ascending("x of the map", map.xs)?;
    check_ascending("y of the map", map.ys)?;
    let Scale::Kinds(names) = &map.scale else { return Ok(()) };
    let kinds = names.len();
    let known = |value: f64| value.is_nan() || (value >= 0.0 && value < kinds as f64 && value.fract() == 0.0);
    match map.values.iter().find(|&&value| !known(value)) {
        Some(value) => Err(format!("{value} is none of the {kinds} kinds of the map, which count from 0")),
        None => Ok(()),
    }
}

fn check_limits(panel: &Panel) -> Result {
    for band in &panel.bands {
        let finite = band.limits.iter().map(|limit| limit.0).filter(|x| x.is_finite());
        check_ascending(&format!("x of band `{}`", band.label), &finite.collect::<Vec<f64>>())?;
    }
    let limits = panel.bands.iter().map(|band| band.limits).chain(panel.bars.iter().map(|bars| bars.limits));
    match limits.flatten().find(|(_, low, high)| low > high) {
        Some((x, low, high)) => Err(format!("limits {low} to {high} at x = {x} are in the wrong order")),
        None => Ok(()),
    }
}

fn check_ascending(what: &str, values: &[f64]) -> Result {
    let gap = values.iter().find(|value| !value.is_finite()).map(|value| (value, value));
    let descent = values.windows(2).find(|pair| pair[0] >= pair[1]).map(|pair| (&pair[0], &pair[1]));
    match gap.or(descent) {
        Some((before, after)) => {
            Err(format!("{what}: {after} follows {before}, but the values must be finite and ascend"))
        }
        None => Ok(()),
    }
}

fn check_logarithms(panel: &Panel) -> Result {
    let limits = || panel.bands.iter().map(|b| b.limits).chain(panel.bars.iter().map(|b| b.limits)).flatten();
    let points = || panel.series.iter().flat_map(|series| series.data.iter());
    let cells = panel.map.as_ref();
    let no_positive = |values: &mut dyn Iterator<Item = f64>| {
        let mut values = values.peekable();
        values.peek().is_some() && !values.any(|value| value > 0.0)
    };
    let mut xs = points().map(|p| p.0).chain(limits().map(|limit| limit.0));
    let mut ys = points().map(|p| p.1).chain(limits().flat_map(|limit| [limit.1, limit.2]));
    // A cell at or below 0 has no place on the axis, while a point may be left out.
    let low_cell = |values: fn(&HeatMap<'_>) -> f64| cells.is_some_and(|map| values(map) <= 0.0);
    let (first_x, first_y) = (|map: &HeatMap<'_>| map.xs[0], |map: &HeatMap<'_>| map.ys[0]);
    let axis = if panel.log_x && (no_positive(&mut xs) || low_cell(first_x)) {
        "x"
    } else if panel.log_y && (no_positive(&mut ys) || low_cell(first_y)) {
        "y"
    } else {
        return Ok(());
    };
    Err(format!("no value on the logarithmic {axis} axis is above 0, or a cell of the map is not"))
}

fn check_size(what: &str, value: f64, (min, max): (f64, f64)) -> std::result::Result<(), ReportError> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(ReportError::Size { what: what.to_owned(), value: format!("{value} px"), min, max })
}

#[cfg(test)]
mod tests {
    use super::super::figure::Series;
    use super::super::svg::render_svg;
    use super::*;

    fn map(xs: &'static [f64], values: &'static [f64]) -> HeatMap<'static> {
        HeatMap { xs, ys: &[1.0, 2.0], values, scale: Scale::Kinds(vec!["none".to_owned()]) }
    }

    #[test]
    fn figures_that_cannot_be_drawn_are_refused_with_the_reason() {
        let (back, reversed) = ([(1.0, 0.0, 1.0), (0.5, 0.0, 1.0)], [(1.0, 2.0, 1.0)]);
        let low = [(-1.0, 0.0), (0.0, -3.0)];
        let panel = || Panel::new("(p)", "", "");
        let falling = || panel().series(Series::points("", &low));
        let torn = Series::columns("C", &[1.0, 2.0], &[1.0]);
        for (panel, told) in [
            (panel().series(torn), "`(p)`: series `C`: 2 x values for 1 y values"),
            (panel().x_range(0.0, f64::INFINITY), "`(p)`: x range 0 to inf"),
            (panel().y_range(2.0, 1.0), "y range 2 to 1"),
            (panel().line("bias", f64::NAN), "`bias` at NaN"),
            (panel().map(map(&[1.0], &[0.0])), "`(p)`: 1 values for a map of 1 x 2 cells"),
            (panel().map(map(&[], &[])), "0 x 2"),
            (panel().map(map(&[2.0, 1.0], &[0.0; 4])), "x of the map: 1 follows 2"),
            (panel().map(map(&[1.0, f64::NAN], &[0.0; 4])), "NaN follows NaN"),
            (panel().map(map(&[1.0], &[0.0, 1.0])), "1 is none of the 1 kinds"),
            (panel().map(map(&[1.0], &[0.5, 0.0])), "0.5 is none"),
            (panel().map(map(&[0.0], &[0.0, 0.0])).log_x(), "logarithmic x axis"),
            (panel().hatched("slack", &[1.0], 0.5), "hatch `slack`: 1 values above 0.5 for a map of 0 cells"),
            (panel().map(map(&[1.0], &[0.0; 2])).hatched("", &[1.0; 2], f64::NAN), "2 values above NaN for a map of 2"),
            (panel().band("range", &back, 0), "x of band `range`: 0.5 follows 1"),
            (panel().band("", &reversed, 0), "2 to 1 at x = 1"),
            (panel().bars(&reversed, 0), "2 to 1 at x = 1"),
            (falling().log_x(), "`(p)`: no value on the logarithmic x axis"),
            (falling().log_y(), "logarithmic y axis"),
            (panel().log_x().equal_aspect(), "to scale"),
        ] {
            let error = render_svg(&Figure::new("F").panel(panel)).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
        for (figure, told) in [
            (Figure::new("F"), "`F` has no panels"),
            (Figure::new("F").columns(0).panel(panel()), "`F` has 0 columns"),
            (Figure::new("F").width(f64::NAN).panel(panel()), "figure width is NaN px"),
        ] {
            let error = render_svg(&figure).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
        for panel in [panel().map(map(&[1.0], &[0.0, f64::NAN])), panel().log_x()] {
            render_svg(&Figure::new("").panel(panel)).unwrap();
        }
    }
}
