//! The circuit of Fig. 8(a): supply, diode, both membranes in parallel, Zener diode, load.

use super::canvas::{BLACK, BLUE, Canvas, Ink, ORANGE, Point, RED, STEEL, THICK};

const WHITE: Ink = Ink(255, 255, 255);
/// Heights of the two rails, px from the top.
const RAILS: (f32, f32) = (130.0, 310.0);
/// Height halfway between them.
const MIDDLE: f32 = 220.0;
/// Places from left to right, px.
const SUPPLY: f32 = 75.0;
const DIODE: f32 = 165.0;
const MEMBRANES: [f32; 2] = [255.0, 345.0];
const ZENER: f32 = 437.0;
const LOAD: f32 = 525.0;
/// Half the height of a diode's bar, px.
const BAR: f32 = 22.0;
/// Height of letters, px.
const LETTER: f32 = 22.0;

/// Draws it.
pub(super) fn draw(canvas: &mut Canvas) {
    canvas.line(
        &[(SUPPLY, RAILS.0), (LOAD, RAILS.0), (LOAD, RAILS.1), (SUPPLY, RAILS.1), (SUPPLY, RAILS.0)],
        THICK,
        BLACK,
    );
    supply(canvas);
    diode(canvas);
    membrane(canvas, MEMBRANES[0], "C_l(t)");
    membrane(canvas, MEMBRANES[1], "C_r(t)");
    zener(canvas);
    load(canvas);
}

fn supply(canvas: &mut Canvas) {
    canvas.circle((SUPPLY, MIDDLE), 32.0, STEEL);
    canvas.label((SUPPLY, MIDDLE - 13.0), 16.0, "+", BLACK);
    canvas.label((SUPPLY, MIDDLE + 13.0), 16.0, "-", BLACK);
    canvas.label((SUPPLY, RAILS.0 - 34.0), LETTER, "U_in", BLACK);
}

/// A triangle from `base` to its tip at `tip`, on the upper rail.
fn triangle(canvas: &mut Canvas, base: f32, tip: f32, ink: Ink) {
    let corners = [(base, RAILS.0 - BAR), (base, RAILS.0 + BAR), (tip, RAILS.0)];
    canvas.polygon(&corners, ink);
    canvas.line(&[corners[0], corners[1], corners[2], corners[0]], THICK, BLACK);
}

/// Lets current from the supply to the membranes only.
fn diode(canvas: &mut Canvas) {
    triangle(canvas, DIODE - 19.0, DIODE + 19.0, STEEL);
    canvas.line(&[(DIODE + 19.0, RAILS.0 - BAR), (DIODE + 19.0, RAILS.0 + BAR)], 5.0, BLACK);
}

/// A capacitor that varies: two plates and an arrow across.
fn membrane(canvas: &mut Canvas, x: f32, label: &str) {
    let (half, gap) = (26.0, 7.0);
    canvas.line(&[(x, RAILS.0), (x, MIDDLE - gap)], THICK, BLACK);
    canvas.line(&[(x, MIDDLE + gap), (x, RAILS.1)], THICK, BLACK);
    for y in [MIDDLE - gap, MIDDLE + gap] {
        canvas.line(&[(x - half, y), (x + half, y)], 6.0, BLUE);
    }
    canvas.arrow((x - 26.0, MIDDLE + 30.0), (x + 30.0, MIDDLE - 34.0), THICK, BLUE);
    dot(canvas, (x, RAILS.0));
    dot(canvas, (x, RAILS.1));
    canvas.label((x, RAILS.1 + 34.0), LETTER, label, BLUE);
}

fn dot(canvas: &mut Canvas, centre: Point) {
    canvas.circle(centre, 3.0, BLACK);
}

/// Breaks down from the membranes to the load: its cathode is on the left.
fn zener(canvas: &mut Canvas) {
    triangle(canvas, ZENER + 19.0, ZENER - 19.0, ORANGE);
    let x = ZENER - 19.0;
    let bar = [(x - 9.0, RAILS.0 - BAR - 7.0), (x, RAILS.0 - BAR), (x, RAILS.0 + BAR), (x + 9.0, RAILS.0 + BAR + 7.0)];
    canvas.line(&bar, 5.0, BLACK);
    canvas.label((ZENER, RAILS.0 - 48.0), LETTER, "U_z", BLACK);
}

fn load(canvas: &mut Canvas) {
    canvas.rectangle((LOAD - 16.0, MIDDLE - 42.0), (LOAD + 16.0, MIDDLE + 42.0), WHITE);
    canvas.label((LOAD, MIDDLE), LETTER, "R", BLACK);
    canvas.arrow((LOAD + 34.0, MIDDLE - 42.0), (LOAD + 34.0, MIDDLE + 42.0), THICK, RED);
    canvas.label((LOAD + 8.0, RAILS.1 + 34.0), LETTER, "U_out", RED);
}
