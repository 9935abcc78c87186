//! Node voltages for given charges: the nonlinear equations of one stage of the implicit Runge-Kutta method.
//!
//! Every equation is reduced to a scalar one that rises monotonically, and is solved inside a bracket: unlike a
//! plain Newton iteration over exponentials, this cannot diverge or overflow. Where equations are nested, behind Zener
//! diodes, Newton's method is tried on all of them at once, which from a good guess is much the quicker.

use core::cell::Cell;

use crate::devices::Devices;
use crate::parameters::Release;
use crate::roots::{NEWTON, increasing, newton};

/// Part of the shortest voltage over which a current changes by a factor, whose square is below rounding.
const SQUARED_IS_NOTHING: f64 = 1e-8;

/// Voltages and currents that solve the node equations.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Point {
    /// Node voltages (V).
    pub voltage: [f64; 2],
    /// Load voltage (V).
    pub load_voltage: f64,
    /// Currents of the charging diodes (A).
    pub supply: [f64; 2],
    /// Currents of the release elements (A).
    pub release: [f64; 2],
}

/// The equations `C_j V_j - charge_j = span (I_supply,j - I_release,j)`. A leak through the film, `l C_j V_j`, is a
/// capacitance that is larger by `1 + span l` here.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeEquations<'a> {
    pub devices: &'a Devices,
    /// Number of nodes.
    pub count: usize,
    /// Capacitances at the end of the stage, with the leak (F).
    pub capacitance: [f64; 2],
    /// Charges without the stage's own currents (C).
    pub charge: [f64; 2],
    /// Step times the diagonal coefficient (s).
    pub span: f64,
    /// Counts the trial voltages where Newton's method does not settle.
    pub trials: &'a Cell<usize>,
}

