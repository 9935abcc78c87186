//! The harvester of Fig. 5, to scale: a cylinder that a force shakes, a frame with a membrane at each end, a ball inside.

use super::canvas::{BLACK, BLUE, Canvas, DARK_STEEL, GREY, ORANGE, RED, STEEL, THICK, THIN};

/// Lengths, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dimensions {
    /// d: length of the cylinder.
    pub cylinder: f64,
    /// w: width of a frame.
    pub frame: f64,
    /// `R_2`: inner radius, that of the membranes.
    pub membrane: f64,
    /// `r_b`: radius of the ball.
    pub ball: f64,
}

/// Centre of the ball, px.
const CENTRE: (f32, f32) = (300.0, 205.0);
/// What the device may fill at most, px: half its length, and half the height inside the cylinder.
const HALF: (f32, f32) = (240.0, 60.0);
/// Thickness of the walls and how far the frames stand out, px. The paper gives neither.
const WALL: f32 = 16.0;
const RIM: f32 = 14.0;
/// Height of letters, px.
const LETTER: f32 = 22.0;

/// The same lengths in px, as distances from the centre.
struct Plan {
    cylinder: f32,
    membrane: f32,
    end: f32,
    radius: f32,
    ball: f32,
}

impl Plan {
    fn new(dimensions: Dimensions) -> Self {
        let Dimensions { cylinder, frame, membrane, ball } = dimensions;
        // Each membrane is held between two frames: the ball reaches it through the inner one.
        let end = cylinder / 2.0 + 2.0 * frame;
        let scale = (f64::from(HALF.0) / end).min(f64::from(HALF.1) / membrane);
        #[allow(clippy::cast_possible_truncation)] // pixels of a picture
        let px = |length: f64| (scale * length) as f32;
        Self {
            cylinder: px(cylinder / 2.0),
            membrane: px(cylinder / 2.0 + frame),
            end: px(end),
            radius: px(membrane),
            ball: px(ball),
        }
    }
}

/// Draws it.
pub(super) fn draw(canvas: &mut Canvas, dimensions: Dimensions) {
    let plan = Plan::new(dimensions);
    body(canvas, &plan);
    membranes(canvas, &plan);
    canvas.circle(CENTRE, plan.ball, ORANGE);
    canvas.label(CENTRE, LETTER, "m", BLACK);
    force_and_motion(canvas, &plan);
    measures(canvas, &plan);
}

/// Walls and frames, cut open.
fn body(canvas: &mut Canvas, plan: &Plan) {
    for side in [-1.0, 1.0] {
        let (inner, outer) = (CENTRE.1 + side * plan.radius, CENTRE.1 + side * (plan.radius + WALL));
        let rim = CENTRE.1 + side * (plan.radius + WALL + RIM);
        let wall = (inner.min(outer), inner.max(outer));
        canvas.rectangle((CENTRE.0 - plan.cylinder, wall.0), (CENTRE.0 + plan.cylinder, wall.1), STEEL);
        let frame = (inner.min(rim), inner.max(rim));
        for (left, right) in [
            (-plan.end, -plan.membrane),
            (-plan.membrane, -plan.cylinder),
            (plan.cylinder, plan.membrane),
            (plan.membrane, plan.end),
        ] {
            canvas.rectangle((CENTRE.0 + left, frame.0), (CENTRE.0 + right, frame.1), DARK_STEEL);
        }
    }
}

/// The membranes, with a wire each to its capacitance.
fn membranes(canvas: &mut Canvas, plan: &Plan) {
    let rim = plan.radius + WALL + RIM;
    for side in [-1.0, 1.0] {
        let x = CENTRE.0 + side * plan.membrane;
        let wire = CENTRE.1 - rim - 34.0;
        canvas.line(&[(x, CENTRE.1 + rim - 4.0), (x, CENTRE.1 - rim + 4.0)], 2.0 * THICK, BLUE);
        canvas.line(&[(x, CENTRE.1 - rim), (x, wire)], THICK, BLUE);
        canvas.label((x, wire - 26.0), LETTER, if side < 0.0 { "C_l(t)" } else { "C_r(t)" }, BLUE);
    }
}

/// What shakes it, and the coordinates of the two bodies.
fn force_and_motion(canvas: &mut Canvas, plan: &Plan) {
    let above = CENTRE.1 - plan.radius - WALL;
    let from = (CENTRE.0 - 48.0, above - 34.0);
    canvas.arrow(from, (CENTRE.0 + 48.0, from.1), 2.0 * THICK, RED);
    canvas.label((CENTRE.0, from.1 - 34.0), LETTER, "F(t)", RED);
    let start = CENTRE.0 + plan.ball;
    canvas.arrow((start + 8.0, CENTRE.1), (start + 70.0, CENTRE.1), THICK, BLACK);
    canvas.label((start + 40.0, CENTRE.1 - 24.0), LETTER, "z_m", BLACK);
}

/// Dimension lines for d and w below.
fn measures(canvas: &mut Canvas, plan: &Plan) {
    let rim = CENTRE.1 + plan.radius + WALL + RIM;
    let line = rim + 34.0;
    for x in [-plan.cylinder, plan.cylinder, plan.membrane] {
        canvas.line(&[(CENTRE.0 + x, rim + 8.0), (CENTRE.0 + x, line + 10.0)], THIN, GREY);
    }
    canvas.arrow((CENTRE.0, line), (CENTRE.0 - plan.cylinder, line), THIN, GREY);
    canvas.arrow((CENTRE.0, line), (CENTRE.0 + plan.cylinder, line), THIN, GREY);
    canvas.label((CENTRE.0, line + 24.0), LETTER, "d", GREY);
    canvas.arrow((CENTRE.0 + plan.membrane + 30.0, line), (CENTRE.0 + plan.membrane, line), THIN, GREY);
    let middle = f32::midpoint(plan.cylinder, plan.membrane);
    canvas.label((CENTRE.0 + middle, line + 24.0), LETTER, "w", GREY);
}
