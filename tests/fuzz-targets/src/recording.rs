//! A recorded excitation: what is read can excite a harvester, and reads the same when it is written again.

use std::fmt::Write as _;

use videg_data::recording;
use videg_model::{ExcitationKind, Harvester, Parameters};

use crate::Target;

pub(crate) const TARGET: Target = Target { name: "recording", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(recording) = recording::parse(bytes) else { return false };
    let kind = recording.kind();
    let mut text = format!("time,{}\n", if kind == ExcitationKind::Motion { "acceleration" } else { "force" });
    for (time, value) in recording.times().iter().zip(recording.values()) {
        writeln!(text, "{time:?},{value:?}").unwrap();
    }
    assert_eq!(recording::parse(text.as_bytes()).unwrap(), recording);
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
