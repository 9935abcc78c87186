// Diagrams over ranges of parameters, computed in a thread of their own.
import { range, variable, variables } from "./description.js";
import { Engine, Superseded } from "./engine.js";
import { SHOWN, base, change, commit, counts, hold, machine, set, state, value } from "./state.js";
import { Plot, around, color } from "./plot.js";
import { quantity, short } from "./format.js";

const COLUMNS = 600;
const POINTS = 200;
/** Periods that pass before a motion is looked at. */
const TRANSIENT = 100;
const CELLS = [56, 40];

const between = ({ low, high, log }, count) => Array.from({ length: count }, (_, k) => (log ? low * (high / low) ** (k / (count - 1)) : low + ((high - low) * k) / (count - 1)));

/** Fills a list with the numbers that may be varied; the motion does not depend on those of the circuit. */
export function fill(select, wanted, ofMotion = false) {
  if (!select.options.length) {
    for (const it of variables.filter((it) => it.kind === "real" && !(ofMotion && it.part === "circuit"))) select.append(new Option(it.symbol ? `${it.symbol}  ${it.name}` : it.name, it.name));
  }
  for (const option of select.options) option.disabled = !counts(variable(option.value)) && option.value !== wanted;
  select.value = wanted;
}

/** The range of a parameter in a map: that of its slider, which the present value is part of. */
function rangeOf(name, chosen) {
  const present = value(name) ?? chosen(name) ?? 1;
  const found = range(variable(name), base(name) ?? chosen(name) ?? 1);
  const fits = Number.isFinite(present) && (present > 0 || !found.log);
  return fits ? { ...found, low: Math.min(found.low, present), high: Math.max(found.high, present) } : found;
}

class Picture {
  constructor(box, text, pick) {
    const drag = (place) => {
      hold();
      pick(place);
    };
    this.plot = new Plot(box, drag, commit);
    this.plot.left = 62;
    this.text = text;
    this.engine = new Engine(20000);
    this.visible = true;
    this.key = "";
    new IntersectionObserver((entries) => {
      this.visible = entries.at(-1).isIntersecting;
      if (this.visible) this.later();
    }, { rootMargin: "200px" }).observe(box);
  }

  /** Computes anew if anything has changed, once the user pauses. */
  later(delay = 250) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.update(), delay);
  }

  async update() {
    if (!this.visible) return;
    const question = this.question();
    const key = JSON.stringify(question, (_, it) => (it === Infinity ? "inf" : it));
    if (key === this.key) return;
    this.key = key;
    const began = performance.now();
    this.begin(question);
    try {
      await this.engine.ask(question, (part) => { this.take(part); this.later_paint(); });
      this.took = performance.now() - began;
      this.paint();
      this.done();
    } catch (error) {
      if (error instanceof Superseded) return;
      this.text.textContent = `stopped: ${error.message}`;
    }
  }

  later_paint() {
    this.frame ??= requestAnimationFrame(() => { this.frame = null; this.paint(); });
  }
}

export class Diagram extends Picture {
  constructor(box, text, chosen) {
    super(box, text, ({ x }) => set(this.asked.name, Number(x.toPrecision(4))));
    this.chosen = chosen;
  }

  question() {
    const { name, shown, from, to } = state.diagram;
    const found = rangeOf(name, this.chosen);
    const range = { low: from ?? found.low, high: to ?? found.high };
    this.isEmpty = !(range.high > range.low);
    this.range = this.isEmpty ? found : { ...range, log: found.log && range.low > 0 && range.high / range.low > 3 };
    const without = machine();
    without.values = without.values.filter(([other]) => other !== name);
    return { job: "diagram", machine: without, name, shown, values: between(this.range, COLUMNS), transient: TRANSIENT, points: POINTS };
  }

  begin(question) {
    this.asked = question;
    this.columns = [];
    this.text.textContent = "computing";
  }

  take({ first, columns }) {
    let at = 0;
    for (let index = first; at < columns.length; index++) {
      const count = columns[at];
      this.columns[index] = columns.subarray(at + 1, at + 1 + count);
      at += 1 + count;
    }
    this.text.textContent = `computing: ${this.columns.length} of ${COLUMNS} values`;
  }

  done() {
    const points = this.columns.reduce((sum, column) => sum + column.length, 0);
    const range = this.isEmpty ? " (the range given is empty)" : "";
    this.text.textContent = `${points} points at ${this.columns.length} values${range} after ${TRANSIENT} periods, in ${(this.took / 1000).toFixed(2)} s. Click to take a value.`;
  }

