//! The map that a user asks for, checked.

use fmu_import::ModelDescription;
use videg_coupled::OVER_LIMITS;

use super::axis::{Axis, labelled};
use super::columns::{Cell, Columns, largest};
use super::error::MapError;
use crate::scenario::Scenario;
use crate::sweep::{self, Design, Engine, POWERS, Sweep, System, Times, Vary};

/// Most points: all of them are kept, and drawn.
const MOST: usize = 1_000_000;

/// A map as a user asks for it.
pub struct Request<'a> {
    /// The runs, but for what is varied and recorded. Sample i has the same seed at all points.
    pub sweep: sweep::Request<'a>,
    /// The horizontal axis.
    pub x: Vary,
    /// The vertical axis.
    pub y: Vary,
    /// What is mapped: a power, `average_voltage_gain`, or any other number that a sweep records.
    pub of: String,
}

impl<'a> Request<'a> {
    /// The map of a quantity over two `axes`, x and y, of a case; `description` is that of `system_description`.
    pub fn of_case(description: &'a ModelDescription, scenario: Scenario, [x, y]: [Vary; 2], of: &str) -> Self {
        let Scenario { name, settings, until, window, .. } = scenario;
        let times = Times { until, step: None, window };
        Self { sweep: sweep::Request::new(name, description, settings, times), x, y, of: of.to_owned() }
    }
}

/// A map, checked.
pub struct Plan {
    /// The horizontal and the vertical axis.
    pub axes: [Axis; 2],
    /// Name of what is mapped.
    pub of: String,
    /// Its unit, empty without one.
    pub unit: String,
    /// The runs at all points of the grid, row by row from the lowest.
    pub sweep: Sweep,
    pub(super) columns: Columns,
}

impl Plan {
    /// Checks a request.
    ///
    /// # Errors
    /// Axes that are none; a quantity that is no number; an error in the request that concerns all runs.
    pub fn new(request: Request<'_>) -> Result<Self, MapError> {
        let Request { mut sweep, x, y, of } = request;
        let description = sweep.description;
        if x.name == y.name {
            let reason = "both axes of the map vary it; two different variables are allowed".to_owned();
            return Err(MapError::Axis { axis: x.name, reason });
        }
        let axes = [Axis::new(description, &x)?, Axis::new(description, &y)?];
        let [columns, rows] = [axes[0].count, axes[1].count];
        if columns.checked_mul(rows).is_none_or(|points| points > MOST) {
            let reason = format!("{columns} x {rows} points are too many for a map; at most {MOST} are allowed");
            return Err(MapError::Axis { axis: x.name, reason });
        }
        let quantity = |reason: String| MapError::Quantity { name: of.clone(), reason };
        if axes.iter().any(|axis| axis.name == of) {
            return Err(quantity("it is an axis of the map".to_owned()));
        }
        sweep.vary = vec![axes[1].vary(&y), axes[0].vary(&x)];
        sweep.sampling.design = Some(Design::Grid);
        sweep.sampling.common_seeds = true;
        sweep.record = POWERS.into_iter().chain(OVER_LIMITS).map(str::to_owned).collect();
        let unit = match average_unit(&of) {
            Some(unit) => unit.to_owned(),
            None => recorded_unit(description, &of).map_err(&quantity)?,
        };
        if average_unit(&of).is_none() && !sweep.record.contains(&of) {
            sweep.record.push(of.clone());
        }
        let sweep = Sweep::new(&sweep)?;
        let columns = Columns::of(&sweep);
        if columns.place(&of).is_none() {
            return Err(quantity("it is no number".to_owned()));
        }
        Ok(Self { axes, of, unit, sweep, columns })
    }

    /// Computes the runs of a quantity that the FMU of the harvester need not tell.
    ///
    /// # Errors
    /// A file that is none; a variable that cannot be set; a quantity that only this FMU tells.
    pub fn engine(&self) -> Result<Engine, MapError> {
        let reason = "only the FMU of the harvester tells it".to_owned();
        let untold = || Err(MapError::Quantity { name: self.of.clone(), reason });
        Ok(Engine::System(Box::new(System::new(&self.sweep, untold)?)))
    }

    /// Names of the numbers that each point has.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.names()
    }

    /// Name and unit of what is mapped.
    pub fn label(&self) -> String {
        labelled(&self.of, &self.unit)
    }

    /// A number of a cell by its name; NaN if it has none.
    pub fn number(&self, cell: &Cell, name: &str) -> f64 {
        self.columns.place(name).and_then(|place| cell.numbers.get(place)).copied().unwrap_or(f64::NAN)
    }

    /// The most that the runs of a cell take of any limit of the film, over the limit; NaN without a run.
    pub fn over_limits(&self, cell: &Cell) -> f64 {
        OVER_LIMITS.iter().map(|name| self.number(cell, name)).fold(0.0, largest)
    }
}

/// Units of the averages that all runs have.
fn average_unit(name: &str) -> Option<&'static str> {
    match name {
        "average_voltage_gain" => Some("V/s"),
        "average_power_eq13" => Some("W"),
        "impacts" => Some(""),
        _ => None,
    }
}

fn recorded_unit(description: &ModelDescription, name: &str) -> Result<String, String> {
    let variable = description.variable(name).map_err(|error| error.to_string())?;
    Ok(variable.unit().unwrap_or_default().to_owned())
}
