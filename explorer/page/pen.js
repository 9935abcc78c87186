// The part of a canvas's interface that the charts use, as SVG.

/** A text within SVG. */
export const escape = (text) => String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
const fixed = (number) => String(Math.round(number * 100) / 100);

export class SvgPen {
  constructor() {
    Object.assign(this, { strokeStyle: "#000", fillStyle: "#000", lineWidth: 1, font: "12px sans-serif", textAlign: "start", textBaseline: "alphabetic", globalAlpha: 1 });
    this.parts = [];
    this.path = "";
    this.dash = "";
    this.clips = 0;
    this.open = 0;
  }

  beginPath() { this.path = ""; }
  moveTo(x, y) { this.path += `M${fixed(x)} ${fixed(y)}`; }
  lineTo(x, y) { this.path += `L${fixed(x)} ${fixed(y)}`; }
  closePath() { this.path += "Z"; }
  rect(x, y, width, height) { this.path += `M${fixed(x)} ${fixed(y)}h${fixed(width)}v${fixed(height)}h${fixed(-width)}Z`; }
  arc(x, y, radius) { this.path += `M${fixed(x - radius)} ${fixed(y)}a${fixed(radius)} ${fixed(radius)} 0 1 0 ${fixed(2 * radius)} 0a${fixed(radius)} ${fixed(radius)} 0 1 0 ${fixed(-2 * radius)} 0`; }
  setLineDash(dash) { this.dash = dash.join(" "); }

  stroke() {
    const dash = this.dash ? ` stroke-dasharray="${this.dash}"` : "";
    this.parts.push(`<path d="${this.path}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" opacity="${this.globalAlpha}"${dash}/>`);
  }

  fill() { this.parts.push(`<path d="${this.path}" fill="${this.fillStyle}" opacity="${this.globalAlpha}"/>`); }
  fillRect(x, y, width, height) { this.parts.push(`<rect x="${fixed(x)}" y="${fixed(y)}" width="${fixed(width)}" height="${fixed(height)}" fill="${this.fillStyle}" opacity="${this.globalAlpha}"/>`); }

  fillText(text, x, y) {
    const anchor = { right: "end", center: "middle" }[this.textAlign] ?? "start";
    const shift = { middle: 4, top: 10 }[this.textBaseline] ?? 0;
    this.parts.push(`<text x="${fixed(x)}" y="${fixed(y + shift)}" text-anchor="${anchor}" fill="${this.fillStyle}" style="font:${this.font}">${escape(text)}</text>`);
  }

  save() { this.parts.push(""); }
  restore() { while (this.open > 0) { this.parts.push("</g>"); this.open -= 1; } }

  clip() {
    // Pictures with several charts need names that differ.
    const name = `clip${SvgPen.count++}`;
    this.parts.push(`<clipPath id="${name}"><path d="${this.path}"/></clipPath><g clip-path="url(#${name})">`);
    this.open += 1;
  }

  text() { return this.parts.join("\n"); }
}
SvgPen.count = 0;
