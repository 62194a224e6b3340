// How each instrument stands: spindle above, table below, what reads between them, and what is seen of it.
import { put } from "/pictures.js";

const SPINDLE = "M52 2h26v16h-8v8h-10v-8h-8z", TABLE = "M8 84h114v8H8z";

function device(svg, parts) {
  for (const [name, attributes] of parts) put(svg, name, { class: "device", ...attributes });
}

function light(svg, d) {
  put(svg, "path", { class: "beam", d });
}

const tool = (svg, to) => put(svg, "line", { class: "holds", x1: 65, y1: 26, x2: 65, y2: to });

const DRAWINGS = {
  interferometer(svg) {
    tool(svg, 40);
    device(svg, [["rect", { x: 57, y: 40, width: 16, height: 14 }], ["rect", { x: 4, y: 38, width: 26, height: 18, rx: 2 }], ["path", { d: "M17 56v28" }]]);
    light(svg, "M30 44H57M30 50H57");
  },
  indicator(svg) {
    tool(svg, 34);
    device(svg, [["circle", { cx: 65, cy: 44, r: 10 }], ["path", { d: "M65 44l5-6M65 54v12" }], ["rect", { x: 44, y: 66, width: 42, height: 18 }]]);
  },
  probe(svg) {
    tool(svg, 60);
    device(svg, [["circle", { cx: 65, cy: 62, r: 3 }], ["rect", { x: 44, y: 66, width: 42, height: 18 }]]);
  },
  sphere(svg) {
    tool(svg, 42);
    device(svg, [["circle", { cx: 65, cy: 44, r: 3 }], ["circle", { cx: 65, cy: 58, r: 11 }], ["path", { d: "M65 69v15" }]]);
  },
  straightedge(svg) {
    tool(svg, 32);
    device(svg, [["circle", { cx: 65, cy: 41, r: 9 }], ["path", { d: "M65 50v12" }], ["rect", { x: 12, y: 62, width: 106, height: 12 }], ["path", { d: "M24 74v10M106 74v10" }]]);
  },
  level(svg) {
    device(svg, [["rect", { x: 34, y: 68, width: 62, height: 16, rx: 2 }], ["rect", { x: 52, y: 71, width: 26, height: 7, rx: 3 }], ["circle", { cx: 66, cy: 74.5, r: 2.5 }]]);
  },
  autocollimator(svg) {
    device(svg, [["rect", { x: 4, y: 52, width: 32, height: 14, rx: 2 }], ["path", { d: "M20 66v18M82 44v30" }], ["rect", { x: 82, y: 44, width: 6, height: 40 }]]);
    light(svg, "M36 56H82M36 62H82");
  },
  ballbar(svg) {
    tool(svg, 40);
    device(svg, [["circle", { cx: 65, cy: 43, r: 4 }], ["circle", { cx: 28, cy: 72, r: 4 }], ["path", { d: "M61 46L31 69M28 76v8" }]]);
  },
  rtest(svg) {
    tool(svg, 44);
    device(svg, [["circle", { cx: 65, cy: 52, r: 8 }], ["path", { d: "M30 52h26M100 52H74M65 80V61M30 52v32M100 52v32" }]]);
  },
  tracker(svg) {
    tool(svg, 38);
    device(svg, [["circle", { cx: 65, cy: 42, r: 5 }], ["circle", { cx: 18, cy: 62, r: 8 }], ["path", { d: "M18 70v14" }]]);
    light(svg, "M26 59L60 44");
  },
};
DRAWINGS.tracer = DRAWINGS.tracker;

export function drawSetup(place, instrument, words) {
  place.replaceChildren();
  const svg = put(place, "svg", { viewBox: "0 0 130 96", role: "img", "aria-label": words, class: "standing" });
  put(svg, "path", { class: "machine", d: SPINDLE });
  put(svg, "path", { class: "machine", d: TABLE });
  (DRAWINGS[instrument] ?? DRAWINGS.indicator)(svg);
}
