//! A block of hold intervals: what the harmonic force does in them, summed.
#![allow(clippy::inline_always)] // only what is inlined becomes part of a loop over vectors

use super::normal::{self, Aligned};
pub use super::normal::{COLUMNS, ROWS};

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
    /// Bits of the samples of the noise at the places of the intervals.
    pub samples: Aligned<[u32; BLOCK]>,
    /// `z_M'` at the places of the intervals, if the cylinder is at rest at the begin of each column, and in one more row at
    /// the end of each column.
    pub velocity: Aligned<[f64; BLOCK + COLUMNS]>,
    /// `z_M` at the places of the intervals, if it is at 0 at the begin of each column.
    pub position: Aligned<[f64; BLOCK]>,
    /// Units of both, m/s and m.
    pub units: [f64; 2],
    /// Velocity and position at the begin of each column and at the end of the block.
    columns: [[f64; 2]; COLUMNS + 1],
    pub number: u64,
}

impl Block {
    pub const EMPTY: Self = Self {
        samples: Aligned([0; BLOCK]),
        velocity: Aligned([0.0; BLOCK + COLUMNS]),
        position: Aligned([0.0; BLOCK]),
        units: [0.0; 2],
        columns: [[0.0; 2]; COLUMNS + 1],
        number: u64::MAX,
    };

    /// Sample of the noise in interval `k` of the block.
    pub fn sample(&self, k: usize) -> f64 {
        f64::from(f32::from_bits(self.samples.0[normal::place(k)]))
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
        let [by_velocity, by_position] =
            [self.units[0] * self.velocity.0[place], self.units[1] * self.position.0[place]];
        [velocity + by_velocity, position + (time * velocity + by_position)]
    }

    /// Sums what each interval of length `hold`, s, does, `change` of the number that stands at its place in `position`: a change of
    /// velocity, and of position what it differs from the mean of the velocities before and after; the unit of position is half
    /// that of velocity times `hold`. It goes down the columns, all at once, then from column to column.
    #[inline(always)]
    pub fn sum(&mut self, hold: f64, change: impl Fn(f64) -> [f64; 2]) {
        let (mut velocity, mut position) = ([0.0; COLUMNS], [0.0; COLUMNS]);
        let (velocities, _) = self.velocity.0.as_chunks_mut::<COLUMNS>();
        let (positions, _) = self.position.0.as_chunks_mut::<COLUMNS>();
        for (row_v, row_z) in velocities.iter_mut().zip(positions) {
            let (mut faster, mut farther) = ([0.0; COLUMNS], [0.0; COLUMNS]);
            for k in 0..COLUMNS {
                [faster[k], farther[k]] = change(row_z[k]);
            }
            *row_v = velocity;
            *row_z = position;
            for k in 0..COLUMNS {
                velocity[k] += faster[k];
            }
            for k in 0..COLUMNS {
                position[k] += (row_v[k] + velocity[k]) + farther[k];
            }
        }
        velocities[ROWS] = velocity;
        let [of_velocity, of_position] = self.units;
        let (length, [mut v, mut z]) = (ROWS as f64 * hold, [0.0; 2]);
        for k in 0..COLUMNS {
            self.columns[k] = [v, z];
            z += length * v + of_position * position[k];
            v += of_velocity * velocity[k];
        }
        self.columns[COLUMNS] = [v, z];
    }
}
