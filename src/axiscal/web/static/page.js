// The dialogue: shows the newest state, sends what is typed, and says which state that answers.
import { button, call, draw, element, find, hear, on, renderWords, show, tell, text, waiting } from "/elements.js";
import { renderControls } from "/after.js";
import { rounded, shown, strip, unitText } from "/pictures.js";
import { said, translate } from "/words.js";

let state = null;
let mounted = sessionStorage.getItem("mounted") ?? "";
let asked = "";
let sending = null; // the reading that is on its way, and the state that it answers
let turn = Promise.resolve();
let giving = "skip"; // what the reason is asked for: to skip a reading, or to leave the set-up

translate(document.body);

// A step on the record, after those that are under way: what went wrong is said, and nothing that was typed is lost.
function step(path, body) {
  const own = path === "/notes" ? body : { after: state.last, ...body };
  turn = turn.then(() => sent(path, own));
  return turn;
}

async function sent(path, body) {
  const lost = { ok: false, document: { problem: "lost", sentence: said("No answer came. Look at what is asked now, then do it again if it is still right.") } };
  const done = await waiting(call(path, body).catch(() => lost));
  if (done.ok) render(done.document.state);
  return done;
}

function number(value) {
  return String(Number(value.toFixed(4))).replace("-", "−");
}

function renderLine() {
  const p = state.progress, end = p.taken + p.coming, going = state.question !== null;
  text("machine", state.machine);
  document.title = `${state.machine} · axiscal`;
  text("count", state.question ? said("reading {number} of {last}", { number: p.taken + 1, last: end }) : said("{count} taken", { count: p.taken }));
  const left = p.left_minutes < 1 ? said("< 1 min") : said("≈ {minutes} min", { minutes: shown(p.left_minutes, 0) });
  text("minutes", going ? `· ${left}` : "");
}

function renderPlaces(question) {
  const go = find("go"), moving = question.places.filter((c) => c.moves);
  go.replaceChildren();
  go.className = moving.length > 1 ? "several" : "";
  for (const c of moving) {
    const line = element("p", "", `${c.unit === "mm" ? "linear" : "rotary"} ${c.changed ? "changed" : ""}`);
    line.append(element("span", c.axis, "axis"), element("span", number(c.value)), element("small", c.unit));
    if (c.diameter) line.append(element("span", `⌀ ${number(2 * c.value)}`, "side"));
    if (c.side) line.append(element("span", c.side === "+" ? `→ ${said("from below")}` : `← ${said("from above")}`, "side"));
    go.append(line);
  }
  const parked = question.places.filter((c) => !c.moves).map((c) => `${c.axis} ${number(c.value)} ${c.unit}`);
  text("parked", parked.length ? `${said("parked")}: ${parked.join(" · ")}` : "");
  tell("touch", question.touch);
}

function expectWords(question) {
  const ranges = question.expected.map((e) => `${rounded(e.mean, e.half)} ± ${rounded(e.half, e.half)}`);
  if (new Set(question.units).size === 1) return `${said("expected")}: ${ranges.join(", ")} ${unitText(question.unit)}`;
  return `${said("expected")}: ${ranges.map((range, n) => `${range} ${unitText(question.units[n])}`).join(", ")}`;
}

function drawStrips(values = [], surprising = false) {
  find("strips").replaceChildren();
  state.question.expected.forEach((e, n) => strip(find("strips"), e, values[n], surprising, state.question.units[n], state.question.names[n]));
}

