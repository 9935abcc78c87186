//! Ranges, ticks and tick labels.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;

/// Relative span below which a range counts as one value: digits beyond are rounding.
const CONSTANT: f64 = 1e-9;
/// Powers of ten beyond which a logarithmic axis does not reach.
const LARGEST_DECADE: f64 = 300.0;

/// An axis, drawn in multiples of a power of ten so that its span is 1 to 10: whatever the unit of
/// the data, ticks are sought among numbers of that size.
///
/// A logarithmic axis is drawn in decades, and its data are their logarithms to base 10 everywhere but in its labels.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Ends in data units.
    pub low: f64,
    pub high: f64,
    log: bool,
    exponent: i32,
    decimals: usize,
    scientific: bool,
    ticks: Vec<f64>,
    /// Ticks in drawing units with a name instead of a number.
    names: Vec<(f64, String)>,
}

impl Axis {
    /// An axis with exactly these ends; `None` if they are no finite, ascending interval.
    pub(super) fn exact(low: f64, high: f64, max_ticks: usize) -> Option<Self> {
        let span = high - low;
        if !span.is_finite() || span <= 0.0 || span < CONSTANT * low.abs().max(high.abs()) {
            return None;
        }
        let exponent = decade(span);
        if exponent.abs() > 250 {
            return None;
        }
        let ticks = Vec::new();
        let names = Vec::new();
        let mut axis = Self { low, high, log: false, exponent, decimals: 0, scientific: false, ticks, names };
        axis.ticks = RangedCoordf64::from(axis.scaled_range()).key_points(max_ticks);
        axis.choose_format();
        Some(axis)
    }

    /// A logarithmic axis between these logarithms; `None` if they are no finite, ascending interval.
    pub(super) fn exact_log(low: f64, high: f64, max_ticks: usize) -> Option<Self> {
        let span = high - low;
        if !(CONSTANT..=2.0 * LARGEST_DECADE).contains(&span) || low.abs().max(high.abs()) > LARGEST_DECADE {
            return None;
        }
        let ticks = if span < 1.0 {
            let plain = Self::exact(10_f64.powf(low), 10_f64.powf(high), max_ticks)?;
            plain.ticks.iter().map(|tick| (tick * 10_f64.powi(plain.exponent)).log10()).collect()
        } else {
            decades(low, high, max_ticks)
        };
        let scientific = ticks.iter().any(|&tick| is_power(tick));
        Some(Self { low, high, log: true, exponent: 0, decimals: 0, scientific, ticks, names: Vec::new() })
    }

    /// [`Self::around`] for logarithms; without data, the decade from 1.
    pub(super) fn around_log(low: f64, high: f64, margin: f64, max_ticks: usize) -> Option<Self> {
        if low > high {
            return Self::exact_log(0.0, 1.0, max_ticks);
        }
        let pad = if high - low <= CONSTANT { 0.1 } else { margin * (high - low) };
        Self::exact_log(low - pad, high + pad, max_ticks)
    }

    /// The same axis with these names at its ticks, given in data units; with its numbers if there are none.
    pub(super) fn named(mut self, names: &[(f64, String)]) -> Self {
        if !names.is_empty() && !self.log {
            self.names = names.iter().map(|(x, name)| (self.scaled(*x), name.clone())).collect();
            self.ticks = self.names.iter().map(|name| name.0).collect();
        }
        self
    }

    /// The same axis with another number of ticks; those with names stay.
    pub(super) fn with_ticks(&self, max_ticks: usize) -> Self {
        if !self.names.is_empty() {
            return self.clone();
        }
        let make = if self.log { Self::exact_log } else { Self::exact };
        make(self.low, self.high, max_ticks).unwrap_or_else(|| self.clone())
    }