impl NodeEquations<'_> {
    /// Solves, starting from `guess`; `None` if that fails.
    pub fn solve(&self, guess: &Point) -> Option<Point> {
        match self.devices.release {
            Release::Zener => self.zeners(guess),
            Release::Switch => self.switches(guess),
            Release::Storage => self.apart(guess, |v| self.devices.storing(v)),
        }
    }

    /// Voltage of node `j` whose release current and its slope depend on the voltage as given.
    fn node(&self, j: usize, guess: f64, release: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let balance = |v: f64| {
            let (supplied, supply_slope) = self.devices.charging(v);
            let (released, release_slope) = release(v);
            (
                self.capacitance[j] * v - self.charge[j] - self.span * (supplied - released),
                self.capacitance[j] + self.span * (supply_slope + release_slope),
            )
        };
        newton(balance, guess, self.resolved([guess; 2])).or_else(|| self.searched(balance, guess))
    }

    /// Root of an increasing `balance` near `guess` where Newton's method has not settled: each trial is counted.
    fn searched(&self, mut balance: impl FnMut(f64) -> (f64, f64), guess: f64) -> Option<f64> {
        let counted = |voltage| {
            self.trials.set(self.trials.get().saturating_add(1));
            balance(voltage)
        };
        increasing(counted, guess, self.devices.reach())
    }

    /// A step of Newton's method after which there is nothing left to gain (V): the next would be shorter than the last
    /// bit of the voltages, or by its square than that of the currents.
    fn resolved(&self, guess: [f64; 2]) -> f64 {
        let highest = guess.into_iter().fold(self.devices.supply, f64::max);
        (2.0 * f64::EPSILON * highest).max(SQUARED_IS_NOTHING * self.devices.steepest())
    }

    /// Nodes behind Zener diodes, all at once, by Newton's method; `None` where it does not settle.
    fn zeners_at_once(&self, guess: &Point) -> Option<Point> {
        let g = self.devices.conductance;
        let mut point = *guess;
        let resolved = self.resolved(guess.voltage);
        for _ in 0..NEWTON {
            // Of the load: what its voltage lacks of taking the Zener currents, and the slope of that, in terms of the
            // node voltages. Of the nodes: their Newton steps at constant load voltage, and how they follow that of the load.
            let (mut lacking, mut slope) = (-g * point.load_voltage, g);
            let (mut step, mut following) = ([0.0; 2], [0.0; 2]);
            for j in 0..self.count {
                let v = point.voltage[j];
                let (supplied, supply_slope) = self.devices.charging(v);
                let (released, release_slope) = self.devices.zener(v - point.load_voltage);
                let rest = self.capacitance[j] + self.span * supply_slope;
                let whole = rest + self.span * release_slope;
                step[j] = (self.charge[j] + self.span * (supplied - released) - self.capacitance[j] * v) / whole;
                following[j] = self.span * release_slope / whole;
                lacking += released + release_slope * step[j];
                slope += release_slope * (rest / whole);
            }
            let rise = if g == f64::INFINITY { -point.load_voltage } else { lacking / slope };
            point.load_voltage += rise;
            // NaN never settles.
            let settles = |step: f64| step.abs() <= resolved;
            let mut settled = settles(rise);
            for j in 0..self.count {
                let moved = step[j] + following[j] * rise;
                point.voltage[j] += moved;
                settled &= settles(moved);
            }
            if settled {
                return Some(point);
            }
        }
        None
    }

    /// Nodes behind Zener diodes.
    fn zeners(&self, guess: &Point) -> Option<Point> {
        if self.devices.conductance == 0.0 {
            return self.unloaded(guess);
        }
        let mut point = self.zeners_at_once(guess).or_else(|| self.zeners_nested(guess))?;
        for j in 0..self.count {
            let v = point.voltage[j];
            let currents = [self.devices.charging(v), self.devices.zener(v - point.load_voltage)];
            [point.supply[j], point.release[j]] = self.balanced(j, v, currents);
        }
        Some(point)
    }

    /// Nodes behind Zener diodes: solved for a trial load voltage, which Kirchhoff's law at the load corrects.
    fn zeners_nested(&self, guess: &Point) -> Option<Point> {
        let g = self.devices.conductance;
        let mut point = *guess;
        let load_voltage = if g == f64::INFINITY {
            0.0
        } else {
            let balance = |trial: f64| match self.behind_zeners(trial, &mut point) {
                Some((current, slope)) => (g * trial - current, g - slope),
                None => (f64::NAN, f64::NAN),
            };
            self.searched(balance, guess.load_voltage)?
        };
        self.behind_zeners(load_voltage, &mut point)?;
        Some(point)
    }

    /// An open load takes no charge; its voltage is what a breakdown without leakage would leave.
    fn unloaded(&self, guess: &Point) -> Option<Point> {
        let mut point = self.apart(guess, |_| (0.0, 0.0))?;
        let top = point.voltage[..self.count].iter().copied().fold(0.0, f64::max);
        point.load_voltage = (top - self.devices.threshold).max(0.0);
        Some(point)
    }

    /// Nodes whose release currents do not depend on each other; the load is at the voltage of release, as a storage.
    fn apart(&self, guess: &Point, release: impl Fn(f64) -> (f64, f64)) -> Option<Point> {
        let mut point = Point { load_voltage: self.devices.threshold, ..Point::default() };
        for j in 0..self.count {
            let v = self.node(j, guess.voltage[j], &release)?;
            point.voltage[j] = v;
            [point.supply[j], point.release[j]] = self.balanced(j, v, [self.devices.charging(v), release(v)]);
        }
        Some(point)
    }

    /// Solves the nodes for a load voltage; sum of the Zener currents and its slope.
    fn behind_zeners(&self, load_voltage: f64, point: &mut Point) -> Option<(f64, f64)> {
        let mut sum = (0.0, 0.0);
        let moved = load_voltage - point.load_voltage;
        for j in 0..self.count {
            let guess = point.voltage[j] + moved * self.following(j, point);
            let v = self.node(j, guess, |v| self.devices.zener(v - load_voltage))?;
            let supply_slope = self.devices.charging(v).1;
            let (released, slope) = self.devices.zener(v - load_voltage);
            point.voltage[j] = v;
            // The node voltage follows the load voltage in part: derivative of the implicit function.
            let rest = self.capacitance[j] + self.span * supply_slope;
            sum.0 += released;
            sum.1 -= slope * (rest / (rest + self.span * slope));
        }
        point.load_voltage = load_voltage;
        Some(sum)
    }

    /// Supply and release current of node `j`, from their values and slopes at the solution.
    ///
    /// Where an element is so steep that the last bit of the voltage moves much current, its current is taken from
    /// the charge balance instead, which determines it to rounding.
    fn balanced(&self, j: usize, voltage: f64, currents: [(f64, f64); 2]) -> [f64; 2] {
        let [(supplied, supply_slope), (released, release_slope)] = currents;
        let net = (self.capacitance[j] * voltage - self.charge[j]) / self.span;
        if self.span * supply_slope.max(release_slope) < self.capacitance[j] {
            [supplied, released]
        } else if supply_slope > release_slope {
            [net + released, released]
        } else {
            [supplied, supplied - net]
        }
    }

    /// How far the voltage of node `j` follows that of the load: 0 when blocked, almost 1 when releasing.
    fn following(&self, j: usize, point: &Point) -> f64 {
        let v = point.voltage[j];
        let release = self.span * self.devices.zener(v - point.load_voltage).1;
        release / (self.capacitance[j] + self.span * self.devices.charging(v).1 + release)
    }

    /// Nodes behind switches.
    fn switches(&self, guess: &Point) -> Option<Point> {
        let mut point = *guess;
        if self.count == 1 {
            point.voltage[0] = self.node(0, guess.voltage[0], |v| self.devices.switch(v))?;
        } else {
            point.voltage = self.switches_at_once(guess).or_else(|| self.switches_nested(guess))?;
        }
        self.switch_currents(&mut point);
        Some(point)
    }

    /// Voltages of two nodes behind switches by Newton's method; `None` where it does not settle.
    fn switches_at_once(&self, guess: &Point) -> Option<[f64; 2]> {
        let resolved = self.resolved(guess.voltage);
        let mut voltage = guess.voltage;
        for _ in 0..NEWTON {
            // Of each node: what it lacks of its charge, and the slopes of that in its own and the other voltage.
            let [(lacking_0, own_0, cross_0), (lacking_1, own_1, cross_1)] = [0, 1].map(|j| {
                let (supplied, supply_slope) = self.devices.charging(voltage[j]);
                let (released, own, cross) = self.switch_beside(voltage[j], voltage[1 - j]);
                let lacking = self.charge[j] + self.span * (supplied - released) - self.capacitance[j] * voltage[j];
                (lacking, self.capacitance[j] + self.span * (supply_slope + own), self.span * cross)
            });
            // Cramer's rule, both equations scaled.
            let (apart_0, apart_1) = (cross_0 / own_0, cross_1 / own_1);
            let determinant = 1.0 - apart_0 * apart_1;
            let step = [
                (lacking_0 / own_0 - apart_0 * (lacking_1 / own_1)) / determinant,
                (lacking_1 / own_1 - apart_1 * (lacking_0 / own_0)) / determinant,
            ];
            for j in 0..2 {
                voltage[j] += step[j];
            }
            // NaN never is.
            if step.iter().all(|step| step.abs() <= resolved) {
                return Some(voltage);
            }
        }
        None
    }

    /// Voltages of two nodes behind switches: node 1 solved for a trial voltage of node 0.
    fn switches_nested(&self, guess: &Point) -> Option<[f64; 2]> {
        let mut second = guess.voltage[1];
        let balance = |first: f64| self.beside_switch(first, &mut second).unwrap_or((f64::NAN, f64::NAN));
        let first = self.searched(balance, guess.voltage[0])?;
        self.beside_switch(first, &mut second)?;
        Some([first, second])
    }

    /// Balance of node 0 and its slope, node 1 being solved for the voltage of node 0.
    fn beside_switch(&self, first: f64, second: &mut f64) -> Option<(f64, f64)> {
        let v = self.node(1, *second, |v| {
            let (current, slope, _) = self.switch_beside(v, first);
            (current, slope)
        })?;
        *second = v;
        let (current_0, own_0, cross_0) = self.switch_beside(first, v);
        let (_, own_1, cross_1) = self.switch_beside(v, first);
        let (supplied, supply_slope) = self.devices.charging(first);
        let diagonal_0 = self.capacitance[0] + self.span * (supply_slope + own_0);
        let diagonal_1 = self.capacitance[1] + self.span * (self.devices.charging(v).1 + own_1);
        let coupling = self.span * cross_0 * (self.span * cross_1 / diagonal_1);
        Some((self.capacitance[0] * first - self.charge[0] - self.span * (supplied - current_0), diagonal_0 - coupling))
    }

    /// Current of a switch beside another node, with its slopes in its own and the other voltage.
    fn switch_beside(&self, voltage: f64, other: f64) -> (f64, f64, f64) {
        let (current, slope) = self.devices.switch(voltage);
        let (part, part_slope) = self.devices.precedence(voltage, other);
        (current * part, slope * part + current * part_slope, -current * part_slope)
    }

    fn switch_currents(&self, point: &mut Point) {
        for j in 0..self.count {
            let v = point.voltage[j];
            let release = if self.count == 1 {
                self.devices.switch(v)
            } else {
                let (current, slope, _) = self.switch_beside(v, point.voltage[1 - j]);
                (current, slope)
            };
            let currents = [self.devices.charging(v), release];
            [point.supply[j], point.release[j]] = self.balanced(j, v, currents);
        }
        let current: f64 = point.release[..self.count].iter().sum();
        // An open load has no current, and no voltage that would follow from it.
        point.load_voltage = if current == 0.0 { 0.0 } else { current * self.devices.resistance };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{DiodeParameters, Parameters};
    use approx::assert_relative_eq;

    #[test]
    fn nested_equations_keep_the_load_in_balance_where_a_trial_ends_at_rounding() {
        let parameters = Parameters { zener_voltage: 2450.0, ..Parameters::default() };
        let devices = Devices::new(&parameters, &DiodeParameters::default());
        let capacitance = [32.774_600_327_305_6e-12, 15e-12];
        let equations = NodeEquations {
            devices: &devices,
            count: 1,
            capacitance,
            charge: [capacitance[0] * 2_452.133_521_7, 0.0],
            span: 0.25 * 2.313_214_4e-4,
            trials: &Cell::default(),
        };
        let guess = Point { voltage: [2446.9, 0.0], load_voltage: 1e-4, ..Point::default() };
        let point = equations.zeners(&guess).unwrap();
        assert_relative_eq!(point.load_voltage, devices.resistance * point.release[0], max_relative = 1e-6);
    }
}
