// From nothing to the first reading: one question a screen; every touch is kept on the disk.
import { call, element, find, on, renderWords, show, text } from "/elements.js";
import { language, said, translate } from "/words.js";

const SCREENS = ["start", "machine", "with", "plan"];
const PATIENCE = 1000; // ms after which it is said what is being computed
const LONGEST = 48000; // letters of a file: a control's own is shorter, and of another one its beginning tells what it is
let start = null; // what there is to choose from
let draft = null; // what was chosen
let machine = null; // what that makes of a machine
let version = 0;
let touched = ""; // the instrument that is drawn
let turn = Promise.resolve();

translate(document.body);

function alarm(words) {
  text("trouble", words);
  show("trouble", words !== "");
}

// What the program answers; what is wrong stands over the page.
async function asked(path, body) {
  try {
    const { ok, document: answer } = await call(path, body);
    alarm(ok ? "" : answer.sentence);
    return ok ? answer : null;
  } catch {
    alarm(said("axiscal does not answer. Start axiscal serve again and open the address it prints."));
    return null;
  }
}

// Choices are shown at once and sent one after another, so that the last one is kept.
function choose(change) {
  draft = { ...draft, ...change };
  const chosen = draft;
  render();
  turn = turn.then(async () => {
    const made = await asked("/draft", chosen);
    if (made === null || chosen !== draft) return;
    machine = made;
    version += 1;
    render();
  });
  return turn;
}

async function go(screen) {
  const kept = choose({ screen });
  find(`${screen}-title`).focus();
  await kept;
  if (screen === "plan") makePlan();
}

function render() {
  const faults = Object.keys(machine.faults), known = machine.title !== "";
  const travels = known && faults.every((field) => field === "target");
  const ready = { start: true, machine: known, with: travels, plan: known && faults.length === 0 && draft.instruments.length > 0 };
  for (const screen of SCREENS) show(screen, screen === draft.screen);
  for (const step of find("path").querySelectorAll("button")) {
    step.disabled = !ready[step.dataset.screen];
    step.toggleAttribute("aria-current", step.dataset.screen === draft.screen);
  }
  renderMachine();
  renderInstruments();
  find("machine-next").disabled = !ready.with;
  find("with-next").disabled = !ready.plan;
  drawMachine();
}

function choice(words, chosen, act) {
  const button = element("button", words);
  button.type = "button";
  button.setAttribute("aria-pressed", chosen);
  button.addEventListener("click", act);
  return button;
}

// The day of an event as people say it: "yesterday".
function day(at) {
  const days = Math.round((new Date(at).setHours(0, 0, 0, 0) - new Date().setHours(0, 0, 0, 0)) / 86400000);
  return new Intl.RelativeTimeFormat(language, { numeric: "auto" }).format(days, "day");
}

function renderStart() {
  const going = start.begun.filter((each) => !each.finished), over = start.begun.filter((each) => each.finished);
  find("begun").replaceChildren(...[...going, ...over].map((each, n) => {
    const values = { machine: each.machine, taken: each.taken, last: each.taken + each.coming, day: day(each.at), record: each.record };
    const words = each.finished ? said("Look at: {machine}, {taken} readings, {day}", values) : said("Go on: {machine}, {taken} of {last} readings, {day}", values);
    const button = choice(words, false, () => openRecord(each.record));
    button.removeAttribute("aria-pressed");
    button.append(element("small", each.record));
    if (n === 0) button.className = "chief";
    return button;
  }));
  find("new").className = start.begun.length ? "" : "chief";
  find("left-out").replaceChildren(...start.left_out.map((words) => element("li", words)));
  text("folder", said("New campaigns are kept in {folder}", { folder: start.folder }));
}

function renderMachine() {
  show("kinds", draft.file === "");
  for (const button of find("kinds").children) button.setAttribute("aria-pressed", button.dataset.machine === draft.machine);
  show("read", draft.file !== "" && machine.title !== "");
  text("machine-title", draft.file ? said("Is this your machine?") : said("Which machine is most like yours?"));
  text("read", said("{file} says: {machine}", { file: draft.file, machine: machine.title }));
  text("file-fault", machine.faults.file ?? "");
  const axes = Object.keys(machine.lengths), shown = [...find("travels").querySelectorAll("input")].map((field) => field.dataset.axis);
  if (axes.join() !== shown.join()) find("travels").replaceChildren(...axes.map(travel));
  for (const field of find("travels").querySelectorAll("input")) {
    if (field !== document.activeElement) field.value = draft.travels[field.dataset.axis] ?? `${machine.lengths[field.dataset.axis]} mm`;
    field.parentElement.querySelector(".fault").textContent = machine.faults[`travels.${field.dataset.axis}`] ?? "";
  }
  find("look").replaceChildren(...machine.look.map((words) => element("li", said("To be looked at in machine.toml: {what}", { what: words }))));
}

function travel(axis) {
  const line = element("p", ""), label = element("label", said("travel of {axis}", { axis })), field = document.createElement("input");
  Object.assign(field, { id: `travel-${axis}`, type: "text", maxLength: 40, spellcheck: false });
  field.dataset.axis = axis;
  label.htmlFor = field.id;
  field.addEventListener("input", () => choose({ travels: { ...draft.travels, [axis]: field.value } }));
  line.append(label, field, element("span", "", "fault"));
  return line;
}

