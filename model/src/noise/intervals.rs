//! States at the begins of hold intervals: from one to any other in its block, and where something might happen.
//!
//! Inside an interval dz stays within a bound, given by the largest acceleration, of its chord; only where that may touch a
//! membrane the interval must be searched in closed form.

use super::block::{BLOCK, Block, COLUMNS, ROWS, place_in_block};

/// State at the begin of a hold interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoldState {
    /// Number of the interval.
    pub sample: u64,
    /// `z_M`, m.
    pub position: f64,
    /// `z_M'`, m/s.
    pub velocity: f64,
    /// `z_M` - `z_m`, m.
    pub dz: f64,
    /// `z_M'` - `z_m'`, m/s.
    pub rate: f64,
    /// External force over M, m/s^2.
    pub external: f64,
}

impl HoldState {
    /// Number of the interval in its block.
    pub fn place(&self) -> usize {
        place_in_block(self.sample)
    }
}

/// The begin of a hold interval, and the anchor that it follows from, in the same block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchored {
    pub anchor: HoldState,
    pub here: HoldState,
}

impl Anchored {
    pub fn at_anchor(anchor: HoldState) -> Self {
        Self { anchor, here: anchor }
    }
}

/// What is the same in all hold intervals up to the next event.
#[derive(Clone, Copy)]
pub struct Conditions {
    /// Length of an interval, s.
    pub hold: f64,
    /// Sign of dz at the membrane on which the ball rests.
    pub resting: Option<f64>,
    /// Rate of the external force over M, m/s^3.
    pub rate: f64,
    /// What gravity adds to the acceleration of dz, m/s^2.
    pub incline: f64,
    /// A / M, m/s^2.
    pub amplitude: f64,
    /// 2 pi `f_0`, rad/s.
    pub omega: f64,
    /// s/2, m.
    pub half_travel: f64,
}

impl Conditions {
    /// What an external force over M, m/s^2, adds within `time`, s, to velocity, m/s, and position, m.
    #[inline]
    fn by(&self, external: f64, time: f64) -> [f64; 2] {
        let change = self.rate * time;
        [time * (external + change / 2.0), time * time * (external / 2.0 + change / 6.0)]
    }

    /// The begin of interval `place` of `block`, or its end, if the state at that of another is `anchor`.
    #[inline]
    pub fn at(&self, anchor: &HoldState, block: &Block, place: usize) -> HoldState {
        let from = anchor.place();
        if place == from {
            return *anchor;
        }
        let ([v0, z0], [v, z]) = (block.at(from, self.hold), block.at(place, self.hold));
        let time = self.hold * (place as f64 - from as f64);
        let external = self.by(anchor.external, time);
        let (velocity, position) = (anchor.velocity - v0, (z - z0) + external[1]);
        let gained = v + external[0];
        let [dz, rate] = if self.resting.is_some() {
            [anchor.dz, 0.0]
        } else {
            let rate = anchor.rate - v0;
            let [faster, farther] = [time * self.incline, 0.5 * time * time * self.incline];
            [anchor.dz + (time * rate + (position + farther)), rate + (gained + faster)]
        };
        HoldState {
            sample: anchor.sample + place as u64 - from as u64,
            position: anchor.position + (time * velocity + position),
            velocity: velocity + gained,
            dz,
            rate,
            external: anchor.external + self.rate * time,
        }
    }

    /// The first interval of `block`, from number `first` on, in which something might happen.
    pub fn doubtful(&self, anchor: &HoldState, block: &Block, first: usize) -> Option<usize> {
        let Some(sign) = self.resting else { return self.doubtful_flight(anchor, block, first) };
        let doubt = self.doubt(anchor);
        let mut from = self.at(anchor, block, first);
        (first..BLOCK).find(|place| {
            let to = self.at(anchor, block, place + 1);
            let change = to.velocity - from.velocity + self.hold * self.incline;
            from = to;
            sign * change <= doubt
        })
    }

    fn doubtful_flight(&self, anchor: &HoldState, block: &Block, first: usize) -> Option<usize> {
        let near = self.near(anchor);
        let is_far = |from: &HoldState, intervals| self.farthest(from, intervals) < near;
        if is_far(anchor, BLOCK - anchor.place()) {
            return None;
        }
        let is_near = |place| self.at(anchor, block, place).dz.abs() >= near;
        let mut columns =
            (first / ROWS..COLUMNS).filter(|column| !is_far(&self.at(anchor, block, column * ROWS), ROWS));
        columns.find_map(|column| {
            let mut places = first.max(column * ROWS)..(column + 1) * ROWS;
            let mut ends_near = is_near(places.start);
            places.find(|place| {
                let begins_near = ends_near;
                ends_near = is_near(place + 1);
                begins_near || ends_near
            })
        })
    }

    /// A bound of |dz|, m, in so many `intervals` from `start`.
    fn farthest(&self, start: &HoldState, intervals: usize) -> f64 {
        let time = self.hold * intervals as f64;
        let straight = start.dz + time * start.rate;
        let force = self.amplitude + start.external.abs() + self.incline.abs() + self.rate.abs() * time / 3.0;
        1.000_001 * (start.dz.abs().max(straight.abs()) + 0.5 * time * time * force)
    }

    /// |dz|, m, at both ends of an interval up to which the ball meets no membrane in between, but by the rounding of the sums; for one
    /// block.
    fn near(&self, from: &HoldState) -> f64 {
        let [begin, end] = [0.0, BLOCK as f64].map(|n| (from.external + n * self.hold * self.rate).abs());
        let bulge = 0.125 * self.hold * self.hold * (self.amplitude + (begin.max(end) + self.incline.abs()));
        let swing = self.amplitude / (self.omega * self.omega);
        self.half_travel * (1.0 - 1e-12) - 1.001 * bulge - 64.0 * f64::EPSILON * swing
    }

    /// Change of velocity in an interval, m/s, above which the acceleration keeps its sign, whatever rounding does to a difference
    /// of velocities that are this large.
    fn doubt(&self, anchor: &HoldState) -> f64 {
        let push = self.hold * (self.amplitude + anchor.external.abs() + BLOCK as f64 * self.hold * self.rate.abs());
        let rounding = 8.0 * f64::EPSILON * (anchor.velocity.abs() + 2.0 * BLOCK as f64 * push);
        1.001 * self.hold * self.hold * (self.amplitude * self.omega + self.rate.abs()) + rounding
    }
}
