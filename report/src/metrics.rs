//! Sizes that the layout of figures goes by, px.

/// Font sizes and distances.
pub(super) const TITLE_SIZE: f64 = 13.0;
pub(super) const TEXT_SIZE: f64 = 11.0;
pub(super) const ROW: f64 = 16.0;
pub(super) const TITLE_ROW: f64 = 18.0;
pub(super) const LABEL_ROW: f64 = 13.0;
pub(super) const LEGEND_KEY: f64 = 18.0;
pub(super) const LEGEND_GAP: f64 = 5.0;
pub(super) const EDGE: f64 = 6.0;
pub(super) const TICK_ROOM: f64 = 10.0;
/// Width of a digit and mean width of a letter, in font sizes; the reader's font is not known.
pub(super) const DIGIT: f64 = 0.6;
pub(super) const LETTER: f64 = 0.53;
pub(super) const BOLD: f64 = 0.58;
/// Distances below a frame, to the middle of the tick labels and of the x label.
pub(super) const TICK_LABEL_DROP: f64 = 13.0;
pub(super) const X_LABEL_DROP: f64 = 28.0;

/// Distance of the colour bar from the frame, and its width.
pub(super) const BAR_GAP: f64 = 10.0;
pub(super) const BAR_WIDTH: f64 = 11.0;

/// The number of whole units in a size.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes are checked to be positive and at most some thousand px"
)]
pub(super) fn floored(value: f64) -> usize {
    value as usize
}

/// Width of a text in px, roughly: the reader's font is not known.
pub(super) fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER * TEXT_SIZE
}
