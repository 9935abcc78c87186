// What the user has chosen, its history, and its text in the address of the page.
import { cases, initial, variable } from "./description.js";

/** Longest file that a link carries, in letters of its compressed text. */
const LONGEST = 24000;

const DEFAULT = {
  case: "fig14", set: {}, files: {}, until: 100, from: 50, begin: 50, span: 4,
  diagram: { name: "membrane.restitution", shown: "Speed" }, map: { x: "zener.voltage", y: "load.resistance" },
};

export const state = { ...structuredClone(DEFAULT), ...structuredClone(initial ?? {}) };

// JSON knows no infinity, which a load resistance may be.
const INFINITE = "Infinity";
const pack = () => JSON.stringify(state, (_, wanted) => (wanted === Infinity ? INFINITE : wanted));
const unpack = (text) => JSON.parse(text, (_, wanted) => (wanted === INFINITE ? Infinity : wanted));

const listeners = [];
const past = [];
const future = [];
let kept = pack();
let timer = 0;

/** Calls `listener` after each change. */
export const listen = (listener) => listeners.push(listener);

export const published = () => cases.find((it) => it.name === state.case) ?? cases[0];

/** The value of a variable in the case, without what the user has set. */
export function base(name) {
  return published().settings[name] ?? variable(name)?.start;
}

/** The value of a variable; undefined where the model chooses it. */
export const value = (name) => state.set[name] ?? base(name);

/** Whether a variable has an effect at the present values of the others. */
export function counts({ condition }) {
  return !condition || condition.values.includes(value(condition.name));
}

function notify() {
  for (const listener of listeners) listener();
}

/** Keeps the present state for undo, once the user has paused. */
function keep() {
  clearTimeout(timer);
  timer = setTimeout(commit, 400);
}

export function commit() {
  clearTimeout(timer);
  const now = pack();
  if (now === kept) return;
  past.push(kept);
  if (past.length > 200) past.shift();
  future.length = 0;
  kept = now;
  write();
  notify();
}

/** Changes the state by a function. */
export function change(edit) {
  edit(state);
  keep();
  notify();
}

/** Sets a variable; undefined takes the case's value again. */
export function set(name, wanted) {
  change((state) => {
    const same = wanted === undefined || wanted === base(name);
    if (same) delete state.set[name];
    else state.set[name] = wanted;
  });
}

function restore(text) {
  for (const key of Object.keys(state)) delete state[key];
  Object.assign(state, unpack(text));
  kept = text;
  write();
  notify();
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
  if (!future.length) return;
  past.push(kept);
  restore(future.pop());
}

const pipe = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
const toBase64 = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const fromBase64 = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));

/** The state as the fragment of an address, and files that are too long for it. */
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
  for (const [name, file] of Object.entries(state.files)) {
    const packed = toBase64(await pipe(new TextEncoder().encode(file.text), new CompressionStream("deflate-raw")));
    if (packed.length > LONGEST) left.push(file.name);
    else parts.set(name, `${file.name},${packed}`);
  }
  return { text: `#${parts}`, left };
}

let written = "";
let wasRead = false;

/** Puts the state into the address of the page. */
async function write() {
  const { text } = await fragment();
  written = text;
  history.replaceState(null, "", text);
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

async function readPart(read, key, text) {
  if (key === "case") return;
  if (["until", "from", "begin", "span"].includes(key)) {
    const number = Number(text);
    if (!(number >= 0)) throw new Error(`${key} = ${text}: no time`);
    read[key] = number;
  } else if (key === "diagram") {
    const [name, shown, from, to] = text.split(",");
    if (!variable(name)) throw new Error(`diagram over ${name}: no such parameter`);
    read.diagram = { name, shown, ...(from && to ? { from: Number(from), to: Number(to) } : {}) };
  } else if (key === "map") {
    const [x, y] = text.split(",");
    if (!variable(x) || !variable(y)) throw new Error(`map over ${x} and ${y}: no such parameters`);
    read.map = { x, y };
  } else {
    const found = variable(key);
    if (!found) throw new Error(`${key}: no such parameter`);
    if (found.kind === "string") {
      const [name, packed] = text.split(",");
      read.files[key] = { name, text: new TextDecoder().decode(await pipe(fromBase64(packed), new DecompressionStream("deflate-raw"))) };
    } else {
      read.set[key] = parse(found, text);
    }
  }
}

/** Takes the state from the address of the page; texts say what was left out. */
export async function read() {
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
  Object.assign(state, wanted);
  // The first address is what the page begins with.
  if (!wasRead) kept = pack();
  wasRead = true;
  commit();
  notify();
  return left;
}

/** The machine as the thread that computes takes it. */
export function machine() {
  const values = Object.entries({ ...published().settings, ...state.set }).map(([name, wanted]) => [name, number(name, wanted)]);
  const files = Object.fromEntries(["excitation.file", "membrane.file"].map((name) => [name, state.files[name]?.text ?? ""]));
  return { values, files };
}

/** A value as the number that the model takes. */
function number(name, wanted) {
  const found = variable(name);
  if (found?.kind === "boolean") return Number(wanted === true || wanted === "true");
  if (found?.kind === "enumeration") return found.items.find((item) => item.name === wanted)?.value ?? Number(wanted);
  return Number(wanted);
}
