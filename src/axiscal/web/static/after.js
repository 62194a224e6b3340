// After the end: the tables for a control, how they come into it, and whether they work.
import { call, element, find, held, on, show, text, waiting } from "/elements.js";
import { unitText } from "/pictures.js";
import { said } from "/words.js";

let shown = null; // what the page shows, null before the end
let check = null; // the places to read for the control that is chosen

export function renderControls(state) {
  shown = state;
  show("controls", state?.tables.length > 0); // the answer says why there are none
  if (find("controls").hidden) { show("check", false); return; }
  const select = find("control");
  if (select.options.length === 0) {
    const others = state.controls.filter((name) => !state.tables.includes(name));
    select.append(...[...state.tables, ...others].map((name) => Object.assign(element("option", name), { value: name })));
    select.value = state.tables.find((name) => name !== "csv") ?? "csv";
    choose();
  }
}

function control() {
  return find("control").value;
}

function choose() {
  show("verify", control() !== "csv"); // no control loads it
  text("controls-fault", "");
  show("check", false);
}

async function asked(path, body) {
  const { ok, document: answer } = await waiting(call(path, body));
  text("controls-fault", ok ? "" : answer.sentence);
  return ok ? answer : null;
}

async function save(path, file) {
  try {
    Object.assign(element("a", ""), { href: await waiting(held(path)), download: file }).click();
    text("controls-fault", "");
  } catch (refusal) {
    text("controls-fault", refusal.message);
  }
}

// What was typed is kept by the browser until it is judged: a closed tab loses nothing.
function kept() {
  return `axiscal ${shown.record} ${control()}`;
}

function fields(side) {
  return [...find("check-places").querySelectorAll(`input[data-side=${side}]`)];
}

function keep() {
  const typed = { found: fields("found").map((e) => e.value), left: fields("left").map((e) => e.value), tolerance: find("tolerance").value };
  localStorage.setItem(kept(), JSON.stringify(typed));
  return typed;
}

async function verify() {
  check = await asked(`/check?${new URLSearchParams({ control: control() })}`);
  show("check", check !== null);
  show("judged", false);
  if (check === null) return;
  const typed = JSON.parse(localStorage.getItem(kept()) ?? "{}");
  find("tolerance").value = typed.tolerance ?? check.tolerance;
  find("check-words").replaceChildren(...check.sentences.map((words) => element("li", words)));
  show("check-virtual", check.places.some((place) => place.shows.length));
  find("check-places").replaceChildren(...check.places.map((place, n) => {
    const row = document.createElement("tr");
    row.append(element("td", `${place.setup}: ${place.place}`), ...["found", "left"].map((side) => cell(place, side, n, typed[side]?.[n] ?? "")));
    return row;
  }));
  fields("found")[0]?.focus();
}

function cell(place, side, n, value) {
  const made = document.createElement("td"), field = document.createElement("input"), fault = element("span", "", "fault");
  Object.assign(field, { type: "text", value, maxLength: 200, spellcheck: false, placeholder: unitText(place.unit) });
  field.dataset.side = side;
  fault.id = `${side}-${n}-fault`;
  field.setAttribute("aria-describedby", fault.id);
  field.setAttribute("aria-label", `${side === "found" ? said("without the tables") : said("with them")}, ${place.setup}: ${place.place}`);
  field.addEventListener("input", keep);
  made.append(field, fault);
  return made;
}

async function judge() {
  const answer = await asked("/check", { control: control(), ...keep() });
  if (answer === null) return;
  for (const fault of find("check-places").querySelectorAll(".fault")) fault.textContent = "";
  text("tolerance-fault", answer.faults.tolerance ?? "");
  for (const [field, words] of Object.entries(answer.faults)) if (field !== "tolerance") text(`${field.replace(".", "-")}-fault`, words);
  show("judged", answer.verdict !== "");
  find("judged").className = `box ${answer.verdict === "promised" ? "reached" : "unreachable"}`;
  find("judged").replaceChildren(...answer.sentences.map((words, n) => element(n ? "span" : "strong", words)));
}

on("control", "change", choose);
on("verify", "click", verify);
on("check", "submit", judge);
on("check-virtual", "click", () => {
  for (const [n, side] of ["found", "left"].entries()) fields(side).forEach((field, k) => { field.value = check.places[k].shows[n]; });
  keep();
});
on("pdf", "click", () => save("/report.pdf", "report.pdf"));
on("download", "click", () => save(`/tables.zip?${new URLSearchParams({ control: control() })}`, `${control()}.zip`));
