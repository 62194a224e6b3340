// What pages are made of: elements by name, new ones, the line that says how a step went, and what they ask of the API.
import { said } from "/words.js";

export const find = (id) => document.getElementById(id);

export function element(name, words, kind) {
  const made = document.createElement(name);
  made.textContent = words;
  if (kind) made.className = kind;
  return made;
}

export function button(words, act) {
  const made = Object.assign(element("button", words), { type: "button" });
  made.addEventListener("click", act);
  return made;
}

export function hear(words, alarm = false) {
  find("heard").textContent = words;
  find("heard").className = alarm ? "alarm" : "";
}

export function text(id, words) {
  find(id).textContent = words;
}

export function show(id, visible) {
  find(id).hidden = !visible;
}

// A line that is there where it says something.
export function tell(id, words) {
  text(id, words);
  show(id, words !== "");
}

export function on(id, kind, act) {
  find(id).addEventListener(kind, (event) => { event.preventDefault(); act(); });
}

// The printed address hands the token over, which this tab keeps until it is closed. Another tab opens that address too.
const given = location.hash.slice(1);
if (given) sessionStorage.setItem("token", given);
history.replaceState(history.state, "", "/");
addEventListener("hashchange", () => location.reload()); // a new address in a tab that shows the page

// What was sent arrives even where the tab is closed in the same moment.
// within : ms after which the way there counts as gone
export async function call(path, body, within = 600000) {
  const answer = await asked(`/api/1${path}`, body, within);
  return { ok: answer.ok, status: answer.status, document: await answer.json() };
}

function asked(path, body, within = 600000) {
  const headers = { Authorization: `Bearer ${sessionStorage.getItem("token")}` };
  const posted = { method: "POST", headers: { ...headers, "Content-Type": "application/json" }, body: JSON.stringify(body), keepalive: true };
  return fetch(path, { ...(body === undefined ? { headers } : posted), signal: AbortSignal.timeout(within) });
}

// An address in this tab of what the page answers, "" where that is nothing; a refusal is thrown.
export async function held(path) {
  const answer = await asked(path);
  if (!answer.ok) throw new Error((await answer.json()).sentence);
  return answer.status === 204 ? "" : URL.createObjectURL(await answer.blob());
}

// The picture of a place, made if there is none; it stays while the same is asked for, and the newest wins.
export async function draw(place, path, words) {
  const picture = place.querySelector("img") ?? place.appendChild(document.createElement("img"));
  picture.alt = words;
  if (picture.dataset.path === path) return;
  picture.dataset.path = path;
  const address = await held(path).catch(() => "");
  if (address && picture.dataset.path === path) picture.src = address;
}

const PATIENCE = 1000; // ms after which it is said what is being computed

export async function waiting(work) {
  let over = false; // what is being computed may be said after it is done
  const look = setInterval(async () => {
    const now = await call("/stage", undefined, PATIENCE).catch(() => null);
    if (now?.ok && !over) text("doing", [said("one moment"), now.document.sentence].filter((words) => words).join(": "));
  }, PATIENCE);
  try {
    return await work;
  } finally {
    over = true;
    clearInterval(look);
    text("doing", "");
  }
}

const FEW = 3; // columns that a narrow screen has room for; of more each row stands in lines

export function renderFirst(parts) {
  find("first").replaceChildren(...parts.map((part, n) => element(n ? "span" : "strong", part)));
}

// A plan or a result in words: its first line in parts, and a table of a heading and rows.
export function renderWords(first, [heading = [], ...rows]) {
  const line = (kind, cells) => { const row = document.createElement("tr"); row.append(...cells.map((cell, n) => Object.assign(element(kind, cell), { title: heading[n] }))); return row; };
  renderFirst(first);
  find("rows").tHead.replaceChildren(...(rows.length ? [line("th", heading)] : []));
  find("rows").tBodies[0].replaceChildren(...rows.map((cells) => line("td", cells)));
  find("rows").className = heading.length > FEW ? "many" : "";
}
