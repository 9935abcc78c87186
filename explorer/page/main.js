// The page: asks for what the present machine does, and shows it.
import { cases, version } from "./description.js";
import { Engine, Superseded } from "./engine.js";
import { SHOWN, SPANS, canRedo, canUndo, change, commit, fragment, listen, machine, published, read, redo, set, state, undo, value } from "./state.js";
import { build, show, take } from "./controls.js";
import { Plot, around, color, curve } from "./plot.js";
import { Device } from "./device.js";
import { escape } from "./pen.js";
import { Circuit } from "./circuit.js";
import { Diagram, PowerMap, axes, fill } from "./maps.js";
import { caseName, caseTitle, fmpy, python, save, toml } from "./exports.js";
import { largest, quantity, short } from "./format.js";

const find = (id) => document.getElementById(id);

// A message stays until the next one that concerns the same.
let messages = {};

function say(text, about = "hint") {
  if (text) messages[about] = text;
  else delete messages[about];
  const lines = Object.values(messages);
  find("message").hidden = lines.length === 0;
  find("message").textContent = lines.join("\n");
}

/** What the machine does now: the last answer. */
let shown = null;
let clock = 0;
// The largest acceleration of the cylinder in the picture.
let strongest = 1;
let playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
let last = null;
let answers = 0;
// The question that was asked last: what has not changed is not computed again.
let asked = "";
const times = [];

const engine = new Engine(5000);
const files = new Engine(30000);
const device = new Device(find("device"));
const circuit = new Circuit(find("circuit"));
const seek = ({ x }) => { clock = x; };
const plots = {
  gap: new Plot(find("plot-gap"), seek), capacitance: new Plot(find("plot-capacitance"), seek),
  voltage: new Plot(find("plot-voltage"), seek), energy: new Plot(find("plot-energy"), seek), phase: new Plot(find("plot-phase")),
};

/** The voltages that the model chooses where none is given. */
const chosen = (name) => shown?.voltages[["supply.voltage", "zener.voltage", "storage.voltage"].indexOf(name)];
const diagram = new Diagram(find("plot-diagram"), find("diagram-text"), chosen);
const highest = () => (shown ? largest(columnOf("left.capacitance"), columnOf("right.capacitance")) / shown.derived.restCapacitance : 2);
const map = new PowerMap(find("plot-map"), find("map-text"), chosen, highest);

const period = () => 1 / Number(value("excitation.frequency"));

/** Asks for the present machine; a machine that the model refuses leaves the picture as it is. */
async function ask() {
  const length = state.span * period();
  const begin = Math.min(state.begin, 1e6);
  const question = { job: "live", machine: machine(), from: state.from, until: state.until, begin, end: begin + length, spacing: period() / 100 };
  const key = JSON.stringify(question);
  if (key === asked) {
    answers += 1;
    return;
  }
  asked = key;
  try {
    const answer = await engine.ask(question);
    say("", "machine");
    document.body.classList.remove("stale");
    take_answer(answer);
  } catch (error) {
    if (error instanceof Superseded) return;
    say(`${error.message}${shown ? "; the picture is that of the values before" : ""}`, "machine");
    document.body.classList.add("stale");
  } finally {
    answers += 1;
  }
}

function take_answer(answer) {
  const before = shown;
  shown = answer;
  const { columns } = answer;
  shown.column = (name) => columns.indexOf(name);
  shown.width = columns.length;
  shown.count = answer.rows.length / columns.length;
  if (!before || before.begin !== answer.begin || before.end !== answer.end) {
    const part = before && before.begin === answer.begin ? (clock - before.begin) / (before.end - before.begin) : 0;
    clock = answer.begin + Math.min(1, Math.max(0, part)) * (answer.end - answer.begin);
  }
  numbers();
  charts();
  scene();
  show();
  diagram.later();
  map.later();
  diagram.mark();
  map.mark();
}

