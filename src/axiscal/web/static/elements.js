// What pages are made of: elements by name, new ones, the line that says how a step went, and what they ask of the API.
import { said } from "/words.js";

export const find = (id) => document.getElementById(id);

export function element(name, words, kind) {
  const made = document.createElement(name);
  made.textContent = words;
  if (kind) made.className = kind;
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

export function on(id, kind, act) {
  find(id).addEventListener(kind, (event) => { event.preventDefault(); act(); });
}

// What was sent arrives even where the tab is closed in the same moment.
export async function call(path, body) {
  const posted = { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), keepalive: true };
  const answer = await fetch(`/api/1${path}`, body === undefined ? {} : posted);
  return { ok: answer.ok, status: answer.status, document: await answer.json() };
}

const PATIENCE = 1000; // ms after which it is said what is being computed

export async function waiting(work) {
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

// A plan or a result in words: its first line in parts, and a table of a heading and rows.
export function renderWords(first, [heading = [], ...rows]) {
  const line = (kind, cells) => { const row = document.createElement("tr"); row.append(...cells.map((cell) => element(kind, cell))); return row; };
  find("first").replaceChildren(...first.map((part, n) => element(n ? "span" : "strong", part)));
  find("rows").tHead.replaceChildren(...(rows.length ? [line("th", heading)] : []));
  find("rows").tBodies[0].replaceChildren(...rows.map((cells) => line("td", cells)));
}

history.replaceState(null, "", "/"); // the token stays in the cookie alone
