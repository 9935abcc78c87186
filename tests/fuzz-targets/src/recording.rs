//! A recorded excitation: what is read can excite a harvester, and reads the same when it is written again.

use std::fmt::Write as _;

use videg_input::recording::{self, Samples};
use videg_model::{ExcitationKind, Harvester, Parameters, Recording};

use crate::Target;

pub(crate) const TARGET: Target = Target { name: "recording", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(samples) = recording::parse(bytes) else { return false };
    let Samples { is_acceleration, times, values } = &samples;
    let mut text = format!("time,{}\n", if *is_acceleration { "acceleration" } else { "force" });
    for (time, value) in times.iter().zip(values) {
        writeln!(text, "{time:?},{value:?}").unwrap();
    }
    assert_eq!(recording::parse(text.as_bytes()).unwrap(), samples);
    let kind = if *is_acceleration { ExcitationKind::Motion } else { ExcitationKind::Force };
    let Ok(recording) = Recording::new(kind, samples.times, samples.values) else { return false };
    let parameters = Parameters { excitation_kind: kind, ..Parameters::default() };
    // A strong force may have more impacts than can be resolved, which is an error.
    if let Ok(mut harvester) = Harvester::new(parameters.with_recording(Some(&recording)), 0.0) {
        let _ = harvester.advance(1e-3);
        assert!(harvester.cylinder_position().is_finite());
    }
    true
}

fn seeds() -> Vec<Vec<u8>> {
    [
        "time,force\n0,1\n0.5,-2e-3\n",
        "\u{feff}time,acceleration\r\n-1,0\r\n0, 9.81\r\n1e-3,-9.81\r\n",
        "# of a lorry\ntime , force\n\t0, 1\n# here it brakes\n+0.5,-0.002\n\n",
    ]
    .map(Vec::from)
    .to_vec()
}
