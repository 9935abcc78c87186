//! Amplitude spectrum of evenly spaced samples.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

/// The one-sided amplitude spectrum of samples `spacing`, s, apart: frequency, Hz, and amplitude in the unit of the samples.
///
/// The mean is taken off, a Hann window is laid over the rest, and the amplitudes are divided by that of the window: the line of a
/// harmonic has its amplitude if its period divides the time of the samples, and at least 0.85 of it otherwise.
pub fn amplitudes(samples: &[f64], spacing: f64) -> Vec<(f64, f64)> {
    let count = samples.len();
    if count < 2 {
        return Vec::new();
    }
    let mean = samples.iter().sum::<f64>() / count as f64;
    let window = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / count as f64).cos();
    let mut weighted: Vec<_> = samples.iter().enumerate().map(|(k, sample)| window(k) * (sample - mean)).collect();
    let transform = RealFftPlanner::new().plan_fft_forward(count);
    let mut lines = transform.make_output_vec();
    if transform.process(&mut weighted, &mut lines).is_err() {
        return Vec::new(); // it fails for lists of other lengths alone
    }
    // Each line stands for two, those of the positive and of the negative frequency, and the window has the mean 1/2.
    let (step, scale) = (1.0 / (count as f64 * spacing), 4.0 / count as f64);
    lines.iter().enumerate().map(|(k, line)| (k as f64 * step, scale * line.norm())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(30))]
        #[test]
        fn harmonics_that_fit_have_lines_of_their_amplitudes(
            count in 64_usize..400, spacing in 1e-4_f64..1.0, amplitude in 0.1_f64..10.0, phase in 0.0_f64..6.0,
            mean in -5.0_f64..5.0, share in 0.1_f64..0.9,
        ) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let line = ((count / 2) as f64 * share) as usize;
            let turn = TAU * line as f64 / count as f64;
            let samples: Vec<_> = (0..count).map(|k| mean + amplitude * (turn * k as f64 + phase).cos()).collect();
            let found = amplitudes(&samples, spacing);
            prop_assert_eq!(found.len(), count / 2 + 1);
            prop_assert!((found[line].0 - line as f64 / (count as f64 * spacing)).abs() < 1e-9 * found[line].0);
            prop_assert!((found[line].1 - amplitude).abs() < 1e-9 * (amplitude + mean.abs()), "{:?}", found[line]);
            // The window spreads a harmonic over its two neighbours and no farther.
            for (k, (_, other)) in found.iter().enumerate().filter(|(k, _)| k.abs_diff(line) > 1) {
                prop_assert!(*other < 1e-9 * (amplitude + mean.abs()), "line {k}: {other}");
            }
        }

        #[test]
        fn lines_are_those_of_the_sum_that_defines_them(
            samples in proptest::collection::vec(-3.0_f64..3.0, 2..80), share in 0.0_f64..1.0,
        ) {
            let (count, found) = (samples.len(), amplitudes(&samples, 0.25));
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let line = (share * (count / 2) as f64) as usize;
            let mean = samples.iter().sum::<f64>() / count as f64;
            let angle = |k: usize| TAU * k as f64 / count as f64;
            let weighted = |k: usize| (1.0 - angle(k).cos()) / 2.0 * (samples[k] - mean);
            let [real, imaginary] = [f64::cos, f64::sin]
                .map(|part| (0..count).map(|k| weighted(k) * part(angle(k * line % count))).sum::<f64>());
            let expected = 4.0 / count as f64 * real.hypot(imaginary);
            prop_assert!((found[line].1 - expected).abs() < 1e-9, "{} for {expected}", found[line].1);
        }
    }
}
