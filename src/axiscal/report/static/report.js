"use strict";
(() => {
  const root = document.documentElement;

  function choose(button, attribute) {
    root.dataset[attribute] = button.dataset[attribute];
    for (const other of button.parentElement.children) other.setAttribute("aria-pressed", String(other === button));
  }

  for (const attribute of ["view", "scale"])
    for (const button of document.querySelectorAll(`[data-${attribute}]`))
      if (button !== root) button.addEventListener("click", () => choose(button, attribute));

  // A table that is wider than its place says so, as long as there is more to the right.
  const wide = [...document.querySelectorAll(".scroll")];
  function mark(box) {
    box.classList.toggle("wide", box.scrollWidth > box.clientWidth + 2);
    box.classList.toggle("more", box.scrollLeft + box.clientWidth < box.scrollWidth - 2);
  }
  const resized = new ResizeObserver((entries) => entries.forEach((entry) => mark(entry.target)));
  for (const box of wide) {
    box.addEventListener("scroll", () => mark(box), { passive: true });
    resized.observe(box);
  }

  // The pictures in space turn together: places are mm of the workpiece, projected as in arrow_pictures.py.
  const spaces = [...document.querySelectorAll("[data-view3]")];
  let turn = 0, tilt = 0;

  function project(at, view) {
    const [mx, my, mz, scale, cx, cy, turn0, tilt0] = view;
    const a = (turn0 + turn) * Math.PI / 180, b = Math.max(-90, Math.min(90, tilt0 + tilt)) * Math.PI / 180;
    const [x, y, z] = [at[0] - mx, at[1] - my, at[2] - mz];
    const depth = x * Math.sin(a) + y * Math.cos(a);
    return [cx + scale * (x * Math.cos(a) - y * Math.sin(a)), cy - scale * (z * Math.cos(b) + depth * Math.sin(b))];
  }

  function drawSpace(svg) {
    const view = JSON.parse(svg.dataset.view3);
    for (const line of svg.querySelectorAll("[data-ends]")) {
      const all = line.dataset.ends.split(" ").map(Number);
      line.setAttribute("d", `M${project(all.slice(0, 3), view)}L${project(all.slice(3), view)}`);
    }
    for (const mark of svg.querySelectorAll("[data-at]")) {
      const [x, y] = project(mark.dataset.at.split(" ").map(Number), view);
      const text = mark.tagName === "text";
      mark.setAttribute(text ? "x" : "cx", x);
      mark.setAttribute(text ? "y" : "cy", y + Number(mark.dataset.down || 0));
    }
  }

  for (const svg of spaces) {
    svg.addEventListener("pointerdown", (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener("pointermove", (event) => {
      if (!svg.hasPointerCapture(event.pointerId)) return;
      turn += event.movementX / 2;
      tilt += event.movementY / 3;
      spaces.forEach(drawSpace);
    });
  }

  // On paper everything is open.
  window.addEventListener("beforeprint", () => {
    for (const folded of document.querySelectorAll("details")) folded.open = true;
  });
})();
