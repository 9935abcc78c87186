//! A measured membrane: its force, and its capacitance if that was measured, over the deflection.

use core::fmt;
use std::sync::Arc;

use super::pchip::{Cubic, Pchip};
use crate::error::ModelError;
use crate::fingerprint::fingerprint;
use crate::points::PointQuantity;

/// Largest deflection, m, and force, N, of a table, and the range of its capacitances, F.
const MAX_DEFLECTION: f64 = 100.0;
const MAX_FORCE: f64 = 1e9;
const CAPACITANCES: [f64; 2] = [1e-18, 1.0];

/// Least rise of the force from point to point, N: a product with a small deflection must not vanish.
const MIN_RISE: f64 = 1e-15;

/// Least difference of two deflections, m.
const MIN_SPACING: f64 = 1e-12;

/// Force of a membrane over its deflection, monotone cubic between the points and a straight line beyond the last one, and
/// capacitance likewise. Copies share the points.
#[derive(Clone)]
pub struct ForceTable(Arc<Points>);

#[derive(PartialEq)]
struct Points {
    deflections: Vec<f64>,
    force: Pchip,
    /// Work of the force up to each point, J.
    works: Vec<f64>,
    /// C over that of the flat membrane, less 1.
    excess: Option<Pchip>,
    /// Of the flat membrane, F.
    rest_capacitance: f64,
    fingerprint: u64,
}

impl ForceTable {
    /// Least and most points of a table.
    pub const POINTS: [usize; 2] = [3, 1_000_000];

    /// The membrane with these `forces`, N, and, if they were measured, `capacitances`, F, at these `deflections`, m.
    ///
    /// # Errors
    /// Lists of different lengths, of less than 3 or more than 1e6 points; a first point that is not 0 m and 0 N; deflections
    /// that do not rise by at least 1e-12 m, forces by 1e-15 N, capacitances that fall; a deflection beyond 100 m, a force beyond
    /// 1e9 N, a capacitance below 1e-18 F or beyond 1 F; NaN. Points are counted from 0.
    pub fn new(deflections: Vec<f64>, forces: Vec<f64>, capacitances: Option<Vec<f64>>) -> Result<Self, ModelError> {
        let count = deflections.len();
        let [min, max] = Self::POINTS;
        let lengths = [Some(forces.len()), capacitances.as_ref().map(Vec::len)];
        if let Some(other) = lengths.into_iter().flatten().find(|length| *length != count) {
            return Err(ModelError::TablePairs { deflections: count, others: other });
        }
        if !(min..=max).contains(&count) {
            return Err(ModelError::TableCount { count, min, max });
        }
        let point = |(index, fault)| ModelError::Point { index, what: "membrane's table", fault };
        // The first point is that of the flat membrane.
        for (name, unit, values, max, rise) in [
            ("deflection", "m", &deflections, MAX_DEFLECTION, MIN_SPACING),
            ("force", "N", &forces, MAX_FORCE, MIN_RISE),
        ] {
            PointQuantity { name, unit, min: 0.0, max: 0.0, rise }.check(&values[..1]).map_err(point)?;
            PointQuantity { name, unit, min: 0.0, max, rise }.check(values).map_err(point)?;
        }
        if let Some(capacitances) = &capacitances {
            let [min, max] = CAPACITANCES;
            PointQuantity { name: "capacitance", unit: "F", min, max, rise: 0.0 }.check(capacitances).map_err(point)?;
        }
        let numbers = deflections.iter().chain(&forces).chain(capacitances.iter().flatten());
        let fingerprint = fingerprint(capacitances.is_some(), numbers);
        let rest_capacitance = capacitances.as_ref().map_or(0.0, |list| list[0]);
        let force = Pchip::new(&deflections, forces);
        let excess = capacitances.map(|list| {
            Pchip::new(&deflections, list.iter().map(|value| (value - rest_capacitance) / rest_capacitance).collect())
        });
        let mut points = Points { deflections, force, works: vec![0.0], excess, rest_capacitance, fingerprint };
        let mut sum = 0.0;
        for k in 1..count {
            let width = points.width(k - 1);
            sum += points.force.piece(k - 1, width).integral(width);
            points.works.push(sum);
        }
        Ok(Self(Arc::new(points)))
    }

