//! A step in closed form while each element either conducts or does not: the solution with ideal elements, each with the
//! drop that its exponential has at the current that flows.
//!
//! - An element to a constant voltage that conducts takes the node within nanoseconds to where it passes what the ramp
//!   needs, `k V`, and holds it there: the voltage of a linear ramp is constant.
//! - Where no element conducts, constant currents leak.
//! - The drop of a Zener diode with a load behind it, `BV' + NBV Vt ln(I / IS)`, hardly changes during a step: the ideal
//!   discharge behind its mean.
//!
//! Each of them estimates what it leaves out. Where this is too much, as in all steps in which an element begins or ceases
//! to conduct, [`step`](super::step) integrates.

use crate::devices::Devices;
use crate::node_equations::Point;
use crate::parameters::Release;
use crate::release::Discharge;

use super::Exponential;
use super::step::{Flow, Step, larger};

/// Trial currents for the voltage that an element holds.
const TRIALS: usize = 4;

/// Exponents beyond this leave nothing that rounding would keep.
const SETTLED: f64 = 40.0;

/// Load voltage that may be off from that of the last step, over itself: one step of Newton's method corrects it.
const STALE: f64 = 1e-6;

/// Part of the tolerance that one step may leave out: what it leaves out has the same sign step after step.
const SHARE: f64 = 0.01;

/// The linear ramp of a node's capacitance.
#[derive(Debug, Clone, Copy, Default)]
struct Ramp {
    /// Charge at the start (C).
    charge: f64,
    /// Capacitances at the start and at the end (F).
    capacitance: [f64; 2],
    /// Rate of the capacitance (F/s).
    rate: f64,
    /// Node voltage at the start (V).
    voltage: f64,
    /// Length (s).
    length: f64,
}

/// What a node does in a step.
#[derive(Debug, Clone, Copy, Default)]
struct Passed {
    /// Voltage at the end, and its mean (V).
    voltage: f64,
    mean: f64,
    /// Charges through the charging diode and the release element (C).
    drawn: f64,
    released: f64,
    /// The same currents at the end (A).
    currents: [f64; 2],
    /// Work of the mechanics (J).
    mechanical: f64,
    /// Charge (C) and energy (J) that the closed form leaves out.
    missed: [f64; 2],
}

/// What a node does that discharges into the load.
struct Led {
    node: usize,
    passed: Passed,
    /// Energy of the load (J), and what of it the closed form leaves out.
    load: f64,
    missed_load: f64,
    /// Mean drop between node and load (V).
    drop: f64,
    /// Load voltage at the end (V).
    excess: f64,
}

