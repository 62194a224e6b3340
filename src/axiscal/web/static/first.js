// The form of a first description: what is chosen, what is lacking, the files as they would be, and as they are.
import { element, find, hear } from "/elements.js";
import { LANGUAGE, said, translate } from "/words.js";

const ROOT = "/api/1/first";
let form = null;
let supposed = ""; // the chain that nobody has confirmed by changing it

translate(document.body);
history.replaceState(null, "", "/"); // the token stays in the cookie alone

async function call(path, body) {
  const headers = { "Accept-Language": LANGUAGE };
  const posted = { method: "POST", headers: { ...headers, "Content-Type": "application/json" }, body: JSON.stringify(body) };
  try {
    const answer = await fetch(ROOT + path, body === undefined ? { headers } : posted);
    const found = await answer.json();
    if (!answer.ok) hear(found.sentence, true);
    return answer.ok ? found : null;
  } catch {
    hear(said("axiscal does not answer any more: start it again"), true);
    return null;
  }
}

function renderForm() {
  const select = find("source");
  select.append(new Option(said("choose one"), "-1"));
  const kinds = [["LinuxCNC", (s) => s.file], [said("built in"), (s) => !s.file]];
  for (const [name, belongs] of kinds) {
    const group = document.createElement("optgroup");
    group.label = name;
    form.sources.forEach((source, n) => belongs(source) && group.append(new Option(source.name, String(n))));
    if (group.children.length) select.append(group);
  }
  select.value = String(form.chosen);
  for (const { name, what } of form.instruments) {
    const label = document.createElement("label"), box = document.createElement("input");
    box.type = "checkbox";
    box.value = name;
    box.checked = form.taken.includes(name);
    label.append(box, element("span", `${said(name)}: ${what}`));
    find("instruments").append(label);
  }
  find("target").value = form.target;
}

async function renderMachine() {
  const chosen = Number(find("source").value);
  hear("");
  find("files").hidden = true;
  find("limits").hidden = find("build").hidden = true;
  find("axes").replaceChildren();
  find("chain").value = supposed = "";
  find("file").textContent = chosen < 0 ? "" : form.sources[chosen].file;
  if (chosen < 0) return;
  const machine = await call(`/machine?source=${chosen}`);
  if (machine === null || chosen !== Number(find("source").value)) return;
  find("limits").hidden = machine.lacking.length === 0;
  find("axes").replaceChildren(...machine.lacking.map(limitsOf));
  find("build").hidden = machine.sure;
  supposed = machine.chain;
  find("chain").value = (chosen === form.chosen && form.chain) || machine.chain;
}

function limitsOf({ axis, unit }) {
  const line = element("div", "", "entry");
  const field = (name) => {
    const made = document.createElement("input");
    made.type = "text";
    made.inputMode = "text";
    made.maxLength = 40;
    made.dataset.axis = axis;
    made.setAttribute("aria-label", `${axis}, ${name}, ${unit}`);
    return made;
  };
  line.append(element("b", axis), field(said("lower limit")), element("span", "…"), field(said("upper limit")), element("span", unit));
  return line;
}

function chosen() {
  const limits = {};
  for (const field of find("axes").querySelectorAll("input")) (limits[field.dataset.axis] ??= []).push(field.value);
  const chain = find("chain").value.trim();
  return {
    source: Number(find("source").value),
    chain: chain === supposed ? "" : chain,
    limits,
    instruments: [...find("instruments").querySelectorAll("input:checked")].map((box) => box.value),
    target: find("target").value,
  };
}

async function made(path) {
  const request = chosen();
  if (request.source < 0) {
    hear(said("Choose a machine to begin with"), true);
    find("source").focus();
    return;
  }
  hear(said("one moment"));
  const files = await call(path, request);
  if (files === null) return;
  const written = path === "/files";
  hear("");
  find("state").textContent = written ? said("The files are written") : said("These files would be written");
  const setups = said("{count} set-ups are offered; a plan takes what is worth mounting.", { count: files.setups });
  find("offered").textContent = `${files.folder}. ${setups}`;
  const doubts = files.look.map((what) => `${said("Look at")}: ${what}`);
  find("doubts").replaceChildren(...doubts.map((words) => element("li", words)));
  find("after").replaceChildren(...(written ? files.after : []).map((command) => {
    const line = element("li", "");
    line.append(element("code", command));
    return line;
  }));
  find("machine-text").textContent = files.machine;
  find("campaign-text").textContent = files.campaign;
  find("files").hidden = false;
  if (!written) return;
  for (const each of find("form").elements) each.disabled = true;
  hear(said("This page has done its work; go on in the terminal."));
}

find("form").addEventListener("submit", (event) => {
  event.preventDefault();
  made("/files");
});
find("look").addEventListener("click", () => made("/preview"));
find("source").addEventListener("change", renderMachine);

form = await call("");
if (form !== null) {
  renderForm();
  await renderMachine();
  find("source").focus();
}
