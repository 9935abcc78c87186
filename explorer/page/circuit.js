// The circuit: branches that conduct are lit, and dashes move as far as charge has moved.
import { make } from "./svg.js";
import { value } from "./state.js";

/** Least share of the largest current of the picture at which a branch counts as conducting. */
const LIT = 1e-3;
/** Part of a voltage within which diodes conduct: ideal ones at it, others near it. */
const NEAR = 5e-3;

export class Circuit {
  constructor(svg) {
    this.svg = svg;
  }

  build() {
    const { svg } = this;
    const isShared = value("topology") === "sharedNode";
    const release = value("release");
    const rows = isShared ? [70] : [50, 150];
    svg.setAttribute("viewBox", `0 0 460 ${isShared ? 206 : 250}`);
    svg.replaceChildren();
    const ground = (x, y) => make("path", { class: "wire", d: `M${x} ${y}v8m-9 0h18m-15 4h12m-9 4h6` }, svg);
    const middle = (rows[0] + rows.at(-1)) / 2;
    // Supply.
    make("path", { class: "wire", d: `M40 ${middle + 62}V${middle + 28}M40 ${middle - 4}V${rows[0]}H88${isShared ? "" : `M64 ${rows[0]}V${rows[1]}H88`}` }, svg);
    make("path", { class: "part", d: `M26 ${middle + 6}h28M32 ${middle + 14}h16M26 ${middle + 22}h28` }, svg);
    make("path", { class: "wire", d: `M40 ${middle - 4}v10m0 16v8` }, svg);
    ground(40, middle + 62);
    make("text", { x: 8, y: middle - 8 }, svg, "U_in");
    this.branches = rows.map((y, row) => {
      const charging = make("g", { class: "branch" }, svg);
      make("path", { class: "wire", d: `M88 ${y}H190` }, charging);
      const inflow = make("path", { class: "flow", d: `M64 ${y}H190` }, charging);
      make("path", { class: "part fill", d: `M112 ${y - 9}l18 9l-18 9Z` }, charging);
      make("path", { class: "part", d: `M130 ${y - 9}v18` }, charging);
      const leaving = make("g", { class: "branch" }, svg);
      const end = isShared ? 300 : 250;
      make("path", { class: "wire", d: `M${end} ${y}H400` }, leaving);
      const outflow = make("path", { class: "flow", d: `M${end} ${y}H400` }, leaving);
      this.element(release, leaving, y);
      make("path", { class: "wire", d: `M190 ${y}H${end}` }, svg);
      return { charging, inflow, leaving, outflow, row };
    });
    const places = isShared ? [[190, rows[0]], [278, rows[0]]] : [[220, rows[0]], [220, rows[1]]];
    this.plates = places.map(([x, y], side) => {
      make("path", { class: "wire", d: `M${x} ${y}v18m0 32v14` }, svg);
      ground(x, y + 64);
      const plates = make("path", { class: `plates ${side ? "right" : "left"}` }, svg);
      // Side by side they are named below, one above the other beside them.
      const [tx, ty, place] = isShared ? [x, y + 96, "middle"] : [x + 30, y + 32, "start"];
      const name = `${place} ${side ? "right" : "left"}`;
      make("text", { x: tx, y: ty, class: name }, svg, side ? "C right" : "C left");
      const text = make("text", { x: tx, y: ty + 15, class: `small ${place}` }, svg);
      const volts = make("text", { x: tx, y: ty + 29, class: `small ${place}` }, svg);
      return { x, y: y + 34, plates, text, volts };
    });
    // Load or storage.
    const out = make("g", { class: "branch" }, svg);
    const low = middle + 66;
    if (!isShared) make("path", { class: "wire", d: `M400 ${rows[0]}V${rows[1]}` }, svg);
    make("path", { class: "wire", d: `M400 ${middle}H420V${middle + 12}M420 ${middle + 48}V${low}` }, out);
    if (release === "storage") make("path", { class: "part", d: `M406 ${middle + 22}h28M412 ${middle + 30}h16M406 ${middle + 38}h28M420 ${middle + 12}v10M420 ${middle + 38}v10` }, out);
    else make("rect", { class: "part", x: 412, y: middle + 12, width: 16, height: 36 }, out);
    this.loadFlow = make("path", { class: "flow", d: `M420 ${middle}V${low}` }, out);
    this.loadBranch = out;
    ground(420, low);
    make("text", { x: 404, y: middle + 34, class: "end" }, svg, release === "storage" ? "U_out" : "R");
  }

