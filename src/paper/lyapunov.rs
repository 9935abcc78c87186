//! How fast nearby motions part: the largest Lyapunov exponent.

use super::stroboscope::{Flash, Orbit, Start, Stroboscope};
use super::{PaperError, Study, excitation::Cylinder};

/// Distance, m, of the neighbour at the start of each period.
const DISTANCE: f64 = 1e-9;
/// Distance, m, below which nothing but rounding is left of it.
const NOTHING: f64 = 1e-17;

/// The largest Lyapunov exponent, 1/s, along `periods` that go on from the end of `orbit`: the mean growth, by
/// logarithm, of the distance to a neighbour, which is scaled back along its direction after each period (Benettin's
/// method). Above 0 the motion is chaotic, below 0 its neighbours approach it. Where `orbit` rests on a membrane at the
/// start of a period its neighbour starts there, too.
pub fn exponent(
    study: &Study<'_>,
    cylinder: &Cylinder,
    start: Start,
    orbit: &Orbit,
    periods: u32,
) -> Result<f64, PaperError> {
    // Velocities count by the distance that they cover in 1/(2 pi f0).
    let scale = 1.0 / (std::f64::consts::TAU * start.frequency);
    let after = |flash: Flash| -> Result<Flash, PaperError> {
        let mut eye = Stroboscope::new(study, &start.from(flash).settings(cylinder), start.frequency)?;
        eye.pass(1)?;
        eye.flash()
    };
    let mut flash = orbit.last();
    let mut apart = [DISTANCE * 0.6, DISTANCE * 0.8];
    let mut sum = 0.0;
    for _ in 0..periods {
        let displacement = flash.displacement + apart[0];
        let neighbour = after(Flash { displacement, velocity: flash.velocity + apart[1] / scale, ..flash })?;
        flash = after(flash)?;
        let now = [neighbour.displacement - flash.displacement, (neighbour.velocity - flash.velocity) * scale];
        let distance = now[0].hypot(now[1]);
        sum += (distance.max(NOTHING) / DISTANCE).ln();
        // A neighbour at no distance starts again in the old direction.
        if distance > NOTHING {
            apart = now.map(|part| part * DISTANCE / distance);
        }
    }
    Ok(sum * start.frequency / f64::from(periods))
}
