//! "Did you mean": the known name nearest to one that is not known.

/// Longest name for which one is looked for, characters: the work grows with the square.
const LONGEST: usize = 100;
/// Most candidates that are compared.
const MOST: usize = 100_000;

/// The candidate nearest to `name`, if one is near enough to be a slip of the keyboard.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let wanted = name.to_lowercase();
    let count = wanted.chars().count();
    if count > LONGEST {
        return None;
    }
    let allowed = (count / 3).max(2);
    // The distance is no less than the difference of lengths. One more tells whether there are more.
    let is_like = |candidate: &&str| candidate.chars().take(count + allowed + 1).count().abs_diff(count) <= allowed;
    candidates
        .into_iter()
        .filter(is_like)
        .take(MOST)
        .map(|candidate| (strsim::osa_distance(&wanted, &candidate.to_lowercase()), candidate))
        .filter(|(distance, candidate)| *distance <= allowed && *distance < candidate.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn finds_a_slip_and_ignores_the_unrelated() {
        let names = ["ball.mass", "ball.radius", "cylinder.mass"];
        assert_eq!(nearest("bal.mass", names).as_deref(), Some("ball.mass"));
        assert_eq!(nearest("Ball.Radius", names).as_deref(), Some("ball.radius"));
        assert_eq!(nearest("excitation", names), None);
        assert_eq!(nearest("x", ["a", "b"]), None);
    }

    #[test]
    fn long_names_are_not_compared() {
        let long = "x".repeat(5000);
        assert_eq!(nearest(&long, [&long[1..]]), None);
        assert_eq!(nearest("ball.mass", [long.as_str(), "ball.mas"]).as_deref(), Some("ball.mas"));
    }
}