function numbers() {
  const { numbers, warnings, derived } = shown;
  const power = (watts) => quantity(watts, "W", 4);
  const film = Math.max(numbers.area_ratio_over_limit, numbers.field_over_limit, numbers.stress_over_limit, numbers.deflection_over_limit);
  find("net-value").textContent = power(numbers.net_power);
  find("net").classList.toggle("loss", numbers.net_power < 0);
  find("net").classList.toggle("fails", film > 1);
  find("net-note").textContent = film > 1 ? "by a machine whose films fail, see below" : "load less supply, with the change of what the membranes store";
  const length = state.until - state.from;
  const facts = [
    ["to the load", power(numbers.load_power)],
    ["from the supply", power(numbers.supply_power)],
    ["from the motion", power(numbers.mechanical_power)],
    ["P of Eq. (14)", power(numbers.average_power_eq13)],
    ["\u27e8U\u27e9 of Eq. (15)", `${numbers.average_voltage_gain.toFixed(1)} V/s`],
    ["impacts", `${short(numbers.impacts / length, 4)} a second`],
    ["deepest deflection", quantity(numbers.largest_deflection, "m", 3)],
    ["highest voltage", `${numbers.highest_voltage.toFixed(0)} V`],
    ["film", `${(100 * film).toFixed(0)} % of its nearest limit`],
    ["C at rest", quantity(derived.restCapacitance, "F", 4)],
    ["travel of the ball", quantity(derived.travel, "m", 4)],
    ["cylinder / half travel", short(derived.gamma, 3)],
  ];
  find("facts").replaceChildren(...facts.map(([name, text]) => {
    const box = document.createElement("div");
    const [term, data] = [document.createElement("dt"), document.createElement("dd")];
    term.textContent = name;
    data.textContent = text;
    box.append(term, data);
    return box;
  }));
  find("warnings").replaceChildren(...warnings.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
  flow(numbers);
}

/** Where the energy comes from and where it goes: two bars of one length. */
function flow(numbers) {
  const into = [["supply", numbers.supply_power], ["motion", numbers.mechanical_power]];
  const out = [["load", numbers.load_power], ["Zener", numbers.zener_power], ["diodes", numbers.diode_power], ["leakage", numbers.leakage_power], ["stored", numbers.stored_power]];
  const positive = (parts, others) => [...parts.filter(([, watts]) => watts > 0), ...others.filter(([, watts]) => watts < 0).map(([name, watts]) => [name, -watts])];
  const bars = [["from", positive(into, out)], ["to", positive(out, into)]];
  const whole = Math.max(...bars.map(([, parts]) => parts.reduce((sum, [, watts]) => sum + watts, 0)), 1e-30);
  find("flow").replaceChildren(...bars.map(([title, parts]) => {
    const bar = document.createElement("div");
    bar.className = "bar";
    bar.setAttribute("role", "img");
    bar.setAttribute("aria-label", `${title} ${parts.map(([name, watts]) => `${name} ${quantity(watts, "W", 3)}`).join(", ")}`);
    bar.append(Object.assign(document.createElement("span"), { className: "title", textContent: title }));
    for (const [name, watts] of parts.filter(([, watts]) => watts > 1e-4 * whole)) {
      const part = document.createElement("span");
      part.className = `part ${name.toLowerCase()}`;
      part.style.flexGrow = watts / whole;
      part.title = `${name}: ${quantity(watts, "W", 4)}`;
      part.textContent = watts > 0.12 * whole ? `${name} ${quantity(watts, "W", 3)}` : "";
      bar.append(part);
    }
    return bar;
  }));
}

const columnOf = (name, factor = 1, shift = 0) => {
  const { rows, width, column } = shown;
  const at = column(name);
  return Array.from({ length: shown.count }, (_, k) => (rows[k * width + at] - shift) * factor);
};

const pair = (pen, x, y, name, factor) => {
  const { rows, width, column } = shown;
  pen.lineWidth = 1.6;
  for (const side of ["left", "right"]) {
    pen.strokeStyle = color(side);
    curve(pen, x, y, rows, width, 0, column(`${side}.${name}`), [1, factor]);
  }
};

const level = (pen, y, size, value, name, dash = [4, 4]) => {
  pen.save();
  pen.strokeStyle = color(name);
  pen.lineWidth = 1;
  pen.setLineDash(dash);
  pen.beginPath(); pen.moveTo(size.left, y(value)); pen.lineTo(size.right, y(value)); pen.stroke();
  pen.setLineDash([]);
  pen.restore();
};

function charts() {
  const { rows, width, column, begin, end, derived } = shown;
  const x = [begin, end];
  const half = (derived.travel / 2) * 1e3;
  const gap = columnOf("relative.displacement", 1e3);
  plots.gap.draw({ x, xUnit: "s", y: around([...gap, -half, half]), draw: (pen, x, y, size) => {
    level(pen, y, size, half, "left");
    level(pen, y, size, -half, "right");
    pen.strokeStyle = color("ink");
    pen.lineWidth = 1.6;
    curve(pen, x, y, rows, width, 0, column("relative.displacement"), [1, 1e3]);
  } });
  const both = (name, factor) => [...columnOf(`left.${name}`, factor), ...columnOf(`right.${name}`, factor)];
  plots.capacitance.draw({ x, xUnit: "s", y: around(both("capacitance", 1e12)), draw: (pen, x, y) => pair(pen, x, y, "capacitance", 1e12) });
  const [supply, release] = supplyAndRelease();
  const voltages = both("voltage", 1);
  const highestShown = Math.max(largest(voltages), release);
  const limits = both("limit", 1).filter((volts) => volts < 3 * highestShown);
  plots.voltage.draw({ x, xUnit: "s", y: around([...voltages, ...limits, supply, release]), draw: (pen, x, y, size) => {
    level(pen, y, size, supply, "supply", [2, 3]);
    level(pen, y, size, release, "load", [6, 4]);
    pen.setLineDash([5, 3]);
    pen.strokeStyle = color("bad");
    pen.lineWidth = 1;
    for (const side of ["left", "right"]) curve(pen, x, y, rows, width, 0, column(`${side}.limit`));
    pen.setLineDash([]);
    pair(pen, x, y, "voltage", 1);
  } });
  const start = (name) => rows[column(name)];
  const energies = [["load.energy", "load"], ["supply.energy", "supply"], ["mechanical.energy", "motion"]];
  const net = net_energy();
  const range = around(function* () { for (const [name] of energies) yield* columnOf(name, 1, start(name)); yield* net; }());
  const [factor, prefix] = Math.max(-range[0], range[1]) < 1e-2 ? [1e6, "\u00b5"] : [1e3, "m"];
  find("energy-unit").textContent = `${prefix}J`;
  plots.energy.draw({ x, xUnit: "s", y: range.map((joules) => joules * factor), draw: (pen, x, y) => {
    for (const [name, hue] of energies) {
      pen.strokeStyle = color(hue);
      pen.lineWidth = 1.4;
      curve(pen, x, y, rows, width, 0, column(name), [1, factor], [0, start(name)]);
    }
    pen.strokeStyle = color("ink");
    pen.lineWidth = 2.2;
    pen.beginPath();
    net.forEach((value, k) => (k ? pen.lineTo(x(rows[k * width]), y(value * factor)) : pen.moveTo(x(rows[0]), y(value * factor))));
    pen.stroke();
  } });
  const speed = columnOf("relative.velocity");
  plots.phase.draw({ x: around([...gap, -half, half], 0.05), xUnit: "mm", y: around(speed), draw: (pen, x, y, size) => {
    for (const [at, hue] of [[half, "left"], [-half, "right"]]) {
      pen.strokeStyle = color(hue);
      pen.lineWidth = 1;
      pen.setLineDash([4, 4]);
      pen.beginPath(); pen.moveTo(x(at), size.top); pen.lineTo(x(at), size.bottom); pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = color("ink");
    pen.lineWidth = 1.3;
    curve(pen, x, y, rows, width, column("relative.displacement"), column("relative.velocity"), [1e3, 1]);
  } });
}

/** Load less supply, with the change of the stored energy, J, since the beginning of the picture. */
function net_energy() {
  const [load, supply, stored] = ["load.energy", "supply.energy", "stored.energy"].map((name) => columnOf(name));
  const at = (k) => load[k] - supply[k] + stored[k];
  return load.map((_, k) => at(k) - at(0));
}

/** Voltages of the supply, and at which charge is let out. */
function supplyAndRelease() {
  const [supply, zener, storage] = shown.voltages;
  return [supply, value("release") === "storage" ? storage : zener];
}

/** Draws what does not move. */
function scene() {
  const { derived, numbers } = shown;
  const z = columnOf("cylinder.position");
  const [low, high] = around(z, 0);
  device.build({ ...derived, deepest: numbers.largest_deflection, limit: shown.deflectionLimit }, [low, high]);
  const isImpulsive = value("contact.law") === "impulsive";
  const contact = isImpulsive
    ? "An impact takes no time here (contact.law = impulsive, the paper's): the ball leaves at once, and the film springs out and back by itself."
    : "The film is a spring with losses, and a contact takes time (contact.law = compliant).";
  const seen = device.follows ? "To scale, and the picture follows the cylinder." : "To scale.";
  find("contact-note").textContent = `${seen} Arrow: acceleration of the cylinder. ${contact}`;
  circuit.build();
  circuit.prepare(shown.rows, shown.width, shown.column, derived.restCapacitance, supplyAndRelease());
  strongest = Math.max(largest(columnOf("cylinder.acceleration").map(Math.abs)), 1e-12);
}

/** The row before a time, and the part of the way to the next one. */
function locate(time) {
  const { rows, width, count } = shown;
  let [low, high] = [0, count - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (rows[middle * width] <= time) low = middle;
    else high = middle;
  }
  const [a, b] = [rows[low * width], rows[high * width]];
  return { k: low, next: high, part: b > a ? Math.min(1, Math.max(0, (time - a) / (b - a))) : 0 };
}

function draw() {
  const { rows, width, column } = shown;
  const { k, next, part } = locate(clock);
  /** A column now. */
  const at = (name) => {
    const index = column(name);
    return rows[k * width + index] + part * (rows[next * width + index] - rows[k * width + index]);
  };
  device.move({
    cylinder: at("cylinder.position"), ball: at("ball.position"), left: at("left.deflection"), right: at("right.deflection"),
    push: at("cylinder.acceleration") / strongest,
  });
  circuit.move(rows, { k, next, part }, at);
  for (const name of ["gap", "capacitance", "voltage", "energy"]) plots[name].cursor([{ x: clock }]);
  plots.phase.cursor([{ x: at("relative.displacement") * 1e3, y: at("relative.velocity"), color: color("accent") }]);
  find("clock").textContent = `${clock.toFixed(4)} s`;
}

/** One frame: the time goes on, and what moves is drawn. */
function frame(now) {
  const passed = last === null ? 0 : Math.min(100, now - last);
  if (last !== null) {
    times.push(now - last);
    if (times.length > 600) times.shift();
  }
  last = now;
  if (shown) {
    if (playing) {
      clock += (passed / 1000) * 10 ** Number(find("speed").value);
      if (clock >= shown.end) clock = shown.begin;
    }
    draw();
  }
  requestAnimationFrame(frame);
}

/** To the impact after the present time, or before it. */
function step(forward) {
  if (!shown) return;
  setPlaying(false);
  const hits = Array.from({ length: shown.impacts.length / 3 }, (_, k) => shown.impacts[3 * k]);
  const slack = 1e-9;
  const found = forward ? hits.find((time) => time > clock + slack) : hits.findLast((time) => time < clock - slack);
  if (found !== undefined) clock = found;
  else say(forward ? "no impact after this one in the time that is shown" : "no impact before this one in the time that is shown");
}

function setPlaying(wanted) {
  playing = wanted;
  find("play").textContent = playing ? "Pause" : "Play";
}

/** Shows the values of all fields that are not those of parameters. */
function fields() {
  find("case").value = state.case;
  find("undo").disabled = !canUndo();
  find("redo").disabled = !canRedo();
  for (const [id, wanted] of [["begin", state.begin], ["span", state.span]]) if (document.activeElement !== find(id)) find(id).value = wanted;
  const { name, shown: what } = state.diagram;
  fill(find("diagram-name"), name, true);
  find("diagram-shown").value = what;
  for (const [id, key] of [["diagram-from", "from"], ["diagram-to", "to"]]) if (document.activeElement !== find(id)) find(id).value = state.diagram[key] ?? "";
  const [x, y] = axes();
  fill(find("map-x"), x);
  fill(find("map-y"), y);
}

function keys() {
  const key = (id, parts) => find(id).replaceChildren(...parts.flatMap(([name, text]) => {
    const mark = Object.assign(document.createElement("span"), { className: `swatch ${name}` });
    return [mark, `${text} `];
  }));
  key("key-gap", [["left dashed", "left membrane"], ["right dashed", "right membrane"]]);
  key("key-capacitance", [["left", "left"], ["right", "right"]]);
  key("key-voltage", [["left", "left"], ["right", "right"], ["supply dashed", "supply"], ["load dashed", "release"], ["bad dashed", "film breaks down"]]);
  key("key-energy", [["ink", "net"], ["load", "load"], ["supply", "supply"], ["motion", "from the motion"]]);
}

async function picture() {
  const width = 900;
  const parts = [];
  let top = 30;
  const add = (text, height) => { parts.push(`<g transform="translate(0 ${top})">${text}</g>`); top += height; };
  const drawing = device.text(width);
  add(drawing.text, drawing.height + 10);
  for (const [name, title] of [["gap", "Relative displacement, mm"], ["capacitance", "Capacitance, pF"], ["voltage", "Voltage, V"], ["energy", `Energy, ${find("energy-unit").textContent}`]]) {
    add(`<text x="52" y="12" style="font:12px sans-serif" fill="${color("ink")}">${title}</text>`, 16);
    add(plots[name].svg(width, 170), 180);
  }
  const title = escape(caseTitle());
  const text = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${top}" viewBox="0 0 ${width} ${top}"><rect width="100%" height="100%" fill="${color("page")}"/><text x="10" y="20" style="font:13px sans-serif" fill="${color("ink")}">${title}</text>${parts.join("\n")}</svg>\n`;
  save(`${caseName()}.svg`, text, "image/svg+xml");
}

async function capacitances(reader, ending) {
  try {
    const text = await files.ask({ job: "capacitances", machine: machine(), until: Math.min(state.until, 10), reader, title: `${caseTitle()}; 0 to ${Math.min(state.until, 10)} s` });
    save(`${caseName()}-C${ending}`, text);
    say("", "export");
  } catch (error) {
    if (!(error instanceof Superseded)) say(error.message, "export");
  }
}

const EXPORTS = [
  ["Case for videg (TOML)", () => save(`${caseName()}.toml`, toml())],
  ["Script for Python", () => save(`${caseName()}.py`, python())],
  ["Script for FMPy", () => save(`${caseName()}-fmpy.py`, fmpy(published().settings))],
  ["C(t) of 10 s as CSV", () => capacitances("Csv", ".csv")],
  ["C(t) of 10 s for ngspice, KiCad", () => capacitances("Ngspice", ".lib")],
  ["C(t) of 10 s for LTspice", () => capacitances("Ltspice", "-ltspice.lib")],
  ["C(t) of 10 s for QSPICE", () => capacitances("Qspice", "-qspice.lib")],
  ["Picture (SVG)", picture],
];

async function copyLink() {
  commit();
  const { text, left } = await fragment();
  const address = location.href.split("#")[0] + text;
  try {
    await navigator.clipboard.writeText(address);
    say(`Link copied${left.length ? `, without ${left.join(", ")}: too long for a link` : ""}.`);
  } catch {
    say(`The browser lets no page copy here; the link is in the address line${left.length ? `, without ${left.join(", ")}` : ""}.`);
  }
}

function toolbar() {
  for (const source of new Set(cases.map((it) => it.source))) {
    const group = document.createElement("optgroup");
    group.label = source;
    for (const it of cases.filter((it) => it.source === source)) group.append(new Option(`${it.name}: ${it.description}`, it.name));
    find("case").append(group);
  }
  find("case").addEventListener("change", (event) => {
    change((state) => { state.case = event.target.value; state.set = {}; state.files = {}; });
    commit();
  });
  find("undo").addEventListener("click", undo);
  find("redo").addEventListener("click", redo);
  find("link").addEventListener("click", copyLink);
  const menu = find("export").querySelector("div");
  for (const [name, act] of EXPORTS) {
    const button = Object.assign(document.createElement("button"), { textContent: name });
    button.addEventListener("click", () => { find("export").open = false; act(); });
    menu.append(button);
  }
  find("open-controls").addEventListener("click", () => {
    const open = document.body.classList.toggle("with-controls");
    find("open-controls").setAttribute("aria-expanded", String(open));
  });
}

function transport() {
  for (const periods of SPANS) find("span").append(new Option(`${periods} ${periods === 1 ? "period" : "periods"}`, periods));
  find("span").addEventListener("change", (event) => { change((state) => { state.span = Number(event.target.value); }); commit(); });
  find("begin").addEventListener("change", (event) => {
    const wanted = Number(event.target.value);
    if (wanted >= 0 && event.target.value !== "") change((state) => { state.begin = wanted; });
    commit();
  });
  find("play").addEventListener("click", () => setPlaying(!playing));
  find("next").addEventListener("click", () => step(true));
  find("previous").addEventListener("click", () => step(false));
  const speed = () => { const factor = 10 ** Number(find("speed").value); find("speed-text").textContent = factor >= 1 ? `${short(factor, 2)} x` : `1/${short(1 / factor, 2)}`; };
  find("speed").addEventListener("input", speed);
  speed();
  setPlaying(playing);
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest("input, select, textarea, summary");
    const isPlain = !typing && !event.altKey && !event.ctrlKey && !event.metaKey;
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !event.target.matches("input[type=text], input[type=number], input[type=search]")) {
      event.preventDefault();
      (event.shiftKey ? redo : undo)();
    } else if (isPlain && event.key === " " && !event.target.closest("button")) {
      event.preventDefault();
      setPlaying(!playing);
    } else if (isPlain && event.key === "ArrowRight") step(true);
    else if (isPlain && event.key === "ArrowLeft") step(false);
    else if (event.key === "Escape") find("export").open = false;
  });
  document.addEventListener("click", (event) => { if (!event.target.closest("#export")) find("export").open = false; });
}

