//! What initial values depend on: found by changing every input and parameter at random starts, and compared with what the
//! variable table promises for `InitialUnknowns`.

use crate::Random;
use fmu_export::{Causality, Experiment, Initial, Kind, Logger, Slave, Variable};
use std::collections::BTreeSet;

/// Unknown and known, by name.
pub type Pair = (&'static str, &'static str);

/// Change of a value, relative to itself and the size of its variable, from which on it is no rounding.
const SIGNIFICANT: f64 = 1e-9;

/// Inputs and what has `initial = "exact"`.
fn knowns<S: Slave>() -> impl Iterator<Item = &'static Variable<S>> {
    let is_known = |row: &&Variable<S>| row.causality() == Causality::Input || row.initial() == Some(Initial::Exact);
    S::variables().iter().filter(is_known)
}

/// Sets a variable that is known to another value: a Real to one that differs by a random factor or, if it may be
/// zero, to one of its `size`.
#[allow(clippy::expect_used)] // as in a test
fn change<S>(row: &Variable<S>, slave: &mut S, size: f64, random: &mut Random) {
    let number = |random: &mut Random, bound| i32::try_from(random.below(bound)).unwrap_or_default();
    match row.kind() {
        Kind::Real(spec) => {
            let (present, sign) = (spec.get.get(slave), random.between(-1.0, 1.0));
            let factor = (sign * random.pick(&[0.03, 0.3, 2.0])).exp();
            let may_be_zero = spec.min <= 0.0 && (present == 0.0 || random.once_in(4));
            let moved = if may_be_zero { sign * size } else { present * factor };
            spec.set.expect("a setter").set(slave, moved.clamp(spec.min, spec.max));
        }
        Kind::Integer(spec) => spec.set.expect("a setter").set(slave, number(random, 1000).into()),
        Kind::Boolean(spec) => spec.set.expect("a setter").set(slave, random.once_in(2)),
        Kind::Enumeration(spec) => spec.set.expect("a setter").set(slave, 1 + number(random, spec.of.items.len())),
        Kind::String(_) | Kind::Clock(_) => {}
    }
}

/// The initial unknowns, all of them Reals; none if the parameters contradict each other.
fn values<S: Slave>(slave: &S) -> Option<Vec<(&'static str, f64)>> {
    let table = S::variables();
    let value = |row: &'static Variable<S>| match row.kind() {
        Kind::Real(spec) => (row.name(), spec.get.get(slave)),
        _ => (row.name(), f64::NAN),
    };
    let values: Vec<_> = table.iter().filter(|row| row.is_initial_unknown(table)).map(value).collect();
    values.iter().all(|(_, value)| !value.is_nan()).then_some(values)
}

/// A slave before its initialisation, about half of whose inputs and parameters differ from their start values.
fn start<S: Slave>(size_of: &impl Fn(&str) -> f64, random: &mut Random) -> S {
    let mut slave = S::new();
    for row in knowns::<S>() {
        if random.once_in(2) {
            change(row, &mut slave, size_of(row.name()), random);
        }
    }
    let start_time = random.pick(&[0.0, 0.3, 100.0]);
    // One that is refused has no values, either.
    let _ = slave.setup_experiment(&Experiment { start_time, stop_time: None, tolerance: None }, &Logger::silent());
    slave.update();
    slave
}

/// All pairs of which the second changes the first at one of so many random `starts`. `size_of` gives the size that a variable
/// typically has.
pub fn found<S: Slave>(starts: usize, size_of: impl Fn(&str) -> f64) -> BTreeSet<Pair> {
    let (random, mut found) = (&mut Random::seeded(1), BTreeSet::new());
    for _ in 0..starts {
        let slave: S = start(&size_of, random);
        let Some(before) = values(&slave) else { continue };
        for known in knowns::<S>() {
            let mut moved = slave.clone();
            change(known, &mut moved, size_of(known.name()), random);
            moved.update();
            for ((name, a), (_, b)) in before.iter().zip(values(&moved).unwrap_or_default()) {
                if (a - b).abs() > SIGNIFICANT * (size_of(name) + a.abs().min(b.abs())) {
                    found.insert((*name, known.name()));
                }
            }
        }
    }
    found
}

/// All pairs that the table promises; everything on everything where it promises nothing.
pub fn promised<S: Slave>() -> BTreeSet<Pair> {
    let table = S::variables();
    let all = || knowns::<S>().map(Variable::name).collect();
    let unknowns = table.iter().filter(|row| row.is_initial_unknown(table));
    let pairs = unknowns.flat_map(|row| {
        let names: Vec<_> = row.initial_dependencies().map_or_else(all, <[&[&str]]>::concat);
        names.into_iter().map(|name| (row.name(), name))
    });
    pairs.collect()
}

/// Those pairs whose second is an input.
pub fn on_inputs<S: Slave>(pairs: &BTreeSet<Pair>) -> BTreeSet<Pair> {
    let is_input =
        |name: &str| S::variables().iter().any(|row| row.name() == name && row.causality() == Causality::Input);
    pairs.iter().copied().filter(|(_, known)| is_input(known)).collect()
}
