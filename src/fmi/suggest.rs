//! "Did you mean": the known name nearest to one that is not known.

/// The candidate nearest to `name`, if one is near enough to be a slip of the keyboard.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let wanted = name.to_lowercase();
    let allowed = (wanted.chars().count() / 3).max(2);
    candidates
        .into_iter()
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
}
