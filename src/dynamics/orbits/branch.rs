//! A branch: one periodic orbit, followed over the parameter through stable and unstable stretches.

use nalgebra::DVector;

use super::arc::Arc;
use super::flow::{Flow, Point};
use super::marks::{self, Mark};
use super::orbit::Orbit;

/// First and longest step, in units of the range of the parameter and of the state's scale.
const FIRST: f64 = 0.005;
const LONGEST: f64 = 0.02;
/// A step below which there is no way on.
const SHORTEST: f64 = 1e-12;
/// Points closer than this to the one before are not kept, but for the last one.
const SPACING: f64 = 1e-4;
/// Most steps in one direction.
const STEPS: usize = 4000;
/// Speed of an impact, and distance from a membrane, in units of the scale, below which the ball grazes.
const GRAZES: f64 = 1e-3;

/// Why a branch goes no further.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The parameter has reached an end of its range.
    Range,
    /// The ball grazes a membrane: beyond, the order of impacts is another.
    Grazing,
    /// It meets another branch in a bifurcation.
    Bifurcation,
    /// It is back where it began.
    Closed,
    /// It cannot be followed further.
    Lost,
}

impl End {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Range => "end of the range",
            Self::Grazing => "grazing",
            Self::Bifurcation => "bifurcation",
            Self::Closed => "closed",
            Self::Lost => "not followed further",
        }
    }
}

/// An orbit over the parameter.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Points in order along the branch; the order of impacts is the same in all.
    pub orbits: Vec<Orbit>,
    /// What happens on the way, in order.
    pub marks: Vec<Mark>,
    /// Why it ends before the first and after the last point.
    pub ends: [End; 2],
}

/// One direction of a branch.
struct Way {
    orbits: Vec<Orbit>,
    marks: Vec<Mark>,
    end: End,
}

impl Branch {
    /// The branch through `orbit`. With a `direction` it begins there, and goes that way alone.
    pub(super) fn through(
        flow: Flow<'_>,
        range: [f64; 2],
        orbit: &Orbit,
        direction: Option<&DVector<f64>>,
        is_stopped: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let arc = Arc::new(flow, range, orbit.period);
        let tangent = match direction {
            Some(direction) => arc.tangent(&orbit.change, direction)?,
            None => arc.first_tangent(&orbit.change)?,
        };
        let ahead = follow(&arc, orbit, &tangent, is_stopped);
        let mut orbits = vec![orbit.clone()];
        let mut marks = Vec::new();
        let mut first = End::Closed;
        if direction.is_some() {
            first = End::Bifurcation;
        } else if ahead.end != End::Closed {
            let mut back = follow(&arc, orbit, &-tangent, is_stopped);
            back.orbits.reverse();
            back.marks.reverse();
            orbits.splice(0..0, back.orbits);
            marks = back.marks;
            first = back.end;
        }
        orbits.extend(ahead.orbits);
        marks.extend(ahead.marks);
        Some(Self { orbits, marks, ends: [first, ahead.end] })
    }

    /// Whether `orbit` lies on it.
    pub(super) fn has(&self, flow: Flow<'_>, orbit: &Orbit) -> bool {
        let value = orbit.point.value;
        let is_like = |other: &Orbit| (other.period, &other.pattern) == (orbit.period, &orbit.pattern);
        if !self.orbits.first().is_some_and(is_like) {
            return false;
        }
        let is_here = |near: &Orbit| {
            let guess = Point { value, ..near.point.clone() };
            Orbit::find(flow, &guess, near.period).is_some_and(|found| found.is_same(orbit, flow))
        };
        let brackets = |pair: &&[Orbit]| {
            let [a, b] = [&pair[0], &pair[1]].map(|end| end.point.value - value);
            a * b <= 0.0
        };
        self.orbits.windows(2).filter(brackets).any(|pair| pair.iter().any(is_here))
    }

    /// The name of its orbits.
    pub fn name(&self) -> String {
        self.orbits.first().map_or_else(String::new, Orbit::name)
    }
}