  paint() {
    if (!this.asked) return;
    const { factor } = SHOWN[this.asked.shown];
    const all = function* (columns) { for (const column of columns) if (column) yield* column; };
    const [low, high] = around(all(this.columns), 0.04);
    const { values, name } = this.asked;
    this.plot.draw({
      x: [this.range.low, this.range.high], xLog: this.range.log, xUnit: variable(name).unit ?? "", y: [low * factor, high * factor],
      draw: (pen, x, y) => {
        pen.fillStyle = color("ink");
        pen.globalAlpha = 0.35;
        this.columns.forEach((column, index) => {
          const at = x(values[index]);
          for (const value of column) pen.fillRect(at - 0.5, y(value * factor) - 0.5, 1, 1);
        });
        pen.globalAlpha = 1;
      },
    });
    this.mark();
  }

  mark() {
    const present = value(state.diagram.name) ?? this.chosen(state.diagram.name);
    if (this.asked?.name === state.diagram.name) this.plot.cursor([{ x: present, color: color("accent") }]);
  }
}

/** Losses are blue and gains orange; what is neither has the colour of the page. */
const LIGHT = [[38, 84, 158], [122, 162, 210], [236, 238, 241], [246, 178, 92], [196, 86, 10]];
const DARK = [[96, 165, 250], [52, 92, 150], [34, 41, 48], [158, 92, 28], [252, 168, 76]];

/** A colour for a part from -1, over 0, to 1. */
function shade(part) {
  const stops = matchMedia("(prefers-color-scheme: dark)").matches ? DARK : LIGHT;
  const place = Math.min(0.9999, Math.max(0, (part + 1) / 2)) * 4;
  const k = Math.floor(place);
  return stops[k].map((from, index) => Math.round(from + (stops[k + 1][index] - from) * (place - k)));
}

/** What takes the place of a parameter that has no effect at present. */
const INSTEAD = ["zener.voltage", "storage.voltage", "load.resistance", "biasVoltage", "excitation.frequency"];

/** The parameters of the map: two that differ and have an effect. */
export function axes() {
  const { x, y } = state.map;
  const found = [];
  for (const name of [x, y]) {
    const fits = (it) => !found.includes(it) && counts(variable(it));
    found.push(fits(name) ? name : INSTEAD.find((it) => fits(it) && it !== y) ?? name);
  }
  return found;
}

export class PowerMap extends Picture {
  /** `highest` tells by how much impacts raise the voltage of a membrane from which no charge is let out. */
  constructor(box, text, chosen, highest) {
    const pick = ({ x, y }) => {
      const [nameX, nameY] = axes();
      change((state) => { state.set[nameX] = Number(x.toPrecision(4)); state.set[nameY] = Number(y.toPrecision(4)); });
    };
    super(box, text, pick);
    this.chosen = chosen;
    this.highest = highest;
    this.plot.over.addEventListener("pointermove", (event) => this.tell(event));
    this.plot.over.addEventListener("pointerleave", () => { if (this.cells) this.done(); });
  }

  question() {
    const [x, y] = axes();
    const ranges = [x, y].map((name) => rangeOf(name, this.chosen));
    // A release below the supply is none.
    const supply = value("supply.voltage") ?? value("biasVoltage");
    ranges.forEach((range, index) => {
      if (!/^(zener|storage)\.voltage$/.test([x, y][index])) return;
      range.low = supply;
      range.high = Math.max(1.1 * this.highest() * supply, value([x, y][index]) ?? 0, 1.2 * supply);
    });
    this.ranges = ranges;
    const without = machine();
    without.values = without.values.filter(([name]) => name !== x && name !== y);
    const { from, until } = state;
    return { job: "power", machine: without, x, y, xs: between(ranges[0], CELLS[0]), ys: between(ranges[1], CELLS[1]), from, until };
  }

  begin(question) {
    this.asked = question;
    this.cells = [];
    this.fault = undefined;
    this.text.textContent = "computing";
  }

  take({ row, cells, fault }) {
    this.cells[row] = cells;
    this.fault ??= fault;
    this.text.textContent = `computing: ${row + 1} of ${CELLS[1]} rows`;
  }

  best() {
    let best = null;
    this.cells.forEach((cells, row) => {
      for (let k = 0; k < cells.length; k += 2) {
        const fits = Number.isFinite(cells[k]) && cells[k + 1] <= 1;
        if (fits && (!best || cells[k] > best.power)) best = { power: cells[k], x: this.asked.xs[k / 2], y: this.asked.ys[row] };
      }
    });
    return best;
  }