function maps() {
  for (const [name, { text }] of Object.entries(SHOWN)) find("diagram-shown").append(new Option(text, name));
  const edit = (id, act) => find(id).addEventListener("change", (event) => { change((state) => act(state, event.target.value)); commit(); });
  edit("diagram-shown", (state, text) => { state.diagram.shown = text; });
  edit("diagram-name", (state, text) => { state.diagram = { name: text, shown: state.diagram.shown }; });
  const number = (text) => (text === "" ? undefined : Number(text));
  edit("diagram-from", (state, text) => { state.diagram.from = number(text); });
  edit("diagram-to", (state, text) => { state.diagram.to = number(text); });
  edit("map-x", (state, text) => { state.map.x = text; });
  edit("map-y", (state, text) => { state.map.y = text; });
}

function changed() {
  say("");
  fields();
  ask();
  show();
  diagram.later();
  map.later();
}

/** What tests ask the page for. */
window.videg = {
  get shown() { return shown; },
  get clock() { return clock; },
  set clock(time) { clock = time; },
  /** Questions that were answered, also by a refusal, and whether none waits. */
  get answers() { return answers; },
  get settled() { return !engine.asked && !engine.waiting; },
  state, engine, machine, set, device, locate,
  frames: () => [...times],
  forget: () => { times.length = 0; },
  diagram, map,
};

async function start() {
  toolbar();
  transport();
  maps();
  keys();
  build(find("groups"), find("filter"), chosen, say);
  find("footer").textContent = `videg ${version}. Computed in this page by the library itself; nothing is loaded or sent.`;
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => { event.preventDefault(); if (event.dataTransfer.files[0]) take(null, event.dataTransfer.files[0], say); });
  const again = () => {
    Object.values(plots).forEach((plot) => plot.redraw());
    diagram.paint();
    map.paint();
    if (shown) scene();
  };
  new ResizeObserver(again).observe(document.querySelector("main"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
  const address = async () => { const left = await read(); if (left.length) say(left.join("\n"), "address"); };
  window.addEventListener("hashchange", address);
  listen(changed, fields);
  await address();
  changed();
  requestAnimationFrame(frame);
}

start();
