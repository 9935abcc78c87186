//! A motion over whole periods: its impacts, its longest flight, and its smallest gap at a turning point.

use videg_model::{Event, Harvester, Impact, ModelError};

use super::flow::{Flow, Point, State};

/// Looks a period.
const LOOKS: u32 = 128;
/// Halvings of the time between two looks, to find a turning point.
const HALVINGS: u32 = 50;
/// Most impacts a period; a motion with more counts as one that is not resolved.
const MOST_IMPACTS: usize = 1000;

/// What a motion over whole periods is like.
#[derive(Debug, Clone)]
pub struct Cycle {
    /// Impacts; their times are in periods since the excitation had the phase `excitation.phase`.
    pub impacts: Vec<Impact>,
    /// Smallest distance, m, from a membrane at which the ball turns without meeting it; infinite if it turns nowhere.
    pub least_gap: f64,
    /// Middle of the longest flight: periods after the start, and the state.
    pub middle: (f64, State),
    /// Sum of `U_DE4` - `U_in` over its time, V/s: `<U>`.
    pub voltage_gain: f64,
}

impl Cycle {
    /// Follows the motion from `point` over `periods`. None if it has too many impacts.
    pub fn along(flow: Flow<'_>, point: &Point, periods: u32) -> Result<Option<Self>, ModelError> {
        let (period, half) = (flow.period(point.value), flow.problem().at(point.value).travel() / 2.0);
        let count = LOOKS * periods;
        let step = period / f64::from(LOOKS);
        let mut harvester = flow.start(point)?;
        let mut impacts: Vec<Impact> = Vec::new();
        let mut least_gap = f64::INFINITY;
        let mut flights = Vec::new();
        for look in 1..=count {
            let before = harvester.clone();
            let known = impacts.len();
            harvester.advance_with(f64::from(look) * step, |event| {
                if let Event::Impact(impact) = event
                    && impacts.len() <= MOST_IMPACTS * periods as usize
                {
                    impacts.push(Impact { time: impact.time / period + point.phase, ..*impact });
                }
            })?;
            if impacts.len() > MOST_IMPACTS * periods as usize {
                return Ok(None);
            }
            let flies = impacts.len() == known && is_free(&before, half) && is_free(&harvester, half);
            if flies {
                least_gap = least_gap.min(gap_at_turn(&before, &harvester, half));
            }
            flights.push(flies);
        }
        let voltage_gain = harvester.totals().voltage_gain / (f64::from(periods) * period);
        let Some(middle) = middle_of_longest(&flights) else { return Ok(None) };
        let middle = middle / f64::from(LOOKS);
        let state = flow.after(point, middle, |_| {})?;
        Ok(Some(Self { impacts, least_gap, middle: (middle, state), voltage_gain }))
    }
}

/// Middle of the longest row of flights; the row is a ring, in which the first one follows the last. None without a flight.
fn middle_of_longest(flights: &[bool]) -> Option<f64> {
    let count = flights.len();
    if flights.iter().all(|flies| *flies) {
        return Some(0.0);
    }
    let row = |start: usize| (0..count).take_while(|k| flights[(start + k) % count]).count();
    let begins = (0..count).filter(|k| flights[*k] && !flights[(k + count - 1) % count]);
    let (length, start) =
        begins.map(|start| (row(start), start)).max_by_key(|(length, start)| (*length, count - start))?;
    Some((start as f64 + 0.5 * length as f64) % count as f64)
}

/// Whether the ball flies, between membranes that lie at `half` of the gap, m.
fn is_free(harvester: &Harvester, half: f64) -> bool {
    harvester.resting().is_none() && !harvester.is_stuck() && harvester.relative_displacement().abs() < half
}

fn rate(harvester: &Harvester) -> f64 {
    harvester.cylinder_velocity() - harvester.ball_velocity()
}

/// Distance, m, from the membrane ahead where the relative motion turns between `before` and `after`; infinite if it does not.
fn gap_at_turn(before: &Harvester, after: &Harvester, half: f64) -> f64 {
    let direction = rate(before).signum();
    if direction * rate(after) > 0.0 {
        return f64::INFINITY;
    }
    let (mut early, mut late) = (before.time(), after.time());
    let mut turned = before.clone();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (early + late);
        let mut trial = before.clone();
        if trial.advance(middle).is_err() || direction * rate(&trial) <= 0.0 {
            late = middle;
        } else {
            early = middle;
            turned = trial;
        }
    }
    half - direction * turned.relative_displacement()
}
