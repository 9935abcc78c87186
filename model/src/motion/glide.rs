//! The way of a free cylinder through the segments of a recording, many in one go.
//!
//! Only position and velocity of cylinder and ball go from segment to segment, in closed form. Bounds of the acceleration show where
//! nothing can happen; only where they leave a doubt the segment is searched.

use super::cylinder::{CylinderMotion, Drive, Harmonic};
use super::events::Piece;
use super::flight::Flight;
use super::flight::angle::Swept;
use super::side::Side;
use super::{Ball, Motion, Start};
use crate::numerics::product::cycle_fraction;
use crate::recording::Playback;

/// Share of the gap, or of an acceleration, by which a bound must be kept: far more than rounding.
const MARGIN: f64 = 1e-12;

/// What stays the same from segment to segment.
struct Glide<'a> {
    motion: &'a Motion,
    playback: &'a Playback,
    harmonic: Harmonic,
    /// What gravity and friction add to dz'', m/s^2, by the ball's own motion.
    relative: f64,
}

impl Motion {
    fn glide(&self, drive: &Drive) -> Option<Glide<'_>> {
        let playback = self.playback.as_ref()?;
        let relative = self.mount.relative(self.slip);
        Some(Glide { motion: self, playback, harmonic: Harmonic::new(drive, &self.cylinder.load), relative })
    }

    /// The piece of this cylinder and flight, if both have the same begin.
    pub(super) fn begun_piece(cylinder: &CylinderMotion, flight: &Flight) -> Option<Piece> {
        let CylinderMotion { start: time, position, velocity, damped, drive, .. } = *cylinder;
        let relative = [flight.dz, flight.rate];
        (time == flight.start).then_some(Piece {
            cylinder: Start { time, position, velocity },
            relative,
            damped,
            drive,
        })
    }

    /// Goes on from a piece over a free cylinder to the next one.
    pub(super) fn pass(&self, piece: &mut Piece) {
        if let Some(glide) = self.glide(&piece.drive) {
            glide.step(piece);
        }
    }

    /// Goes on from a piece over a free cylinder to that of `time`, s, up to which nothing happens.
    pub(super) fn pass_to(&self, piece: &mut Piece, time: f64) {
        let Some(glide) = self.glide(&piece.drive) else { return };
        while piece.drive.recorded.end <= time {
            glide.step(piece);
        }
    }

    /// Goes on from a piece over a free cylinder to the first one in which something might happen, or which begins after `until`,
    /// s, or does not end before `limit`, s.
    pub(super) fn pass_quiet(&self, piece: &mut Piece, limit: Option<f64>, until: f64) {
        let Some(glide) = self.glide(&piece.drive) else { return };
        let limit = limit.unwrap_or(f64::INFINITY);
        while piece.cylinder.time <= until && piece.drive.recorded.end < limit && glide.is_quiet(piece) {
            glide.step(piece);
        }
    }
}

impl Glide<'_> {
    /// Goes on to the next segment.
    #[inline]
    fn step(&self, piece: &mut Piece) {
        let Piece { cylinder: Start { time, position, velocity }, relative: [dz, rate], ref mut drive, .. } = *piece;
        let end = drive.recorded.end;
        let length = end - time;
        let [farther, faster] = self.change(drive, time, length);
        piece.cylinder =
            Start { time: end, position: position + (velocity * length + farther), velocity: velocity + faster };
        if !self.motion.ball.is_carried() {
            let by_ball = self.relative * length;
            piece.relative = [dz + (length * (rate + 0.5 * by_ball) + farther), rate + (by_ball + faster)];
        }
        drive.external += drive.external_rate * length;
        drive.recorded = self.playback.segment_after(&drive.recorded);
    }

    /// What the forces add within `length`, s, from `start`, s, on to position, m, beyond the way of the first velocity, and to
    /// velocity, m/s.
    #[inline]
    fn change(&self, drive: &Drive, start: f64, length: f64) -> [f64; 2] {
        let [external, rate] = drive.line(&self.motion.cylinder.load, start);
        let line = [
            length * length * (0.5 * external + length * rate * (1.0 / 6.0)),
            length * (external + 0.5 * rate * length),
        ];
        if self.harmonic.amplitude == 0.0 {
            return line;
        }
        let Harmonic { swing, speed, .. } = self.harmonic;
        let [sin, cos] = self.harmonic.sine(start);
        let swept = Swept::new(drive.omega() * length, cycle_fraction(drive.frequency, length));
        let harmonic =
            [swing * (cos * swept.versine - sin * swept.lag), speed * (cos * swept.sine - sin * swept.versine)];
        [line[0] + harmonic[0], line[1] + harmonic[1]]
    }

    /// Whether a bound shows that nothing happens in this segment.
    #[inline]
    fn is_quiet(&self, piece: &Piece) -> bool {
        let Piece { cylinder: Start { time, .. }, relative: [dz, rate], ref drive, .. } = *piece;
        let Motion { half_travel, mount, ball, slip, .. } = self.motion;
        let length = drive.recorded.end - time;
        let [external, change] = drive.line(&self.motion.cylinder.load, time);
        let (begin, end) = (external + self.relative, external + change * length + self.relative);
        let (harmonic, largest) = (self.harmonic.amplitude, begin.abs().max(end.abs()));
        let margin = MARGIN * (harmonic + largest + mount.friction);
        match ball {
            Ball::Free => {
                let faster = length * (harmonic + largest);
                let reach = dz.abs() + length * (rate.abs() + 0.5 * faster);
                let slides_on = *slip == 0.0 || slip * rate > faster * (1.0 + MARGIN);
                slides_on && reach < half_travel * (1.0 - MARGIN)
            }
            Ball::Resting(side) => {
                let push = side.sign() * if *side == Side::Left { begin.min(end) } else { begin.max(end) };
                push + mount.friction > harmonic + margin
            }
            Ball::Stuck => mount.friction > largest + harmonic + margin,
            Ball::InContact(_) => false,
        }
    }
}