function renderInstruments() {
  for (const button of find("instruments").children) {
    const name = button.dataset.instrument;
    button.disabled = !machine.offered.includes(name);
    button.title = button.disabled ? said("nothing of this machine can be read with it") : "";
    button.setAttribute("aria-pressed", draft.instruments.includes(name));
  }
  text("target-fault", machine.faults.target ?? "");
  if (find("target") !== document.activeElement) find("target").value = draft.target;
  find("compensated").value = draft.compensated;
  show("compensation", machine.asks);
}

function touch(name) {
  const there = draft.instruments.includes(name);
  touched = there ? "" : name;
  choose({ instruments: there ? draft.instruments.filter((each) => each !== name) : [...draft.instruments, name] });
}

// The machine with its travels, and on it the instrument that was touched last.
function drawMachine() {
  const kind = machine.title ? "" : Object.keys(start.machines)[0], place = find("machine-drawing"), width = Math.round(Math.min(place.clientWidth, 900));
  if (width < 200) return;
  const picture = place.querySelector("img") ?? place.appendChild(document.createElement("img"));
  const instrument = ["start", "machine"].includes(draft.screen) ? "" : touched || (draft.instruments.at(-1) ?? "");
  picture.alt = machine.title || start.machines[kind];
  const address = `/machine.svg?${new URLSearchParams({ width, machine: kind, instrument, version })}`;
  if (picture.getAttribute("src") !== address) picture.src = address;
}

// A campaign that is here, or that of the draft, which begins.
async function openRecord(record) {
  find("begin").disabled = true;
  if (await waiting(asked("/open", { record })) !== null) location.assign("/");
  else find("begin").disabled = false;
}

// What is being computed is said from the second second on.
async function waiting(work) {
  const look = setInterval(async () => {
    const { document: now } = await call("/stage");
    text("doing", [said("one moment"), now.stage].filter((words) => words).join(": "));
  }, PATIENCE);
  try {
    return await work;
  } finally {
    clearInterval(look);
    text("doing", "");
  }
}

async function makePlan() {
  const of = version;
  find("begin").disabled = true;
  show("first", false);
  for (const id of ["strip", "known", "minds"]) find(id).replaceChildren();
  renderWords([], []);
  text("doing", said("one moment"));
  const plan = await waiting(asked("/plan"));
  if (plan === null || of !== version || draft.screen !== "plan") return;
  show("first", true);
  renderWords(plan.answer.first, plan.answer.rows);
  find("strip").replaceChildren(...plan.answer.document.setups.map(mounted));
  find("known").replaceChildren(...plan.answer.sentences.map((words) => element("p", words)));
  find("minds").replaceChildren(...plan.minds.map((words) => element("li", words)));
  find("begin").disabled = false;
  find("begin").focus();
}

// A set-up of the plan, as wide as it has readings; its minutes are those of the end.
function mounted({ setup, readings, minutes }) {
  const part = element("li", String(readings));
  part.title = setup;
  part.style.flexGrow = readings;
  part.append(element("small", said("{minutes} min", { minutes: Math.ceil(minutes) })));
  return part;
}

// A file of the control, or of a campaign that is here already.
async function take(file) {
  const known = start.begun.find((each) => each.record.split("/").at(-1) === file.name);
  if (known) return openRecord(known.record);
  const letters = (await file.slice(0, LONGEST).text()).replaceAll("\0", " ").slice(0, LONGEST);
  const name = file.name.slice(-60).replace(/^\.+/, "");
  const usual = /^\s*\[stepper_/m.test(letters) ? ["probe"] : [];
  draft = { ...draft, file: name, text: letters, machine: "", travels: {}, instruments: usual };
  return go("machine");
}

function chooseMachine(name) {
  choose({ machine: name, file: "", text: "", travels: {}, instruments: name === draft.machine ? draft.instruments : [] });
}

function anew(virtual) {
  draft = { ...draft, file: "", text: "", virtual };
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
on("with-next", "click", () => go("plan"));
on("begin", "click", () => openRecord(""));
for (const step of find("path").querySelectorAll("button")) step.addEventListener("click", () => go(step.dataset.screen));
for (const back of document.querySelectorAll(".back")) back.addEventListener("click", () => go(SCREENS[SCREENS.indexOf(draft.screen) - 1]));
find("target").addEventListener("input", () => choose({ target: find("target").value }));
find("compensated").addEventListener("change", () => choose({ compensated: find("compensated").value }));
addEventListener("resize", () => { if (machine !== null) drawMachine(); });

start = await asked("/start");
if (start !== null) {
  ({ draft, machine } = start);
  find("kinds").replaceChildren(...Object.entries(start.machines).map(([name, words]) => {
    const button = choice("", false, () => chooseMachine(name)), picture = document.createElement("img");
    Object.assign(picture, { src: `/machine.svg?${new URLSearchParams({ width: 220, machine: name, small: true })}`, alt: "", width: 220, height: 209 });
    button.dataset.machine = name;
    button.append(picture, element("span", words));
    return button;
  }));
  find("instruments").replaceChildren(...Object.entries(start.instruments).map(([name, words]) => {
    const button = choice(words, false, () => touch(name));
    button.dataset.instrument = name;
    return button;
  }));
  renderStart();
  render();
  if (draft.screen === "plan") makePlan();
}
