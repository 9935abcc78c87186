// The generator, drawn to scale and moved.
import { make } from "./svg.js";
import { color } from "./plot.js";
import { value } from "./state.js";

/** Half lengths of the cylinder that it moves within the picture. */
const FAR = 8;

export class Device {
  constructor(svg) {
    this.svg = svg;
    this.sizes = null;
  }

  /** Draws the parts for lengths in m: half of the travel, radii of ball and membrane, lengths of the cylinder; `reach` is how far it moves. */
  build({ travel, membraneRadius: radius, deepest, limit }, reach) {
    const ball = value("ball.radius");
    this.sizes = { half: travel / 2 + ball, ball, radius };
    const thick = Math.max(radius, ball) * 0.35;
    const frame = Math.max(0.15 * this.sizes.half, Math.min(value("frame.width"), this.sizes.half));
    // Behind a membrane there is room for its deflection.
    const room = Math.max(deepest * 1.3, ball * 0.8, frame * 0.5);
    const outer = this.sizes.half + room;
    const tall = Math.max(radius, ball) * 1.15 + thick;
    const beta = value("cylinder.inclination") ?? 0;
    // A cylinder that goes far is followed, lest it be too small to see.
    this.follows = reach[1] - reach[0] > FAR * outer;
    const [low, high] = this.follows ? [-0.3 * outer, 0.3 * outer] : reach;
    const [left, right] = [low - outer, high + outer];
    const length = right - left;
    const heightOf = (Math.abs(Math.sin(beta)) * length + 2 * tall * Math.cos(beta)) * 1.12 + tall * 0.9;
    const widthOf = Math.abs(Math.cos(beta)) * length + Math.abs(Math.sin(beta)) * 2 * tall;
    const middle = (left + right) / 2;
    // Letters keep their size on a small screen.
    const shrink = Math.min(3.5, 1000 / Math.max(200, this.svg.clientWidth));
    const unit = 1000 / Math.max(widthOf * 1.04, heightOf * 2.4);
    this.unit = unit;
    const view = { width: 1000, height: Math.max(heightOf * unit, 150) + 14 * shrink };
    this.svg.setAttribute("viewBox", `0 0 ${view.width} ${view.height}`);
    this.svg.replaceChildren();
    const px = (metres) => metres * unit;
    const whole = make("g", { transform: `translate(${view.width / 2} ${view.height * 0.46}) rotate(${(-beta * 180) / Math.PI}) translate(${-px(middle)} 0)` }, this.svg);
    // Where the room is: a ruler that does not move.
    const floor = px(tall) + 12;
    const ruler = make("g", { class: "ruler" }, whole);
    make("line", { x1: px(left), x2: px(right), y1: floor, y2: floor }, ruler);
    const step = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].find((it) => length / it < 13 / shrink) ?? length / 4;
    const first = Math.ceil(left / step);
    for (let k = first; k * step <= right && k < first + 20; k++) {
      make("line", { x1: px(k * step), x2: px(k * step), y1: floor - 4, y2: floor + 4 }, ruler);
      make("text", { x: px(k * step), y: floor + 8 + 12 * shrink, "font-size": 12 * shrink }, ruler, `${Number((k * step * 1000).toPrecision(3))}${k === 0 ? " mm" : ""}`);
    }
    if (value("cylinder.suspensionStiffness") > 0) this.spring = make("path", { class: "spring" }, whole);
    else this.spring = null;
    this.anchor = px(left) - 4;
    this.cylinder = make("g", {}, whole);
    const wall = (y) => make("rect", { class: "wall", x: px(-outer), y, width: px(2 * outer), height: px(thick) }, this.cylinder);
    wall(-px(tall));
    wall(px(tall) - px(thick));
    const holder = tall - thick - radius;
    for (const side of [-1, 1]) {
      const at = side * this.sizes.half;
      if (holder > 0) {
        for (const y of [-px(tall - thick), px(radius)]) make("rect", { class: "frame", x: px(at) - 3, y, width: 6, height: px(holder) }, this.cylinder);
      }
      if (limit < room) make("line", { class: "limit", x1: px(at + side * limit), x2: px(at + side * limit), y1: -px(radius * 0.5), y2: px(radius * 0.5) }, this.cylinder);
    }
    this.films = ["left", "right"].map((name) => make("path", { class: `film ${name}` }, this.cylinder));
    this.outer = outer;
    this.force = make("path", { class: "force" }, whole);
    this.ball = make("circle", { class: "ball", r: px(ball) }, whole);
  }

  /** The film at a deflection: straight from its frame to the ball, and around it. */
  film(deflection, side) {
    const { half, ball, radius } = this.sizes;
    const px = (metres) => (metres * this.unit).toFixed(2);
    const at = side * half;
    if (deflection <= 0) return `M${px(at)} ${px(-radius)}L${px(at)} ${px(radius)}`;
    // From the frame at (0, radius) a line touches the ball, whose centre is at (centre, 0).
    const centre = deflection - ball;
    const far = Math.hypot(centre, radius);
    const toward = far > ball ? Math.atan2(radius, -centre) - Math.acos(ball / far) : 0;
    const [x, y] = toward > 0 ? [centre + ball * Math.cos(toward), ball * Math.sin(toward)] : [deflection, 0];
    const around = y > 0 ? `A${px(ball)} ${px(ball)} 0 0 ${side > 0 ? 1 : 0} ${px(at + side * x)} ${px(y)}` : "";
    return `M${px(at)} ${px(-radius)}L${px(at + side * x)} ${px(-y)}${around}L${px(at)} ${px(radius)}`;
  }

  /** Moves the parts: positions of cylinder and ball, deflections, all in m, and the acceleration of the cylinder, from -1 to 1. */
  move({ cylinder: position, ball: place, left, right, push }) {
    if (!this.sizes) return;
    const [cylinder, ball] = this.follows ? [0, place - position] : [position, place];
    const px = (metres) => (metres * this.unit).toFixed(2);
    this.cylinder.setAttribute("transform", `translate(${px(cylinder)} 0)`);
    this.ball.setAttribute("cx", px(ball));
    this.films[0].setAttribute("d", this.film(left, -1));
    this.films[1].setAttribute("d", this.film(right, 1));
    const dir = push < 0 ? -1 : 1;
    const long = Math.abs(push) * 60;
    const tip = (cylinder + dir * this.outer) * this.unit;
    this.force.setAttribute("d", long < 2 ? "" : `M${tip.toFixed(1)} 0h${(dir * long).toFixed(1)}m${-dir * 8} -5l${dir * 8} 5l${-dir * 8} 5`);
    if (this.spring) {
      const end = (cylinder - this.outer) * this.unit;
      const turns = 9;
      let path = `M${this.anchor} 0`;
      for (let k = 1; k < turns; k++) path += `L${(this.anchor + ((end - this.anchor) * k) / turns).toFixed(1)} ${k % 2 ? -9 : 9}`;
      this.spring.setAttribute("d", `${path}L${end.toFixed(1)} 0`);
    }
  }

  /** The drawing as SVG with its colours, for a picture. */
  text(width) {
    const copy = this.svg.cloneNode(true);
    const styles = {
      wall: `fill:${color("wall")}`, frame: `fill:${color("frame")}`, "film left": `stroke:${color("left")};stroke-width:3;fill:none`,
      "film right": `stroke:${color("right")};stroke-width:3;fill:none`, ball: `fill:${color("ball")}`, force: `stroke:${color("force")};stroke-width:2;fill:none`,
      spring: `stroke:${color("faint")};stroke-width:1.5;fill:none`, limit: `stroke:${color("bad")};stroke-dasharray:3 3`,
    };
    for (const node of copy.querySelectorAll("[class]")) if (styles[node.getAttribute("class")]) node.setAttribute("style", styles[node.getAttribute("class")]);
    for (const node of copy.querySelectorAll(".ruler line")) node.setAttribute("style", `stroke:${color("faint")}`);
    for (const node of copy.querySelectorAll(".ruler text")) node.setAttribute("style", `font:11px sans-serif;text-anchor:middle;fill:${color("faint")}`);
    const [, , w, h] = copy.getAttribute("viewBox").split(" ").map(Number);
    const height = (width * h) / w;
    return { text: `<svg viewBox="0 0 ${w} ${h}" width="${width}" height="${height}">${copy.innerHTML}</svg>`, height };
  }
}
