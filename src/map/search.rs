//! A local search for the largest value, without derivatives.
//!
//! Around the best place so far, eight places on a circle are tried. The best of them is taken if it is better, and the circle grows; else it
//! shrinks to the half. It is turned from round to round, so that a narrow ridge does not end the search. At the border of the region that is
//! allowed, where the ways up may lie in a narrow angle, several turned circles are tried before it shrinks (the idea of mesh adaptive direct search: Audet and Dennis 2006, SIAM Journal on Optimization 17, 188).

/// Radii of the circle, in distances of the grid: the largest one, and where the search ends.
const LARGEST: f64 = 1.0;
const SMALLEST: f64 = 1.0 / 128.0;
/// Places on the circle.
const PLACES: u32 = 8;
/// Circles of one size that are tried where some of the places do not count: ways up of a few degrees are seen then.
const TURNS: u32 = 8;
/// Rounds at most.
const ROUNDS: u32 = 200;
/// Turn from round to round: the golden part of the angle between two places comes back to none.
const TURN: f64 = 0.618_033_988_749_895;

/// A place, counted in distances of the grid, and what is there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spot<T> {
    pub at: [f64; 2],
    /// What is to be largest; minus infinity where the place does not count.
    pub score: f64,
    pub what: T,
}

/// The best place that the search finds from `start` on between 0 and `last`; never a worse one. `evaluate` gives score and content of
/// some places.
pub(super) fn climb<T, E>(
    start: Spot<T>,
    last: [f64; 2],
    mut evaluate: impl FnMut(&[[f64; 2]]) -> Result<Vec<Spot<T>>, E>,
) -> Result<Spot<T>, E> {
    let (mut best, mut radius, mut tried) = (start, LARGEST / 2.0, 0);
    for round in 0..ROUNDS {
        if radius < SMALLEST {
            break;
        }
        let places = circle(best.at, radius, f64::from(round) * TURN, last);
        let found = evaluate(&places)?;
        let is_at_border = found.iter().any(|spot| spot.score == f64::NEG_INFINITY);
        match found.into_iter().max_by(|a, b| a.score.total_cmp(&b.score)) {
            Some(better) if better.score > best.score => {
                best = better;
                (radius, tried) = ((2.0 * radius).min(LARGEST), 0);
            }
            _ if is_at_border && tried + 1 < TURNS => tried += 1,
            _ => (radius, tried) = (radius / 2.0, 0),
        }
    }
    Ok(best)
}

/// Places around `middle` between 0 and `last`, turned by a `share` of the angle between two.
fn circle(middle: [f64; 2], radius: f64, share: f64, last: [f64; 2]) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = Vec::new();
    for k in 0..PLACES {
        let angle = std::f64::consts::TAU * (f64::from(k) + share) / f64::from(PLACES);
        let step = [angle.cos(), angle.sin()];
        let place = [0, 1].map(|j| (middle[j] + radius * step[j]).clamp(0.0, last[j]));
        if place != middle && !places.contains(&place) {
            places.push(place);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest value of `f` that is found from the best cell of the grid on, and that of the grid.
    fn best(last: [f64; 2], f: impl Fn([f64; 2]) -> f64) -> (Spot<()>, f64) {
        let spot = |at: [f64; 2]| Spot { at, score: f(at), what: () };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
        let grid = (0..=last[0] as u32).flat_map(|i| (0..=last[1] as u32).map(move |j| [f64::from(i), f64::from(j)]));
        let start = grid.map(spot).max_by(|a, b| a.score.total_cmp(&b.score)).unwrap();
        let from = start.score;
        let found = climb(start, last, |places| Ok::<_, ()>(places.iter().map(|at| spot(*at)).collect())).unwrap();
        assert!(found.score >= from);
        (found, from)
    }

    #[test]
    fn tops_between_the_cells_are_found_on_hills_and_ridges() {
        for k in 0..200 {
            let k = f64::from(k);
            let (top, turn) = ([4.5 + 3.0 * (1.7 * k).sin(), 5.0 + 4.0 * (2.3 * k).cos()], 0.7 * k);
            for narrow in [1.0, 4.0, 15.0] {
                let hill = |at: [f64; 2]| {
                    let [x, y] = [at[0] - top[0], at[1] - top[1]];
                    let (along, across) = (x * turn.cos() + y * turn.sin(), y * turn.cos() - x * turn.sin());
                    -along * along - narrow * across * across
                };
                let (found, _) = best([9.0, 10.0], hill);
                assert!(found.score > -2e-3, "{k}, {narrow}: {found:?}");
            }
        }
    }

    #[test]
    fn along_the_border_of_what_is_allowed_the_search_goes_on() {
        for k in 0..100 {
            // The value rises to the upper right, and a slanting border stops it; the best place is a corner of border and frame.
            let slope = 0.3 + 0.02 * f64::from(k);
            let value = |[x, y]: [f64; 2]| if x + slope * y <= 7.3 { x + 0.5 * slope * y } else { f64::NEG_INFINITY };
            let (found, _) = best([9.0, 4.0], value);
            assert!(found.score > 7.3 - 0.03, "{slope}: {found:?}");
        }
    }

    #[test]
    fn neither_steps_nor_noise_lead_to_a_worse_place() {
        for k in 0..100 {
            let noise = |[x, y]: [f64; 2]| (1e4 * (x + f64::from(k)).sin() * (3.0 * y).cos()).sin() + (0.3 * x).floor();
            best([8.0, 8.0], noise);
        }
        let (found, _) = best([3.0, 3.0], |_| f64::NEG_INFINITY);
        assert_eq!(found.score, f64::NEG_INFINITY);
    }
}
