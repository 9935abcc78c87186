// Charts: axes, curves and a cursor on a canvas, and the same as SVG.
import { SvgPen } from "./pen.js";
import { short } from "./format.js";

/** Colours of the page. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Round numbers within a range, some `count` of them. */
export function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0) || !Number.isFinite(raw)) return [];
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((factor) => factor * size >= raw) * size;
  const first = Math.ceil(low / step - 1e-9);
  const found = Math.floor(high / step + 1e-9) - first + 1;
  // A range below the digits of its ends has no round numbers.
  return Array.from({ length: Math.min(50, Math.max(0, found)) }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

/** Powers of ten within a range, at most `count` of them. */
function decades(low, high, count) {
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  if (last - first < 1) {
    const within = [low, Math.sqrt(low * high), high];
    return within.map((value) => Number(value.toPrecision(2)));
  }
  const every = Math.max(1, Math.ceil((last - first + 1) / count));
  return Array.from({ length: Math.floor((last - first) / every) + 1 }, (_, k) => 10 ** (first + k * every));
}

export class Plot {
  /** A chart in `box`; `pick` gets the place at which a user clicks or drags, `picked` is called when that ends. */
  constructor(box, pick, picked = () => {}) {
    this.box = box;
    this.base = document.createElement("canvas");
    this.over = document.createElement("canvas");
    box.append(this.base, this.over);
    this.spec = null;
    this.left = 52;
    if (pick) this.listen(pick, picked);
  }

  listen(pick, picked) {
    let down = false;
    this.over.addEventListener("pointerdown", (event) => {
      const place = this.place(event);
      // Numbers beside the axes are no place to pick.
      if (!place?.inside) return;
      down = true;
      this.over.setPointerCapture(event.pointerId);
      pick(place);
    });
    this.over.addEventListener("pointermove", (event) => { if (down) pick(this.place(event)); });
    for (const name of ["pointerup", "pointercancel"]) {
      this.over.addEventListener(name, () => {
        if (down) picked();
        down = false;
      });
    }
  }

  /** Where a pointer is, in the units of the axes. */
  place(event) {
    if (!this.spec) return null;
    const bounds = this.over.getBoundingClientRect();
    const { x, y } = this.scales(bounds.width, bounds.height);
    const [px, py] = [event.clientX - bounds.left, event.clientY - bounds.top];
    const [width, height] = [bounds.width - 8 - this.left, bounds.height - 30];
    const part = { x: (px - this.left) / width, y: (bounds.height - 22 - py) / height };
    const inside = [part.x, part.y].every((it) => it >= 0 && it <= 1);
    return { x: x.back(px), y: y.back(py), part, inside };
  }

  scales(width, height) {
    const { spec, left } = this;
    const axis = ([low, high], log, from, to) => {
      const [a, b] = log ? [Math.log(low), Math.log(high)] : [low, high];
      const there = (value) => from + (((log ? Math.log(value) : value) - a) / (b - a)) * (to - from);
      const back = (place) => {
        const value = a + ((place - from) / (to - from)) * (b - a);
        return Math.min(high, Math.max(low, log ? Math.exp(value) : value));
      };
      return Object.assign(there, { back });
    };
    return { x: axis(spec.x, spec.xLog, left, width - 8), y: axis(spec.y, spec.yLog, height - 22, 8) };
  }

  /** Draws: { x: [low, high], y: [low, high], xLog, yLog, xUnit, draw(pen, x, y, size) }. */
  draw(spec) {
    this.spec = spec;
    const pen = this.pen(this.base);
    if (pen) this.paint(pen, this.base.clientWidth, this.base.clientHeight);
    this.cursor(this.marks ?? []);
  }

  redraw() {
    if (this.spec) this.draw(this.spec);
  }

  pen(canvas) {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return null;
    const scale = Math.min(3, window.devicePixelRatio || 1);
    const [w, h] = [Math.round(width * scale), Math.round(height * scale)];
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    return pen;
  }

  paint(pen, width, height) {
    const { spec, left } = this;
    const { x, y } = this.scales(width, height);
    const bottom = height - 22;
    pen.font = "11px system-ui, sans-serif";
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    const rows = spec.yLog ? decades(...spec.y, height / 40) : ticks(...spec.y, height / 36);
    for (const value of rows) {
      const at = y(value);
      if (at < 7 || at > bottom + 0.5) continue;
      pen.strokeStyle = color("grid");
      pen.beginPath(); pen.moveTo(left, at); pen.lineTo(width - 8, at); pen.stroke();
      pen.fillStyle = color("faint");
      pen.fillText(spec.yLog ? label(value) : short(value), left - 6, at);
    }
    pen.textBaseline = "top";
    const columns = spec.xLog ? decades(...spec.x, width / 70) : ticks(...spec.x, width / 80);
    for (const value of columns) {
      const at = x(value);
      pen.strokeStyle = color("grid");
      pen.beginPath(); pen.moveTo(at, 8); pen.lineTo(at, bottom); pen.stroke();
      pen.fillStyle = color("faint");
      pen.textAlign = at > width - 30 ? "right" : "center";
      pen.fillText((spec.xLog ? label(value) : short(value, 6)) + (value === columns.at(-1) && spec.xUnit ? ` ${spec.xUnit}` : ""), at > width - 30 ? width - 2 : at, bottom + 6);
    }
    pen.save();
    pen.beginPath(); pen.rect(left, 6, width - 8 - left, bottom - 6); pen.clip();
    spec.draw(pen, x, y, { left, top: 8, right: width - 8, bottom });
    pen.restore();
  }

  /** Marks over the chart: vertical lines { x }, horizontal ones { y }, points { x, y }. */
  cursor(marks) {
    this.marks = marks;
    if (!this.spec) return;
    const pen = this.pen(this.over);
    if (!pen) return;
    const { clientWidth: width, clientHeight: height } = this.box;
    const { x, y } = this.scales(width, height);
    for (const mark of marks) {
      pen.strokeStyle = pen.fillStyle = mark.color ?? color("ink");
      pen.lineWidth = 1.2;
      pen.beginPath();
      if (mark.x !== undefined && mark.y !== undefined) {
        pen.arc(x(mark.x), y(mark.y), 4.5, 0, 7);
        pen.fill();
        pen.strokeStyle = color("page");
      } else if (mark.x !== undefined) {
        pen.moveTo(x(mark.x), 6); pen.lineTo(x(mark.x), height - 22);
      } else {
        pen.moveTo(this.left, y(mark.y)); pen.lineTo(width - 8, y(mark.y));
      }
      pen.stroke();
    }
  }

  /** The chart as a part of an SVG picture of this size. */
  svg(width, height) {
    if (!this.spec) return "";
    const pen = new SvgPen();
    this.paint(pen, width, height);
    return pen.text();
  }
}

const label = (value) => (value >= 1e4 || value < 1e-2 ? Number(value.toPrecision(2)).toExponential().replace("e+", "e") : short(value, 3));

/** A curve through rows: columns `a` and `b`, each times a factor. */
export function curve(pen, x, y, rows, width, a, b, scale = [1, 1], shift = [0, 0]) {
  pen.beginPath();
  for (let at = 0; at < rows.length; at += width) {
    const [px, py] = [x((rows[at + a] - shift[0]) * scale[0]), y((rows[at + b] - shift[1]) * scale[1])];
    if (at) pen.lineTo(px, py);
    else pen.moveTo(px, py);
  }
  pen.stroke();
}

/** Range of values with a margin. */
export function around(values, part = 0.08) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const margin = (high - low || Math.abs(high) || 1) * part;
  return [low - margin, high + margin];
}
