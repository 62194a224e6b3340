// From nothing to the first reading: one question a screen; every touch is kept on the disk.
import { button, call, draw, element, find, on, renderFirst, show, tell, text, waiting } from "/elements.js";
import { language, said, translate } from "/words.js";

const SCREENS = ["start", "machine", "with", "plan"];
const LONGEST = 48000; // letters of a file: a control's own is shorter, and of another one its beginning tells what it is
const HELPS = 2; // instruments that are proposed, the most usual that show more; the others stand in the list
const OF_MACHINE = { travels: {}, switched: [], size: "used", without: [], budget: "", along: "" }; // what another machine has as usual
let start = null; // what there is to choose from
let draft = null; // what was chosen
let machine = null; // what that makes of a machine
let version = 0;
let leaving = false; // a campaign is being opened: nothing more is asked about the draft
let touched = ""; // the instrument that is drawn
let turn = Promise.resolve();
const rows = new Map(); // what each instrument can show, by machine and instrument
const faults = new Map(); // why it cannot be set up there
let planned = { of: "" }; // the newest plan, and the choices that it is of
let curve = { of: "", marks: [] }; // what minutes buy, whatever the budget

translate(document.body);

// What the program answers; what is wrong stands over the page.
async function asked(path, body) {
  try {
    const { ok, document: answer } = await call(path, body);
    tell("trouble", ok ? "" : answer.sentence);
    return ok ? answer : null;
  } catch {
    tell("trouble", said("axiscal does not answer. Start axiscal serve again and open the address it prints."));
    return null;
  }
}

// Choices are shown at once, and the last one is sent as soon as the one before has arrived.
function choose(change) {
  draft = { ...draft, ...change };
  const chosen = draft;
  render();
  if (planned.of !== planOf()) outdate();
  version += 1; // nothing more is asked about the choices before
  turn = turn.then(async () => {
    if (chosen !== draft) return;
    const made = await asked("/draft", chosen);
    if (made === null || chosen !== draft) return;
    machine = made;
    version += 1;
    render();
    renew();
  });
  return turn;
}

// The browser's history has an entry for each screen up to this one: its Back and ours go one screen back.
function go(screen) {
  const at = SCREENS.indexOf(history.state.screen), to = SCREENS.indexOf(screen);
  for (const next of SCREENS.slice(at + 1, to + 1)) history.pushState({ screen: next }, "", "/");
  if (to < at) history.go(to - at);
  else enter(screen);
}

function enter(screen) {
  choose({ screen });
  find(`${screen}-title`).focus();
}

function render() {
  const wrong = Object.keys(machine.faults), known = machine.title !== "";
  const travels = known && wrong.every((field) => field === "target");
  const enough = known && wrong.length === 0 && draft.instruments.length > 0, plan = enough && machine.readings === "";
  const ready = { start: true, machine: known || machine.readings !== "", with: travels, plan };
  for (const screen of SCREENS) show(screen, screen === draft.screen);
  for (const step of find("path").querySelectorAll("button")) {
    step.disabled = !ready[step.dataset.screen];
    step.toggleAttribute("aria-current", step.dataset.screen === draft.screen);
  }
  renderMachine();
  renderInstruments();
  renderRows();
  text("instruments-fault", draft.instruments.map((name) => faults.get(ofMachine(name)) ?? "").join(" ").trim());
  show("coming", plan && ["with", "plan"].includes(draft.screen));
  find("machine-next").disabled = !ready.with;
  find("with-next").disabled = !enough;
  drawMachine();
}

function choice(words, chosen, act) {
  const made = button(words, act);
  made.setAttribute("aria-pressed", chosen);
  return made;
}

// The day of an event as people say it: "yesterday".
function day(at) {
  const days = Math.round((new Date(at).setHours(0, 0, 0, 0) - new Date().setHours(0, 0, 0, 0)) / 86400000);
  return new Intl.RelativeTimeFormat(language, { numeric: "auto" }).format(days, "day");
}

