// Numbers and symbols as a reader expects them.

const PREFIXES = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "\u00b5"], [1e-9, "n"], [1e-12, "p"], [1e-15, "f"]];
/** Units that take a prefix; kg has one, and those made of several would take it for the first. */
const TAKES_PREFIX = /^(A|C|F|Hz|J|N|Ohm|Pa|V|W|m|s)$/;

/** A number with `digits` significant digits, without zeros at its end. */
export function short(value, digits = 4) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "none" : value > 0 ? "inf" : "-inf";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return Number(value.toPrecision(digits)).toExponential().replace("e+", "e");
  return String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size))))));
}

/** A quantity, with a prefix before its unit where it takes one. */
export function quantity(value, unit, digits = 4) {
  if (!Number.isFinite(value) || !TAKES_PREFIX.test(unit)) return `${short(value, digits)} ${unit}`.trimEnd();
  const size = Math.abs(value);
  const [factor, prefix] = size === 0 ? [1, ""] : PREFIXES.find(([factor]) => size >= factor) ?? PREFIXES.at(-1);
  return `${Number((value / factor).toPrecision(digits))} ${prefix}${unit}`;
}

/** The largest of many numbers. */
export function largest(...lists) {
  let most = -Infinity;
  for (const list of lists) for (const value of list) if (value > most) most = value;
  return most;
}

const GREEK = { lambda: "\u03bb", epsilon: "\u03b5", sigma: "\u03c3", beta: "\u03b2", mu: "\u03bc", alpha: "\u03b1", tau: "\u03c4", gamma: "\u03b3" };

/** The symbol of a variable and what it means: descriptions begin with the symbol and a colon. */
export function meaning(description) {
  const found = /^([A-Za-z_0-9'()]{1,10}): (.*)$/s.exec(description);
  return found ? { symbol: found[1], text: found[2] } : { symbol: "", text: description };
}

/** A symbol such as `epsilon_r` as a node of a page. */
export function symbolNode(symbol) {
  const node = document.createElement("i");
  const [, head, sub, rest] = /^([A-Za-z]+)_?([A-Za-z0-9]*)(.*)$/.exec(symbol) ?? [null, symbol, "", ""];
  node.append(GREEK[head] ?? head);
  if (sub) {
    const lower = document.createElement("sub");
    lower.textContent = sub;
    node.append(lower);
  }
  node.append(rest);
  return node;
}
