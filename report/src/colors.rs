//! Colours of series and maps, the same in the drawing and in the interactive chart.

use super::reduce::extent;

/// Red, green, blue.
pub(super) type Rgb = (u8, u8, u8);

/// Colours that readers with any colour vision tell apart (Okabe and Ito 2008), darkest first:
/// yellow comes last, since it is faint on white.
const PALETTE: [Rgb; 8] = [
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (230, 159, 0),
    (86, 180, 233),
    (0, 0, 0),
    (240, 228, 66),
];
pub(super) const REFERENCE: Rgb = (90, 90, 90);

/// Evenly spaced samples of viridis, which grows lighter with the value for any colour vision.
const VIRIDIS: [Rgb; 10] = [
    (68, 1, 84),
    (72, 40, 120),
    (62, 74, 137),
    (49, 104, 142),
    (38, 130, 142),
    (31, 158, 137),
    (53, 183, 121),
    (109, 205, 89),
    (180, 222, 44),
    (253, 231, 37),
];
/// Blue below, orange above, white between.
const DIVERGING: [Rgb; 7] =
    [(8, 48, 107), (33, 113, 181), (127, 184, 218), (255, 255, 255), (253, 184, 99), (224, 130, 20), (127, 59, 8)];

/// An entry of the palette, which repeats.
pub(super) fn palette(index: usize) -> Rgb {
    PALETTE.get(index % PALETTE.len()).copied().unwrap_or(REFERENCE)
}

/// `#rrggbb`.
pub(super) fn hex((red, green, blue): Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Colours of a quantity over its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramp {
    pub low: f64,
    pub high: f64,
    anchors: &'static [Rgb],
}

impl Ramp {
    /// Distinct colours: few enough that cells of a smooth map join, too many to be told apart.
    pub(super) const LEVELS: usize = 65;

    /// Spans the finite ones of `values`; symmetric about 0 if they have both signs.
    pub(super) fn over(values: &[f64]) -> Self {
        let (low, high) = extent(values.iter().copied().filter(|value| value.is_finite()));
        if low < 0.0 && high > 0.0 {
            let size = high.max(-low);
            return Self { low: -size, high: size, anchors: &DIVERGING };
        }
        let (low, high) = match (low <= high, low < high) {
            (true, true) => (low, high),
            (true, false) if low != 0.0 => (low - 0.1 * low.abs(), low + 0.1 * low.abs()),
            _ => (0.0, 1.0),
        };
        Self { low, high, anchors: &VIRIDIS }
    }

    /// The level of a value, from 0 up to [`Self::LEVELS`], excluded; `None` for a gap.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..LEVELS")]
    pub(super) fn level(&self, value: f64) -> Option<usize> {
        let last = Self::LEVELS as f64 - 1.0;
        let share = (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        value.is_finite().then(|| (share * last).round().clamp(0.0, last) as usize)
    }

    /// The colour of a level.
    pub(super) fn color(&self, level: usize) -> Rgb {
        mixed(self.anchors, level as f64 / (Self::LEVELS as f64 - 1.0))
    }

    /// Evenly spaced colours from low to high.
    pub(super) fn anchors(&self) -> &'static [Rgb] {
        self.anchors
    }
}

/// The colour at a share, 0 to 1, of the way along `anchors`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the share is at least 0")]
fn mixed(anchors: &[Rgb], share: f64) -> Rgb {
    let place = share.clamp(0.0, 1.0) * (anchors.len() as f64 - 1.0);
    let below = place.floor() as usize;
    let at = |index: usize| anchors.get(index.min(anchors.len() - 1)).copied().unwrap_or(REFERENCE);
    let (from, to, part) = (at(below), at(below + 1), place.fract());
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_white_between_blue_and_orange() {
        let ramp = Ramp::over(&[-1.0, f64::NAN, 4.0]);
        assert_eq!((ramp.low, ramp.high), (-4.0, 4.0));
        assert_eq!(ramp.color(ramp.level(0.0).unwrap()), (255, 255, 255));
        let (red, _, blue) = ramp.color(ramp.level(-4.0).unwrap());
        assert!(blue > red);
        let (red, _, blue) = ramp.color(ramp.level(4.0).unwrap());
        assert!(red > blue);
    }

    #[test]
    fn one_sign_grows_lighter_with_the_value() {
        let ramp = Ramp::over(&[2.0, 3.0]);
        let light = |level| {
            let (r, g, b) = ramp.color(level);
            2 * u32::from(r) + 7 * u32::from(g) + u32::from(b)
        };
        let levels: Vec<u32> = (0..Ramp::LEVELS).map(light).collect();
        assert!(levels.is_sorted(), "{levels:?}");
        assert_eq!((ramp.level(2.0), ramp.level(3.0), ramp.level(f64::NAN)), (Some(0), Some(64), None));
    }

    #[test]
    fn a_constant_and_nothing_have_a_range_too() {
        for values in [&[][..], &[f64::NAN], &[0.0], &[-3.0, -3.0], &[1e308, 1e308]] {
            let ramp = Ramp::over(values);
            assert!(ramp.low < ramp.high, "{values:?}");
        }
    }
}
