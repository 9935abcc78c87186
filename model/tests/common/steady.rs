//! What a capsule does once it has settled: when its motion comes back, and with how many impacts.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, reason = "a helper fails a test, too")]

use videg_model::{Event, Harvester, Impact, Parameters, Side};

/// Periods after the transient in which a motion has to come back.
const TAKEN: f64 = 60.0;
/// Longest return that is looked for, in periods.
const LONGEST: u32 = 16;
/// Differences that count as none: of times in periods, of speeds in m/s.
const EQUAL: f64 = 1e-6;

/// A motion after its transient.
pub struct Motion {
    /// Impacts until the motion comes back; `None` if it does not.
    period: Option<usize>,
    /// All that were taken.
    taken: Vec<Impact>,
    /// W of Eq. (13) over time, W.
    pub power: f64,
    /// `z_M - z_m` over s/2 and its rate, m/s, at the end of a period.
    end: [f64; 2],
}

impl Motion {
    /// The motion from the start that the parameters give, after a transient of so many periods.
    pub fn of(p: &Parameters, transient: u32) -> Self {
        let mut harvester = Harvester::new(p, 0.0).unwrap();
        let transient = f64::from(transient);
        harvester.advance(transient / p.frequency).unwrap();
        let (before, mut taken) = (harvester.totals().energy, Vec::new());
        harvester
            .advance_with((transient + TAKEN) / p.frequency, |event| {
                if let Event::Impact(impact) = event {
                    taken.push(*impact);
                }
            })
            .unwrap();
        let power = (harvester.totals().energy - before) * p.frequency / TAKEN;
        let end = [
            2.0 * harvester.relative_displacement() / p.travel(),
            harvester.cylinder_velocity() - harvester.ball_velocity(),
        ];
        Self { period: (1..=LONGEST).find_map(|n| period(&taken, f64::from(n) / p.frequency)), taken, power, end }
    }

    /// The same from where this motion has got to: how a diagram is followed along a parameter. The cylinder must be free.
    pub fn followed(&self, p: &Parameters, transient: u32) -> Self {
        let [place, rate] = self.end;
        let ball_position = p.cylinder_position - place.clamp(-1.0, 1.0) * p.travel() / 2.0;
        let start = Parameters { ball_position, ball_velocity: p.cylinder_velocity - rate, ..*p };
        Self::of(&start, transient)
    }

    /// Impacts until the motion comes back, or all that were taken.
    pub fn impacts(&self) -> &[Impact] {
        &self.taken[..self.period.unwrap_or(self.taken.len())]
    }

    /// Relative speeds of the impacts on a side.
    pub fn speeds(&self, side: Side) -> Vec<f64> {
        self.impacts().iter().filter(|impact| impact.side == side).map(|impact| impact.speed).collect()
    }

    /// Whether the ball comes to rest on a membrane, after impacts without number.
    pub fn rests(&self) -> bool {
        self.impacts().iter().any(|impact| impact.rests)
    }

    /// Impacts at the bottom and at the top until the motion comes back: `2:1`.
    pub fn sequence(&self) -> String {
        match self.period {
            None => "irregular".to_owned(),
            Some(_) if self.rests() => "rest".to_owned(),
            Some(_) => format!("{}:{}", self.speeds(Side::Left).len(), self.speeds(Side::Right).len()),
        }
    }

    /// W of Eq. (13) for each impact, J.
    pub fn energy_of_an_impact(&self, p: &Parameters) -> f64 {
        self.power * TAKEN / p.frequency / self.taken.len() as f64
    }
}

/// After how many impacts the motion repeats all that it did `time` ago.
fn period(taken: &[Impact], time: f64) -> Option<usize> {
    let is_later = |a: &Impact, b: &Impact| {
        a.side == b.side && (b.time - a.time - time).abs() < EQUAL * time && (b.speed - a.speed).abs() < EQUAL
    };
    let count = taken.iter().position(|impact| is_later(&taken[0], impact))?;
    taken.iter().zip(&taken[count..]).all(|(a, b)| is_later(a, b)).then_some(count)
}
