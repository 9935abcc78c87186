//! The machine in motion: rows of what a picture of it shows.

use videg_circuit::Ledger;
use videg_coupled::{CoupledError, Simulation, TOLERANCE};
use videg_model::{Harvester, Membrane, Side};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::machine::Machine;

/// Columns of a row.
const NAMES: [&str; 20] = [
    "time",
    "cylinder.position",
    "cylinder.acceleration",
    "ball.position",
    "relative.displacement",
    "relative.velocity",
    "left.deflection",
    "right.deflection",
    "left.capacitance",
    "right.capacitance",
    "left.voltage",
    "right.voltage",
    // The highest voltages that the films stand.
    "left.limit",
    "right.limit",
    "supply.energy",
    "load.energy",
    "stored.energy",
    "mechanical.energy",
    "supply.charge",
    "load.charge",
];

/// Rows between two knots of C(t) while a membrane is deflected.
const IN_PULSE: u32 = 16;

/// Most rows of one answer: what a page can draw.
const MOST: usize = 40_000;

#[wasm_bindgen]
impl Machine {
    /// Names of the columns of [`Machine::motion`].
    #[wasm_bindgen(js_name = motionNames)]
    pub fn motion_names() -> Vec<String> {
        NAMES.map(ToOwned::to_owned).to_vec()
    }

    /// The machine whose runs end at `until`, s, as it moves from `from` to `to`, s, in rows of [`Machine::motion_names`]: at most `spacing`, s, apart, and closer where a
    /// membrane is deflected.
    ///
    /// # Errors
    /// As [`Machine::run`]; more rows than a page can draw.
    pub fn motion(&self, from: f64, to: f64, spacing: f64, until: f64) -> Result<Vec<f64>, String> {
        if spacing.is_nan() || spacing <= 0.0 {
            return Err(format!("a row every {spacing} s: allowed: above 0"));
        }
        let mut rows = Vec::new();
        self.follow([from, to], until, (spacing, IN_PULSE), |simulation| {
            row(simulation, &mut rows);
            rows.len() / NAMES.len()
        })?;
        Ok(rows)
    }

    /// Deflection, m, from which on the film ruptures.
    ///
    /// # Errors
    /// Parameters that the harvester refuses.
    #[wasm_bindgen(js_name = deflectionLimit)]
    pub fn deflection_limit(&self) -> Result<f64, String> {
        let harvester = Harvester::new(self.setup(), 0.0).map_err(|error| error.to_string())?;
        let membrane = harvester.membrane();
        let is_over = |deflection: f64| membrane.over_limits(deflection, 0.0)[0] > 1.0;
        let (mut low, mut high) = (0.0, membrane.radius());
        // The area grows with the deflection, but a film whose table ends may never get there.
        for _ in 0..60 {
            if !is_over(high) {
                (low, high) = (high, 2.0 * high);
            }
        }
        while high - low > 1e-9 * high {
            let middle = 0.5 * (low + high);
            if is_over(middle) { high = middle } else { low = middle }
        }
        Ok(high)
    }
}

impl Machine {
    /// Shows the machine whose runs end at `until`, s, to `see` from the first of the times, s, to the second one: at most a spacing, s, apart,
    /// and a number of times between two knots of C(t) where a membrane is deflected. It says how many there are.
    pub(crate) fn follow(
        &self,
        [from, to]: [f64; 2],
        until: f64,
        (spacing, in_pulse): (f64, u32),
        mut see: impl FnMut(&Simulation<'_>) -> usize,
    ) -> Result<(), String> {
        let are_times = from >= 0.0 && to > from && to.is_finite();
        if !are_times {
            return Err(format!("from {from} to {to} s: allowed: 0 <= from < to, finite"));
        }
        let settings = self.settings(until)?;
        let mut nobody = ();
        let failed = |error: CoupledError| error.to_string();
        let mut simulation = Simulation::new(self.setup(), &settings, TOLERANCE, &mut nobody).map_err(failed)?;
        simulation.advance(from).map_err(failed)?;
        see(&simulation);
        while simulation.harvester().time() < to {
            let harvester = simulation.harvester();
            let now = harvester.time();
            let (end, _) = harvester.smooth_until(to);
            let least = if is_deflected(harvester) { in_pulse } else { 1 };
            let count = ((end - now) / spacing).ceil().clamp(f64::from(least), MOST as f64);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to the most rows")]
            let count = count as u32;
            for k in 1..=count {
                let next = if k == count { end } else { now + (end - now) * (f64::from(k) / f64::from(count)) };
                simulation.advance(next).map_err(failed)?;
                if see(&simulation) > MOST {
                    return Err(format!("more than {MOST} points from {from} to {to} s: too many impacts"));
                }
            }
        }
        Ok(())
    }
}

/// Whether a membrane is deflected now, or begins to be.
fn is_deflected(harvester: &Harvester) -> bool {
    Side::BOTH.iter().any(|side| {
        let deflection = harvester.deflection(*side);
        deflection.value != 0.0 || deflection.rate != 0.0 || harvester.pulses(*side).next().is_some()
    })
}

fn row(simulation: &Simulation<'_>, rows: &mut Vec<f64>) {
    let (harvester, circuit) = (simulation.harvester(), simulation.circuit());
    let deflections = Side::BOTH.map(|side| harvester.deflection(side).value);
    let [left, right] = circuit.voltage();
    let [left_limit, right_limit] = deflections.map(|deflection| highest_voltage(harvester.membrane(), deflection));
    let velocity = harvester.cylinder_velocity() - harvester.ball_velocity();
    let Ledger { supply, load, stored, mechanical, supply_charge, load_charge, .. } = circuit.ledger();
    rows.extend([
        harvester.time(),
        harvester.cylinder_position(),
        harvester.cylinder_acceleration(),
        harvester.ball_position(),
        harvester.relative_displacement(),
        velocity,
        deflections[0],
        deflections[1],
        harvester.capacitance(Side::Left),
        harvester.capacitance(Side::Right),
        left,
        right,
        left_limit,
        right_limit,
        supply,
        load,
        stored,
        mechanical,
        supply_charge,
        load_charge,
    ]);
}

/// The highest voltage, V, that a film stands at a deflection, m: its field grows as the voltage, its Maxwell stress as the square.
fn highest_voltage(membrane: &Membrane, deflection: f64) -> f64 {
    /// A voltage, V, at which shares of the limits have all their digits.
    const PROBE: f64 = 1e3;
    let [_, field, stress, _] = membrane.over_limits(deflection, PROBE);
    (PROBE / field).min(PROBE / stress.sqrt())
}