    /// An axis around data from `low` to `high` with a margin (a share of the span).
    ///
    /// A constant gets room on either side, no data at all (`low > high`) the range 0 to 1.
    pub(super) fn around(low: f64, high: f64, margin: f64, max_ticks: usize) -> Option<Self> {
        if low > high {
            return Self::exact(0.0, 1.0, max_ticks);
        }
        let size = low.abs().max(high.abs());
        let pad = if high - low <= CONSTANT * size {
            if size == 0.0 { 1.0 } else { 0.1 * size }
        } else {
            margin * (high - low)
        };
        let (low, high) = if pad == 0.0 { snapped(low, high) } else { (low - pad, high + pad) };
        Self::exact(low, high, max_ticks)
    }

    /// A value in drawing units.
    pub(super) fn scaled(&self, value: f64) -> f64 {
        value / 10_f64.powi(self.exponent)
    }

    /// Ends in drawing units.
    pub(super) fn scaled_range(&self) -> Range<f64> {
        self.scaled(self.low)..self.scaled(self.high)
    }

    /// The text at a tick given in drawing units.
    pub(super) fn label(&self, scaled: f64) -> String {
        if let Some((_, name)) = self.names.iter().find(|(at, _)| (at - scaled).abs() < CONSTANT) {
            return name.clone();
        }
        let text = if self.log {
            if self.scientific { power(scaled) } else { plain(scaled) }
        } else if self.scientific {
            scientific(scaled, self.exponent)
        } else {
            format!("{:.*}", self.decimals, scaled * 10_f64.powi(self.exponent))
        };
        // A typographic minus; a rounded negative zero loses its sign.
        match text.strip_prefix('-') {
            Some(digits) if digits.chars().any(|c| ('1'..='9').contains(&c)) => {
                format!("\u{2212}{digits}")
            }
            Some(digits) => digits.to_owned(),
            None => text,
        }
    }

    /// The longest tick label, in characters.
    pub(super) fn label_length(&self) -> usize {
        self.ticks.iter().map(|&tick| self.label(tick).chars().count()).max().unwrap_or(0)
    }

    /// Labelled ticks in drawing units.
    pub(super) fn ticks(&self) -> &[f64] {
        &self.ticks
    }

    /// Labelled ticks of a linear axis in data units.
    pub(super) fn tick_values(&self) -> Vec<f64> {
        self.ticks.iter().map(|tick| tick * 10_f64.powi(self.exponent)).collect()
    }

    /// Finer lines in drawing units: 2 to 9 times each decade, where there are few of them.
    pub(super) fn light_ticks(&self) -> Vec<f64> {
        if !self.log || !(1.0..=6.0).contains(&(self.high - self.low)) {
            return Vec::new();
        }
        multiples(self.low, self.high, &[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    }

    /// As many decimals as tell all ticks apart; powers of ten for the very large and very small.
    fn choose_format(&mut self) {
        let fine = (0_i32..6).find(|&d| {
            let shift = 10_f64.powi(d);
            self.ticks.iter().all(|t| (t * shift - (t * shift).round()).abs() < 1e-6 * shift.max(1.0))
        });
        let decimals = fine.unwrap_or(6) - self.exponent;
        self.decimals = usize::try_from(decimals.max(0)).unwrap_or(0);
        let largest = self.low.abs().max(self.high.abs());
        self.scientific = !(1e-3..1e6).contains(&largest);
    }
}

/// What the plotting library asks of an axis, in drawing units.
impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.scaled_range()).map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { self.light_ticks() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.scaled_range()
    }
}

/// Ticks of a logarithmic axis: 1, 2 and 5 times each decade, each decade, or every so many of them.
fn decades(low: f64, high: f64, max_ticks: usize) -> Vec<f64> {
    let fine = multiples(low, high, &[1.0, 2.0, 5.0]);
    if fine.len() <= max_ticks {
        return fine;
    }
    let powers = multiples(low, high, &[1.0]);
    let stride = powers.len().div_ceil(max_ticks.max(1)).max(1);
    powers.into_iter().step_by(stride).collect()
}

