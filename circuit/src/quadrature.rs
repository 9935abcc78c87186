//! Gauss-Legendre quadrature of exponentials, exact to rounding.

/// Positive nodes and their weights of the 4-point rule (Abramowitz and Stegun, Table 25.4).
const FOUR: [(f64, f64); 2] =
    [(0.339_981_043_584_856_3, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];

/// The same of the 8-point rule.
pub(crate) const EIGHT: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Change of an exponent for which the 4-point rule is exact to rounding: its error is 6e-10 of the eighth power.
pub(crate) const SHORT: f64 = 0.15;

/// Change of an exponent for which the 8-point rule is.
pub(crate) const PANEL: f64 = 2.0;

/// The rule for an interval over which no exponent changes by more than `change`, at most [`PANEL`].
pub(crate) fn rule(change: f64) -> &'static [(f64, f64)] {
    if change < SHORT { &FOUR } else { &EIGHT }
}
