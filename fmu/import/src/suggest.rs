//! "Did you mean": the known name nearest to one that is not known.

/// Longest name for which one is looked for, characters: the work grows with the square.
const LONGEST: usize = 100;
/// Most candidates that are compared.
const MOST: usize = 100_000;
/// Most candidates with one end that are named.
const ENDS: usize = 3;

/// The candidate nearest to `name`, if one is near enough to be a slip of the keyboard; or those that end in `name`: a user may leave
/// out what stands before a dot.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let candidates: Vec<_> = candidates.into_iter().take(MOST).collect();
    if let Some((_, found)) = nearest_of(name, candidates.iter().map(|name| (*name, *name))) {
        return Some(found.to_owned());
    }
    let ends = candidates.iter().filter_map(|name| Some((name.rsplit_once('.')?.1, *name)));
    let (end, _) = nearest_of(name, ends.clone())?;
    let found: Vec<_> = ends.filter(|(other, _)| *other == end).map(|(_, name)| name).take(ENDS).collect();
    Some(found.join(" or "))
}

/// The pair whose first name is nearest to `name`.
fn nearest_of<'a>(name: &str, pairs: impl Iterator<Item = (&'a str, &'a str)>) -> Option<(&'a str, &'a str)> {
    let wanted = name.to_lowercase();
    let count = wanted.chars().count();
    if count > LONGEST {
        return None;
    }
    let allowed = (count / 3).max(2);
    // The distance is no less than the difference of lengths. One more tells whether there are more.
    let is_like =
        |(candidate, _): &(&str, &str)| candidate.chars().take(count + allowed + 1).count().abs_diff(count) <= allowed;
    pairs
        .filter(is_like)
        .map(|pair| (strsim::osa_distance(&wanted, &pair.0.to_lowercase()), pair))
        .filter(|(distance, (candidate, _))| *distance <= allowed && *distance < candidate.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, pair)| pair)
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
    fn what_stands_before_a_dot_may_be_left_out() {
        let names = ["ball.mass", "ball.radius", "cylinder.mass", "membrane.restitution"];
        assert_eq!(nearest("restitution", names).as_deref(), Some("membrane.restitution"));
        assert_eq!(nearest("Restitutoin", names).as_deref(), Some("membrane.restitution"));
        assert_eq!(nearest("mass", names).as_deref(), Some("ball.mass or cylinder.mass"));
        assert_eq!(nearest("height", names), None);
    }

    #[test]
    fn long_names_are_not_compared() {
        let long = "x".repeat(5000);
        assert_eq!(nearest(&long, [&long[1..]]), None);
        assert_eq!(nearest("ball.mass", [long.as_str(), "ball.mas"]).as_deref(), Some("ball.mas"));
    }
}
