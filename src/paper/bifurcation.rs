//! Bifurcation diagrams: how the motion changes along a parameter.

use super::excitation::Cylinder;
use super::stroboscope::{Orbit, Start, Stroboscope, periods};
use super::{Finding, PaperError, Picture, Sheet, Study};
use videg_report::{Column, Figure, Panel, Series, Style, Table};

/// Periods of the transient, and periods after it at whose ends the motion is sampled.
const TRANSIENT: u32 = 200;
const TAKEN: u32 = 60;

/// A parameter and where it goes.
pub struct Path {
    /// Name of the files, e.g. `bifurcation-r`.
    pub name: &'static str,
    /// Axis label.
    pub axis: &'static str,
    /// Ends.
    pub range: [f64; 2],
    /// Parameters that stay the same.
    pub caption: &'static str,
    /// The saw-tooth start at a value of the parameter.
    pub start: fn(&Cylinder, f64) -> Start,
}

impl Path {
    /// Symbol of the parameter, without its unit.
    fn symbol(&self) -> &str {
        self.axis.split(' ').next().unwrap_or_default()
    }
}

/// Distance, mm, of dots that look like one.
const RESOLUTION: f64 = 0.05;

/// Whether a dot of a cloud, which is sorted by x, is one with this to the eye.
fn hidden(dot: (f64, f64), cloud: &[(f64, f64)]) -> bool {
    let column = cloud.iter().skip(cloud.partition_point(|other| other.0 < dot.0)).take_while(|other| other.0 == dot.0);
    column.map(|other| other.1).any(|y| (y - dot.1).abs() < 1.5 * RESOLUTION)
}

/// How the motion at a value of the parameter is reached.
const WAYS: [&str; 3] = ["saw-tooth start", "followed upwards", "followed downwards"];

/// A diagram: for each way, the motion at each value.
pub struct Diagram {
    path: &'static Path,
    xs: Vec<f64>,
    ways: Vec<Vec<Orbit>>,
}

