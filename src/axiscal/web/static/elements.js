// What a page is made of: its elements by name, new ones, and the line that says how a step went.
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