function renderStart() {
  const going = start.begun.filter((each) => !each.finished), over = start.begun.filter((each) => each.finished);
  find("begun").replaceChildren(...[...going, ...over].map((each, n) => {
    const values = { machine: each.machine, taken: each.readings, last: each.readings + each.coming, day: day(each.last), record: each.record };
    const words = each.finished ? said("Look at: {machine}, {taken} readings, {day}", values) : said("Go on: {machine}, {taken} of {last} readings, {day}", values);
    const made = Object.assign(button(words, () => openRecord(each.record)), { className: n ? "" : "chief" });
    made.append(element("small", each.record));
    return made;
  }));
  find("new").className = start.begun.length ? "" : "chief";
  find("left-out").replaceChildren(...start.left_out.map((words) => element("li", words)));
  text("folder", said("kept in {folder}", { folder: start.folder }));
}

function renderMachine() {
  const read = draft.file !== "" && machine.title !== "" && machine.readings === "";
  show("kinds", !read);
  for (const button of find("kinds").children) button.setAttribute("aria-pressed", button.dataset.machine === draft.machine);
  show("read", read || machine.readings !== "");
  text("machine-title", read ? said("Your machine?") : said("Machine"));
  text("read", `${draft.file}: ${machine.readings || machine.title}`);
  text("file-fault", machine.faults.file ?? "");
  const axes = Object.keys(machine.lengths), shown = [...find("travels").querySelectorAll("input")].map((field) => field.dataset.axis);
  if (axes.join() !== shown.join()) find("travels").replaceChildren(...axes.map(travel));
  for (const field of find("travels").querySelectorAll("input")) {
    if (field !== document.activeElement) field.value = draft.travels[field.dataset.axis] ?? `${machine.lengths[field.dataset.axis]} mm`;
    field.parentElement.querySelector(".fault").textContent = machine.faults[`travels.${field.dataset.axis}`] ?? "";
    const carries = field.parentElement.querySelector("button"), carried = machine.carried.includes(field.dataset.axis);
    carries.textContent = carried ? said("table moves") : said("head moves");
    carries.setAttribute("aria-label", `${field.dataset.axis}: ${carries.textContent}`);
  }
  show("sizes", axes.length > 0);
  show("travel", axes.length > 0);
  for (const button of find("sizes").children) button.setAttribute("aria-pressed", button.dataset.size === draft.size);
  show("look", machine.look.length > 0);
  find("look").lastElementChild.replaceChildren(...machine.look.map((words) => element("li", words)));
}

function travel(axis) {
  const line = element("p", ""), field = document.createElement("input");
  const carries = button("", () => choose({ switched: toggled(draft.switched, axis) }));
  const label = element("label", machine.radii.includes(axis) ? said("{axis}, the radius", { axis }) : axis);
  Object.assign(field, { id: `travel-${axis}`, type: "text", maxLength: 40, spellcheck: false });
  field.dataset.axis = axis;
  label.htmlFor = field.id;
  field.addEventListener("input", () => choose({ travels: { ...draft.travels, [axis]: field.value } }));
  line.append(label, field, carries, element("span", "", "fault"));
  return line;
}

function renderInstruments() {
  for (const button of find("instruments").children) {
    const name = button.dataset.instrument;
    button.hidden = !machine.offered.includes(name); // nothing of this machine can be read with the others
    button.setAttribute("aria-pressed", draft.instruments.includes(name));
  }
  text("target-fault", machine.faults.target ?? "");
  if (find("target") !== document.activeElement) find("target").value = draft.target;
  find("compensated").value = draft.compensated;
  show("compensation", machine.asks);
  show("reads", machine.readings !== "");
  find("along").replaceChildren(...["", ...Object.keys(machine.lengths)].map((axis) => new Option(axis || said("as the file says"), axis, false, axis === draft.along)));
  text("with-next", machine.readings ? said("Evaluate the readings") : said("Plan"));
}

