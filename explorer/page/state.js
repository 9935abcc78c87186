// What the user has chosen, its history, and its text in the address of the page.
import { cases, initial, variable } from "./description.js";

/** Longest file that a link carries, in letters of its compressed text, and in bytes of its own. */
const LONGEST = 24000;
const LARGEST = 2 ** 23;
/** Steps back that are kept. */
const STEPS = 200;

export const SPANS = [1, 2, 4, 8, 20, 60];
export const SHOWN = {
  Speed: { text: "relative speed of impacts, m/s", factor: 1 },
  Phase: { text: "phase of impacts in the period", factor: 1 },
  Interval: { text: "periods from impact to impact", factor: 1 },
  Voltage: { text: "U_DE4 of impacts at biasVoltage, V", factor: 1 },
  Displacement: { text: "relative displacement each period, mm", factor: 1e3 },
};

const DEFAULT = {
  case: "fig14", set: {}, files: {}, until: 100, from: 50, begin: 50, span: 4,
  diagram: { name: "membrane.restitution", shown: "Speed" }, map: { x: "zener.voltage", y: "load.resistance" },
};

/** Voltages that follow from the harvester where none is given. */
const CHOSEN = new Set(["supply.voltage", "zener.voltage", "storage.voltage"]);

// Texts of files by number: the state and its history have only the numbers.
const texts = [];

/** Keeps a file for the state. */
export function keepFile(name, text) {
  return { name, id: texts.push({ name, text, packed: null }) - 1 };
}

/** The text of the file with this number. */
export const textOf = (id) => texts[id].text;

const begun = structuredClone(initial ?? {});
for (const [name, file] of Object.entries(begun.files ?? {})) begun.files[name] = keepFile(file.name, file.text);

export const state = { ...structuredClone(DEFAULT), ...begun };

// JSON knows no infinity, which a load resistance may be.
const INFINITE = "Infinity";
const pack = () => JSON.stringify(state, (_, wanted) => (wanted === Infinity ? INFINITE : wanted));
const unpack = (text) => JSON.parse(text, (_, wanted) => (wanted === INFINITE ? Infinity : wanted));

const listeners = [];
const historyListeners = [];
const past = [];
const future = [];
let kept = pack();
let timer = 0;
let held = false;

/** Calls `listener` after each change of the state, and `ofHistory` after each change of what can be undone. */
export function listen(listener, ofHistory) {
  listeners.push(listener);
  historyListeners.push(ofHistory);
}

const notify = () => listeners.forEach((listener) => listener());
const notifyHistory = () => historyListeners.forEach((listener) => listener());

export const published = () => cases.find((it) => it.name === state.case) ?? cases[0];

/** The value of a variable in the case, without what the user has set; undefined where it follows from others. */
export const base = (name) => published().settings[name] ?? (CHOSEN.has(name) ? undefined : variable(name)?.start);

/** The value of a variable; undefined where the model chooses it. */
export const value = (name) => state.set[name] ?? base(name);

/** Whether a variable has an effect at the present values of the others. */
export function counts({ condition }) {
  return !condition || condition.values.includes(value(condition.name));
}

/** Takes all changes up to the next commit as one: a drag is a single step, however long it takes. */
export function hold() {
  held = true;
  clearTimeout(timer);
}

/** Keeps the present state for undo, and puts it into the address. */
export function commit() {
  held = false;
  clearTimeout(timer);
  const now = pack();
  if (now === kept) return;
  past.push(kept);
  if (past.length > STEPS) past.shift();
  future.length = 0;
  kept = now;
  write();
  notifyHistory();
}

/** Changes the state by a function; it can be undone once the user has paused. */
export function change(edit) {
  edit(state);
  future.length = 0;
  clearTimeout(timer);
  if (!held) timer = setTimeout(commit, 400);
  notify();
  notifyHistory();
}

/** Sets a variable; undefined takes the case's value again. */
export function set(name, wanted) {
  change((state) => {
    if (wanted === undefined || wanted === base(name)) delete state.set[name];
    else state.set[name] = wanted;
  });
}

function assign(wanted) {
  for (const key of Object.keys(state)) delete state[key];
  Object.assign(state, wanted);
}

function restore(text) {
  assign(unpack(text));
  kept = text;
  write();
  notify();
  notifyHistory();
}

export const canUndo = () => past.length > 0 || pack() !== kept;
export const canRedo = () => future.length > 0;

export function undo() {
  commit();
  if (!past.length) return;
  future.push(kept);
  restore(past.pop());
}

export function redo() {
  commit();
  if (!future.length) return;
  past.push(kept);
  restore(future.pop());
}

/** What a stream makes of `bytes`, if that is not too large. */
async function pipe(bytes, stream) {
  const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader();
  const parts = [];
  let size = 0;
  for (;;) {
    const { done, value: part } = await reader.read();
    if (done) break;
    size += part.length;
    if (size > LARGEST) throw new Error(`more than ${LARGEST} bytes`);
    parts.push(part);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

const toBase64 = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const fromBase64 = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));

/** The text of a file for a link; empty if that would be too long. */
async function packed(id) {
  const file = texts[id];
  // Nothing packs to less than a thousandth.
  if (file.text.length > 1000 * LONGEST) return "";
  file.packed ??= pipe(new TextEncoder().encode(file.text), new CompressionStream("deflate-raw")).then((bytes) => (bytes.length * 4 > LONGEST * 3 ? "" : toBase64(bytes)), () => "");
  return file.packed;
}