/// Logarithms, from `low` to `high`, of these multiples of powers of ten.
fn multiples(low: f64, high: f64, factors: &[f64]) -> Vec<f64> {
    let (first, last) = (low.floor(), high.floor());
    let mut ticks = Vec::new();
    let mut power = first;
    while power <= last {
        ticks.extend(factors.iter().map(|factor| power + factor.log10()));
        power += 1.0;
    }
    ticks.retain(|tick| (low - CONSTANT..=high + CONSTANT).contains(tick));
    ticks
}

/// Whether a tick of a logarithmic axis, and so all of them, is written as a power of ten.
fn is_power(logarithm: f64) -> bool {
    !(-3..=4).contains(&decade_of(logarithm + CONSTANT))
}

/// Power of ten and factor of the number with this logarithm.
fn parts(logarithm: f64) -> (i32, f64) {
    let shift = decade_of(logarithm + CONSTANT);
    (shift, (10_f64.powf(logarithm - f64::from(shift)) * 1e6).round() / 1e6)
}

/// `200` for its logarithm.
fn plain(logarithm: f64) -> String {
    let (shift, mantissa) = parts(logarithm);
    let decimals = usize::try_from(6 - shift).unwrap_or(0);
    let text = format!("{:.decimals$}", mantissa * 10_f64.powi(shift));
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// `2 x 10^-7` for its logarithm; 1 stays 1.
fn power(logarithm: f64) -> String {
    let (shift, mantissa) = parts(logarithm);
    if shift == 0 {
        return mantissa.to_string();
    }
    if mantissa == 1.0 {
        return format!("10{}", superscript(shift));
    }
    format!("{mantissa}\u{d7}10{}", superscript(shift))
}

/// Moves an end to the round number just outside, so that a run to 99.999 s has a tick at 100 s.
fn snapped(low: f64, high: f64) -> (f64, f64) {
    let span = high - low;
    let step = 10_f64.powi(decade(span)) / 10.0;
    let (below, above) = ((low / step).floor() * step, (high / step).ceil() * step);
    let near = 0.005 * span;
    (if low - below < near { below } else { low }, if above - high < near { above } else { high })
}

/// `2.5 x 10^6`, typeset; zero is plain.
fn scientific(scaled: f64, exponent: i32) -> String {
    if scaled.abs() < 1e-9 {
        return "0".to_owned();
    }
    let shift = decade(scaled.abs() * (1.0 + 1e-12));
    let mantissa = (scaled / 10_f64.powi(shift) * 1e6).round() / 1e6;
    format!("{mantissa}\u{d7}10{}", superscript(exponent + shift))
}

fn superscript(exponent: i32) -> String {
    let raised = |c| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
    };
    exponent.to_string().chars().map(raised).collect()
}

/// Exponent of the power of ten at or below a positive value.
fn decade(value: f64) -> i32 {
    decade_of(value.log10())
}

