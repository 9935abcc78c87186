//! Communication points of a run, and its averages over the window.

use serde::Serialize;

use crate::cosim::{Averages, Gains, Schedule};

/// Times of a run, which starts at 0 s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    /// End of the run, s.
    pub until: f64,
    /// Communication step, s; none: one step to each edge of the window, and one to the end.
    pub step: Option<f64>,
    /// Averaging window, s.
    pub window: [f64; 2],
}

/// A slave that is driven through a run.
pub(super) trait Driven {
    /// Its error.
    type Error;

    /// Steps from `time` by `step`, s.
    fn step(&mut self, time: f64, step: f64) -> Result<(), Self::Error>;

    /// The sums so far.
    fn gains(&self) -> Result<Gains, Self::Error>;
}

impl Times {
    /// Drives `slave` up to `end`, s; its averages over the window, if `end` lies behind that.
    pub(super) fn drive<D: Driven>(&self, slave: &mut D, end: f64) -> Result<Option<Averages>, D::Error> {
        let (mut now, mut gains) = (0.0, [None; 2]);
        loop {
            for (gain, edge) in gains.iter_mut().zip(self.window) {
                if gain.is_none() && now >= edge {
                    *gain = Some(slave.gains()?);
                }
            }
            if now >= end {
                break;
            }
            let next = self.next(now);
            slave.step(now, next - now)?;
            now = next;
        }
        let [before, after] = gains;
        Ok(before.zip(after).map(|(before, after)| Averages::over(self.window, &before, &after)))
    }

    /// The next communication point after `now`, s.
    fn next(&self, now: f64) -> f64 {
        match self.step {
            Some(step) => Schedule::new(step, self.until, self.window).next(now, f64::MAX),
            None => self.window.into_iter().filter(|edge| *edge > now).fold(self.until, f64::min),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gains one V, two J and three impacts a second.
    #[derive(Default)]
    struct Steady(Vec<f64>);

    impl Driven for Steady {
        type Error = ();

        fn step(&mut self, time: f64, step: f64) -> Result<(), ()> {
            self.0.push(time + step);
            Ok(())
        }

        #[allow(clippy::cast_possible_truncation)] // small
        fn gains(&self) -> Result<Gains, ()> {
            let time = self.0.last().copied().unwrap_or(0.0);
            Ok(Gains { voltage: time, energy: 2.0 * time, impacts: (3.0 * time) as i32 })
        }
    }

    #[test]
    fn a_run_lands_on_the_window_and_the_end() {
        for (step, window, end, expected) in [
            (None, [2.0, 4.0], 4.0, vec![2.0, 4.0]),
            (None, [2.0, 4.0], 5.0, vec![2.0, 4.0, 5.0]),
            (None, [0.0, 5.0], 5.0, vec![5.0]),
            (Some(1.5), [2.0, 4.0], 5.0, vec![1.5, 2.0, 3.0, 4.0, 4.5, 5.0]),
        ] {
            let mut slave = Steady::default();
            let averages = Times { until: 5.0, step, window }.drive(&mut slave, end).unwrap().unwrap();
            assert_eq!(slave.0, expected);
            let length = window[1] - window[0];
            assert_eq!((averages.voltage_gain, averages.power), (1.0, 2.0));
            assert_eq!(f64::from(averages.impacts), 3.0 * length);
        }
    }
}
