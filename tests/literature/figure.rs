//! The bifurcation diagram of the page.

use std::path::Path;

use videg_model::{ContactLaw, Parameters, Side};
use videg_report::{Figure, Panel, Series, Style, render_svg};

use crate::capsule::Capsule;
use crate::diagram::Diagram;
use crate::{GOLDEN, case, of_length};

const RANGE: [f64; 2] = [0.36, 0.1];
/// Steps of the diagram.
const COUNT: u32 = 130;

/// Speeds at the bottom of the 1:1 orbits of the closed form over d: stable, and unstable.
fn orbits(p: &Parameters) -> [Vec<(f64, f64)>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for k in 0..=COUNT {
        let d = RANGE[1] + (RANGE[0] - RANGE[1]) * f64::from(k) / f64::from(COUNT);
        let orbits = Capsule::new(&of_length(*p, d)).orbits();
        if let Some(orbit) = orbits.iter().max_by(|a, b| a.speeds[0].total_cmp(&b.speeds[0])) {
            found[usize::from(!orbit.is_stable())].push((d, orbit.speeds[0]));
        }
    }
    found
}

/// The words of a picture. Where dots and numbers of its axes are depends on the last bits of irregular motions.
fn lasting(svg: &str) -> Vec<&str> {
    let is_word = |line: &&str| line.starts_with("<title") || !line.starts_with('<') && line.parse::<f64>().is_err();
    svg.lines().filter(is_word).collect()
}

#[test]
fn the_figure_of_the_page_is_the_diagram() {
    let hard = case("capsule-1-1");
    let soft = Parameters { contact_law: ContactLaw::Compliant, ..hard };
    let [of_hard, of_soft] = [hard, soft].map(|p| Diagram::new(&p, RANGE, COUNT));
    let ([stable, unstable], speeds) = (orbits(&hard), [&of_hard, &of_soft].map(|it| it.speeds(Side::Left)));
    let powers = [&of_hard, &of_soft].map(Diagram::powers);
    for diagram in [&of_hard, &of_soft] {
        let first = diagram.points.iter().position(|(_, motion)| motion.sequence() == "2:1").unwrap();
        let [irregular, regular] = [first - 1, first].map(|k| diagram.points[k].1.power);
        assert!(regular > 1.05 * irregular, "W over time rises where the motion becomes 2:1: {irregular} to {regular}");
    }
    let panel = |title: &str, label: &str, height: f64| {
        Panel::new(title, "d (1)", label).x_range(RANGE[1], RANGE[0]).height(height)
    };
    let dots = |label: &str, points, color| Series::points(label, points).style(Style::Dots).color(color);
    let speed = "impact speed at the bottom (m/s)";
    let figure = Figure::new("The inclined capsule, followed to shorter lengths")
        .caption("Relative impact speeds at the bottom, hard and soft, and energy of Eq. (13), over d.")
        .panel(
            panel("(a) hard", speed, 240.0)
                .share_x_with_next()
                .series(dots("simulated", &speeds[0], 0))
                .series(Series::points("1:1 orbit, stable", &stable).color(1))
                .series(Series::points("1:1 orbit, unstable", &unstable).style(Style::Dashed).color(1)),
        )
        .panel(panel("(b) soft", speed, 240.0).share_x_with_next().series(dots("simulated", &speeds[1], 2)))
        .panel(
            panel("(c)", "W over time (mW)", 160.0)
                .series(Series::points("hard", &powers[0]).color(0))
                .series(Series::points("soft", &powers[1]).color(2)),
        );
    let svg = render_svg(&figure).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/capsule.svg");
    if GOLDEN.updating() {
        GOLDEN.file(path, &svg);
    } else {
        let written = std::fs::read_to_string(path).unwrap();
        assert_eq!(lasting(&written), lasting(&svg), "run `UPDATE_BOOK=1 cargo test --test literature`");
    }
}
