//! The motion over some time from a state at a phase of the excitation, and its first-order changes.
//!
//! The relative motion of a ball in a free or shaken cylinder does not depend on where the cylinder is: its state has two
//! numbers, dz = `z_M` - `z_m` and its rate. A suspended cylinder adds `z_M` and its rate.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use videg_model::{Direction, Event, Harvester, Impact, ModelError, Parameters, Sensitivities};

use crate::dynamics::Problem;

/// dz, m, its rate, m/s, and of a suspended cylinder `z_M`, m, and its rate, m/s.
pub type State = DVector<f64>;

/// A state at a phase of the excitation, where the parameter that varies has a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Of the parameter; NaN if none varies.
    pub value: f64,
    /// Periods since the excitation had the phase `excitation.phase`, from 0 to below 1.
    pub phase: f64,
    /// The state.
    pub state: State,
}

/// Where a motion is after some time, and how that changes to first order.
#[derive(Debug, Clone)]
pub struct Change {
    /// The state.
    pub end: State,
    /// Per unit of the state at the start.
    pub by_state: DMatrix<f64>,
    /// Per unit of the parameter that varies, at a phase that stays; 0 if none varies.
    pub by_value: DVector<f64>,
}

/// The motion of a problem from states.
#[derive(Debug, Clone, Copy)]
pub struct Flow<'a> {
    problem: &'a Problem,
}

impl<'a> Flow<'a> {
    /// The motion of this problem.
    pub fn new(problem: &'a Problem) -> Self {
        Self { problem }
    }

    /// The problem.
    pub fn problem(self) -> &'a Problem {
        self.problem
    }

    /// Numbers of a state.
    pub fn dimension(self) -> usize {
        let varied = self.problem.varied.as_ref().map(|varied| self.problem.at(varied.range()[1]));
        if self.problem.parameters.is_suspended() || varied.is_some_and(|p| p.is_suspended()) { 4 } else { 2 }
    }

    /// Period of the excitation, s, at a value of what varies.
    pub fn period(self, value: f64) -> f64 {
        1.0 / self.problem.at(value).frequency
    }

    /// Half of the travel, m, and what the motion covers in 1 / (2 pi f0), as a rate, m/s: what states are measured in.
    pub fn scale(self, value: f64) -> State {
        let p = self.problem.at(value);
        let (length, rate) = (p.travel() / 2.0, p.travel() / 2.0 * TAU * p.frequency);
        self.state_of([length, rate], [length, rate])
    }

    /// A state of relative motion and, if it is suspended, of the cylinder.
    pub fn state_of(self, relative: [f64; 2], cylinder: [f64; 2]) -> State {
        DVector::from_column_slice(&[relative, cylinder].concat()[..self.dimension()])
    }

    /// The harvester at `point`, at its time 0.
    ///
    /// # Errors
    /// A parameter out of its bounds.
    pub fn start(self, point: &Point) -> Result<Harvester, ModelError> {
        Harvester::new(self.problem.setup(&self.parameters(point)), 0.0)
    }

    fn parameters(self, point: &Point) -> Parameters {
        let mut p = self.problem.at(point.value);
        p.phase = (p.phase + TAU * point.phase) % TAU;
        let state = &point.state;
        [p.cylinder_position, p.cylinder_velocity] = if let [_, _, position, velocity] = state.as_slice() {
            [*position, *velocity]
        } else {
            // It swings about one place, so that nothing large is added to the relative motion.
            [0.0, p.harmonic_acceleration() / (TAU * p.frequency) * p.phase.sin()]
        };
        (p.ball_position, p.ball_velocity) = (p.cylinder_position - state[0], p.cylinder_velocity - state[1]);
        p
    }

    /// The state of a harvester.
    pub fn state(self, harvester: &Harvester) -> State {
        let [position, velocity] = [harvester.cylinder_position(), harvester.cylinder_velocity()];
        let relative = [harvester.relative_displacement(), velocity - harvester.ball_velocity()];
        self.state_of(relative, [position, velocity])
    }

    /// The state `periods` after `point`; `show` gets the impacts on the way.
    ///
    /// # Errors
    /// A parameter out of its bounds; more events than can be resolved.
    pub fn after(self, point: &Point, periods: f64, mut show: impl FnMut(&Impact)) -> Result<State, ModelError> {
        let mut harvester = self.start(point)?;
        harvester.advance_with(periods * self.period(point.value), |event| {
            if let Event::Impact(impact) = event {
                show(impact);
            }
        })?;
        Ok(self.state(&harvester))
    }

    /// The state `periods` after `point`, and its changes.
    ///
    /// # Errors
    /// As [`Flow::after`].
    pub fn change(self, point: &Point, periods: f64) -> Result<Change, ModelError> {
        let parameters = self.parameters(point);
        let time = periods * self.period(point.value);
        let along = |direction: &Direction| -> Result<(Harvester, State), ModelError> {
            let mut harvester = Harvester::along(self.problem.setup(&parameters), 0.0, 0.0, direction)?;
            harvester.advance(time)?;
            let change = self.changed(&harvester.sensitivities());
            Ok((harvester, change))
        };
        let dimension = self.dimension();
        let mut by_state = DMatrix::zeros(dimension, dimension);
        let mut end = point.state.clone();
        for (column, direction) in directions().iter().take(dimension).enumerate() {
            let (harvester, change) = along(direction)?;
            by_state.set_column(column, &change);
            end = self.state(&harvester);
        }
        let mut by_value = DVector::zeros(dimension);
        if let Some(varied) = &self.problem.varied
            && let Some(direction) = Direction::of_parameter(varied.quantity.name)
        {
            let (harvester, change) = along(&direction)?;
            by_value = change;
            if varied.quantity.name == "excitation.frequency" {
                // The time, periods / f, changes with it.
                by_value -= self.rate(&harvester) * (time / parameters.frequency);
            }
        }
        Ok(Change { end, by_state, by_value })
    }

    /// The state's derivative with respect to time.
    fn rate(self, harvester: &Harvester) -> State {
        let acceleration = harvester.cylinder_acceleration();
        let state = self.state(harvester);
        let relative = [state[1], acceleration - harvester.ball_acceleration()];
        let cylinder = [harvester.cylinder_velocity(), acceleration];
        self.state_of(relative, cylinder)
    }

    fn changed(self, of: &Sensitivities) -> State {
        let relative = [of.relative_displacement, of.cylinder[1] - of.ball[1]];
        self.state_of(relative, [of.cylinder[0], of.cylinder[1]])
    }
}

/// One unit of each number of a state.
fn directions() -> [Direction; 4] {
    let along = |cylinder: [f64; 2], ball: [f64; 2]| {
        let mut direction = Direction { force: 0.0, ..Direction::of_force() };
        let parameters = &mut direction.parameters;
        [parameters.cylinder_position, parameters.cylinder_velocity] = cylinder;
        [parameters.ball_position, parameters.ball_velocity] = ball;
        direction
    };
    [
        along([0.0; 2], [-1.0, 0.0]),
        along([0.0; 2], [0.0, -1.0]),
        along([1.0, 0.0], [1.0, 0.0]),
        along([0.0, 1.0], [0.0, 1.0]),
    ]
}
