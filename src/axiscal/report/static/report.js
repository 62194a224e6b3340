"use strict";
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const plots = [...document.querySelectorAll(".plot")];
  const root = document.documentElement;
  let view = "readings";
  let scale = "shared";

  // Colours and fonts stand in the figures as CSS variables: var(--accent).
  function resolved(value, style) {
    if (typeof value === "string") {
      const match = /^var\((--[a-z-]+)\)$/.exec(value);
      return match ? style.getPropertyValue(match[1]).trim() : value;
    }
    if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map((item) => resolved(item, style));
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, resolved(item, style)]));
  }

  // On a phone there is no room beside the lines: a legend above the picture names them instead.
  function withoutEndLabels(layout) {
    layout.margin.r = 12;
    layout.annotations = layout.annotations.filter((label) => label.x !== 1);
  }

  function draw(plot) {
    const source = figures[Number(plot.dataset.figure)];
    const figure = resolved(source, getComputedStyle(root));
    if (source.views) {
      const chosen = resolved(source.views[view], getComputedStyle(root));
      figure.data.forEach((trace, index) => {
        trace.x = chosen.x;
        trace.visible = !chosen.hidden.includes(index);
      });
      figure.layout.xaxis.title.text = chosen.title;
      figure.layout.xaxis.range = [0, Math.max(1, ...chosen.x)];
      figure.layout.annotations = chosen.annotations;
      if (plot.clientWidth < 560) withoutEndLabels(figure.layout);
    }
    if (source.ranges) figure.layout.yaxis.range = source.ranges[scale].slice();
    if (root.classList.contains("printing")) figure.layout.height *= 0.78;
    if (figure.layout.scene) figure.layout.height = Math.min(figure.layout.height, plot.clientWidth);
    if (plot.clientWidth > 0) figure.layout.width = plot.clientWidth;
    return Plotly.react(plot, figure.data, figure.layout, { displayModeBar: false, responsive: false, scrollZoom: false });
  }

  function drawAll(chosen = plots) {
    for (const plot of chosen) draw(plot);
  }

  // The page must be readable before thirty pictures are drawn.
  function drawInTurn(index = 0) {
    if (index === plots.length) {
      root.dataset.drawn = String(plots.length);
      return;
    }
    draw(plots[index]);
    setTimeout(drawInTurn, 0, index + 1);
  }

  function choose(button, attribute, set) {
    set(button.dataset[attribute]);
    for (const other of button.parentElement.children) other.setAttribute("aria-pressed", String(other === button));
    drawAll();
  }

  for (const button of document.querySelectorAll("[data-view]"))
    button.addEventListener("click", () => choose(button, "view", (value) => { view = value; }));
  for (const button of document.querySelectorAll("[data-scale]"))
    button.addEventListener("click", () => choose(button, "scale", (value) => { scale = value; }));

  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(() => { if (!root.classList.contains("printing")) drawAll(); }, 120);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawAll());
  window.addEventListener("beforeprint", () => { root.classList.add("printing"); drawAll(); });
  window.addEventListener("afterprint", () => { root.classList.remove("printing"); drawAll(); });
  drawInTurn();
})();
