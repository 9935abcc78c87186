// Sliders and fields for all parameters.
import { groups, range } from "./description.js";
import { base, change, commit, counts, hold, keepFile, set, state, value } from "./state.js";
import { quantity, short, symbolNode } from "./format.js";

const STEPS = 1000;

/** The pieces of the page that show a variable, by its name. */
const rows = new Map();

const element = (name, attributes = {}, ...children) => {
  const node = document.createElement(name);
  for (const [key, wanted] of Object.entries(attributes)) node.setAttribute(key, wanted);
  node.append(...children);
  return node;
};

/** Makes the panel; `chosen` says what the model chooses for a voltage that is left open, and `say` shows a message. */
export function build(panel, filter, chosen, say) {
  for (const group of groups) {
    const details = element("details", { class: "group" }, element("summary", {}, group.title));
    details.open = ["membrane", "excitation", "circuit"].includes(group.key);
    for (const variable of group.variables) details.append(row(variable, chosen, say));
    panel.append(details);
  }
  const run = element("details", { class: "group" }, element("summary", {}, "Run"));
  run.append(timeField("until", "End of the run", say), timeField("from", "Averages from", say));
  panel.append(run);
  filter.addEventListener("input", () => search(panel, filter.value.trim().toLowerCase()));
}

/** Shows what has `wanted` in its name or description, in whatever group it is. */
function search(panel, wanted) {
  for (const [name, { node, variable }] of rows) {
    node.classList.toggle("filtered", wanted !== "" && !`${name} ${variable.description}`.toLowerCase().includes(wanted));
  }
  const isSearching = panel.classList.contains("searching");
  for (const group of panel.querySelectorAll(".group")) {
    if (wanted !== "") {
      if (!isSearching) group.dataset.open = group.open;
      const has = group.querySelector(".row:not(.filtered)") !== null;
      group.open = has;
      group.hidden = !has;
    } else if (isSearching) {
      group.open = group.dataset.open === "true";
      group.hidden = false;
    }
  }
  panel.classList.toggle("searching", wanted !== "");
}

function timeField(key, text, say) {
  const input = element("input", { type: "number", min: "0", step: "any", id: `time-${key}` });
  input.addEventListener("change", () => {
    const number = Number(input.value);
    const fits = input.value !== "" && number >= 0 && (key === "until" ? number > 0 : number < state.until);
    input.toggleAttribute("aria-invalid", !fits);
    if (!fits) return say(`${text}: ${input.value || "nothing"} s: allowed: ${key === "until" ? "above 0" : `0 to below ${state.until}`} s`);
    change((state) => {
      state[key] = number;
      // An end before the window moves the window.
      if (state.from >= state.until) state.from = state.until / 2;
    });
    commit();
  });
  const node = element("div", { class: "row" }, element("label", { for: input.id }, text), input, element("span", { class: "unit" }, "s"));
  rows.set(`time.${key}`, { node, variable: { description: text }, show: () => {
    if (document.activeElement === input) return;
    input.value = state[key];
    input.removeAttribute("aria-invalid");
  } });
  return node;
}

function row(variable, chosen, say) {
  const id = `value-${variable.name.replaceAll(".", "-")}`;
  const label = element("label", { for: id, title: `${variable.name}: ${variable.description}` });
  if (variable.symbol) label.append(symbolNode(variable.symbol), " ");
  label.append(element("span", { class: "name" }, variable.name));
  const node = element("div", { class: `row ${variable.kind}`, "data-name": variable.name }, label);
  const make = { real: number, integer: number, boolean: toggle, enumeration: choice, string: file }[variable.kind];
  const show = make(variable, id, node, chosen, say);
  const back = element("button", { class: "back", title: `Back to the value of the case`, "aria-label": `${variable.name}: back to the value of the case` }, "\u21ba");
  back.addEventListener("click", () => variable.kind === "string" ? change((state) => { delete state.files[variable.name]; }) : set(variable.name, undefined));
  node.append(back);
  if (variable.condition) node.append(element("span", { class: "condition" }, `counts only with ${variable.condition.name} = ${variable.condition.values.join(" or ")}`));
  rows.set(variable.name, { node, variable, show });
  return node;
}

