//! The tables and the figure of `docs/results/literature.md` are what the model and the closed form give.
//! `UPDATE_BOOK=1 cargo test --test literature` writes them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a panic is how a test fails")]

#[path = "../../model/tests/common/capsule.rs"]
mod capsule;
mod diagram;
mod figure;
#[path = "../../model/tests/common/steady.rs"]
mod steady;
mod tables;

use std::f64::consts::{FRAC_PI_3, FRAC_PI_4, FRAC_PI_6, PI, TAU};
use std::path::Path;

use videg_golden::{Golden, agree};
use videg_model::{Case, Parameters};

const GOLDEN: Golden = Golden::new("UPDATE_BOOK", "cargo test --test literature");

/// Largest relative difference between a number on the page and one computed now, as in `tests/readme.rs`.
const TOLERANCE: f64 = 1e-3;

/// The same of lengths at which an irregular motion ends, which takes a last bit elsewhere.
const OF_IRREGULAR: f64 = 0.02;

/// Inclinations of the tables, as they are printed.
const INCLINATIONS: [(&str, f64); 5] =
    [("0.1", 0.1), ("0.3", 0.3), ("π/6", FRAC_PI_6), ("π/4", FRAC_PI_4), ("π/3", FRAC_PI_3)];

fn case(name: &str) -> Parameters {
    (Case::find(name).unwrap().parameters)()
}

/// The capsule of another length d of the literature, the ball on the lower membrane.
fn of_length(p: Parameters, d: f64) -> Parameters {
    let travel = d / length(1.0, &p);
    let cylinder_length = travel - 2.0 * p.frame_width + 2.0 * p.ball_radius;
    Parameters { cylinder_length, ball_position: -travel / 2.0, ..p }
}

/// d = s M w^2 / (A pi^2) of a travel s, m.
fn length(travel: f64, p: &Parameters) -> f64 {
    let omega = TAU * p.frequency;
    travel * p.cylinder_mass * omega * omega / (p.amplitude * PI * PI)
}

fn check(name: &str, table: &str, tolerance: f64) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results/literature.md");
    GOLDEN.section_as(page, name, table, |written, now| agree(written, now, tolerance));
}
