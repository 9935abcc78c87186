//! A sweep file: what it resolves to has runs, each with values that its variables can have.

use videg::sweep::SweepFile;

use crate::{Target, sweeps};

pub(crate) const TARGET: Target = Target { name: "sweep_file", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(file) = SweepFile::parse(text) else { return false };
    let Ok(sweep) = sweeps::resolve(file, Vec::new()) else { return false };
    sweeps::check(&sweep);
    true
}

fn seeds() -> Vec<Vec<u8>> {
    [
        "case = 'fig14'\nuntil = 60.0\ndesign = 'lhs'\npoints = 1000\nsamples = 20\nseed = 7\ncommon_seeds = true\n\
         seed_variable = 'excitation.seed'\nrecord = ['cylinder.position']\n[set]\nexcitation.phaseNoise = 0.5\n\
         [vary]\nmembrane.restitution = { from = 0.2, to = 0.9 }\n",
        "[vary]\nmembrane.stiffness = { from = 1e4, to = 1e6, count = 7, scale = 'log' }\n\
         initial.outsideGap = ['project', 'free']\nexcitation.seed = { from = 9, to = -9, count = 4 }\n",
        "design = 'random'\npoints = 1000000000000\n[vary]\nexcitation.seed = { from = -2147483648, to = 2147483647 }\n\
         contact.reaction = [true, 0]\n",
    ]
    .map(Vec::from)
    .to_vec()
}
