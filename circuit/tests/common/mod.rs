//! Shared by the tests: capacitance signals, and a solver that has nothing in common with the crate's.
#![allow(dead_code, clippy::unwrap_used)]

use proptest::prelude::*;
use videg_circuit::{Circuit, Ledger, Parameters, Release, Topology};

/// A piece of a piecewise linear signal: its length [s] and the capacitances at its end [F].
pub type Ramp = (f64, [f64; 2]);

/// Half-sine pulse of the left capacitance by `height`, cut into `pieces` ramps, then rest until `period`.
pub fn pulse(rest: [f64; 2], height: f64, length: f64, period: f64, pieces: u32) -> Vec<Ramp> {
    let dt = length / f64::from(pieces);
    let at = |i: u32| {
        let phase = std::f64::consts::PI * f64::from(i) / f64::from(pieces);
        [rest[0] + height * phase.sin(), rest[1]]
    };
    let mut ramps: Vec<Ramp> = (1..pieces).map(|i| (dt, at(i))).collect();
    ramps.push((dt, rest));
    ramps.push((period - length, rest));
    ramps
}

/// Supply voltage (V), capacitances at rest and at the peak of [`steady_cycle`] (F).
pub const U: f64 = 2000.0;
pub const C2: f64 = 15e-12;
pub const C3: f64 = 27e-12;
pub const TOPOLOGIES: [Topology; 2] = [Topology::SharedNode, Topology::Isolated];

/// `C2`, `C3` of the node: the idle membrane lies in parallel on a shared node.
pub fn node(topology: Topology) -> (f64, f64) {
    match topology {
        Topology::SharedNode => (C2 + C2, C3 + C2),
        Topology::Isolated => (C2, C3),
    }
}

/// A circuit with both membranes at rest, and the ledger of its third pulse of one second on the left membrane.
pub fn steady_cycle(parameters: Parameters) -> (Circuit, Ledger) {
    let mut circuit = Circuit::new(parameters, [C2; 2]).unwrap();
    let ledger = last_cycle(&mut circuit, &pulse([C2; 2], C3 - C2, 1.0, 3.0, 200), 3);
    (circuit, ledger)
}

pub fn run(circuit: &mut Circuit, ramps: &[Ramp]) {
    for &(dt, ends) in ramps {
        circuit.advance(dt, ends).unwrap();
    }
}

/// Ledger of the last of `cycles` cycles.
pub fn last_cycle(circuit: &mut Circuit, ramps: &[Ramp], cycles: usize) -> Ledger {
    for _ in 1..cycles {
        run(circuit, ramps);
    }
    let before = circuit.ledger();
    run(circuit, ramps);
    difference(&circuit.ledger(), &before)
}

pub fn difference(a: &Ledger, b: &Ledger) -> Ledger {
    a.flows_since(b, 1.0)
}

/// Sum of all energies, the scale of the ledger's error.
pub fn moved(ledger: &Ledger) -> f64 {
    ledger.supply.abs()
        + ledger.load.abs()
        + ledger.zener.abs()
        + ledger.leakage.abs()
        + ledger.mechanical.abs()
        + ledger.stored.abs()
}

/// Every circuit: topology and release.
pub fn kinds() -> Vec<(Topology, Release)> {
    let releases = [Release::Zener, Release::Switch, Release::Storage];
    TOPOLOGIES.into_iter().flat_map(|topology| releases.map(|release| (topology, release))).collect()
}

/// A value of these decades.
pub fn decades(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|d| 10.0_f64.powf(d))
}

/// Any of the `kinds` that releases at the supply voltage, or at up to `most` times that, with a load, ohm, and a time constant of the
/// leakage, s.
pub fn parameters(
    kinds: Vec<(Topology, Release)>,
    most: f64,
    load: impl Strategy<Value = f64>,
    leakage: impl Strategy<Value = f64>,
) -> impl Strategy<Value = Parameters> {
    let circuit = (prop::sample::select(kinds), prop_oneof![Just(U), U..U * most], load, leakage);
    circuit.prop_map(|((topology, release), voltage, load_resistance, leakage_time_constant)| Parameters {
        zener_voltage: voltage,
        storage_voltage: voltage,
        load_resistance,
        leakage_time_constant,
        topology,
        release,
        ..Parameters::default()
    })
}

/// No leakage in half of the cases, else time constants (s) of these decades.
pub fn leakage(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), decades(range)]
}

/// The sums of the independent solver: supply charge, load charge, energies of load, Zener diodes and leakage, final charges.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reference {
    pub supply_charge: f64,
    pub load_charge: f64,
    pub load: f64,
    pub zener: f64,
    pub leakage: f64,
    pub charge: [f64; 2],
}

