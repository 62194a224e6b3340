// After the end: the tables for a control, and the report.
import { element, find, held, on, show, text, waiting } from "/elements.js";

export function renderControls(state) {
  show("controls", state?.tables.length > 0); // the answer says why there are none
  const select = find("control");
  if (find("controls").hidden || select.options.length > 0) return;
  const others = state.controls.filter((name) => !state.tables.includes(name));
  select.append(...[...state.tables, ...others].map((name) => Object.assign(element("option", name), { value: name })));
  select.value = state.tables.find((name) => name !== "csv") ?? "csv";
}

async function save(path, file) {
  try {
    Object.assign(element("a", ""), { href: await waiting(held(path)), download: file }).click();
    text("controls-fault", "");
  } catch (refusal) {
    text("controls-fault", refusal.message);
  }
}

on("control", "change", () => text("controls-fault", ""));
on("pdf", "click", () => save("/report.pdf", "report.pdf"));
on("download", "click", () => save(`/tables.zip?${new URLSearchParams({ control: find("control").value })}`, `${find("control").value}.zip`));
