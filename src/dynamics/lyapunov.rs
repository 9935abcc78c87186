//! How fast nearby motions part: the largest Lyapunov exponent.

use videg_model::{Harvester, OutsideGap, Parameters, Setup};

use super::motion::Flash;
use super::{DynamicsError, excitation};

/// Distance, m, of the neighbour at the start of each period.
const DISTANCE: f64 = 1e-9;
/// Distance, m, below which nothing but rounding is left of it.
const NOTHING: f64 = 1e-17;

/// The largest Lyapunov exponent, 1/s, along `periods` that go on from `flash`: the mean growth, by logarithm, of the distance to a
/// neighbour, which is scaled back along its direction after each 1 / f0 (Benettin's method). Above 0 the motion is chaotic, below 0
/// its neighbours approach it. Where the ball rests on a membrane at the start of a period its neighbour starts there, too. A ball
/// that has a compliant membrane pressed in then cannot start anew: the distance grows on until it is free. None if it never is, and
/// with viscous films, which would start each period relaxed.
///
/// # Errors
/// As [`Motion::take`](super::Motion::take).
pub fn exponent<'a>(setup: impl Into<Setup<'a>>, flash: Flash, periods: u32) -> Result<Option<f64>, DynamicsError> {
    let setup = setup.into();
    let Setup { parameters, recording, table } = setup;
    if parameters.is_viscous() {
        return Ok(None);
    }
    let frequency = parameters.frequency;
    // Velocities count by the distance that they cover in 1/(2 pi f0).
    let scale = 1.0 / (std::f64::consts::TAU * frequency);
    // During a recording the neighbour is scaled back as often as without.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates
    let intervals = (f64::from(periods) * excitation::period(&setup)? * frequency).round().max(1.0) as u64;
    let half = parameters.travel() / 2.0;
    let is_suspended = parameters.is_suspended();
    let mut apart = if is_suspended { [0.5 * DISTANCE; 4] } else { [DISTANCE * 0.6, DISTANCE * 0.8, 0.0, 0.0] };
    let start = |flash: Flash, time: f64| {
        // A neighbour beyond the membrane on which the ball rests.
        let parameters = Parameters { outside_gap: OutsideGap::Project, ..flash.start(*parameters) };
        Harvester::new(Setup { parameters: &parameters, recording, table }, time)
    };
    let neighbour_of = |flash: Flash, apart: [f64; 4]| Flash {
        displacement: flash.displacement + apart[0],
        velocity: flash.velocity + apart[1] / scale,
        cylinder: [flash.cylinder[0] + apart[2], flash.cylinder[1] + apart[3] / scale],
        ..flash
    };
    let mut pair = [start(flash, 0.0)?, start(neighbour_of(flash, apart), 0.0)?];
    let mut elapsed = 0.0;
    let mut sum = 0.0;
    let mut is_measured = false;
    for _ in 0..intervals {
        elapsed += 1.0 / frequency;
        for harvester in &mut pair {
            harvester.advance(elapsed)?;
        }
        let [flash, neighbour] = [Flash::of(&pair[0]), Flash::of(&pair[1])];
        if [flash, neighbour].iter().any(|flash| flash.displacement.abs() > half * (1.0 + 1e-9)) {
            continue;
        }
        let of_cylinder = [0, 1].map(|k| if is_suspended { neighbour.cylinder[k] - flash.cylinder[k] } else { 0.0 });
        let now = [
            neighbour.displacement - flash.displacement,
            (neighbour.velocity - flash.velocity) * scale,
            of_cylinder[0],
            of_cylinder[1] * scale,
        ];
        let distance = now[0].hypot(now[1]).hypot(now[2].hypot(now[3]));
        is_measured = true;
        sum += (distance.max(NOTHING) / DISTANCE).ln();
        // A neighbour at no distance starts again in the old direction.
        if distance > NOTHING {
            apart = now.map(|part| part * DISTANCE / distance);
        }
        // A harmonic excitation is at the start of a period what it is at 0.
        elapsed = if recording.is_some() { elapsed } else { 0.0 };
        pair = [start(flash, elapsed)?, start(neighbour_of(flash, apart), elapsed)?];
    }
    Ok(is_measured.then(|| sum * frequency / intervals as f64))
}