impl<const LEAKS: bool> Exponential<'_, LEAKS> {
    /// One step of `h` seconds from `start`, `elapsed` seconds after the start of the call, in closed form; `None` where
    /// there is none that is accurate.
    pub fn closed(&self, start: &Flow<LEAKS>, from: &Point, elapsed: f64, h: f64) -> Option<Step<LEAKS>> {
        if LEAKS {
            return None;
        }
        let d = self.devices;
        let ramps = self.ramps(start, elapsed, h);
        let resistive = d.release == Release::Zener && d.conductance < f64::INFINITY;
        let behind = if resistive { from.load_voltage } else { 0.0 };
        let has_load = d.conductance > 0.0 || d.release == Release::Storage;
        let conducts = |j: usize| has_load && ramps[j].voltage - behind > d.release_edge();
        let leads = |j: usize| conducts(j) && (resistive || d.release == Release::Switch);
        let leader = (0..self.count).find(|j| leads(*j));
        let mut passed = [Passed::default(); 2];
        for j in (0..self.count).filter(|j| Some(*j) != leader) {
            passed[j] = match () {
                () if leads(j) => return None,
                () if conducts(j) => ramps[j].held(d)?,
                () => ramps[j].without_release(d, |v| leaking(d, v - behind, has_load)),
            };
        }
        let led = match leader {
            Some(j) => Some(self.led(j, &ramps[j], &passed[1 - j], behind)?),
            None => None,
        };
        self.finish(start, &ramps, passed, led.as_ref(), [elapsed, behind])
    }

    fn ramps(&self, start: &Flow<LEAKS>, elapsed: f64, h: f64) -> [Ramp; 2] {
        let charges = self.charges(start);
        let (from, to) = (self.capacitances(elapsed), self.capacitances(elapsed + h));
        [0, 1].map(|j| Ramp {
            charge: charges[j],
            capacitance: [from[j], to[j]],
            rate: self.rate[j],
            voltage: charges[j] / from[j],
            length: h,
        })
    }

    /// The node `j` that discharges into the load, beside `other`, from the load voltage `behind` (V) of the last step on.
    fn led(&self, j: usize, ramp: &Ramp, other: &Passed, behind: f64) -> Option<Led> {
        let d = self.devices;
        match d.release {
            Release::Switch if ramp.voltage < d.closed_from() => {
                let passed = ramp.held(d)?;
                let (load, excess) = (passed.mean * passed.released, passed.voltage);
                Some(Led { node: j, passed, load, missed_load: 0.0, drop: 0.0, excess })
            }
            Release::Switch => ramp.discharged(d, j, 0.0, 0.0).filter(|led| led.passed.voltage >= d.closed_from()),
            Release::Zener | Release::Storage => ramp.discharged(d, j, other.currents[1], behind),
        }
    }

    /// Adds up what the nodes have passed; `None` where that leaves out too much.
    fn finish(
        &self,
        start: &Flow<LEAKS>,
        ramps: &[Ramp; 2],
        mut passed: [Passed; 2],
        led: Option<&Led>,
        [elapsed, behind]: [f64; 2],
    ) -> Option<Step<LEAKS>> {
        if let Some(led) = led {
            passed[led.node] = led.passed;
        }
        let (mut flow, mut point) = (*start, Point::default());
        point.load_voltage = self.load_voltage(&passed, led, behind)?;
        let scale = self.scale(start, elapsed, point.load_voltage.max(behind));
        let mut error: f64 = 0.0;
        if led.is_none() && self.devices.release == Release::Zener {
            flow.load += point.load_voltage * (passed[0].released + passed[1].released);
        }
        if let Some(led) = led {
            flow.load += led.load;
            let beside = self.beside(led, ramps, &passed, point.load_voltage)?;
            error = larger(beside / scale.charge, led.missed_load / scale.load);
        }
        for (j, it) in passed.iter().enumerate().take(self.count) {
            error = larger(error, larger(it.missed[0] / scale.charge, it.missed[1] / scale.energy));
            flow.drawn[j] += it.drawn;
            flow.released[j] += it.released;
            flow.mechanical += it.mechanical;
            flow.diode += (self.devices.supply - it.mean) * it.drawn;
            let led = led.filter(|led| led.node == j);
            self.release(&mut flow, it, led, 0.5 * (behind + point.load_voltage));
            point.voltage[j] = it.voltage;
            [point.supply[j], point.release[j]] = it.currents;
        }
        let allowed = SHARE * self.solver.relative_tolerance;
        let sum = flow.load + flow.zener + flow.diode + flow.mechanical + point.voltage[0] + point.voltage[1];
        // NaN never is.
        (error <= allowed && sum.is_finite()).then_some(Step { flow, point, error: error / allowed })
    }

    /// Energies of the charge that a node has released, beside that of the load that it leads.
    fn release(&self, flow: &mut Flow<LEAKS>, it: &Passed, led: Option<&Led>, load_voltage: f64) {
        match (self.devices.release, led) {
            (Release::Zener, Some(led)) => flow.zener += led.drop * it.released,
            (Release::Zener, None) => flow.zener += (it.mean - load_voltage) * it.released,
            (Release::Storage, _) => {
                flow.load += self.devices.threshold * it.released;
                flow.diode += (it.mean - self.devices.threshold) * it.released;
            }
            (Release::Switch, _) => {}
        }
    }

    /// Load voltage at the end (V).
    fn load_voltage(&self, passed: &[Passed; 2], led: Option<&Led>, behind: f64) -> Option<f64> {
        let d = self.devices;
        let current = passed[0].currents[1] + passed[1].currents[1];
        match (d.release, led) {
            (Release::Storage, _) => Some(d.threshold),
            (Release::Zener, Some(led)) => Some(led.excess),
            (Release::Zener, None) if d.conductance == 0.0 => {
                let top = passed[..self.count].iter().map(|it| it.voltage).fold(0.0, f64::max);
                Some((top - d.threshold).max(0.0))
            }
            (Release::Zener, None) => {
                let leaked = current * d.resistance;
                // A load voltage that still falls to what leaks is a transient.
                ((leaked - behind).abs() <= d.zener_slope() || d.resistance == 0.0).then_some(leaked)
            }
            (Release::Switch, Some(led)) if d.conductance > 0.0 => Some(led.passed.currents[1] * d.resistance),
            (Release::Switch, _) => Some(0.0),
        }
    }

    /// What passes the node beside the one that leads and is left out (C); `None` where the load might follow it, too.
    fn beside(&self, led: &Led, ramps: &[Ramp; 2], passed: &[Passed; 2], load_voltage: f64) -> Option<f64> {
        let d = self.devices;
        if self.count == 1 {
            return Some(0.0);
        }
        let (other, ramp) = (&passed[1 - led.node], &ramps[1 - led.node]);
        match d.release {
            Release::Switch => {
                let highest = ramp.voltage.max(other.voltage);
                let lowest = ramps[led.node].voltage.min(led.passed.voltage);
                (highest + d.clearance() <= lowest).then_some(0.0)
            }
            Release::Zener | Release::Storage => {
                Some(((d.zener(other.voltage - load_voltage).0 - other.currents[1]) * ramp.length).abs())
            }
        }
    }
}

