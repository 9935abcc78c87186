//! Whether a page shows what was printed.

/// Largest relative difference between a number on a page and one printed now, if it has a point or an exponent: last bits differ
/// between C libraries.
const TOLERANCE: f64 = 1e-3;

/// Stands for any words of a line, and alone on it for any lines.
const ANYTHING: &str = "...";

/// Whether `shown`, which may have placeholders, is what was `printed`.
pub fn agree(shown: &str, printed: &str) -> bool {
    let lines = |text: &'_ str| text.trim_end().lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>();
    sequence(&lines(shown), &lines(printed), &line)
}

/// Whether items agree one by one, where [`ANYTHING`] stands for any number of them.
fn sequence(shown: &[String], printed: &[String], same: &dyn Fn(&str, &str) -> bool) -> bool {
    match (shown.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((first, rest)), _) if first.trim() == ANYTHING => {
            (0..=printed.len()).any(|skipped| sequence(rest, &printed[skipped..], same))
        }
        (Some((first, rest)), Some((found, others))) => same(first, found) && sequence(rest, others, same),
        _ => false,
    }
}

fn line(shown: &str, printed: &str) -> bool {
    sequence(&words(shown), &words(printed), &word)
}

/// Words and the marks between them, so that numbers in tables and JSON are found.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for c in line.chars() {
        if c.is_whitespace() {
            words.push(String::new());
        } else if "|,;:()[]{}\"=".contains(c) {
            words.extend([c.to_string(), String::new()]);
        } else if let Some(word) = words.last_mut() {
            word.push(c);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn word(shown: &str, printed: &str) -> bool {
    if let Some((before, after)) = shown.split_once(ANYTHING) {
        return printed.len() >= before.len() + after.len() && printed.starts_with(before) && printed.ends_with(after);
    }
    shown == printed
        || matches!((measured(shown), measured(printed)), (Some(a), Some(b)) if (a - b).abs() <= TOLERANCE * a.abs())
}

/// A number with a point or an exponent; integers count, and are exact.
fn measured(word: &str) -> Option<f64> {
    word.contains(['.', 'e', 'E']).then(|| word.parse().ok())?
}

/// Whether `shown` stands for whatever is printed.
pub fn says_nothing(shown: &str) -> bool {
    let lines: Vec<_> = shown.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    !lines.is_empty() && lines.iter().all(|line| *line == ANYTHING)
}

#[test]
fn numbers_agree_within_the_tolerance_and_placeholders_with_anything() {
    for (shown, printed) in [
        ("a 1.0 V/s\n", "a 1.0004 V/s"),
        ("{\"a\": 8078.9}", "{\"a\": 8079.0}"),
        ("begin\n...\nend", "begin\nx\ny\nend"),
        ("begin\n...\nend", "begin\nend"),
        ("8 runs; ... runs/s, ... s", "8 runs; 30.2 runs/s, 0.265 s"),
        ("out/.../a.csv", "out/x/y/a.csv"),
    ] {
        assert!(agree(shown, printed), "{shown} must stand for {printed}");
    }
    for (shown, printed) in [
        ("a 1.0", "a 1.01"),
        ("a", "a\nb"),
        ("a\n...", "b"),
        ("597 impacts", "598 impacts"),
        ("20361 steps", "20362 steps"),
        ("a 1.0", "a 1"),
        ("x...y", "xz"),
        ("", "a"),
    ] {
        assert!(!agree(shown, printed), "{shown} must not stand for {printed}");
    }
}

#[test]
fn placeholders_alone_say_nothing() {
    assert!(says_nothing("...\n") && says_nothing("...\n\n ...\n"));
    assert!(!says_nothing("") && !says_nothing("begin\n...\n") && !says_nothing("... s\n"));
}
