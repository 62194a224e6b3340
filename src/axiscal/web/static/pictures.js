// Pictures drawn from numbers, as SVG; no text becomes markup.
import { DECIMAL, said } from "/words.js";

const SVG = "http://www.w3.org/2000/svg";

export function put(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

export function shown(value, digits = 1) {
  const text = value.toFixed(Math.abs(value) < 100 ? digits : 0);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−").replace(".", DECIMAL);
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
  for (const at of [expected.mean - half, expected.mean, expected.mean + half])
    put(svg, "text", { x: x(at), y: 42, "text-anchor": "middle" }, shown(at) + (at === expected.mean ? ` ${unitText(unit)}` : ""));
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

// The workpiece's x, y, z as seen from the front right, and the way in which a reading is positive.
export function drawDirection(place, question) {
  place.replaceChildren();
  const svg = put(place, "svg", { viewBox: "0 0 92 76", role: "img", "aria-label": question.sign });
  const seen = ([x, y, z]) => [38 + 26 * x + 15 * y, 50 + 9 * x - 13 * y - 34 * z];
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

function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((n) => n * power).find((s) => s >= raw);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(Number((k * step).toPrecision(12)));
  return found;
}

// Axes of a picture; returns where numbers stand in it.
function frame(place, height, across, up, labels) {
  const width = Math.max(260, place.clientWidth);
  const svg = put(place, "svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": labels.all });
  const left = 52, right = 22, top = 18, bottom = 36;
  const x = (v) => left + ((v - across[0]) / (across[1] - across[0])) * (width - left - right);
  const y = (v) => height - bottom - ((v - up[0]) / (up[1] - up[0])) * (height - top - bottom);
  for (const v of ticks(...up, 4)) {
    put(svg, "line", { class: "grid", x1: left, x2: width - right, y1: y(v), y2: y(v) });
    put(svg, "text", { x: left - 6, y: y(v) + 4, "text-anchor": "end" }, String(v).replace("-", "−"));
  }
  for (const v of ticks(...across, 6).filter((v) => labels.whole !== true || Number.isInteger(v)))
    put(svg, "text", { x: x(v), y: height - bottom + 16, "text-anchor": "middle" }, String(v).replace("-", "−"));
  put(svg, "line", { class: "frame", x1: left, x2: width - right, y1: height - bottom, y2: height - bottom });
  put(svg, "text", { x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, labels.across);
  put(svg, "text", { x: 4, y: 12 }, labels.up);
  return { svg, x, y, bottom: height - bottom, top, left, right: width - right };
}

function range(values) {
  const low = Math.min(...values), high = Math.max(...values), margin = 0.08 * (high - low) || 1;
  return [low - margin, high + margin];
}

function line(x, y, xs, ys) {
  return xs.map((v, n) => `${n ? "L" : "M"}${x(v).toFixed(1)} ${y(ys[n]).toFixed(1)}`).join("");
}

function dots(at, dots, latest) {
  for (const dot of dots) {
    const kind = ["dot", dot.same_side ? "" : "other", dot.doubted ? "doubted" : "", dot.number === latest ? "latest" : ""].join(" ");
    const circle = put(at.svg, "circle", { class: kind, cx: at.x(dot.at), cy: at.y(dot.value), r: dot.number === latest ? 6 : 4.5 });
    put(circle, "title", {}, said("reading {number}: {value}", { number: dot.number, value: shown(dot.value) }));
  }
}

function along(place, picture, latest) {
  const high = picture.mean.map((m, n) => m + picture.half[n]), low = picture.mean.map((m, n) => m - picture.half[n]);
  const values = picture.dots[0].map((dot) => dot.value);
  const near = picture.at.reduce((best, v, n) => (Math.abs(v - picture.next) < Math.abs(picture.at[best] - picture.next) ? n : best), 0);
  const focus = range([...values, ...picture.mean, high[near], low[near]]);
  const reach = [Math.min(...picture.at), Math.max(...picture.at)];
  const labels = { across: `${picture.axis}, ${unitText(picture.axis_unit)}`, up: unitText(picture.unit), all: said("Readings of {setup} along {axis}", picture) };
  const at = frame(place, 300, reach, focus, labels);
  const held = (v) => at.y(Math.max(focus[0], Math.min(focus[1], v)));
  const outline = line(at.x, held, [...picture.at, ...[...picture.at].reverse()], [...high, ...low.reverse()]);
  put(at.svg, "path", { class: "band", d: `${outline}Z` });
  put(at.svg, "path", { class: "mean", d: line(at.x, held, picture.at, picture.mean) });
  put(at.svg, "line", { class: "next", x1: at.x(picture.next), x2: at.x(picture.next), y1: at.top, y2: at.bottom });
  dots(at, picture.dots[0], latest);
}

const _RECENT = 12; // readings that decide how tall the picture is: earlier ones surprised more

function inOrder(place, picture, latest, expected) {
  const several = picture.dots.length > 1;
  picture.dots.forEach((row, number) => {
    if (!row.length) return;
    const shift = (dot) => ({ ...dot, value: dot.value - dot.mean, same_side: true });
    const moved = row.map(shift), widest = Math.max(row.at(-1).half, expected[number].half);
    const focus = range([...moved.slice(-_RECENT).map((dot) => dot.value), widest, -widest]), across = [0.5, Math.max(picture.next, 8) + 0.5];
    const up = several ? `${picture.names[number]}, ${unitText(picture.unit)}` : unitText(picture.unit);
    const labels = { across: several && number < picture.dots.length - 1 ? "" : said("readings of this set-up, in their order"), up, whole: true, all: said("Readings of {setup} in their order", picture) };
    const at = frame(place, several ? 150 : 280, across, focus, labels);
    const held = (v) => at.y(Math.max(focus[0], Math.min(focus[1], v)));
    const width = Math.min(18, (0.6 * (at.right - at.left)) / (across[1] - across[0]));
    for (const bar of [...row, { ...expected[number], at: picture.next }]) {
      const top = held(bar.half), bottom = held(-bar.half);
      put(at.svg, "rect", { class: "band", x: at.x(bar.at) - width / 2, width, y: top, height: Math.max(1, bottom - top) });
    }
    put(at.svg, "line", { class: "next", x1: at.x(picture.next), x2: at.x(picture.next), y1: at.top, y2: at.bottom });
    dots(at, moved.filter((dot) => dot.value > focus[0] && dot.value < focus[1]), latest);
  });
}

export function drawPicture(place, words, picture, latest, expected) {
  place.replaceChildren();
  words.textContent = "";
  if (!picture) return;
  const empty = picture.kind === "order" && !picture.dots[0].length;
  words.textContent = picture.kind === "along"
    ? said("Readings of {setup} along {axis}, and what is expected there ± 2 standard deviations; the dashed line is the next place", picture)
    : said("Readings of {setup} less what was expected before each; bars: ± 2 standard deviations", picture) + (empty ? said(". None yet") : "");
  if (picture.kind === "along") along(place, picture, latest);
  else inOrder(place, picture, latest, expected);
}

export function drawCourse(place, words, history, progress, forecast) {
  place.replaceChildren();
  words.textContent = "";
  if (!history.length) return;
  const now = { minutes: progress.minutes, rms_um: progress.now.rms_um }, coming = [now, ...forecast], end = coming.at(-1);
  const target = progress.target_rms_um, marks = [...history, ...coming].map((m) => m.rms_um);
  words.textContent = [
    said("Accuracy (RMS) against minutes of machine time"),
    forecast.length ? said("dotted: what the plan will reach") : "",
    target === null ? "" : said("dashed: the target"),
  ].filter((part) => part).join("; ");
  const labels = { across: said("minutes"), up: "µm", all: said("Accuracy against minutes") };
  const at = frame(place, 240, [0, Math.max(1, 1.03 * end.minutes)], [0, 1.08 * Math.max(...marks, target ?? 0)], labels);
  if (target !== null) put(at.svg, "line", { class: "target", x1: at.left, x2: at.right, y1: at.y(target), y2: at.y(target) });
  put(at.svg, "path", { class: "mean", d: line(at.x, at.y, history.map((m) => m.minutes), history.map((m) => m.rms_um)) });
  if (forecast.length) put(at.svg, "path", { class: "forecast", d: line(at.x, at.y, coming.map((m) => m.minutes), coming.map((m) => m.rms_um)) });
  put(at.svg, "circle", { class: "dot latest", cx: at.x(now.minutes), cy: at.y(now.rms_um), r: 6 });
}
