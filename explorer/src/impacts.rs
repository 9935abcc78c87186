//! Impacts of a run: for steps from one to the next, and for bifurcation diagrams.

use videg_model::{Event, Harvester};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::machine::Machine;
use crate::setter::Setter;

/// What a diagram shows over a parameter.
#[wasm_bindgen]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Relative speed of impacts, m/s.
    Speed,
    /// When in the period of the excitation they are, 0 to 1.
    Phase,
    /// Time since the impact before, in periods.
    Interval,
    /// Their `U_DE4`, V, Eq. (12).
    Voltage,
    /// Relative displacement at the ends of periods, m.
    Displacement,
}

#[wasm_bindgen]
impl Machine {
    /// Impacts from `from` to `to`, s: time, side (0 left, 1 right), relative speed, m/s, of each.
    ///
    /// # Errors
    /// Parameters that the harvester refuses; more events than can be resolved.
    pub fn impacts(&self, from: f64, to: f64) -> Result<Vec<f64>, String> {
        let mut rows = Vec::new();
        let failed = |error: videg_model::ModelError| error.to_string();
        let mut harvester = Harvester::new(self.setup(), 0.0).map_err(failed)?;
        // An impact at the first time is one of them.
        if from > 0.0 {
            harvester.advance(from.next_down()).map_err(failed)?;
        }
        let show = |event: &Event| {
            if let Event::Impact(impact) = event {
                rows.extend([impact.time, impact.side.index() as f64, impact.speed]);
            }
        };
        harvester.advance_with(to, show).map_err(failed)?;
        Ok(rows)
    }

    /// At each of the `values` of the variable called `name`, at most `points` of what is `shown`, once `transient` periods are over: how many,
    /// then these. Where there is no such motion, there are none.
    ///
    /// # Errors
    /// If there is no such variable.
    pub fn diagram(
        &self,
        name: &str,
        values: &[f64],
        transient: u32,
        points: u32,
        shown: Shown,
    ) -> Result<Vec<f64>, String> {
        let setter = Setter::of(name)?;
        let mut columns = Vec::new();
        for &value in values {
            // A motion that does not exist leaves its column empty.
            let column = self.with(setter, value).and_then(|machine| machine.column(transient, points, shown));
            let column = column.unwrap_or_default();
            columns.push(column.len() as f64);
            columns.extend(column);
        }
        Ok(columns)
    }

    fn column(&self, transient: u32, points: u32, shown: Shown) -> Result<Vec<f64>, String> {
        let most = points as usize;
        let failed = |error: videg_model::ModelError| error.to_string();
        let mut harvester = Harvester::new(self.setup(), 0.0).map_err(failed)?;
        let (frequency, bias) = (self.values.parameters.frequency, self.values.parameters.bias_voltage);
        let membrane = harvester.membrane().clone();
        harvester.advance(f64::from(transient) / frequency).map_err(failed)?;
        let (mut column, mut before) = (Vec::new(), None);
        // Motions without impacts end, too.
        for period in 1..=points {
            if column.len() >= most {
                break;
            }
            let end = (f64::from(transient) + f64::from(period)) / frequency;
            let show = |event: &Event| match (event, shown) {
                (Event::Impact(impact), Shown::Speed) => column.push(impact.speed),
                (Event::Impact(impact), Shown::Phase) => column.push((impact.time * frequency).fract()),
                (Event::Impact(impact), Shown::Interval) => {
                    column.extend(before.map(|before| (impact.time - before) * frequency));
                    before = Some(impact.time);
                }
                (Event::Peak(peak), Shown::Voltage) => {
                    column.push(bias * membrane.capacitance(peak.deflection) / membrane.rest_capacitance());
                }
                _ => {}
            };
            harvester.advance_with(end, show).map_err(failed)?;
            if shown == Shown::Displacement {
                column.push(harvester.relative_displacement());
            }
        }
        column.truncate(most);
        Ok(column)
    }
}
