// Computes what the page asks for, in a thread of its own. A message is { id, machine, texts, job, ... }; the answer has the same id.

let machine = null;
let names = null;
// Settles once the model can be called: questions may come before.
let ready = null;
// Texts of files by number, and the numbers of those that the machine has read.
const texts = new Map();
const taken = new Map();

async function start(module) {
  await wasm_bindgen({ module_or_path: module });
  const { Machine, Outcome } = wasm_bindgen;
  names = { outcome: Outcome.names(), derived: Machine.derivedNames(), motion: Machine.motionNames() };
  machine = new Machine();
}

/** Gives the machine a file, or takes it away. */
function takeFile(name, id) {
  if (taken.get(name) === id) return;
  taken.delete(name);
  const text = id === undefined ? "" : texts.get(id);
  if (name === "excitation.file") machine.setRecording(text);
  else machine.setTable(text);
  taken.set(name, id);
}

/** Sets the machine: numbers by name, and files by number. */
function set({ values, files }) {
  for (const name of ["excitation.file", "membrane.file"]) takeFile(name, files[name]);
  machine.clear();
  for (const [name, value] of values) machine.set(name, value);
}

/** What a picture of the motion and the numbers beside it need. */
function live({ from, until, begin, end, spacing }) {
  const began = performance.now();
  const outcome = machine.run(from, until);
  const took = performance.now() - began;
  const named = (keys, values) => Object.fromEntries(keys.map((key, index) => [key, values[index]]));
  const result = {
    numbers: named(names.outcome, outcome.values()),
    warnings: outcome.warnings(),
    derived: named(names.derived, machine.derived()),
    voltages: machine.voltages(until),
    deflectionLimit: machine.deflectionLimit(),
    rows: machine.motion(begin, end, spacing, until),
    columns: names.motion,
    impacts: machine.impacts(begin, end),
    begin, end, took,
  };
  outcome.free();
  return result;
}

/** A bifurcation diagram, some columns at a time. */
function* diagram({ name, values, transient, points, shown }) {
  const chunk = 10;
  for (let first = 0; first < values.length; first += chunk) {
    const part = values.slice(first, first + chunk);
    yield { first, columns: machine.diagram(name, part, transient, points, wasm_bindgen.Shown[shown]) };
  }
}

/** Net power over two parameters, row by row. */
function* power({ x, xs, y, ys, from, until }) {
  const map = new wasm_bindgen.Map(machine, x, xs, y, from, until);
  try {
    for (let row = 0; row < ys.length; row++) yield { row, cells: map.row(ys[row]), fault: map.fault() };
  } finally {
    map.free();
  }
}

const jobs = {
  live: (message) => [live(message)],
  diagram,
  power,
  capacitances: ({ until, reader, title }) => [machine.exportCapacitances(until, wasm_bindgen.Reader[reader], title)],
};

self.onmessage = async ({ data }) => {
  if (data.module) {
    ready = start(data.module);
    // A question waits for it, too, and says what is wrong.
    ready.catch(() => {});
    return;
  }
  const { id } = data;
  try {
    await ready;
    for (const [number, text] of data.texts) texts.set(number, text);
    set(data.machine);
    for (const part of jobs[data.job](data)) self.postMessage({ id, part });
    self.postMessage({ id, done: true });
  } catch (error) {
    // A text is what the library says; anything else is a fault, after which the model may be in any state.
    self.postMessage({ id, error: String(error), isFault: typeof error !== "string" });
  }
};
