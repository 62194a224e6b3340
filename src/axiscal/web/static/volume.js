// The volume in space: points coloured by error or by what is unknown, travels, way and balls; turned by dragging or by arrow keys.
import { put, shown } from "/pictures.js";

const COLOURS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]; // viridis: even steps, also in grey
const view = { turn: -0.6, tip: 0.45 };
let drawn = null;

function colour(share) {
  const at = Math.max(0, Math.min(0.9999, share)) * (COLOURS.length - 1), n = Math.floor(at);
  return `rgb(${COLOURS[n].map((c, k) => Math.round(c + (COLOURS[n + 1][k] - c) * (at - n))).join(",")})`;
}

// Where a point stands in the picture, and how near it is.
function projector(all, width, height) {
  const low = [0, 1, 2].map((k) => Math.min(...all.map((p) => p[k]))), high = [0, 1, 2].map((k) => Math.max(...all.map((p) => p[k])));
  const middle = low.map((v, k) => (v + high[k]) / 2), size = Math.hypot(...low.map((v, k) => high[k] - v)) || 1;
  const [ct, st, cp, sp] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tip), Math.sin(view.tip)];
  const scale = Math.min(width, height) / size;
  return (p) => {
    const [x, y, z] = p.map((v, k) => v - middle[k]);
    const across = ct * x - st * y, deep = st * x + ct * y;
    return [width / 2 + scale * across, height / 2 - scale * (cp * z + sp * deep), cp * deep - sp * z];
  };
}

function draw() {
  const { place, outlook, shade, words } = drawn;
  place.replaceChildren();
  const width = Math.max(260, place.clientWidth), height = Math.min(380, Math.round(0.75 * width));
  const svg = put(place, "svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": words, tabindex: 0, class: "space" });
  const seen = projector([...outlook.box, ...outlook.points, ...outlook.way, ...outlook.balls.map((b) => b.at)], width, height - 46);
  for (const [a, b] of outlook.edges) {
    const [x1, y1] = seen(outlook.box[a]), [x2, y2] = seen(outlook.box[b]);
    put(svg, "line", { class: "travels", x1, y1, x2, y2 });
  }
  const values = outlook[shade], low = Math.min(...values), high = Math.max(...values), span = high - low || 1;
  outlook.points
    .map((p, n) => [...seen(p), values[n]])
    .sort((a, b) => b[2] - a[2])
    .forEach(([x, y, , v]) => put(svg, "circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 4, fill: colour((v - low) / span), "fill-opacity": 0.8 }));
  const way = outlook.way.map((p) => seen(p));
  const path = (points) => points.map(([x, y], n) => `${n ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
  if (way.length) {
    put(svg, "path", { class: "way coming", d: path(way.slice(Math.max(0, outlook.taken - 1))) });
    put(svg, "path", { class: "way", d: path(way.slice(0, outlook.taken)) });
    if (outlook.taken < way.length) put(svg, "circle", { class: "here", cx: way[outlook.taken][0], cy: way[outlook.taken][1], r: 7 });
  }
  for (const ball of outlook.balls) {
    const [x, y] = seen(ball.at);
    put(put(svg, "rect", { class: "ball", x: x - 5, y: y - 5, width: 10, height: 10, rx: 5 }), "title", {}, ball.name);
  }
  legend(svg, width, height, low, high);
  handle(svg);
}

function legend(svg, width, height, low, high) {
  const left = 52, right = width - 52, steps = 24;
  for (let n = 0; n < steps; n += 1)
    put(svg, "rect", { x: left + ((right - left) * n) / steps, y: height - 32, width: (right - left) / steps + 0.5, height: 9, fill: colour((n + 0.5) / steps) });
  put(svg, "text", { x: left, y: height - 8, "text-anchor": "middle" }, `${shown(low)} µm`);
  put(svg, "text", { x: right, y: height - 8, "text-anchor": "middle" }, `${shown(high)} µm`);
}

function turn(across, up) {
  view.turn += across;
  view.tip = Math.max(-1.5, Math.min(1.5, view.tip + up));
  const held = document.activeElement?.classList?.contains("space");
  draw();
  if (held) drawn.place.firstElementChild.focus();
}

function handle(svg) {
  svg.addEventListener("pointerdown", (event) => { drawn.from = [event.clientX, event.clientY]; });
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    turn(...step);
  });
}

addEventListener("pointermove", (event) => {
  if (!drawn?.from || !event.buttons) return;
  const [x, y] = drawn.from;
  drawn.from = [event.clientX, event.clientY];
  turn((event.clientX - x) / 120, (event.clientY - y) / 120);
});
addEventListener("pointerup", () => { if (drawn) drawn.from = null; });

export function drawVolume(place, outlook, shade, words) {
  drawn = { place, outlook, shade, words, from: null };
  draw();
}