    /// Deflections of the points, m.
    pub fn deflections(&self) -> &[f64] {
        &self.0.deflections
    }

    /// The largest deflection that was measured, m. Beyond it, force and capacitance go on with their last slopes.
    pub fn end(&self) -> f64 {
        self.0.deflections[self.0.deflections.len() - 1]
    }

    /// C of the flat membrane, F, if it was measured.
    pub(super) fn rest_capacitance(&self) -> Option<f64> {
        self.0.excess.as_ref().map(|_| self.0.rest_capacitance)
    }

    /// Force, N, at `x`, m.
    pub(super) fn force(&self, x: f64) -> f64 {
        let (cubic, s) = self.0.force_at(x);
        cubic.at(s)[0]
    }

    /// Work, J, of the force from 0 to `x`, m.
    pub(super) fn work(&self, x: f64) -> f64 {
        let (k, s) = self.0.place(x);
        self.0.works[k] + self.0.force.piece(k, self.0.width(k)).integral(s)
    }

    /// Work, J, of the force from `way` before `x`, m, to there.
    pub(super) fn last_work(&self, x: f64, way: f64) -> f64 {
        let (points, way) = (&*self.0, way.min(x));
        let (k, s) = points.place(x);
        let cubic = points.force.piece(k, points.width(k));
        if way <= s {
            return cubic.backwards(s).integral(way);
        }
        let from = x - way;
        let j = points.place(from).0.min(k.saturating_sub(1));
        let width = points.width(j);
        let end = points.deflections[j + 1];
        cubic.integral(s)
            + (points.works[k] - points.works[j + 1])
            + points.force.piece(j, width).backwards(width).integral((end - from).max(0.0))
    }

    /// Bounds, m, between which the work is `work`, J.
    pub(super) fn bracket(&self, work: f64) -> [f64; 2] {
        let points = &*self.0;
        let k = points.works.partition_point(|there| *there < work);
        let low = points.deflections[k.saturating_sub(1)];
        let Some(high) = points.deflections.get(k) else {
            // w = f y + s y^2 / 2 on the line beyond the last point.
            let Cubic([force, slope, ..]) = points.force.piece(k - 1, 0.0);
            let rest = work - points.works[k - 1];
            let beyond = 2.0 * rest / (force + (force * force + 2.0 * slope * rest).sqrt());
            return [low, low + 1.000_001 * beyond];
        };
        [low, *high]
    }

    /// C over that of the flat membrane, less 1, and its derivative, 1/m, at `x`, m, if it was measured.
    pub(super) fn capacitance_excess_and_slope(&self, x: f64) -> Option<[f64; 2]> {
        let excess = self.0.excess.as_ref()?;
        let (k, s) = self.0.place(x);
        Some(excess.piece(k, self.0.width(k)).at(s))
    }

    /// A number that hardly any other table has; never 0.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.0.fingerprint
    }
}

impl Points {
    /// Number of the point at or before `x`, m, and the distance from it, m.
    fn place(&self, x: f64) -> (usize, f64) {
        let k = self.deflections.partition_point(|point| *point <= x).saturating_sub(1);
        (k, x - self.deflections[k])
    }

    /// Distance of point `k` from the next, m; 0 for the last one.
    fn width(&self, k: usize) -> f64 {
        self.deflections.get(k + 1).map_or(0.0, |next| next - self.deflections[k])
    }

    fn force_at(&self, x: f64) -> (Cubic, f64) {
        let (k, s) = self.place(x);
        (self.force.piece(k, self.width(k)), s)
    }
}

