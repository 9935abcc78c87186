//! A capsule followed to shorter and shorter lengths.

use videg_model::{ContactLaw, Parameters, Side};

use crate::of_length;
use crate::steady::Motion;

/// Lengths d, from the longest, and the motions there, each from where the one before has got to.
pub struct Diagram {
    pub points: Vec<(f64, Motion)>,
}

impl Diagram {
    /// Follows the capsule in `count` steps.
    pub fn new(p: &Parameters, [from, to]: [f64; 2], count: u32) -> Self {
        // Contacts that take time are integrated.
        let transient = if p.contact_law == ContactLaw::Compliant { 150 } else { 1000 };
        let mut points: Vec<(f64, Motion)> = Vec::new();
        for k in 0..=count {
            let d = from + (to - from) * f64::from(k) / f64::from(count);
            let p = of_length(*p, d);
            let motion =
                points.last().map_or_else(|| Motion::of(&p, transient), |(_, last)| last.followed(&p, transient));
            points.push((d, motion));
        }
        Self { points }
    }

    /// The longest unbroken stretch of lengths at which the motion has this sequence, from its upper end.
    pub fn stretch(&self, sequence: &str) -> Option<[f64; 2]> {
        let is_alike = |a: &(f64, Motion), b: &(f64, Motion)| a.1.sequence() == b.1.sequence();
        let stretches = self.points.chunk_by(is_alike).filter(|stretch| stretch[0].1.sequence() == sequence);
        stretches.max_by_key(|stretch| stretch.len()).map(|stretch| [stretch[0].0, stretch[stretch.len() - 1].0])
    }

    /// Speeds at one end over d.
    pub fn speeds(&self, side: Side) -> Vec<(f64, f64)> {
        let of =
            |(d, motion): &(f64, Motion)| motion.speeds(side).into_iter().map(|speed| (*d, speed)).collect::<Vec<_>>();
        self.points.iter().flat_map(of).collect()
    }

    /// W of Eq. (13) over time, mW, over d.
    pub fn powers(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|(d, motion)| (*d, 1e3 * motion.power)).collect()
    }
}
