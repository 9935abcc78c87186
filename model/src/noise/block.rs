//! A block of hold intervals: what the harmonic force does in them, summed.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use super::normal::{self, Aligned, COLUMNS, ROWS};

/// Hold intervals in a block.
pub const BLOCK: usize = normal::GROUP;

/// Number in its block of hold interval `sample`.
pub fn place_in_block(sample: u64) -> usize {
    #[allow(clippy::cast_possible_truncation)] // less than BLOCK
    let place = (sample % BLOCK as u64) as usize;
    place
}

/// What the harmonic force does up to the begin of each hold interval of one block, if the cylinder is at rest at the
/// begin of the block.
#[derive(Clone)]
pub struct Block {
    /// Samples of the noise at the places of the intervals.
    pub samples: Aligned<[f64; BLOCK]>,
    /// `z_M'`, m/s, at the places of the intervals, if the cylinder is at rest at the begin of each column.
    pub velocity: Aligned<[f64; BLOCK]>,
    /// `z_M`, m, likewise, if it is at 0 there.
    pub position: Aligned<[f64; BLOCK]>,
    /// Velocity and position at the begin of each column and at the end of the block.
    columns: [[f64; 2]; COLUMNS + 1],
    /// No |`z_M`| is larger at the begin or end of an interval, to rounding, m.
    pub reach: f64,
    pub number: u64,
}

impl Block {
    pub const EMPTY: Self = Self {
        samples: Aligned([0.0; BLOCK]),
        velocity: Aligned([0.0; BLOCK]),
        position: Aligned([0.0; BLOCK]),
        columns: [[0.0; 2]; COLUMNS + 1],
        reach: 0.0,
        number: u64::MAX,
    };

    /// Sample of the noise in interval `k` of the block.
    pub fn sample(&self, k: usize) -> f64 {
        self.samples.0[normal::place(k)]
    }

    /// Velocity, m/s, and position, m, at the begin of interval `k` of the block, or at its end ([`BLOCK`]); the
    /// intervals are `hold`, s, long.
    #[inline]
    pub fn at(&self, k: usize, hold: f64) -> [f64; 2] {
        let [velocity, position] = self.columns[k / ROWS];
        if k >= BLOCK {
            return [velocity, position];
        }
        let (place, time) = (normal::place(k), (k % ROWS) as f64 * hold);
        [velocity + self.velocity.0[place], position + (time * velocity + self.position.0[place])]
    }

    /// Sums what each interval of length `hold`, s, does, which stands at its place: down the columns, all at once,
    /// then from column to column. Velocities come first: together, compilers would pack velocity and position of a
    /// column into one vector.
    #[inline(always)]
    pub fn sum(&mut self, hold: f64) {
        let (velocities, _) = self.velocity.0.as_chunks_mut::<COLUMNS>();
        let (mut velocity, mut position, mut reach) = ([0.0; COLUMNS], [0.0; COLUMNS], [0.0_f64; COLUMNS]);
        for row in velocities.iter_mut() {
            let before = velocity;
            for (sum, change) in velocity.iter_mut().zip(&*row) {
                *sum += change;
            }
            *row = before;
        }
        for (row, velocities) in self.position.0.as_chunks_mut::<COLUMNS>().0.iter_mut().zip(velocities) {
            let before = position;
            for k in 0..COLUMNS {
                position[k] += hold * velocities[k] + row[k];
                reach[k] = if position[k].abs() > reach[k] { position[k].abs() } else { reach[k] };
            }
            *row = before;
        }
        self.sum_columns(hold, velocity, position, reach);
    }

    /// The same for what each column does, and how far each reaches.
    #[inline(always)]
    fn sum_columns(&mut self, hold: f64, velocity: [f64; COLUMNS], position: [f64; COLUMNS], reach: [f64; COLUMNS]) {
        let length = ROWS as f64 * hold;
        let ([mut v, mut z], mut farthest) = ([0.0_f64; 2], 0.0_f64);
        for k in 0..COLUMNS {
            self.columns[k] = [v, z];
            farthest = farthest.max(z.abs() + length * v.abs() + reach[k]);
            z += length * v + position[k];
            v += velocity[k];
        }
        self.columns[COLUMNS] = [v, z];
        self.reach = farthest;
    }
}