/** A number: a slider over a sensible range, and a field for all that is allowed. */
function number(variable, id, node, chosen, say) {
  const { name, unit } = variable;
  const field = element("input", { type: "text", inputmode: "decimal", id, autocomplete: "off", "aria-label": `${name}${unit ? `, ${unit}` : ""}` });
  const isCount = variable.kind === "integer";
  const slider = isCount ? null : element("input", { type: "range", min: "0", max: String(STEPS), step: "1", "aria-label": `${name}, slider` });
  const present = () => value(name) ?? chosen(name);
  const bounds = () => range(variable, base(name) ?? chosen(name) ?? 1);
  field.addEventListener("change", () => {
    const text = field.value.trim();
    const wanted = text === "inf" ? Infinity : Number(text);
    const { min, max } = variable;
    const fits = text !== "" && wanted >= min && wanted <= max && (!isCount || Number.isInteger(wanted));
    if (fits) {
      field.removeAttribute("aria-invalid");
      set(name, wanted);
      field.value = short(wanted, 6);
    } else {
      field.setAttribute("aria-invalid", "true");
      say(`${name} = ${text || "nothing"}: allowed: ${isCount ? "whole numbers " : ""}${short(min)} to ${short(max)}${unit ? ` ${unit}` : ""}`);
    }
    commit();
  });
  slider?.addEventListener("input", () => {
    const { low, high, log } = bounds();
    const part = slider.value / STEPS;
    const wanted = log ? low * (high / low) ** part : low + (high - low) * part;
    set(name, Number(wanted.toPrecision(4)));
  });
  slider?.addEventListener("pointerdown", hold);
  for (const name of ["change", "pointerup", "pointercancel"]) slider?.addEventListener(name, commit);
  const line = element("div", { class: "line" });
  if (slider) line.append(slider);
  line.append(field, element("span", { class: "unit" }, unit ?? ""));
  node.append(line);
  return () => {
    const shown = present();
    // Whoever types is not disturbed.
    if (document.activeElement !== field) {
      field.value = shown === undefined ? "" : short(shown, 6);
      field.removeAttribute("aria-invalid");
    }
    field.title = shown !== undefined && value(name) === undefined ? "follows from the harvester until a value is given" : "";
    const { low, high, log } = bounds();
    if (slider && shown !== undefined) {
      const part = log ? Math.log(shown / low) / Math.log(high / low) : (shown - low) / (high - low);
      slider.value = Math.round(STEPS * Math.min(1, Math.max(0, Number.isNaN(part) ? 0 : part)));
      slider.setAttribute("aria-valuetext", quantity(shown, unit ?? ""));
    }
  };
}

function toggle(variable, id, node) {
  const box = element("input", { type: "checkbox", id });
  box.addEventListener("change", () => { set(variable.name, box.checked); commit(); });
  node.append(element("div", { class: "line" }, box));
  return () => { box.checked = value(variable.name) === true; };
}

function choice(variable, id, node) {
  const select = element("select", { id });
  for (const item of variable.items) select.append(element("option", { value: item.name, title: item.description ?? "" }, item.name));
  select.addEventListener("change", () => { set(variable.name, select.value); commit(); });
  node.append(element("div", { class: "line" }, select));
  return () => { select.value = value(variable.name); };
}

/** A file, chosen or dropped. */
function file(variable, id, node, _, say) {
  const input = element("input", { type: "file", id, accept: ".csv,text/csv,text/plain" });
  const name = element("span", { class: "file" });
  input.addEventListener("change", () => { if (input.files[0]) take(variable.name, input.files[0], say); input.value = ""; });
  node.addEventListener("dragover", (event) => event.preventDefault());
  node.addEventListener("drop", (event) => {
    event.preventDefault();
    event.stopPropagation();
    if (event.dataTransfer.files[0]) take(variable.name, event.dataTransfer.files[0], say);
  });
  node.append(element("div", { class: "line" }, input, name));
  return () => { name.textContent = state.files[variable.name]?.name ?? "none; choose a CSV file or drop it here"; };
}

/** Largest file, bytes: a million rows. */
const LARGEST = 2 ** 26;

/** Takes a file for the variable `name`, or by its heading if that is open. */
export async function take(name, given, say) {
  if (given.size > LARGEST) return say(`${given.name}: ${given.size} bytes; at most ${LARGEST} are read`);
  const text = await given.text();
  const heading = text.split("\n").find((line) => line.trim() !== "" && !line.startsWith("#")) ?? "";
  const target = name ?? (heading.includes("deflection") ? "membrane.file" : heading.includes("time") ? "excitation.file" : null);
  if (!target) return say(`${given.name}: its heading is neither that of a recording (time,acceleration or time,force) nor of a membrane (deflection,force)`);
  change((state) => {
    state.files[target] = keepFile(given.name.replaceAll(",", "_"), text);
    if (target === "membrane.file") state.set["membrane.law"] = "table";
    if (target === "excitation.file") state.set["excitation.kind"] = heading.includes("force") ? "force" : "motion";
  });
  commit();
}

/** Shows the present values. */
export function show() {
  for (const [name, { node, variable, show }] of rows) {
    show();
    if (!variable.kind) continue;
    node.classList.toggle("off", !counts(variable));
    node.classList.toggle("changed", name in state.set || name in state.files);
  }
}
