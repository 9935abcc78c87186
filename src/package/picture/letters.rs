//! The few letters that the sketches need, as strokes: no font has to be found on the machine that packages.

use super::canvas::Point;

/// Height of a capital in grid units.
const GRID: f32 = 6.0;
/// Space between letters, grid units.
const GAP: f32 = 1.4;
/// Size of a low letter over that of a normal one, and how far it goes down, in heights of a capital.
const LOW: (f32, f32) = (0.68, 0.28);

/// A letter: its width, and lines from point to point, from the base line up.
struct Letter(f32, &'static [&'static [Point]]);

/// Lines of a text and its width, both for capitals of this height; the base line begins at the origin.
pub(super) fn set(text: &str, height: f32) -> (Vec<Vec<Point>>, f32) {
    let (mut lines, mut pen, mut low) = (Vec::new(), 0.0, false);
    for character in text.chars() {
        if character == '_' {
            low = true;
            continue;
        }
        // A symbol's index ends where something that is no letter begins.
        low &= character.is_alphanumeric();
        let (factor, drop) = if low { (LOW.0, LOW.1 * height) } else { (1.0, 0.0) };
        let scale = factor * height / GRID;
        let Letter(width, strokes) = letter(character);
        for stroke in strokes {
            lines.push(stroke.iter().map(|point| (pen + scale * point.0, scale * point.1 - drop)).collect());
        }
        pen += (width + GAP) * scale;
    }
    (lines, (pen - GAP * height / GRID).max(0.0))
}

fn letter(character: char) -> Letter {
    match character {
        'A' => Letter(4.0, &[&[(0.0, 0.0), (2.0, 6.0), (4.0, 0.0)], &[(0.7, 2.0), (3.3, 2.0)]]),
        'C' => Letter(
            4.0,
            &[&[
                (4.0, 5.0),
                (3.0, 6.0),
                (1.3, 6.0),
                (0.3, 5.0),
                (0.0, 3.0),
                (0.3, 1.0),
                (1.3, 0.0),
                (3.0, 0.0),
                (4.0, 1.0),
            ]],
        ),
        'F' => Letter(3.2, &[&[(0.0, 0.0), (0.0, 6.0), (3.4, 6.0)], &[(0.0, 3.2), (2.8, 3.2)]]),
        'M' => Letter(4.6, &[&[(0.0, 0.0), (0.0, 6.0), (2.3, 2.0), (4.6, 6.0), (4.6, 0.0)]]),
        'R' => Letter(
            3.8,
            &[
                &[(0.0, 0.0), (0.0, 6.0), (2.4, 6.0), (3.4, 5.4), (3.6, 4.5), (3.4, 3.6), (2.4, 3.0), (0.0, 3.0)],
                &[(1.9, 3.0), (3.8, 0.0)],
            ],
        ),
        'U' => Letter(
            4.0,
            &[&[(0.0, 6.0), (0.0, 1.6), (0.6, 0.4), (1.6, 0.0), (2.4, 0.0), (3.4, 0.4), (4.0, 1.6), (4.0, 6.0)]],
        ),
        'b' => Letter(
            3.0,
            &[&[
                (0.0, 6.0),
                (0.0, 0.0),
                (1.8, 0.0),
                (2.7, 0.6),
                (3.0, 2.0),
                (2.7, 3.4),
                (1.8, 4.0),
                (0.9, 3.9),
                (0.0, 3.2),
            ]],
        ),
        'd' => Letter(
            3.0,
            &[&[
                (3.0, 6.0),
                (3.0, 0.0),
                (1.2, 0.0),
                (0.3, 0.6),
                (0.0, 2.0),
                (0.3, 3.4),
                (1.2, 4.0),
                (2.1, 3.9),
                (3.0, 3.2),
            ]],
        ),
        'i' => Letter(0.4, &[&[(0.2, 0.0), (0.2, 4.0)], &[(0.2, 5.6), (0.2, 5.7)]]),
        'l' => Letter(0.4, &[&[(0.2, 0.0), (0.2, 6.0)]]),
        'm' => Letter(
            4.8,
            &[
                &[(0.0, 0.0), (0.0, 4.0)],
                &[(0.0, 3.0), (1.0, 4.0), (1.9, 4.0), (2.4, 3.2), (2.4, 0.0)],
                &[(2.4, 3.0), (3.4, 4.0), (4.3, 4.0), (4.8, 3.2), (4.8, 0.0)],
            ],
        ),
        'n' => Letter(2.8, &[&[(0.0, 0.0), (0.0, 4.0)], &[(0.0, 3.0), (1.1, 4.0), (2.1, 4.0), (2.8, 3.2), (2.8, 0.0)]]),
        'o' => Letter(
            3.0,
            &[&[
                (1.2, 0.0),
                (0.3, 0.6),
                (0.0, 2.0),
                (0.3, 3.4),
                (1.2, 4.0),
                (1.8, 4.0),
                (2.7, 3.4),
                (3.0, 2.0),
                (2.7, 0.6),
                (1.8, 0.0),
                (1.2, 0.0),
            ]],
        ),
        'r' => Letter(2.0, &[&[(0.0, 0.0), (0.0, 4.0)], &[(0.0, 2.8), (0.8, 3.8), (2.0, 4.0)]]),
        't' => Letter(2.4, &[&[(1.0, 5.6), (1.0, 0.9), (1.5, 0.0), (2.4, 0.1)], &[(0.0, 4.0), (2.3, 4.0)]]),
        'u' => Letter(2.8, &[&[(0.0, 4.0), (0.0, 0.8), (0.7, 0.0), (1.7, 0.0), (2.8, 1.0)], &[(2.8, 4.0), (2.8, 0.0)]]),
        'w' => Letter(4.2, &[&[(0.0, 4.0), (1.1, 0.0), (2.1, 3.4), (3.1, 0.0), (4.2, 4.0)]]),
        'z' => Letter(2.8, &[&[(0.0, 4.0), (2.8, 4.0), (0.0, 0.0), (2.9, 0.0)]]),
        '(' => Letter(1.4, &[&[(1.4, 7.0), (0.4, 5.4), (0.0, 3.0), (0.4, 0.6), (1.4, -1.0)]]),
        ')' => Letter(1.4, &[&[(0.0, 7.0), (1.0, 5.4), (1.4, 3.0), (1.0, 0.6), (0.0, -1.0)]]),
        '+' => Letter(3.6, &[&[(0.0, 3.0), (3.6, 3.0)], &[(1.8, 4.8), (1.8, 1.2)]]),
        '-' => Letter(3.6, &[&[(0.0, 3.0), (3.6, 3.0)]]),
        _ => Letter(2.0, &[]),
    }
}