function renderQuestion() {
  const question = state.question;
  const key = question ? `${question.number} ${question.setup} ${JSON.stringify(question.places)}` : "";
  const mounting = question !== null && question.mount && mounted !== question.setup;
  const jogging = question !== null && !mounting && state.jog !== null;
  show("task", question !== null && !mounting && !jogging);
  show("jog", jogging);
  show("mount", mounting);
  if (question === null) { asked = ""; return; }
  if (!question.mount) mounted = question.setup;
  text("mount-title", question.setup);
  text("mount-sentence", `${question.mount_sentence[0].toUpperCase()}${question.mount_sentence.slice(1)}.`);
  find("mount-steps").replaceChildren(...question.mounting.flatMap(([name, what]) => [element("dt", name), element("dd", what)]));
  text("setup", question.setup);
  text("mount-sign", state.jog === null ? question.sign : "");
  renderPlaces(question);
  tell("again", question.again);
  text("sign", question.sign);
  text("unit", question.names.map((name, n) => `${name} ${unitText(question.units[n])}`.trim()).join(", "));
  find("field").className = question.expected.length > 1 ? "several" : "";
  text("expect", expectWords(question));
  text("jog-words", jogging ? `${state.jog.sentence}.` : "");
  text("jog-unit", jogging ? unitText(state.jog.unit) : "");
  for (const place of ["shows", "jog-shows"]) text(place, state.shows && said("the instrument on the virtual machine shows {value}", { value: state.shows }));
  if (key !== asked) newQuestion(key);
  if (mounting && document.activeElement !== find("stands") && !find("stopping").contains(document.activeElement)) find("stands").focus();
}

async function tryJog(anyway) {
  const typed = find("jogged").value.trim();
  if (!typed) return;
  const done = await step("/jogs", { text: typed, anyway });
  text("jog-fault", done.ok ? "" : done.document.sentence);
  show("jog-anyway", !done.ok && done.document.problem === "refused");
  if (!done.ok) { find("jogged").select(); return; }
  find("jogged").value = "";
  hear("");
  begun();
}

// The set-up stands and shows what it should: the temperature, then the readings.
function begun() {
  if (state.jog !== null) find("jogged").focus();
  else if (state.due.ask) asksForNote(true, true);
  else find("field").focus();
}

// What was typed for another reading must not be sent for this one.
function newQuestion(key) {
  const left = find("field").value.trim();
  if (left && asked && left !== sending?.typed) hear(said("Not kept: “{text}” was typed for the reading before, which has been answered in another window.", { text: left }), true);
  find("field").value = "";
  asked = key;
  show("doubt", false);
  show("skip-form", false);
  drawStrips();
  if (!find("task").hidden) find("field").focus();
}

function renderKept() {
  find("latest").replaceChildren(...state.readings.map((r) => {
    const row = document.createElement("tr");
    const values = r.values.map((v) => shown(v, 2)).join("  ");
    row.append(element("td", `${r.number}`), element("td", `${values} ${unitText(r.unit)}`), element("td", r.place.replaceAll("-", "−") + (r.doubted ? ` (${said("not relied on")})` : "")), element("td", clock(r.at)));
    return row;
  }));
  find("notes").replaceChildren(...state.notes.slice(-3).map((n) => element("li", `${clock(n.at)} ${n.text}`)));
  renderDue();
  find("minds").replaceChildren(...state.minds.map((m) => element("li", m)));
  show("accept", state.named);
}

function renderDue() {
  const { temperature_degc: warm, minutes_ago: ago, ask } = state.due, parts = [];
  if (warm !== null) parts.push(said("temperature {value} °C, {minutes} min ago", { value: shown(warm, 1), minutes: shown(ago, 0) }));
  if (state.question !== null && ask) parts.push(said("note the temperature"));
  text("due", parts.join(" · "));
}

function clock(at) {
  return at ? new Date(at).toLocaleTimeString("en-GB") : "";
}

// What is known, as every report has it: the first line, the rows, what is to be done next.
function renderAnswer() {
  const { first, rows, sentences, document: found } = state.answer ?? {}, unread = state.progress.taken === 0;
  const ahead = unread && found?.verdict === "unreachable";
  show("answer", found !== undefined && (!unread || ahead)); // a plan stood beside the button that began it
  if (found === undefined) return;
  find("first").className = `box ${found.verdict}`;
  find("answer").className = state.finished !== null ? "result" : ahead ? "ahead" : "";
  renderWords(first, rows);
  find("known").replaceChildren(...sentences.map((words) => element("p", words)));
}

