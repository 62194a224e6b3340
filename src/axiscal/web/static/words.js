// The language of the page: English in the code, another one from the catalogue that the server has.
export const { language, messages } = await (await fetch("/words.json")).json();

// What stands before the decimals of a value; places keep the point, as controls have them.
export const DECIMAL = new Intl.NumberFormat(language).format(0.5)[1];

export function said(message, values = {}) {
  return (messages[message] ?? message).replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

// What stands in the page itself.
export function translate(root) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const text = node.data.trim();
    if (text) node.data = node.data.replace(text, said(text));
  }
  for (const named of root.querySelectorAll("[aria-label]")) named.setAttribute("aria-label", said(named.getAttribute("aria-label")));
  document.documentElement.lang = language;
}