function toggled(names, name) {
  return names.includes(name) ? names.filter((each) => each !== name) : [...names, name];
}

function touch(name) {
  touched = draft.instruments.includes(name) ? "" : name;
  choose({ instruments: toggled(draft.instruments, name) });
}

// What instruments can show follows from the machine alone.
function ofMachine(instrument) {
  const { machine: kind, file, travels, switched, size } = draft;
  return JSON.stringify([kind, file, travels, switched, size, instrument]);
}

function rowsOf(instrument) {
  return rows.get(ofMachine(instrument)) ?? {};
}

// Rows with what the plan tells of each, to be ticked; what other instruments would show besides, in grey.
function renderRows() {
  const { volume, ...single } = Object.assign({}, ...draft.instruments.map(rowsOf)), known = volume ? { ...single, volume } : single;
  const kinds = Map.groupBy(Object.entries(known), ([, words]) => words.split(" ")[0]), lines = [];
  for (const [kind, each] of kinds) each.forEach(([name, words], n) => {
    const line = document.createElement("tr"), short = words.slice(kind.length).trim(), ticked = document.createElement("td");
    ticked.append(tick(name, words, short));
    line.append(element("td", n ? "" : kind), ticked, ...(planned.plan?.rows[name] ?? ["", ""]).map((figure) => element("td", figure)));
    lines.push(line);
  });
  const before = document.activeElement?.dataset?.row;
  find("rows").tBodies[0].replaceChildren(...lines);
  if (before) find("rows").querySelector(`[data-row="${before}"]`)?.focus();
  show("rows", lines.length > 0 && ["with", "plan"].includes(draft.screen));
  const seen = new Set(Object.keys(known)), helps = [];
  for (const name of machine.offered.filter((each) => !draft.instruments.includes(each))) {
    const more = Object.entries(rowsOf(name)).filter(([row]) => !seen.has(row));
    if (!more.length || !draft.instruments.length || helps.length === HELPS) continue;
    for (const [row] of more) seen.add(row);
    const line = element("li", "");
    line.append(button(`+ ${start.instruments[name]}`, () => touch(name)), element("span", [...new Set(more.map(([, words]) => words.split(" ")[0]))].join(", ")));
    helps.push(line);
  }
  find("helps").replaceChildren(...helps);
}

function tick(name, words, short) {
  const label = element("label", ""), box = document.createElement("input");
  Object.assign(box, { type: "checkbox", checked: !draft.without.includes(name) });
  box.dataset.row = name;
  box.setAttribute("aria-label", words);
  box.addEventListener("change", () => choose({ without: toggled(draft.without, name) }));
  label.append(box, short);
  return label;
}

// Rows of the instruments that were touched, then the plan; at leisure what others would show, and what minutes buy.
let later = 0;
function renew() {
  clearTimeout(later);
  if (!["with", "plan"].includes(draft.screen) || !machine.title) return;
  later = setTimeout(async () => {
    const of = version, around = () => [...machine.offered].map((name) => () => look(name));
    const steps = [...draft.instruments.map((name) => () => look(name)), makePlan];
    steps.push(...(draft.screen === "plan" ? [makeCurve, ...around()] : [...around(), makeCurve]));
    for (const step of steps) if (of === version && !leaving) await step();
  }, 250);
}

async function look(name) {
  const of = ofMachine(name);
  if (rows.has(of)) return;
  rows.set(of, {}); // asked for once
  const found = await call(`/rows?${new URLSearchParams({ instrument: name })}`);
  rows.set(of, found.document.rows ?? {});
  faults.set(of, found.document.fault ?? found.document.sentence);
  if (of === ofMachine(name)) render();
}

// The machine with its travels, and on it the instrument that was touched last.
function drawMachine() {
  const kind = machine.title ? "" : Object.keys(start.machines)[0], place = find("machine-drawing"), width = Math.round(Math.min(place.clientWidth, 900));
  if (width < 200 || leaving) return;
  const instrument = ["start", "machine"].includes(draft.screen) ? "" : touched || (draft.instruments.at(-1) ?? "");
  draw(place, `/machine.svg?${new URLSearchParams({ width, machine: kind, instrument, version })}`, machine.title || start.machines[kind]);
}

