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

// The workpiece's x, y, z as the picture of the machine has them, and the way in which a reading is positive.
export function drawDirection(place, question, axes) {
  place.replaceChildren();
  const svg = put(place, "svg", { viewBox: "0 0 92 76", role: "img", "aria-label": question.sign });
  const seen = (way) => [0, 1].map((side) => [46, 38][side] + 28 * way.reduce((sum, c, n) => sum + c * axes[n][side], 0));
  const [ox, oy] = seen([0, 0, 0]);
  [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, n) => {
    const [x, y] = seen(axis), [tx, ty] = seen(axis.map((c) => 1.28 * c));
    put(svg, "line", { class: "axis-line", x1: ox, y1: oy, x2: x, y2: y });
    put(svg, "text", { x: tx, y: ty + 4, "text-anchor": "middle" }, "xyz"[n]);
  });
  for (const way of question.ways) arrow(svg, [ox, oy], seen(way), question.turns);
}

function arrow(svg, [ox, oy], [x, y], turns) {
  const length = Math.hypot(x - ox, y - oy) || 1, [dx, dy] = [(x - ox) / length, (y - oy) / length];
  put(svg, "line", { class: "sense-line", x1: ox, y1: oy, x2: x - 6 * dx, y2: y - 6 * dy });
  put(svg, "path", { class: "sense-tip", d: `M${x} ${y}l${-9 * dx - 5 * dy} ${-9 * dy + 5 * dx}l${10 * dy} ${-10 * dx}z` });
  if (turns) put(svg, "path", { class: "sense-line", d: `M${(ox + x) / 2 + 9 * dy} ${(oy + y) / 2 - 9 * dx}a9 9 0 1 0 ${-18 * dy} ${18 * dx}` });
}
