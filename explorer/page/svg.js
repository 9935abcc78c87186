// Nodes of a drawing.

const SPACE = "http://www.w3.org/2000/svg";

/** A node of SVG within `parent`, with a `text` in it. */
export function make(name, attributes, parent, text) {
  const node = document.createElementNS(SPACE, name);
  for (const [key, wanted] of Object.entries(attributes)) node.setAttribute(key, wanted);
  if (text !== undefined) node.textContent = text;
  parent.append(node);
  return node;
}