function renderEnd() {
  const over = state.question === null;
  find("measuring").toggleAttribute("aria-current", state.finished === null);
  find("ended").toggleAttribute("aria-current", state.finished !== null);
  show("end", over);
  if (!over) return;
  const done = state.finished !== null;
  text("end-title", done ? said("The campaign has ended") : state.ended ? said("Nothing more to measure") : said("There is no next reading"));
  text("end-words", done ? `${state.finished}.` : state.ended ? `${state.ended}.` : "");
  show("report", done && state.results !== "");
  renderControls(done && state.results !== "" ? state : null);
  text("finish", done ? said("Write the results") : said("End the campaign and write its results"));
  show("finish", !done || state.results === "");
  show("more", !done);
}

function render(newer) {
  if (state !== null && newer.version <= state.version) return;
  state = newer;
  tell("trouble", state.trouble);
  renderLine();
  renderQuestion();
  renderKept();
  renderAnswer();
  renderEnd();
  find("undo").disabled = state.undo === "";
  find("undo").title = state.undo;
  find("skip").disabled = find("anew").disabled = find("leave").disabled = find("stop").disabled = state.question === null;
  drawMachine();
  if (document.activeElement === document.body || document.activeElement.offsetParent === null) home();
  document.body.dataset.version = state.version;
}

// The machine as it stands at the reading asked for; after the end its error, found and left.
function drawMachine() {
  const question = state.question, over = state.results !== "" && state.progress.taken > 0;
  show("stood", question !== null || over);
  if (find("stood").hidden) return;
  find("answer")[over ? "after" : "before"](find("stood"));
  const place = find("machine-drawing"), width = Math.round(Math.min(place.clientWidth, 900));
  if (width < 200) return;
  const words = over ? said("The error of the volume") : said("How the instrument stands: {instrument}", { instrument: said(question.instrument) });
  draw(place, `/${over ? "volume" : "setup"}.svg?${new URLSearchParams({ width, version: state.version })}`, words);
}