  element(release, parent, y) {
    const x = 340;
    if (release === "switch") {
      make("path", { class: "gap", d: `M${x - 14} ${y}h28` }, parent);
      make("path", { class: "part lever", d: `M${x - 14} ${y}l26 -12` }, parent);
      make("path", { class: "part lever closed", d: `M${x - 14} ${y}h28` }, parent);
    } else if (release === "zener") {
      // Against the current: a Zener diode releases in its reverse direction.
      make("path", { class: "part fill", d: `M${x + 9} ${y - 9}l-18 9l18 9Z` }, parent);
      make("path", { class: "part", d: `M${x - 14} ${y - 12}l5 3v18l5 3` }, parent);
    } else {
      make("path", { class: "part fill", d: `M${x - 9} ${y - 9}l18 9l-18 9Z` }, parent);
      make("path", { class: "part", d: `M${x + 9} ${y - 9}v18` }, parent);
    }
    const text = { zener: "U_z", switch: "U_z", storage: "" }[release];
    make("text", { x, y: y - 18, class: "middle" }, parent, text);
  }

  /** What happens between two rows of the motion: charges that came from the supply at its voltage, and left at that of the release. */
  prepare(rows, width, column, rest, [supplied, released]) {
    this.rest = rest;
    this.width = width;
    const count = rows.length / width;
    const isShared = value("topology") === "sharedNode";
    const sides = isShared ? 1 : 2;
    const moved = Array.from({ length: sides }, () => ({ came: new Float64Array(count), left: new Float64Array(count) }));
    const names = ["left", "right"].map((name) => [column(`${name}.capacitance`), column(`${name}.voltage`)]);
    const charge = (at, side) => rows[at + names[side][0]] * rows[at + names[side][1]];
    const voltage = (at, side) => rows[at + names[side][1]];
    const [supply, load] = [column("supply.charge"), column("load.charge")];
    for (let k = 1; k < count; k++) {
      const [before, at] = [(k - 1) * width, k * width];
      moved.forEach(({ came, left }, side) => {
        if (isShared) {
          came[k] = rows[at + supply] - rows[supply];
          left[k] = rows[at + load] - rows[load];
          return;
        }
        // Charge that comes or leaves elsewhere leaks through the film.
        const change = charge(at, side) - charge(before, side);
        const [low, high] = [Math.min(voltage(before, side), voltage(at, side)), Math.max(voltage(before, side), voltage(at, side))];
        came[k] = came[k - 1] + (low <= supplied * (1 + NEAR) ? Math.max(0, change) : 0);
        left[k] = left[k - 1] + (high >= released * (1 - NEAR) ? Math.max(0, -change) : 0);
      });
    }
    this.moved = moved;
    const most = (values, unit) => { let top = 0; for (let k = 1; k < count; k++) top = Math.max(top, (values[k] - values[k - 1]) / unit(k)); return top; };
    const time = (k) => Math.max(1e-12, rows[k * width] - rows[(k - 1) * width]);
    this.fastest = moved.map(({ came, left }) => ({ came: most(came, time), left: most(left, time) }));
    this.total = Math.max(...moved.map(({ came, left }) => Math.max(came.at(-1) ?? 0, left.at(-1) ?? 0)), 1e-30);
  }

  /** Shows the circuit at row `k` and a `part` of the way to the `next` one, where columns have the values that `at` tells. */
  move(rows, { k, next, part }, at) {
    if (!this.moved) return;
    const { width } = this;
    const between = (values) => values[k] + part * (values[next] - values[k]);
    const seconds = Math.max(1e-12, rows[next * width] - rows[k * width]);
    // Dashes of a picture move a few hundred pixels in all.
    const pixels = 900 / this.total;
    let out = 0;
    this.branches.forEach(({ charging, inflow, leaving, outflow, row }) => {
      const { came, left } = this.moved[row];
      const { came: fast, left: loss } = this.fastest[row];
      charging.classList.toggle("on", (came[next] - came[k]) / seconds > LIT * fast);
      const isLeaving = (left[next] - left[k]) / seconds > LIT * loss;
      leaving.classList.toggle("on", isLeaving);
      inflow.setAttribute("stroke-dashoffset", (-pixels * between(came)).toFixed(1));
      outflow.setAttribute("stroke-dashoffset", (-pixels * between(left)).toFixed(1));
      out += between(left);
    });
    this.loadBranch.classList.toggle("on", this.branches.some(({ leaving }) => leaving.classList.contains("on")));
    this.loadFlow.setAttribute("stroke-dashoffset", (-pixels * out).toFixed(1));
    this.plates.forEach(({ x, y, plates, text, volts }, side) => {
      const name = side ? "right" : "left";
      const ratio = at(`${name}.capacitance`) / this.rest;
      const wide = Math.min(24, 13 * Math.sqrt(ratio));
      const gap = 16 / Math.sqrt(ratio);
      plates.setAttribute("d", `M${x - wide} ${y - gap}h${2 * wide}M${x - wide} ${y + gap}h${2 * wide}M${x} ${y - 16}V${y - gap}M${x} ${y + gap}V${y + 16}`);
      text.textContent = `${(at(`${name}.capacitance`) * 1e12).toFixed(2)} pF`;
      volts.textContent = `${at(`${name}.voltage`).toFixed(0)} V`;
    });
  }
}