// A campaign that is here, or that of the draft, which begins.
async function openRecord(record) {
  find("begin").disabled = find("with-next").disabled = leaving = true;
  if (await waiting(turn.then(() => asked("/open", { record }))) !== null) location.assign("/");
  else find("begin").disabled = find("with-next").disabled = leaving = false;
}

// The choices that a plan is of.
function planOf() {
  const { screen, ...chosen } = draft;
  return JSON.stringify(chosen);
}

// What is shown is the plan of other choices: nothing begins by it.
function outdate() {
  find("begin").disabled = true;
  find("beside").className = "old";
  show("buying", false);
}

// A plan is made for each choice; one that has been overtaken by another says nothing.
async function makePlan() {
  if (find("coming").hidden) return;
  const of = planOf();
  if (planned.of !== of) {
    outdate();
    const { ok, document: plan } = await waiting(call("/plan"));
    if (plan === null || of !== planOf()) return; // it comes too late for the choices of now
    tell("trouble", ok ? "" : plan.sentence);
    if (!ok) return;
    planned = { of, plan };
  }
  renderPlan(planned.plan);
}

// The curve is made once for all budgets, when nothing else is asked for.
async function makeCurve() {
  const { screen, budget, ...timeless } = draft, of = JSON.stringify(timeless);
  if (find("coming").hidden || planned.plan === undefined) return;
  if (curve.of !== of) {
    const { ok, document: bought } = await call("/curve");
    if (!ok || bought === null) return;
    curve = { of, marks: bought.marks };
  }
  renderCurve(planned.plan.answer.document.minutes);
}

function renderPlan(plan) {
  find("beside").className = "";
  show("first", true);
  find("first").className = `box ${plan.answer.document.verdict}`;
  renderFirst(plan.answer.first.map((words, n) => n ? words : `≈ ${words}`));
  renderRows();
  find("strip").replaceChildren(...plan.answer.document.setups.map(mounted));
  find("known").replaceChildren(...plan.answer.sentences.map((words) => element("p", words)));
  find("minds").replaceChildren(...plan.minds.map((words) => element("li", words)));
  find("begin").disabled = false;
  if (draft.screen === "plan" && [document.body, find("plan-title")].includes(document.activeElement)) find("begin").focus();
}

// What minutes buy stands on a line between marks that were planned once: a move of the slider asks nobody.
function renderCurve(minutes) {
  const marks = curve.marks;
  show("buying", marks.length > 1);
  if (marks.length < 2) return;
  Object.assign(find("minutes"), { min: Math.ceil(marks[0].minutes), max: Math.floor(marks.at(-1).minutes) });
  find("minutes").value = Math.round(minutes);
  sayBought();
}

function sayBought() {
  const minutes = Number(find("minutes").value), marks = curve.marks, n = Math.max(1, marks.findIndex((mark) => mark.minutes >= minutes));
  const [low, high] = [marks[n - 1], marks[n]], share = Math.log(minutes / low.minutes) / Math.log(high.minutes / low.minutes);
  const u = low.expanded_um * (high.expanded_um / low.expanded_um) ** Math.min(Math.max(share, 0), 1);
  text("buys", said("≈ {minutes} min: U ≈ {u} µm", { minutes, u: Number(u.toPrecision(2)) }));
}

// A set-up of the plan, as wide as it has readings.
function mounted({ setup, instrument, moves, readings, minutes }, n, setups) {
  const part = element("li", moves.join(""));
  part.title = setup;
  part.dataset.instrument = instrument;
  part.style.flexGrow = readings;
  const own = Math.max(Math.round(minutes - (setups[n - 1]?.minutes ?? 0)), 1);
  part.append(element("strong", String(readings)), element("small", said("{minutes} min", { minutes: own })));
  return part;
}