/// Implicit Euler time stepping of the complementarity problem, `steps` to a ramp, with one Richardson
/// extrapolation. No events, no modes: every step intersects the nodes' charge with the load line.
pub fn reference(parameters: &Parameters, start: [f64; 2], ramps: &[Ramp], steps: u32) -> Reference {
    let coarse = stepped(parameters, start, ramps, steps);
    let fine = stepped(parameters, start, ramps, 2 * steps);
    let extrapolate = |c: f64, f: f64| 2.0 * f - c;
    Reference {
        supply_charge: extrapolate(coarse.supply_charge, fine.supply_charge),
        load_charge: extrapolate(coarse.load_charge, fine.load_charge),
        load: extrapolate(coarse.load, fine.load),
        zener: extrapolate(coarse.zener, fine.zener),
        leakage: extrapolate(coarse.leakage, fine.leakage),
        charge: [extrapolate(coarse.charge[0], fine.charge[0]), extrapolate(coarse.charge[1], fine.charge[1])],
    }
}

fn stepped(parameters: &Parameters, start: [f64; 2], ramps: &[Ramp], steps: u32) -> Reference {
    let node = |c: [f64; 2]| match parameters.topology {
        Topology::SharedNode => [c[0] + c[1], f64::MIN_POSITIVE],
        Topology::Isolated => c,
    };
    let mut from = start;
    let mut sums = Reference { charge: node(from).map(|c| c * parameters.supply_voltage), ..Reference::default() };
    let mut conducting = [false; 5];
    for &(dt, to) in ramps {
        // Short against the time constant of the load, too.
        let relaxation = dt / (load_resistance(parameters) * 5e-12);
        let mut refine = 1;
        while 20.0 * f64::from(refine) < relaxation && refine < 20 {
            refine += 1;
        }
        let steps = steps * refine;
        let h = dt / f64::from(steps);
        for i in 0..steps {
            let at = |part: f64| {
                let part = (f64::from(i) + part) / f64::from(steps);
                node([0, 1].map(|j| from[j] + (to[j] - from[j]) * part))
            };
            let before = sums;
            let after = euler(parameters, &mut sums, at(1.0), h);
            if after != conducting {
                // A current may jump inside this step: go through it again in small ones.
                sums = before;
                for fine in 1..=REFINEMENT {
                    let part = f64::from(fine) / f64::from(REFINEMENT);
                    euler(parameters, &mut sums, at(part), h / f64::from(REFINEMENT));
                }
                conducting = after;
            }
        }
        from = to;
    }
    sums
}

/// A storage has no time constant to resolve.
fn load_resistance(parameters: &Parameters) -> f64 {
    if parameters.release == Release::Storage { f64::INFINITY } else { parameters.load_resistance }
}

/// Parts of a step in which a current may jump.
const REFINEMENT: u32 = 1000;

/// One step to the capacitances `c`; which diodes and release elements conducted, and if above the voltage of release.
fn euler(parameters: &Parameters, sums: &mut Reference, c: [f64; 2], h: f64) -> [bool; 5] {
    // A leak takes l C V at the end of the step, as a capacitance does that is larger by the factor.
    let t = parameters.leakage_time_constant;
    let leak = if t > 0.0 { h / t } else { 0.0 };
    let held = c;
    let c = c.map(|c| c * (1.0 + leak));
    let (u_in, u_z) = (parameters.supply_voltage, parameters.release_voltage());
    let drop = if parameters.release == Release::Zener { u_z } else { 0.0 };
    let free = [0, 1].map(|j| sums.charge[j] / c[j]);
    let top = match parameters.release {
        Release::Storage => u_z,
        Release::Zener | Release::Switch => load_line(c, free, h, u_z, drop, parameters.load_resistance),
    };
    let mut current = 0.0;
    let mut conducting = [false; 5];
    for j in 0..2 {
        if free[j] < u_in {
            let drawn = u_in * c[j] - sums.charge[j];
            sums.supply_charge += drawn;
            sums.charge[j] += drawn;
            conducting[j] = true;
        } else if free[j] > top {
            let passed = c[j] * (free[j] - top);
            sums.charge[j] -= passed;
            current += passed / h;
            conducting[2 + j] = true;
        }
    }
    conducting[4] = top > u_z;
    for j in 0..2 {
        let voltage = sums.charge[j] / c[j];
        sums.charge[j] = held[j] * voltage;
        sums.leakage += leak * held[j] * voltage * voltage;
    }
    sums.load_charge += h * current;
    sums.zener += h * current * drop;
    sums.load += h * current * (top - drop);
    conducting
}

/// Voltage at which what the nodes give in a step, `C (free - V) / h` each if positive, is what the load takes.
fn load_line(c: [f64; 2], free: [f64; 2], h: f64, u_z: f64, drop: f64, r: f64) -> f64 {
    let given = |v: f64| -> f64 { (0..2).map(|j| (c[j] * (free[j] - v) / h).max(0.0)).sum() };
    if given(u_z) * r <= u_z - drop {
        return u_z;
    }
    let meet = |nodes: &[usize]| {
        let (mut charge, mut capacitance) = (0.0, 0.0);
        for &j in nodes {
            charge += c[j] * free[j];
            capacitance += c[j];
        }
        (charge * r / h + drop) / (capacitance * r / h + 1.0)
    };
    let both = meet(&[0, 1]);
    if both <= free[0] && both <= free[1] { both } else { meet(if free[0] > free[1] { &[0] } else { &[1] }) }
}