/// Follows the curve from `start` in the direction of `tangent`; `start` is not among the points.
fn follow(arc: &Arc<'_>, start: &Orbit, tangent: &DVector<f64>, is_stopped: &dyn Fn() -> bool) -> Way {
    let (mut orbits, mut marks): (Vec<Orbit>, Vec<Mark>) = (Vec::new(), Vec::new());
    let (mut here, mut tangent) = (start.clone(), tangent.clone());
    let (mut step, mut has_failed, mut travelled) = (FIRST, false, 0.0);
    let mut pending: Option<Orbit> = None;
    let mut since_kept = 0.0;
    let mut steps = 0..STEPS;
    let end = loop {
        if steps.next().is_none() || is_stopped() {
            break End::Lost;
        }
        // The last step ends on the end of the range.
        let rest = arc.rest(&here.point, &tangent);
        let is_last = step >= rest;
        let advanced = if is_last { arrive(arc, &here, &tangent, rest) } else { advance(arc, &here, &tangent, step) };
        let is_next = |(next, next_tangent): &(Orbit, DVector<f64>)| {
            arc.has(&next.point) && marks::is_smooth((&here, &tangent), (next, next_tangent))
        };
        let Some((next, next_tangent)) = advanced.filter(is_next) else {
            step = 0.5 * step.min(rest);
            has_failed = true;
            if step < SHORTEST {
                break last_end(arc, &here);
            }
            continue;
        };
        if next.period != here.period {
            break End::Bifurcation;
        }
        marks.extend(marks::between(arc, (&here, &tangent), (&next, &next_tangent), step));
        travelled += step;
        since_kept += step;
        let is_back = travelled > 10.0 * LONGEST
            && (next.point.phase - start.point.phase).abs() < 0.05
            && arc.distance(&next.point, &start.point) < 1.2 * step;
        (here, tangent) = (next, next_tangent);
        if since_kept >= SPACING {
            orbits.push(here.clone());
            since_kept = 0.0;
            pending = None;
        } else {
            pending = Some(here.clone());
        }
        if is_back || is_last {
            break if is_last { End::Range } else { End::Closed };
        }
        if !has_failed {
            step = (1.5 * step).min(LONGEST);
        }
        has_failed = false;
    };
    orbits.extend(pending);
    if end == End::Grazing {
        marks.push(Mark::grazing(here));
    }
    Way { orbits, marks, end }
}

/// The next orbit and its tangent. None if the order of impacts is another there, or nothing is found.
fn advance(arc: &Arc<'_>, here: &Orbit, tangent: &DVector<f64>, step: f64) -> Option<(Orbit, DVector<f64>)> {
    reach(arc, here, tangent, &arc.along(&here.point, tangent, step), (tangent, step))
}

/// The orbit at the end of the range, `rest` further on, and its tangent.
fn arrive(arc: &Arc<'_>, here: &Orbit, tangent: &DVector<f64>, rest: f64) -> Option<(Orbit, DVector<f64>)> {
    let guess = arc.clamped(arc.along(&here.point, tangent, rest));
    reach(arc, here, tangent, &guess, (&arc.of_value(), rest))
}

/// The orbit near `guess` in the plane at right angles to `normal`, about a step from `here`.
fn reach(
    arc: &Arc<'_>,
    here: &Orbit,
    tangent: &DVector<f64>,
    guess: &Point,
    (normal, step): (&DVector<f64>, f64),
) -> Option<(Orbit, DVector<f64>)> {
    let (point, change) = arc.correct(guess, normal)?;
    // A corrector that goes far has found another curve.
    if arc.distance(&point, guess) > 0.5 * step + 1e-9 {
        return None;
    }
    let there = arc.tangent(&change, tangent)?;
    // Sharp turns are taken in short steps.
    if there.dot(tangent) < 0.9 && step > 1e-5 {
        return None;
    }
    let next = Orbit::measured(arc.flow, &point, arc.period)?;
    if next.period == here.period && next.pattern != here.pattern {
        return None;
    }
    let carried = arc.carried(&point, &there, next.elapsed)?;
    let tangent = arc.tangent(&next.change, &carried)?;
    Some((next, tangent))
}

fn last_end(arc: &Arc<'_>, here: &Orbit) -> End {
    let scale = arc.flow.scale(here.point.value);
    let grazes = here.least_speed < GRAZES * scale[1] || here.least_gap < GRAZES * scale[0];
    if grazes { End::Grazing } else { End::Lost }
}
