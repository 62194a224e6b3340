"use strict";
(() => {
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

  // On paper everything is open.
  window.addEventListener("beforeprint", () => {
    for (const folded of document.querySelectorAll("details")) folded.open = true;
  });
})();
