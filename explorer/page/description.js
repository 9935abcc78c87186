// Variables and cases, as the program that made this page knows them.
import { meaning } from "./format.js";

// JSON knows no infinity, which a load resistance may be.
const data = JSON.parse(document.getElementById("description").textContent, (_, found) => (found === "Infinity" ? Infinity : found));

export const version = data.version;
export const initial = data.state;
export const cases = data.cases;

/** Parameters of exponential diodes, and of what solves their equations. */
const EXPONENTIAL = /^(diode\.(?!model)|zener\.(?!voltage)|switch\.|solver\.)/;

/** Where a parameter is of no effect: [its name, the name of another one, values of that for which it counts]. */
const CONDITIONS = [
  [/^membrane\.ogden/, "membrane.law", ["ogden"]],
  [/^membrane\.stiffness/, "membrane.law", ["power"]],
  [/^membrane\.relaxationTime$/, "membrane.law", ["gent", "ogden"]],
  [/^membrane\.file$/, "membrane.law", ["table"]],
  [/^excitation\.amplitude$/, "excitation.kind", ["force"]],
  [/^cylinder\.suspension/, "excitation.kind", ["force"]],
  [EXPONENTIAL, "diode.model", ["exponential"]],
  [/^storage\.voltage$/, "release", ["storage"]],
  [/^(zener\.voltage|load\.resistance)$/, "release", ["zener", "switch"]],
];

/** Ranges of sliders for parameters that start at 0 or may have either sign. All others go from a tenth to ten times the case's value. */
const RANGES = {
  "ball.friction": [0, 1],
  "cylinder.inclination": [-1.571, 1.571],
  "cylinder.suspensionStiffness": [0, 100],
  "cylinder.suspensionDamping": [0, 2],
  "excitation.acceleration": [0, 50],
  "excitation.phase": [-3.1416, 3.1416],
  "excitation.phaseNoise": [0, 4],
  "excitation.fileScale": [-5, 5],
  "excitation.fileOffset": [-10, 10],
  "initial.cylinderPosition": [-0.05, 0.05],
  "initial.cylinderVelocity": [-1, 1],
  "initial.ballPosition": [-0.05, 0.05],
  "initial.ballVelocity": [-1, 1],
  "leakage.timeConstant": [0, 200],
  "membrane.ogdenModulus1": [0, 2e5],
  "membrane.ogdenModulus2": [-1e5, 1e5],
  "membrane.ogdenModulus3": [-1e5, 1e5],
  "membrane.prestretch": [1, 6],
  "membrane.relaxationTime": [0, 1],
  "membrane.viscousModulus": [0, 1e5],
  "biasVoltage": [200, 6000],
  "supply.voltage": [200, 6000],
  "zener.voltage": [200, 10000],
  "storage.voltage": [200, 10000],
};
const LOGARITHMIC = { "load.resistance": [1e6, 1e13], "zener.breakdownCurrent": [1e-13, 1] };

const TITLES = {
  cylinder: "Cylinder and mount", ball: "Ball", membrane: "Membrane", contact: "Contact", excitation: "Excitation", initial: "Start",
  circuit: "Circuit", diode: "Diodes",
};

function group(name, part) {
  const head = name.split(".")[0];
  if (name === "frame.width" || name === "gravity") return "cylinder";
  if (name === "diode.model" || EXPONENTIAL.test(name)) return "diode";
  return name === "biasVoltage" || part === "circuit" ? "circuit" : head;
}

function condition(variable) {
  const known = CONDITIONS.find(([pattern]) => pattern.test(variable.name));
  if (known) return { name: known[1], values: known[2] };
  const said = /\((\w+\.\w+) = (\w+)(?: or (\w+))?[,)]/.exec(variable.description);
  return said ? { name: said[1], values: said.slice(2).filter(Boolean) } : null;
}

export const variables = data.variables.map((variable) => ({
  ...variable,
  min: variable.min ?? -Infinity,
  max: variable.max ?? Infinity,
  ...meaning(variable.description),
  group: group(variable.name, variable.part),
  condition: condition(variable),
}));

const byName = new Map(variables.map((variable) => [variable.name, variable]));

/** The variable called `name`, if there is one. */
export const variable = (name) => byName.get(name);

/** Groups of variables, in the order of the reference. */
export const groups = Object.entries(TITLES).map(([key, title]) => ({ key, title, variables: variables.filter((it) => it.group === key) }));

/** Range of the slider of a number whose value in the case is `base`, and whether it is logarithmic. */
export function range(variable, base) {
  const { name, min, max } = variable;
  const clamp = ([low, high]) => [Math.max(low, min), Math.min(high, max)];
  if (LOGARITHMIC[name]) return { low: LOGARITHMIC[name][0], high: LOGARITHMIC[name][1], log: true };
  if (RANGES[name]) {
    const [low, high] = clamp(RANGES[name]);
    return { low, high, log: false };
  }
  if (!variable.unit && max - min <= 20) return { low: min, high: max, log: false };
  const middle = base > 0 ? base : variable.start > 0 ? variable.start : 1;
  const [low, high] = clamp([middle / 10, middle * 10]);
  return { low, high, log: true };
}