async function follow() {
  for (;;) {
    try {
      const newest = await call(`/state?seen=${state?.version ?? 0}&wait=20`, undefined, 40000);
      if (newest.ok) render(newest.document);
      else throw new Error(newest.document.sentence);
    } catch (failure) {
      tell("trouble", failure instanceof TypeError ? said("axiscal does not answer. Start axiscal serve again and open the address it prints.") : failure.message);
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
  }
}

async function record(how = {}) {
  const typed = find("field").value.trim();
  if (!typed || state === null || sending?.last === state.last) return; // Enter pressed twice is one reading
  const own = (sending = { last: state.last, typed });
  try {
    await recorded(own, how);
  } finally {
    if (sending === own) sending = null;
  }
}

async function recorded({ last, typed }, how) {
  const meant = how.cause ? null : await understood(typed);
  if (meant?.sentence) {
    find("causes").replaceChildren(...Object.entries(meant.causes).map(([cause, words]) => button(words, () => record({ cause }).then(home))));
    refuse({ problem: meant.surprising ? "surprising" : "refused", sentence: meant.sentence });
    return;
  }
  const done = await step("/readings", { after: last, text: typed, ...how });
  const lost = done.document.problem === "overtaken" ? `${said("“{text}” was not kept.", { text: typed })} ` : "";
  if (done.ok) hear(done.document.sentence);
  else refuse({ ...done.document, sentence: lost + done.document.sentence });
}

let refused = null; // the text that was refused: a look at it that comes later says nothing more
function refuse(problem) {
  refused = find("field").value;
  hear(problem.sentence, true);
  show("doubt", problem.problem === "surprising");
  if (problem.problem === "surprising") find("reread").focus();
  else find("field").focus();
}

async function plain(path, body = {}) {
  if (state === null) return null;
  const pressed = document.activeElement;
  const done = await step(path, body);
  hear(done.document.sentence, !done.ok);
  if (find("task").hidden) tell("trouble", done.ok ? "" : done.document.sentence);
  if ([pressed, document.body].includes(document.activeElement)) home(); // unless the person has gone elsewhere
  return done;
}

// The place where the hands of the person are.  asked : a field that comes before the others while it is shown
function home(...asked) {
  const first = [...asked, "field", "stands", "jogged", "finish"].map(find).find((e) => e.offsetParent !== null);
  first?.focus();
}

// What a text means to the program; null where it does not answer.
async function understood(typed) {
  try {
    const { ok, document: meant } = await call(`/typed?text=${encodeURIComponent(typed)}`, undefined, 5000);
    return ok ? meant : null;
  } catch {
    return null;
  }
}

async function preview() {
  const typed = find("field").value;
  if (!typed.trim()) { drawStrips(); return; }
  const meant = await understood(typed);
  if (meant === null || typed !== find("field").value || state.question === null) return;
  drawStrips(meant.values, meant.surprising);
  if (typed === refused) return;
  hear(meant.surprising ? meant.sentence : "", meant.surprising);
}

function asksForReason(visible, why = "skip") {
  giving = why;
  text("really-skip", why === "skip" ? said("Skip it") : said("Leave it"));
  document.querySelector("label[for=reason]").textContent = why === "skip" ? said("why can it not be taken?") : said("why can nothing more be read with this set-up?");
  show("note-form", false);
  show("skip-form", visible);
  home("reason");
  if (visible) askCost(why === "leave");
}

// What is lost is said before it is done.
async function askCost(rest) {
  text("costs", said("one moment"));
  const { ok, document: cost } = await call(`/cost?rest=${rest}`);
  if (rest === (giving === "leave")) text("costs", ok ? cost.sentence : "");
}

// A number alone is the temperature of the scale where that is asked for.
let warming = false;
function asksForNote(visible, warm = false) {
  warming = warm;
  document.querySelector("label[for=sentence]").textContent = warm ? said("temperature of the scale, °C; may stay empty") : said("what is to be kept in the record? (the temperature: 21.4 °C)");
  show("skip-form", false);
  show("note-form", visible);
  home("sentence");
}

function asksToStop(visible) {
  const p = state.progress, figures = { now: shown(p.now_um), figure: said(p.figure), count: p.coming, minutes: shown(Math.max(p.left_minutes, 1), 0), promised: shown(p.promised_um) };
  text("stop-words", said("Now {figure} = {now} µm; with the readings to come ({count}), in about {minutes} minutes, {promised} µm.", figures));
  show("stopping", visible);
  home("not-stop");
}

on("form", "submit", () => record());
on("reread", "click", () => { show("doubt", false); find("field").select(); find("field").focus(); });
on("jog-form", "submit", () => tryJog(false));
on("jog-anyway", "click", () => tryJog(true));
on("accept", "click", () => plain("/accepts"));
on("to-start", "click", async () => { if ((await call("/leave", {})).ok) location.assign("/"); });
on("anew", "click", () => plain("/zeros"));
on("undo", "click", () => plain("/undo"));
on("skip", "click", () => asksForReason(true));
on("leave", "click", () => asksForReason(true, "leave"));
on("note", "click", () => asksForNote(true));
on("not-note", "click", () => asksForNote(false));
on("note-form", "submit", async () => {
  const typed = find("sentence").value.trim();
  if (warming && !typed) return asksForNote(false);
  const done = await plain("/notes", { text: warming && /\d$/.test(typed) ? `${typed} °C` : typed });
  if (!done?.ok) return;
  find("sentence").value = "";
  asksForNote(false);
});
on("not-skip", "click", () => asksForReason(false));
on("skip-form", "submit", async () => {
  const done = await plain("/skips", { reason: find("reason").value, rest: giving === "leave" });
  if (!done?.ok) return;
  find("reason").value = "";
  asksForReason(false);
});
on("stop", "click", () => asksToStop(true));
on("not-stop", "click", () => asksToStop(false));
on("really", "click", async () => { show("stopping", false); await plain("/finish"); });
on("finish", "click", () => plain("/finish"));
on("more", "click", () => plain("/next"));
on("stands", "click", () => {
  mounted = state.question.setup;
  sessionStorage.setItem("mounted", mounted);
  renderQuestion();
  drawMachine();
  drawStrips();
  begun();
});
find("field").addEventListener("input", () => { show("doubt", false); preview(); });
addEventListener("resize", () => {
  if (state === null) return;
  drawMachine();
  if (state.question) preview();
});

follow();