/// Current of a release element that does not conduct, at a voltage across it and its load (A).
fn leaking(d: &Devices, voltage: f64, has_load: bool) -> f64 {
    match d.release {
        Release::Zener if has_load => d.zener(voltage).0,
        Release::Switch if has_load => d.switch(voltage).0,
        Release::Storage => d.storing(voltage).0,
        Release::Zener | Release::Switch => 0.0,
    }
}

impl Ramp {
    fn grown(&self) -> f64 {
        (self.capacitance[1] - self.capacitance[0]) / self.capacitance[0]
    }

    /// At most the charging diode conducts.
    fn without_release(&self, d: &Devices, leaking: impl Fn(f64) -> f64) -> Passed {
        let charged = if self.voltage < d.supply { self.charged(d, &leaking) } else { None };
        charged.unwrap_or_else(|| self.idle(d, &leaking))
    }

    /// The charging diode holds the node, while the current `leaking` at a node voltage (A) passes the release element.
    fn charged(&self, d: &Devices, leaking: impl Fn(f64) -> f64) -> Option<Passed> {
        let mut passed = self.settled(|i| d.supplying_at(i), |v| self.rate * v + leaking(v), 1.0)?;
        let current = leaking(passed.voltage);
        passed.released = current * self.length;
        passed.drawn = self.capacitance[1] * passed.voltage - self.charge + passed.released;
        passed.currents = [self.rate * passed.voltage + current, current];
        passed.missed[0] += ((leaking(self.voltage) - current) * self.length).abs();
        Some(passed)
    }

    /// The release element holds the node.
    fn held(&self, d: &Devices) -> Option<Passed> {
        let supplied = |v: f64| d.charging(v).0;
        let mut passed = self.settled(|i| d.held_at(i), |v| supplied(v) - self.rate * v, -1.0)?;
        if d.release == Release::Switch && !(d.threshold..d.closed_from()).contains(&passed.voltage) {
            return None;
        }
        let current = supplied(passed.voltage);
        passed.drawn = current * self.length;
        passed.released = self.charge - self.capacitance[1] * passed.voltage + passed.drawn;
        passed.currents = [current, current - self.rate * passed.voltage];
        passed.missed[0] += ((supplied(self.voltage) - current) * self.length).abs();
        Some(passed)
    }

    /// Voltage at which an element passes what the ramp needs, by the element's voltage and slope at a current and by the
    /// current needed at a voltage. `sign` is 1 where the current grows with a falling voltage.
    fn settled(&self, element: impl Fn(f64) -> (f64, f64), needed: impl Fn(f64) -> f64, sign: f64) -> Option<Passed> {
        let (mut voltage, mut found) = (self.voltage, None);
        for _ in 0..TRIALS {
            let current = needed(voltage);
            if current.is_nan() || current <= 0.0 {
                return None;
            }
            let (next, slope) = element(current);
            let moved = (next - voltage).abs();
            voltage = next;
            // By how much the next trial would move it.
            if moved * self.rate.abs() <= slope * (f64::EPSILON * voltage) {
                found = Some((slope, current / slope));
                break;
            }
        }
        let (slope, reach) = found?;
        let [from, to] = self.capacitance;
        // In units of the time constant at the end, what is left for it after a way on which the current is smaller.
        let way = sign * (self.voltage - voltage);
        let rest = (slope + sign * self.rate) * (self.length / from.max(to)) - way.max(0.0) / reach;
        if rest.is_nan() || rest <= 0.0 {
            return None;
        }
        let left = if rest < SETTLED { (-rest).exp() } else { 0.0 };
        let missed = [to * way.abs() * left, from * way.abs() * way.abs().max(reach)];
        let mechanical = -0.5 * voltage * voltage * (to - from);
        Some(Passed { voltage, mean: voltage, mechanical, missed, ..Passed::default() })
    }

