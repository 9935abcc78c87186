// The case as files for the tool, Python and FMPy.
import { variable, version } from "./description.js";
import { state, value } from "./state.js";

const isCircuit = (name) => variable(name)?.part === "circuit";

/** Variables that differ from the case, with the names of files for those that are files. */
function changes() {
  const files = Object.entries(state.files).map(([name, file]) => [name, file.name]);
  return [...Object.entries(state.set), ...files];
}

const json = (wanted) => (wanted === Infinity ? null : JSON.stringify(wanted));

/** A case file of `videg`. */
export function toml() {
  const lines = changes().map(([name, wanted]) => `${name} = ${json(wanted) ?? "inf"}`);
  const head = [`# Made by the page of videg ${version}; videg cosim --case-file THIS_FILE`, `case = "${state.case}"`, `until = ${float(state.until)}`, `window = [${float(state.from)}, ${float(state.until)}]`];
  return `${[...head, "", "[set]", ...lines].join("\n")}\n`;
}

const float = (number) => (Number.isInteger(number) ? number.toFixed(1) : String(number));
const literal = (wanted) => (wanted === true ? "True" : wanted === false ? "False" : json(wanted) ?? 'float("inf")');

/** A script for the package `videg` of Python. */
export function python() {
  const lines = changes().map(([name, wanted]) => `    ${JSON.stringify(name)}: ${literal(wanted)},`);
  return `"""Made by the page of videg ${version}."""

import videg

changes = {
${lines.join("\n")}
}
run = videg.cosim(${JSON.stringify(state.case)}, set=changes, until=${float(state.until)}, window=(${float(state.from)}, ${float(state.until)}))
# Coupled in steps of 1 ms; the page is the limit of small steps.
print(f"net power {1e6 * run.net_power:.2f} uW, load {1e6 * run.load_power:.2f} uW, supply {1e6 * run.supply_power:.2f} uW")
`;
}

/** A script for FMPy: the mechanics, and C(t) at the end. */
export function fmpy(settings) {
  const all = Object.entries({ ...settings, ...Object.fromEntries(changes()) }).filter(([name]) => !isCircuit(name));
  const text = (name, wanted) => {
    const found = variable(name);
    if (found?.kind === "enumeration") return found.items.find((item) => item.name === wanted)?.value ?? Number(wanted);
    return literal(wanted);
  };
  const lines = all.map(([name, wanted]) => `    ${JSON.stringify(name)}: ${text(name, wanted)},`);
  return `"""Made by the page of videg ${version}: the FMU VibroImpactHarvester in FMPy."""

import fmpy

start_values = {
${lines.join("\n")}
}
outputs = ["left.capacitance", "right.capacitance", "impact.countReal"]
result = fmpy.simulate_fmu(
    "target/fmu/VibroImpactHarvester.fmu", start_values=start_values, output=outputs,
    stop_time=${float(state.until)}, output_interval=1e-3,
)
print(f"{result['impact.countReal'][-1]:.0f} impacts, C = {result['left.capacitance'][-1]:.6g} F")
`;
}

/** Lets the user keep a text as a file. */
export function save(name, text, type = "text/plain") {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** What the case is called in names of files and titles. */
export const caseName = () => (changes().length ? `${state.case}-changed` : state.case);
export const caseTitle = () => [`videg ${version}: ${state.case}`, ...changes().map(([name]) => `${name} = ${state.files[name]?.name ?? value(name)}`)].join("; ");