/** The state as the fragment of an address, and names of files that are too long for it. */
export async function fragment() {
  const parts = new URLSearchParams({ case: state.case });
  for (const [name, wanted] of Object.entries(state.set)) parts.set(name, wanted);
  for (const key of ["until", "from", "begin", "span"]) {
    if (state[key] !== DEFAULT[key]) parts.set(key, state[key]);
  }
  const { diagram, map } = state;
  if (JSON.stringify(diagram) !== JSON.stringify(DEFAULT.diagram)) parts.set("diagram", [diagram.name, diagram.shown, diagram.from ?? "", diagram.to ?? ""].join(","));
  if (JSON.stringify(map) !== JSON.stringify(DEFAULT.map)) parts.set("map", [map.x, map.y].join(","));
  const left = [];
  for (const [name, file] of Object.entries({ ...state.files })) {
    const text = await packed(file.id);
    if (!text) left.push(file.name);
    parts.set(name, `${file.name},${text}`);
  }
  return { text: `#${parts}`, left };
}

let written = "";
let wasRead = false;
let writes = 0;

/** Puts the state into the address of the page. */
async function write() {
  const [number, before] = [++writes, location.hash];
  const { text } = await fragment();
  // Another one, or another address, may have overtaken it.
  if (number !== writes || location.hash !== before) return;
  written = text;
  try {
    history.replaceState(null, "", text);
  } catch {
    // Browsers bound how often an address may change; the next change has this one in it.
  }
}

/** A number, a choice or a switch as an address has it; an error says what it is not. */
function parse(found, text) {
  if (found.kind === "enumeration") {
    if (!found.items.some((item) => item.name === text)) throw new Error(`${found.name} = ${text}: allowed: ${found.items.map((item) => item.name).join(", ")}`);
    return text;
  }
  if (found.kind === "boolean") return text === "true";
  const number = text === "inf" || text === "Infinity" ? Infinity : Number(text);
  if (text.trim() === "" || Number.isNaN(number)) throw new Error(`${found.name} = ${text}: no number`);
  return number;
}

function real(what, name) {
  if (variable(name)?.kind !== "real") throw new Error(`${what} over ${name}: no such number`);
  return name;
}

/** A file as an address has it: its content, or its name alone, which the page may know. */
async function readFile(key, text) {
  const comma = text.indexOf(",");
  const [name, content] = [text.slice(0, comma), text.slice(comma + 1)];
  if (content === "") {
    const known = texts.findLastIndex((file) => file.name === name);
    if (known < 0) throw new Error(`${key} = ${name}: too long for a link; drop the file here`);
    return { name, id: known };
  }
  try {
    return keepFile(name, new TextDecoder().decode(await pipe(fromBase64(content), new DecompressionStream("deflate-raw"))));
  } catch {
    throw new Error(`${key} = ${name}: the link is damaged`);
  }
}

async function readPart(wanted, key, text) {
  if (key === "case") return;
  if (["until", "from", "begin"].includes(key)) {
    const number = Number(text);
    if (!(number >= 0) || text === "") throw new Error(`${key} = ${text}: no time`);
    wanted[key] = number;
  } else if (key === "span") {
    if (!SPANS.includes(Number(text))) throw new Error(`span = ${text}: allowed: ${SPANS.join(", ")}`);
    wanted.span = Number(text);
  } else if (key === "diagram") {
    const [name, shown, from, to] = text.split(",");
    if (!(shown in SHOWN)) throw new Error(`diagram of ${shown}: allowed: ${Object.keys(SHOWN).join(", ")}`);
    wanted.diagram = { name: real("diagram", name), shown, ...(from && to ? { from: Number(from), to: Number(to) } : {}) };
  } else if (key === "map") {
    const [x, y] = text.split(",").map((name) => real("map", name));
    if (y === undefined || x === y) throw new Error(`map over ${text}: two different numbers are wanted`);
    wanted.map = { x, y };
  } else {
    const found = variable(key);
    if (!found) throw new Error(`${key}: no such parameter`);
    if (found.kind === "string") wanted.files[key] = await readFile(key, text);
    else wanted.set[key] = parse(found, text);
  }
}

/** Takes the state from the address of the page; texts say what was left out. */
export async function read() {
  const isFirst = !wasRead;
  wasRead = true;
  if (location.hash.length < 2 || location.hash === written) return [];
  const parts = new URLSearchParams(location.hash.slice(1));
  const wanted = { ...structuredClone(DEFAULT), case: parts.get("case") ?? DEFAULT.case };
  const left = [];
  if (!cases.some((it) => it.name === wanted.case)) {
    left.push(`case ${wanted.case}: there is none; fig14 instead`);
    wanted.case = DEFAULT.case;
  }
  for (const [key, text] of parts) {
    await readPart(wanted, key, text).catch((error) => left.push(`${error.message}; left out`));
  }
  commit();
  assign(wanted);
  if (isFirst) {
    // What the page begins with is nothing to undo.
    kept = pack();
  } else {
    commit();
    notify();
  }
  return left;
}

/** The machine as the thread that computes takes it; files by number. */
export function machine() {
  const values = Object.entries({ ...published().settings, ...state.set }).map(([name, wanted]) => [name, number(name, wanted)]);
  const files = Object.fromEntries(Object.entries(state.files).map(([name, { id }]) => [name, id]));
  return { values, files };
}

/** A value as the number that the model takes. */
function number(name, wanted) {
  const found = variable(name);
  if (found?.kind === "boolean") return Number(wanted === true || wanted === "true");
  if (found?.kind === "enumeration") return found.items.find((item) => item.name === wanted)?.value ?? Number(wanted);
  return Number(wanted);
}
