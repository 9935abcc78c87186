//! A case file: what it resolves to is a run with an end, a step and a window inside it.

use videg::scenario::{CaseFile, Request};

use crate::{Target, sweeps};

pub(crate) const TARGET: Target = Target { name: "case_file", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(file) = CaseFile::parse(text) else { return false };
    let Ok(scenario) = (Request { file: Some(file), ..Request::default() }).resolve() else { return false };
    let [from, to] = scenario.window;
    assert!(0.0 <= from && from < to && to <= scenario.until && scenario.step > 0.0, "{scenario:?}");
    scenario.settings.iter().for_each(sweeps::apply);
    true
}

fn seeds() -> Vec<Vec<u8>> {
    [
        "",
        "case = 'fig15'\nname = 'softer'\ndescription = 'softer membrane'\nuntil = 60\nstep = 1e-3\nwindow = [30.0, 60.0]\n",
        "[set]\nmembrane.restitution = 0.25\n'excitation.seed' = 7\ncontact.law = 'compliant'\nload.resistance = inf\n",
        "until = 1e-4\n[set.contact]\nelectrostaticFeedback = true\n[set.ball]\nmass = \"0.1\"\n",
    ]
    .map(Vec::from)
    .to_vec()
}
