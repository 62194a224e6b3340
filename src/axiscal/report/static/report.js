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
    box.classList.toggle("more", box.scrollLeft + box.clientWidth < box.scrollWidth - 2);
  }
  const resized = new ResizeObserver((entries) => entries.forEach((entry) => mark(entry.target)));
  for (const box of wide) {
    box.addEventListener("scroll", () => mark(box), { passive: true });
    resized.observe(box);
  }

  // On paper everything is open.
  window.addEventListener("beforeprint", () => {
    for (const folded of document.querySelectorAll("details")) folded.open = true;
  });
})();
