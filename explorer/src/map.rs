//! Net power over two variables, row by row.

use std::cell::RefCell;

use videg_coupled::{CoupledError, Film, Results, Track, run_watched};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::machine::{Machine, times};
use crate::setter::Setter;

/// Runs over two variables.
#[wasm_bindgen]
pub struct Map {
    machine: Machine,
    x: Setter,
    y: Setter,
    xs: Vec<f64>,
    window: [f64; 2],
    /// C(t), if it is the same in all rows.
    track: Option<Track>,
    /// Why the first of those cells that have none has no number.
    fault: RefCell<Option<String>>,
}

#[wasm_bindgen]
impl Map {
    /// The `machine` over the variables called `x`, at the values `xs`, and `y`; its runs end at `until`, s, and are averaged from `from` on.
    ///
    /// # Errors
    /// If there is no such variable.
    #[wasm_bindgen(constructor)]
    pub fn new(machine: &Machine, x: &str, xs: Vec<f64>, y: &str, from: f64, until: f64) -> Result<Self, String> {
        let (machine, x, y) = (machine.clone(), Setter::of(x)?, Setter::of(y)?);
        let mut map = Self { machine, x, y, xs, window: [from, until], track: None, fault: RefCell::default() };
        if x.is_electrical() && y.is_electrical() {
            map.track = map.track(&map.machine);
        }
        Ok(map)
    }

    /// At each of the values of x and this one of `y`: the net power, W, and the most that is taken of a limit of the film; NaN where
    /// no such machine runs.
    ///
    /// # Errors
    /// A choice that is no whole number.
    pub fn row(&self, y: f64) -> Result<Vec<f64>, String> {
        let machine = self.machine.with(self.y, y)?;
        let own = if self.track.is_none() && self.x.is_electrical() { self.track(&machine) } else { None };
        let track = self.track.as_ref().or(own.as_ref());
        let cell = |x: &f64| {
            let numbers = self.cell(&machine, *x, track);
            numbers.unwrap_or_else(|reason| {
                self.fault.borrow_mut().get_or_insert(reason);
                [f64::NAN; 2]
            })
        };
        Ok(self.xs.iter().flat_map(cell).collect())
    }

    /// Why the first cell without a number has none, if there is one so far.
    pub fn fault(&self) -> Option<String> {
        self.fault.borrow().clone()
    }
}

impl Map {
    /// C(t) of `machine`, if it can be kept. A run says why it fails.
    fn track(&self, machine: &Machine) -> Option<Track> {
        let [from, until] = self.window;
        Track::of(machine.setup(), &times(from, until)).ok().flatten()
    }

    fn cell(&self, machine: &Machine, x: f64, track: Option<&Track>) -> Result<[f64; 2], String> {
        let [from, until] = self.window;
        let machine = machine.with(self.x, x)?;
        let settings = machine.settings(until)?;
        let mut film = Film::default();
        let results: Result<Results, CoupledError> = match track {
            Some(track) => track.run(&settings, &mut film),
            None => run_watched(machine.setup(), &settings, &times(from, until), &mut film),
        };
        let results = results.map_err(|error| error.to_string())?;
        Ok([results.powers.net_power, film.over_limits().into_iter().fold(0.0, f64::max)])
    }
}