#[expect(clippy::cast_possible_truncation, reason = "the exponent of an f64 is within -324..=308")]
fn decade_of(logarithm: f64) -> i32 {
    logarithm.floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().iter().map(|&tick| axis.label(tick)).collect()
    }

    #[test]
    fn labels_are_short_equally_precise_and_powers_of_ten_where_numbers_are_long() {
        for (low, high, told) in [
            (0.0, 1.0, "0.0 0.2 0.4 0.6 0.8 1.0"),
            (98.0, 100.0, "98.0 98.5 99.0 99.5 100.0"),
            (-22.0, 22.0, "\u{2212}20 \u{2212}10 0 10 20"),
            (0.0, 100.0, "0 20 40 60 80 100"),
            (0.0, 2e6, "0 5\u{d7}10\u{2075} 1\u{d7}10\u{2076} 1.5\u{d7}10\u{2076} 2\u{d7}10\u{2076}"),
            (
                0.0,
                1.5e-11,
                "0 5\u{d7}10\u{207b}\u{b9}\u{b2} 1\u{d7}10\u{207b}\u{b9}\u{b9} 1.5\u{d7}10\u{207b}\u{b9}\u{b9}",
            ),
        ] {
            assert_eq!(labels(&Axis::exact(low, high, 6).unwrap()).join(" "), told);
        }
        assert!(labels(&Axis::exact(-3e-9, 3e-9, 6).unwrap()).contains(&"0".to_owned()));
    }

    #[test]
    fn logarithmic_ticks_are_decades_or_fit_between_them() {
        for (low, high, told) in [
            (0.01, 1000.0, "0.01 0.1 1 10 100 1000"),
            (1e-7, 1e-5, "10\u{207b}\u{2077} 10\u{207b}\u{2076} 10\u{207b}\u{2075}"),
            (1.0, 20.0, "1 2 5 10 20"),
            (2.0, 6.0, "2 3 4 5 6"),
            (0.1, 1e5, "10\u{207b}\u{b9} 10\u{b9} 10\u{b3} 10\u{2075}"),
        ] {
            let (low, high): (f64, f64) = (low, high);
            assert_eq!(labels(&Axis::exact_log(low.log10(), high.log10(), 6).unwrap()).join(" "), told);
        }
        assert_eq!(Axis::exact_log(-100.0, 100.0, 6).unwrap().ticks().len(), 6);
    }

    #[test]
    fn ticks_of_any_decade_are_ticks_of_the_first() {
        for exponent in [-200, -17, -3, 0, 5, 200] {
            let unit = 10_f64.powi(exponent);
            let axis = Axis::exact(0.0, 4.2 * unit, 6).unwrap();
            assert_eq!(axis.ticks().len(), 5, "10^{exponent}");
        }
    }

    #[test]
    fn a_constant_gets_room_and_no_data_a_default() {
        let flat = Axis::around(2000.0, 2000.0, 0.05, 6).unwrap();
        assert_eq!((flat.low, flat.high), (1800.0, 2200.0));
        let zero = Axis::around(0.0, 0.0, 0.05, 6).unwrap();
        assert_eq!((zero.low, zero.high), (-1.0, 1.0));
        let empty = Axis::around(f64::INFINITY, f64::NEG_INFINITY, 0.05, 6).unwrap();
        assert_eq!((empty.low, empty.high), (0.0, 1.0));
    }

    #[test]
    fn an_end_next_to_a_round_number_moves_there() {
        assert_eq!(snapped(0.0, 99.9998), (0.0, 100.0));
        assert_eq!(snapped(0.2, 99.0), (0.0, 99.0));
        assert_eq!(snapped(3.37, 8.84), (3.37, 8.84));
        let axis = Axis::around(0.001, 99.9998, 0.0, 8).unwrap();
        assert_eq!((axis.low, axis.high), (0.0, 100.0));
    }

    #[test]
    fn an_interval_that_is_none_is_refused() {
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (0.0, f64::INFINITY), (f64::NAN, 1.0)] {
            assert!(Axis::exact(low, high, 6).is_none(), "{low} to {high}");
        }
        assert!(Axis::exact(-1e308, 1e308, 6).is_none());
        assert!(Axis::exact(1e9, 1e9 + 1e-3, 6).is_none());
    }

    #[test]
    fn names_take_the_place_of_numbers() {
        let names = [(10.0, "ten".to_owned()), (12.5, "half".to_owned())];
        let axis = Axis::exact(9.5, 15.5, 6).unwrap().named(&names).with_ticks(2);
        assert_eq!(labels(&axis), ["ten", "half"]);
    }

    #[test]
    fn a_logarithmic_axis_has_finer_lines_and_bounds() {
        let axis = Axis::exact_log(0.0, 2.0, 6).unwrap();
        assert_eq!(axis.light_ticks().len(), 16);
        assert!(Axis::exact_log(0.0, 400.0, 6).is_none());
        assert!(Axis::exact_log(1.0, 1.0, 6).is_none());
        assert!(Axis::exact_log(f64::NEG_INFINITY, 1.0, 6).is_none());
        let constant = Axis::around_log(2.0, 2.0, 0.06, 6).unwrap();
        assert!(constant.low < 2.0 && 2.0 < constant.high);
    }
}
