//! Integrals by the rules of Gauss and Legendre.

/// Half of the nodes on [-1, 1], which are symmetric, and their weights.
const FOUR: [[f64; 2]; 2] =
    [[0.339_981_043_584_856_26, 0.652_145_154_862_546_1], [0.861_136_311_594_052_6, 0.347_854_845_137_453_85]];
const EIGHT: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_27],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// The integral by 4 values.
pub fn gauss_4(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    gauss(&FOUR, from, to, function)
}

/// The integral by 8 values.
pub fn gauss_8(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    gauss(&EIGHT, from, to, function)
}

fn gauss(rule: &[[f64; 2]], from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let pair = |node: f64| function(middle - half * node) + function(middle + half * node);
    half * rule.iter().map(|[node, weight]| weight * pair(*node)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn each_rule_is_exact_for_powers_up_to_its_degree() {
        for k in 0..16 {
            let exact = (2.0_f64.powi(k + 1) - 1.0) / f64::from(k + 1);
            let power = |x: f64| x.powi(k);
            for (degree, value) in [(7, gauss_4(1.0, 2.0, power)), (15, gauss_8(1.0, 2.0, power))] {
                if k <= degree {
                    assert_relative_eq!(value, exact, max_relative = 1e-15 * f64::from(k + 4));
                }
            }
        }
    }
}