  done() {
    const [x, y] = [this.asked.x, this.asked.y].map(variable);
    const best = this.best();
    const place = best && `${quantity(best.x, x.unit ?? "", 3)}, ${quantity(best.y, y.unit ?? "", 3)}`;
    const nothing = this.cells.every((cells) => cells.every((it, k) => k % 2 || Number.isNaN(it))) && this.fault ? `none of them runs: ${this.fault}` : "no machine within the limits of its films";
    const where = !best ? nothing : best.power > 0 ? `largest ${quantity(best.power, "W", 4)} at ${place}` : "nothing gains here";
    this.text.textContent = `${where}. ${CELLS[0] * CELLS[1]} runs in ${(this.took / 1000).toFixed(2)} s. Hatched: a film fails. Click to go there.`;
  }

  tell(event) {
    const place = this.plot.place(event);
    if (!place?.inside || !this.cells?.length) return;
    const [column, row] = [place.part.x, place.part.y].map((part, axis) => Math.min(CELLS[axis] - 1, Math.floor(part * CELLS[axis])));
    const power = this.cells[row]?.[2 * column];
    if (power === undefined) return;
    const [x, y] = [this.asked.x, this.asked.y].map(variable);
    this.text.textContent = `${Number.isFinite(power) ? quantity(power, "W", 4) : "no such machine"} at ${quantity(this.asked.xs[column], x.unit ?? "", 3)}, ${quantity(this.asked.ys[row], y.unit ?? "", 3)}`;
  }

  paint() {
    if (!this.asked) return;
    const [xr, yr] = this.ranges;
    let [most, least] = [0, 0];
    for (const cells of this.cells) {
      for (let k = 0; cells && k < cells.length; k += 2) {
        if (cells[k] > most) most = cells[k];
        if (cells[k] < least) least = cells[k];
      }
    }
    // Losses may be many times the gains: beyond the scale they have its last colour.
    const scale = most > 0.01 * -least ? most : -least || 1e-6;
    this.plot.draw({
      x: [xr.low, xr.high], xLog: xr.log, xUnit: variable(this.asked.x).unit ?? "", y: [yr.low, yr.high], yLog: yr.log,
      draw: (pen, x, y, size) => {
        const [wide, tall] = [(size.right - size.left) / CELLS[0], (size.bottom - size.top) / CELLS[1]];
        this.cells.forEach((cells, row) => {
          const bottom = size.bottom - row * tall;
          for (let k = 0; k < cells.length; k += 2) {
            if (!Number.isFinite(cells[k])) continue;
            const left = size.left + (k / 2) * wide;
            pen.fillStyle = `rgb(${shade(cells[k] / scale).join(",")})`;
            pen.fillRect(left, bottom - tall, wide + 0.7, tall + 0.7);
            if (cells[k + 1] <= 1) continue;
            pen.strokeStyle = "rgba(0,0,0,.45)";
            pen.lineWidth = 0.8;
            pen.beginPath(); pen.moveTo(left, bottom); pen.lineTo(left + wide, bottom - tall); pen.stroke();
          }
        });
        // The scale of the colours.
        const bar = { x: size.right - 118, y: size.top + 8, width: 110, height: 8 };
        pen.fillStyle = color("page"); pen.globalAlpha = 0.85;
        pen.fillRect(bar.x - 6, bar.y - 6, bar.width + 12, 34);
        pen.globalAlpha = 1;
        for (let k = 0; k < 44; k++) {
          pen.fillStyle = `rgb(${shade((k / 43) * 2 - 1).join(",")})`;
          pen.fillRect(bar.x + (k * bar.width) / 44, bar.y, bar.width / 44 + 0.5, bar.height);
        }
        pen.fillStyle = color("ink"); pen.textBaseline = "top";
        for (const [part, align] of [[-1, "left"], [0, "center"], [1, "right"]]) {
          pen.textAlign = align;
          pen.fillText(short(part * scale * 1e6, 3), bar.x + ((part + 1) / 2) * bar.width, bar.y + 11);
        }
      },
    });
    this.mark();
  }

  mark() {
    const [x, y] = axes();
    if (this.asked?.x !== x || this.asked?.y !== y) return;
    const [px, py] = [x, y].map((name) => value(name) ?? this.chosen(name));
    this.plot.cursor(Number.isFinite(px) && Number.isFinite(py) ? [{ x: px, y: py, color: color("accent") }] : []);
  }
}