    /// No element conducts, and constant currents leak.
    fn idle(&self, d: &Devices, leaking: impl Fn(f64) -> f64) -> Passed {
        let (h, [from, to]) = (self.length, self.capacitance);
        let currents = |v: f64| [d.charging(v).0, leaking(v)];
        let before = currents(self.voltage);
        let after = currents((self.charge + (before[0] - before[1]) * h) / to);
        let [drawn, released] = [0, 1].map(|i| 0.5 * (before[i] + after[i]) * h);
        let net = drawn - released;
        let voltage = (self.charge + net) / to;
        let middle = (self.charge + 0.5 * net) / (0.5 * (from + to));
        // When the mean of 1/C^2 is reached, as a part of the ramp.
        let u = self.grown();
        let when = if u.abs() < 1e-4 { 0.5 } else { (1.0 + u) * (u.ln_1p() - u / (1.0 + u)) / (u * u) };
        let charge = self.charge + net * when;
        // The error of the mean currents, if they change exponentially.
        let missed = [0, 1].map(|i| {
            let changed = after[i] - before[i];
            if changed == 0.0 { 0.0 } else { h * changed * changed / before[i].abs().max(after[i].abs()) }
        });
        let bent = (self.voltage - 2.0 * middle + voltage).abs();
        let missed_energy = net * net / to * u.abs() + (drawn.abs() + released.abs()) * bent;
        Passed {
            voltage,
            mean: (self.voltage + 4.0 * middle + voltage) / 6.0,
            drawn,
            released,
            currents: after,
            mechanical: 0.5 * charge * (charge / to) * ((from - to) / from),
            missed: [missed[0] + missed[1], missed_energy],
        }
    }

    /// The node `j` discharges into the load, which takes the current `beside` (A) from the other node, too; from the load voltage
    /// `behind` (V) of the last step on.
    fn discharged(&self, d: &Devices, j: usize, beside: f64, behind: f64) -> Option<Led> {
        let (g, [from, to], h) = (d.conductance, self.capacitance, self.length);
        let own = |excess: f64| g * excess - beside;
        let (steep, excess) = match d.release {
            Release::Switch | Release::Storage => (0.0, self.voltage),
            Release::Zener => (d.zener_slope(), self.behind_zener(d, own, behind)?),
        };
        let (supplied, drop) = (d.charging(self.voltage).0, self.voltage - excess);
        // What leaks into the node adds to the current of the load.
        let bias = (supplied + beside) / g;
        let discharge = |drop: f64| self.behind(drop + bias, g);
        let rough = discharge(drop);
        let [middle, last] = [0.5 * h, h].map(|t| rough.excess_at(t) + bias);
        let growth = |w: f64| if steep == 0.0 { 0.0 } else { steep * (own(w) / own(excess)).ln() };
        let [half, whole] = [middle, last].map(growth);
        let mean = (4.0 * half + whole) / 6.0;
        let fine = discharge(drop + mean);
        let span = fine.span(h);
        let voltage = span.excess + fine.drop;
        let after = voltage - (drop + whole);
        let (work, gone) = (fine.work(&span), self.charge - to * voltage);
        let part = from.max(to) * (g * h / from.min(to)).min(1.0);
        let missed = part * ((half - 0.5 * whole).abs() + mean.abs() * (steep / excess.min(after)).abs());
        let turned = (d.charging(voltage).0 - supplied).abs() * h;
        let passed = Passed {
            voltage,
            mean: (self.voltage + 4.0 * (middle + drop) + voltage) / 6.0,
            drawn: supplied * h,
            released: gone + supplied * h,
            currents: [supplied, own(after)],
            mechanical: work.mechanical,
            missed: [missed + turned, part * whole.abs() * (self.grown() * voltage).abs()],
        };
        let load = work.load + 2.0 * bias * gone + g * bias * bias * h;
        let missed_load = part * whole.abs() * (after - excess).abs() + missed * after;
        (after > 0.0).then_some(Led { node: j, passed, load, missed_load, drop: drop + mean, excess: after })
    }

    /// The discharge behind a drop (V) into a conductance (S).
    fn behind(&self, drop: f64, conductance: f64) -> Discharge {
        let (capacitance, rate, excess) = (self.capacitance[0], self.rate, self.voltage - drop);
        Discharge { capacitance, rate, conductance, drop, excess, leak: 0.0 }
    }

    /// Load voltage behind a Zener diode (V), from its current at a load voltage.
    fn behind_zener(&self, d: &Devices, own: impl Fn(f64) -> f64, behind: f64) -> Option<f64> {
        let current = own(behind);
        if current.is_nan() || current <= 0.0 {
            return None;
        }
        let lacking = self.voltage - behind - d.zener_drop(current);
        let moved = lacking / (1.0 + d.zener_slope() * d.conductance / current);
        (moved.abs() <= STALE * behind).then_some(behind + moved)
    }
}