// The first letters of a file as spreadsheets write it: UTF-16 with its mark, UTF-8, or else a page of Windows.
async function lettersOf(file) {
  const bytes = new Uint8Array(await file.slice(0, 4 * LONGEST).arrayBuffer());
  const marked = { "255,254": "utf-16le", "254,255": "utf-16be" }[bytes.slice(0, 2)];
  try {
    return new TextDecoder(marked ?? "utf-8", { fatal: !marked }).decode(bytes, { stream: true }); // the last letter may be cut
  } catch {
    return new TextDecoder("windows-1252").decode(bytes);
  }
}

// A file of the control, or of a campaign that is here already.
async function take(file) {
  const known = start.begun.find((each) => each.record.split("/").at(-1) === file.name);
  if (known) return openRecord(known.record);
  const letters = (await lettersOf(file)).replaceAll("\0", "\x01").slice(0, LONGEST);
  const name = file.name.slice(-60).replace(/^\.+/, "");
  const usual = /^\s*\[stepper_/m.test(letters) ? ["probe"] : [];
  draft = { ...draft, ...OF_MACHINE, file: name, text: letters, machine: "", instruments: usual, virtual: false };
  return go("machine");
}

// Readings that were dropped stay: they are of the machine that is chosen.
function chooseMachine(name) {
  const { file, text: letters } = machine.readings ? draft : { file: "", text: "" };
  choose({ ...OF_MACHINE, machine: name, file, text: letters, instruments: name === draft.machine ? draft.instruments : [] });
}

function anew(virtual) {
  draft = { ...draft, file: "", text: "", along: "", virtual };
  go("machine");
}

on("new", "click", () => anew(false));
on("try", "click", () => anew(true));
on("pick", "click", () => find("file").click());
find("file").addEventListener("change", () => take(find("file").files[0]));
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  if (event.dataTransfer.files.length) take(event.dataTransfer.files[0]);
});
on("machine-next", "click", () => go("with"));
on("with-next", "click", () => machine.readings ? openRecord("") : go("plan"));
find("along").addEventListener("change", () => choose({ along: find("along").value }));
on("begin", "click", () => openRecord(""));
on("minutes", "input", sayBought);
on("minutes", "change", () => choose({ budget: `${find("minutes").value} min` }));
for (const button of find("sizes").children) button.addEventListener("click", () => choose({ size: button.dataset.size }));
for (const step of find("path").querySelectorAll("button")) step.addEventListener("click", () => go(step.dataset.screen));
for (const back of document.querySelectorAll(".back")) back.addEventListener("click", () => history.back());
addEventListener("popstate", (event) => { if (event.state?.screen && draft !== null) enter(event.state.screen); });
find("target").addEventListener("input", () => choose({ target: find("target").value }));
find("compensated").addEventListener("change", () => choose({ compensated: find("compensated").value }));
addEventListener("resize", () => { if (machine !== null) drawMachine(); });

start = await asked("/start");
if (start !== null) {
  ({ draft, machine } = start);
  if (history.state?.screen !== draft.screen) {
    history.replaceState({ screen: SCREENS[0] }, "", "/");
    for (const next of SCREENS.slice(1, SCREENS.indexOf(draft.screen) + 1)) history.pushState({ screen: next }, "", "/");
  }
  find("kinds").replaceChildren(...Object.entries(start.machines).map(([name, words]) => {
    const made = choice("", false, () => chooseMachine(name)), picture = Object.assign(document.createElement("img"), { width: 220, height: 209 });
    made.dataset.machine = name;
    made.append(picture, element("span", words));
    draw(made, `/machine.svg?${new URLSearchParams({ width: 220, machine: name, small: true })}`, "");
    return made;
  }));
  find("instruments").replaceChildren(...Object.entries(start.instruments).map(([name, words]) => {
    const made = choice(words, false, () => touch(name));
    made.dataset.instrument = name;
    return made;
  }));
  renderStart();
  render();
  renew();
}
