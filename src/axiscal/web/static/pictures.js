// Pictures drawn from numbers, as SVG; no text becomes markup.
import { DECIMAL } from "/words.js";

const SVG = "http://www.w3.org/2000/svg";

export function put(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

export function shown(value, digits = Math.abs(value) < 100 ? 1 : 0) {
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−").replace(".", DECIMAL);
}

// A value of a band as exactly as two digits of its half.
export function rounded(value, half) {
  const digits = 1 - Math.floor(Math.log10(half)), step = 10 ** -digits;
  return shown(Math.round(value / step) * step, Math.min(Math.max(digits, 0), 9));
}

export function unitText(unit) {
  return { um: "µm", urad: "µrad", deg: "°" }[unit] ?? unit;
}

// The expectation of one number, its band, and what is typed.
export function strip(place, expected, value, far, unit, name = "") {
  const width = Math.max(260, place.clientWidth), height = 46, middle = 16;
  const svg = put(place, "svg", { viewBox: `0 0 ${width} ${height}` });
  const half = Math.max(expected.half, 1e-9), span = 2.5 * half;
  const x = (v) => width / 2 + (Math.max(-1, Math.min(1, (v - expected.mean) / span)) * (width - 60)) / 2;
  put(svg, "rect", { class: "band", x: x(expected.mean - half), y: middle - 11, width: x(expected.mean + half) - x(expected.mean - half), height: 22, rx: 3 });
  put(svg, "line", { class: "frame", x1: 20, x2: width - 20, y1: middle, y2: middle });
  for (const [n, at] of [expected.mean - half, expected.mean, expected.mean + half].entries())
    put(svg, "text", { x: x(at) + 12 * (1 - n), y: 42, "text-anchor": ["end", "middle", "start"][n] }, rounded(at, half) + (at === expected.mean ? ` ${unitText(unit)}` : ""));
  put(svg, "text", { x: 2, y: middle + 5 }, name);
  if (value === undefined) return;
  const beyond = Math.abs(value - expected.mean) > span;
  const mark = { class: far ? "typed far" : "typed" };
  if (!beyond) put(svg, "circle", { ...mark, cx: x(value), cy: middle, r: 8 });
  else {
    const side = value > expected.mean ? 1 : -1, tip = x(value) + side * 12;
    put(svg, "path", { ...mark, d: `M${tip} ${middle}l${-side * 18} -11v22z` });
  }
}
