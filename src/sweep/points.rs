//! The points of a sweep: the values that the variables have in each.

use super::axis::Axis;
use super::{Design, SweepError};
use fmu_import::Value;

/// Most runs of a sweep: a year on a thousand cores at a tenth of a second each.
pub(super) const MAX_RUNS: u64 = 1_000_000_000_000;

/// The points: the value of each variable in each.
pub(super) struct Points {
    design: Design,
    count: u64,
    axes: Vec<Axis>,
}

impl Points {
    /// Whether they are those of a grid, which has a number of its own.
    pub fn is_grid(&self) -> bool {
        self.design == Design::Grid
    }

    /// The points of a `design` over `axes`; a design that draws them has as many as `asked`.
    pub fn new(design: Design, axes: Vec<Axis>, asked: Option<u64>) -> Result<Self, SweepError> {
        let bad = |value: String, reason: String| Err(SweepError::option("points", value, reason));
        let count = match (design, asked) {
            (Design::Grid, asked) => {
                let product = axes.iter().try_fold(1_u64, |product, axis| product.checked_mul(axis.len()));
                let Some(product) = product else {
                    let reason =
                        format!("the grid has more than {} points; it may have from 1 to {MAX_RUNS}", u64::MAX);
                    return Err(SweepError::option("vary", "", reason));
                };
                if let Some(asked) = asked.filter(|asked| *asked != product) {
                    return bad(asked.to_string(), format!("the grid has {product}; a grid needs no --points"));
                }
                product
            }
            (_, None) => return bad(String::new(), format!("the design {design} needs the number of points")),
            (_, Some(_)) if axes.is_empty() => {
                let reason = format!("the design {design} needs a variable to spread, by --vary name=from:to");
                return Err(SweepError::option("design", design.to_string(), reason));
            }
            (_, Some(asked)) => asked,
        };
        if !(1..=MAX_RUNS).contains(&count) {
            if design == Design::Grid {
                let reason = format!("the grid has {count} points; it may have from 1 to {MAX_RUNS}");
                return Err(SweepError::option("vary", "", reason));
            }
            return bad(count.to_string(), format!("must lie from 1 to {MAX_RUNS}"));
        }
        Ok(Self { design, count, axes })
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The varied variables.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Values of the variables in point number `point`.
    pub fn values(&self, point: u64) -> Vec<Value> {
        if self.design != Design::Grid {
            return self.axes.iter().map(|axis| axis.quantile(axis.share(self.design, point, self.count))).collect();
        }
        let mut rest = point;
        let mut values: Vec<_> = self.axes.iter().rev().map(|axis| digit(axis, &mut rest)).collect();
        values.reverse();
        values
    }
}

/// The value at the last digit of `rest`, a number whose base is the length of `axis`; removes the digit.
fn digit(axis: &Axis, rest: &mut u64) -> Value {
    let index = *rest % axis.len();
    *rest /= axis.len();
    axis.at(index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Vary;

    fn points(design: Design, vary: &[&str], count: Option<u64>, seed: u64) -> Result<Points, String> {
        let description = crate::sweep::harvester_description().unwrap();
        let axis = |text: &&str| Axis::new(&description, &Vary::parse(text).unwrap(), design, seed).unwrap();
        Points::new(design, vary.iter().map(axis).collect(), count).map_err(|error| error.to_string())
    }

    fn real(value: &Value) -> f64 {
        value.to_string().parse().unwrap()
    }

    #[test]
    fn the_last_variable_of_a_grid_is_the_fastest() {
        let vary = ["contact.law=impulsive,compliant", "excitation.seed=1:3:3", "contact.reaction=false"];
        let points = points(Design::Grid, &vary, None, 1).unwrap();
        let shown: Vec<_> = (0..points.count())
            .map(|point| points.values(point).iter().map(ToString::to_string).collect::<Vec<_>>().join(" "))
            .collect();
        let expected = ["impulsive 1", "impulsive 2", "impulsive 3", "compliant 1", "compliant 2", "compliant 3"];
        assert_eq!(shown, expected.map(|values| format!("{values} false")));
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_stratum_of_each_variable() {
        let vary = ["membrane.restitution=0:1", "excitation.amplitude=2:4", "membrane.stiffness=log:1:1e6"];
        for count in [1, 2, 3, 10, 16, 17, 64, 100, 1021] {
            for seed in [0, 1, 12_345_678_901] {
                let points = points(Design::Lhs, &vary, Some(count), seed).unwrap();
                let mut strata = [vec![], vec![], vec![]];
                for point in 0..count {
                    let values = points.values(point);
                    let shares = [real(&values[0]), (real(&values[1]) - 2.0) / 2.0, real(&values[2]).log10() / 6.0];
                    for (strata, share) in strata.iter_mut().zip(shares) {
                        strata.push((share * count as f64).floor());
                    }
                }
                for mut strata in strata {
                    strata.sort_by(f64::total_cmp);
                    let expected: Vec<f64> = (0..count).map(|k| k as f64).collect();
                    assert_eq!(strata, expected, "{count} points, seed {seed}");
                }
            }
        }
    }

    #[test]
    fn variables_of_a_drawn_design_are_not_tied_to_each_other() {
        for design in [Design::Lhs, Design::Random] {
            let points = points(design, &["membrane.restitution=0:1", "cylinder.length=0:1"], Some(4000), 5).unwrap();
            let pairs: Vec<_> = (0..4000).map(|point| points.values(point)).collect();
            let product: f64 = pairs.iter().map(|pair| (real(&pair[0]) - 0.5) * (real(&pair[1]) - 0.5)).sum();
            assert!((product / 4000.0 * 12.0).abs() < 5.0 / 4000_f64.sqrt(), "{design}");
        }
    }

    #[test]
    fn a_random_design_goes_on_where_a_smaller_one_ends_and_other_variables_change_nothing() {
        let short = points(Design::Random, &["membrane.restitution=0:1"], Some(10), 5).unwrap();
        let long = points(Design::Random, &["ball.mass=1:2", "membrane.restitution=0:1"], Some(99), 5).unwrap();
        (0..10).for_each(|point| assert_eq!(short.values(point)[0], long.values(point)[1]));
    }

    #[test]
    fn numbers_of_points_that_make_no_sense_are_named() {
        for (design, vary, count, named) in [
            (Design::Lhs, "membrane.restitution=0:1", None, "the design lhs needs the number of points"),
            (Design::Random, "membrane.restitution=0:1", Some(0), "--points 0: must lie from 1 to 1000000000000"),
            (Design::Random, "membrane.restitution=0:1", Some(u64::MAX), "must lie from 1 to 1000000000000"),
            (Design::Grid, "membrane.restitution=0:1:3", Some(4), "--points 4: the grid has 3"),
            (
                Design::Grid,
                "membrane.restitution=0:1:99999999999999",
                None,
                "--vary: the grid has 99999999999999 points; it may",
            ),
        ] {
            let message = points(design, &[vary], count, 1).err().unwrap();
            assert!(message.contains(named), "{message}");
        }
        assert!(points(Design::Lhs, &[], Some(3), 1).err().unwrap().contains("needs a variable to spread"));
    }
}