impl PartialEq for ForceTable {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

impl fmt::Debug for ForceTable {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Points { deflections, fingerprint, .. } = &*self.0;
        write!(out, "ForceTable {{ points: {}, fingerprint: {fingerprint:#x} }}", deflections.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_table() -> impl Strategy<Value = ForceTable> {
        proptest::collection::vec((1e-6..1e-3_f64, 1e-6..1.0_f64, 0.0..1e-12_f64), 2..40).prop_map(|steps| {
            let sums = |of: fn(&(f64, f64, f64)) -> f64, first: f64| {
                let rest = steps.iter().scan(first, move |sum, step| {
                    *sum += of(step);
                    Some(*sum)
                });
                core::iter::once(first).chain(rest).collect::<Vec<_>>()
            };
            ForceTable::new(sums(|it| it.0, 0.0), sums(|it| it.1, 0.0), Some(sums(|it| it.2, 1.5e-11))).unwrap()
        })
    }

    proptest! {
        #[test]
        fn force_and_capacitance_rise_and_work_is_the_integral(table in any_table(), places in proptest::collection::vec(0.0..1.3_f64, 2..20)) {
            let mut places: Vec<f64> = places.iter().map(|place| place * table.end()).collect();
            places.sort_by(f64::total_cmp);
            for pair in places.windows(2) {
                prop_assert!(table.force(pair[0]) <= table.force(pair[1]));
                let [low, high] = [pair[0], pair[1]].map(|x| table.capacitance_excess_and_slope(x).unwrap());
                prop_assert!(low[0] <= high[0] && low[1] >= 0.0);
                // Simpson's rule is exact for the cubics between the points.
                let knots = table.deflections().iter().copied().filter(|x| (pair[0]..pair[1]).contains(x));
                let ends: Vec<f64> = core::iter::once(pair[0]).chain(knots).chain([pair[1]]).collect();
                let integral: f64 = ends.windows(2).map(|it| {
                    let middle = 0.5 * (it[0] + it[1]);
                    (it[1] - it[0]) / 6.0 * (table.force(it[0]) + 4.0 * table.force(middle) + table.force(it[1]))
                }).sum();
                let work = table.work(pair[1]) - table.work(pair[0]);
                prop_assert!((work - integral).abs() <= 1e-13 * table.work(pair[1]));
                let last = table.last_work(pair[1], pair[1] - pair[0]);
                prop_assert!((last - integral).abs() <= 1e-12 * integral + 1e-15 * table.work(pair[1]), "{last} {integral}");
                let [low, high] = table.bracket(work);
                prop_assert!(table.work(low) <= work && work <= table.work(high));
            }
        }
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_point_and_value() {
        let error = |x: &[f64], f: &[f64], c: Option<&[f64]>| {
            ForceTable::new(x.to_vec(), f.to_vec(), c.map(<[f64]>::to_vec)).unwrap_err().to_string()
        };
        let x = [0.0, 1e-3, 2e-3];
        let f = [0.0, 0.1, 0.3];
        for (message, part) in [
            (error(&x, &f[..2], None), "3 deflections and 2"),
            (error(&x[..2], &f[..2], None), "2 points"),
            (error(&[1e-4, 1e-3, 2e-3], &f, None), "point 0 (from 0) of the membrane's table: deflection = 0.0001 m"),
            (error(&x, &[0.01, 0.1, 0.3], None), "point 0 (from 0) of the membrane's table: force = 0.01 N"),
            (error(&[0.0, 2e-3, 2e-3], &f, None), "point 2 (from 0) of the membrane's table: deflection = 0.002 m"),
            (error(&x, &[0.0, 0.1, 0.1], None), "point 2 (from 0) of the membrane's table: force = 0.1 N"),
            (error(&x, &[0.0, 0.1, f64::NAN], None), "point 2 (from 0) of the membrane's table: force = NaN N"),
            (
                error(&x, &f, Some(&[1e-11, 2e-11, 1.9e-11])),
                "point 2 (from 0) of the membrane's table: capacitance = 1.9e-11 F",
            ),
            (error(&x, &f, Some(&[0.0, 2e-11, 2e-11])), "point 0 (from 0) of the membrane's table: capacitance = 0 F"),
        ] {
            assert!(message.contains(part), "{message}");
        }
    }
}
