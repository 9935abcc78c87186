//! Titles and legends above the panels, and how long words are.

use super::figure::{Panel, Scale};
use super::metrics::{BOLD, LEGEND_GAP, LEGEND_KEY, LETTER, ROW, TEXT_SIZE, text_width};
use super::trace::{Key, Shape, Trace};

/// A legend entry at its place; `y` counts from the top of the header.
pub(super) struct Entry<'f> {
    pub label: &'f str,
    pub key: Key,
    pub x: f64,
    pub y: f64,
}

/// Entries that flow from the title to the right, and on to further rows, and the height they take.
pub(super) fn legend<'f>(panel: &'f Panel<'f>, traces: &[Trace], (left, right): (f64, f64)) -> (Vec<Entry<'f>>, f64) {
    let entries = entries(panel, traces);
    if entries.is_empty() && panel.title.is_empty() {
        return (Vec::new(), TEXT_SIZE);
    }
    let indent = if panel.title.is_empty() { 0.0 } else { text_width(&panel.title) * BOLD / LETTER + ROW };
    let (mut x, mut y) = (left + indent, ROW / 2.0);
    let mut placed = Vec::new();
    for (label, key) in entries {
        let width = LEGEND_KEY + LEGEND_GAP + text_width(label);
        if x + width > right && x > left {
            (x, y) = (left, y + ROW);
        }
        placed.push(Entry { label, key, x, y });
        x += width + ROW;
    }
    (placed, y + ROW / 2.0 + 3.0)
}

fn entries<'f>(panel: &'f Panel<'f>, traces: &[Trace]) -> Vec<(&'f str, Key)> {
    let series = panel.series.iter().zip(traces).map(|(s, t)| (s.label.as_str(), t.key));
    let bands = panel.bands.iter().map(|band| (band.label.as_str(), Key::new(Shape::Area, band.color)));
    let hatches = panel.hatches.iter().map(|hatch| (hatch.label.as_str(), Key::HATCH));
    let lines = panel.lines.iter().map(|line| (line.label.as_str(), Key::REFERENCE));
    let kinds = match panel.map.as_ref().map(|map| &map.scale) {
        Some(Scale::Kinds(names)) => names.as_slice(),
        _ => &[],
    };
    let kinds = kinds.iter().enumerate().map(|(index, name)| (name.as_str(), Key::new(Shape::Cell, index)));
    series.chain(bands).chain(hatches).chain(lines).chain(kinds).filter(|entry| !entry.0.is_empty()).collect()
}

/// Words of a label in as few lines of at most `length` characters as possible.
pub(super) fn wrap(label: &str, length: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in label.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= length => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_labels_wrap() {
        assert_eq!(wrap("relative displacement (mm)", 16), ["relative", "displacement", "(mm)"]);
        assert_eq!(wrap("relative displacement (mm)", 21), ["relative displacement", "(mm)"]);
    }

    #[test]
    fn every_kind_of_mark_has_its_key() {
        use super::super::figure::HeatMap;
        let kinds = Scale::Kinds(vec!["none".to_owned(), "one".to_owned()]);
        let map = HeatMap { xs: &[0.0], ys: &[0.0], values: &[0.0], scale: kinds };
        let panel = Panel::new("", "", "").band("range", &[], 2).line("bias", 0.0).map(map);
        let labels: Vec<&str> = entries(&panel, &[]).iter().map(|entry| entry.0).collect();
        assert_eq!(labels, ["range", "bias", "none", "one"]);
    }
}