impl Diagram {
    /// Follows `path`.
    pub fn new(study: &Study<'_>, cylinder: &Cylinder, path: &'static Path) -> Result<Self, PaperError> {
        let count = study.effort.of(400_u32, 100);
        let [from, to] = path.range;
        let xs: Vec<f64> = (0..=count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)).collect();
        let orbit = |start: &Start| -> Result<Orbit, PaperError> {
            Stroboscope::new(study, &start.settings(cylinder), start.frequency)?.take(TRANSIENT, TAKEN)
        };
        let fresh = study.each(&xs, |&x| orbit(&(path.start)(cylinder, x)))?;
        // Each motion begins where the one before has ended, so these are one task each.
        let followed = study.each(&[false, true], |&downwards| {
            let mut orbits: Vec<Orbit> = Vec::new();
            for k in 0..xs.len() {
                let x = if downwards { xs[xs.len() - 1 - k] } else { xs[k] };
                let start = (path.start)(cylinder, x);
                orbits.push(orbit(&orbits.last().map_or(start, |before| start.from(before.last())))?);
            }
            if downwards {
                orbits.reverse();
            }
            Ok(orbits)
        })?;
        Ok(Self { path, xs, ways: std::iter::once(fresh).chain(followed).collect() })
    }

    /// How often starts of different history end in different periodic motions.
    pub fn finding(&self) -> Finding {
        let coexisting = self.coexisting();
        let reason = match (coexisting.first(), coexisting.last()) {
            (Some(first), Some(last)) => {
                format!("of the {} looked at; between {first:.4} and {last:.4}", self.xs.len())
            }
            _ => "one <U> wherever the motions are periodic".to_owned(),
        };
        let place = format!("Bifurcation diagram over {}", self.path.symbol());
        let quantity = "values at which two periodic motions of different <U> exist";
        Finding::new(place, quantity, "1", coexisting.len() as f64).reason(reason)
    }

    /// Values at which two ways lead to different `<U>`, by more than a part in a thousand, though both are periodic.
    fn coexisting(&self) -> Vec<f64> {
        let periodic = |orbit: &Orbit| orbit.recurrence().map(|n| orbit.voltage_gain(n));
        let differs = |index: usize| {
            let gains: Vec<f64> = self.ways.iter().filter_map(|orbits| periodic(&orbits[index])).collect();
            let [low, high] = [f64::min, f64::max].map(|pick| gains.iter().copied().reduce(pick).unwrap_or_default());
            high - low > 1e-3 * high
        };
        self.xs.iter().enumerate().filter(|(index, _)| differs(*index)).map(|(_, &x)| x).collect()
    }

    /// Stretches of the parameter over which the saw-tooth start leads to one number of periods; `None` is no
    /// recurrence.
    fn stretches(&self) -> Vec<(f64, f64, Option<usize>)> {
        let mut found: Vec<(f64, f64, Option<usize>)> = Vec::new();
        for (&x, orbit) in self.xs.iter().zip(self.ways.iter().flatten()) {
            let recurrence = orbit.recurrence();
            match found.last_mut() {
                Some(last) if last.2 == recurrence => last.1 = x,
                _ => found.push((x, x, recurrence)),
            }
        }
        found
    }

    /// The longer stretches as a table.
    pub fn table(&self) -> Table {
        let symbol = self.path.symbol();
        let columns = [
            Column::numbers(format!("{symbol} from")),
            Column::numbers(format!("{symbol} to")),
            Column::words("motion comes back after"),
        ];
        let spacing = self.xs.get(1).zip(self.xs.first()).map_or(0.0, |(b, a)| b - a);
        let long = self.stretches().into_iter().filter(|(from, to, _)| to - from > 2.5 * spacing);
        long.fold(Table::new(columns), |table, (from, to, recurrence)| {
            let never = format!("more than {} periods: chaos, or a slow transient", TAKEN / 2);
            table.row([format!("{from:.4}"), format!("{to:.4}"), periods(recurrence, never)])
        })
    }

    /// Displacements over the parameter, each way, and `<U>`.
    pub fn picture(&self) -> Result<Picture, PaperError> {
        let path = self.path;
        let mut clouds: Vec<Vec<(f64, f64)>> = self.ways.iter().map(|orbits| self.cloud(orbits)).collect();
        // Upwards and downwards share a panel, where equal dots would hide each other.
        let upwards = clouds[1].clone();
        clouds[2].retain(|dot| !hidden(*dot, &upwards));
        let gain = |orbit: &Orbit| 1e-3 * orbit.voltage_gain(TAKEN as usize);
        let gains: Vec<Vec<(f64, f64)>> =
            self.ways.iter().map(|orbits| self.xs.iter().copied().zip(orbits.iter().map(gain)).collect()).collect();
        let [from, to] = path.range;
        let panel = |title: &str, label: &str, height: f64| {
            Panel::new(title, path.axis, label).x_range(from, to).height(height)
        };
        let dots = |index: usize| {
            let label = if index == 2 { "followed downwards, where that differs" } else { WAYS[index] };
            Series::points(label, &clouds[index]).style(Style::Dots).color(index)
        };
        let displacement = "z_M - z_m (mm)";
        let output = panel("(c)", "<U> (kV/s)", 160.0);
        let output = (0..WAYS.len()).rev().fold(output, |panel, index| {
            panel.series(Series::points(WAYS[index], &gains[index]).style(Style::Dots).color(index))
        });
        let figure = Figure::new("Bifurcation diagram")
            .caption("Relative displacement once a period, and average voltage gain, over a parameter.")
            .panel(panel("(a)", displacement, 240.0).share_x_with_next().series(dots(0)))
            .panel(panel("(b)", displacement, 240.0).share_x_with_next().series(dots(1)).series(dots(2)))
            .panel(output);
        let caption = format!(
            "{} Relative displacement at the start of each period, when the cylinder is at the end of its swing: \
             {TAKEN} periods after {TRANSIENT}; (a) from the saw-tooth start, (b) each motion going on from the one \
             before along the parameter, upwards and downwards; (c) <U> of Eq. (15) over the {TAKEN} periods. Where the ways \
             differ, several attractors coexist, and the start decides.",
            path.caption
        );
        Picture::new(path.name, &figure, caption)
    }

    /// Dots to draw, mm: one of those that look alike.
    fn cloud(&self, orbits: &[Orbit]) -> Vec<(f64, f64)> {
        let dots = |orbit: &Orbit| {
            let mut values: Vec<f64> =
                orbit.flashes.iter().map(|flash| (1e3 * flash.displacement / RESOLUTION).round()).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let column = |(&x, orbit): (&f64, &Orbit)| dots(orbit).into_iter().map(move |value| (x, value * RESOLUTION));
        self.xs.iter().zip(orbits).flat_map(column).collect()
    }

    /// Every flash of the periodic or chaotic motions: one row each until the motion comes back.
    pub fn sheet(&self) -> Sheet {
        let columns =
            [self.path.axis, "way (1)", "displacement (m)", "velocity (m/s)", "<U> (V/s)", "recurrence (periods)"];
        let rows = self.ways.iter().zip([0.0, 1.0, 2.0]).flat_map(|(orbits, way)| {
            self.xs.iter().zip(orbits).flat_map(move |(&x, orbit)| {
                let recurrence = orbit.recurrence();
                let gain = orbit.voltage_gain(recurrence.unwrap_or(TAKEN as usize));
                let taken = orbit.flashes.iter().take(recurrence.unwrap_or(usize::MAX));
                let recurrence = recurrence.map_or(f64::NAN, |n| n as f64);
                taken.map(move |flash| vec![x, way, flash.displacement, flash.velocity, gain, recurrence])
            })
        });
        Sheet::new(self.path.name, columns, rows)
    }
}
