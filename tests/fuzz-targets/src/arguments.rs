//! What stands behind `--set`, `--vary` and `--shard`, a line each: read, applied, and put together to a sweep.

use videg::scenario::Setting;
use videg::sweep::{Design, Sampling, Shard, SweepFile, Vary};

use crate::{Target, sweeps};

pub(crate) const TARGET: Target = Target { name: "arguments", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let (mut settings, mut vary) = (Vec::new(), Vec::new());
    for line in text.lines() {
        if let Some(option) = line.strip_prefix("--vary ") {
            vary.extend(Vary::parse(option));
        } else if let Some(option) = line.strip_prefix("--shard ") {
            shard(option);
        } else if let Ok(setting) = Setting::parse(line.strip_prefix("--set ").unwrap_or(line)) {
            sweeps::apply(&setting);
            settings.push(setting);
        }
    }
    let designs = [Design::Grid, Design::Lhs, Design::Random].map(|design| {
        let points = (design != Design::Grid).then_some(5);
        let sampling = Sampling { design: Some(design), points, ..Sampling::default() };
        let file = SweepFile { sampling, vary: vary.clone(), ..SweepFile::default() };
        sweeps::resolve(file, settings.clone()).is_ok_and(|sweep| {
            sweeps::check(&sweep);
            true
        })
    });
    designs.contains(&true)
}

/// A shard that is read has a name of its own, which reads as the same shard, and a share of the runs.
fn shard(text: &str) {
    let Ok(shard) = Shard::parse(text) else { return };
    assert_eq!(Shard::of_file_name(&shard.file_name()), Some(shard));
    for runs in [0, 1, 1000, u64::MAX] {
        let range = shard.range(runs);
        assert!(range.start <= range.end && range.end <= runs, "{shard} of {runs}: {range:?}");
    }
}

fn seeds() -> Vec<Vec<u8>> {
    [
        "--set membrane.restitution=0.7\n--set load.resistance=inf\n--set topology=isolated\n",
        "--set contact.law=compliant\n--vary membrane.stiffness=log:1e4:1e6:5\n--shard 2/8\n",
        "--vary excitation.seed=1:9:3\n--vary initial.outsideGap=project,free\n--vary contact.reaction=true\n",
        "--vary membrane.restitution=0.2:0.9\n--vary excitation.amplitude = 0.3 : 0.5\n--set excitation.phaseNoise=0.5\n",
    ]
    .map(Vec::from)
    .to_vec()
}
