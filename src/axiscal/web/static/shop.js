// Devices of the shop: at the computer a code that lets one in for a person, on the device whose readings it keeps.
import { call, device, find, on, person, show, text } from "/elements.js";
import { put } from "/pictures.js";
import { said } from "/words.js";

async function showCode() {
  const { ok, document: code } = await call("/codes", { person: find("device-person").value });
  text("device-fault", ok ? "" : code.sentence);
  show("device-code", ok);
  if (!ok) return;
  text("device-words", said("{person}: scan it within 10 min, or open {address}", code));
  text("device-print", said("SHA-256 of the certificate: {fingerprint}", code));
  find("device-picture").replaceChildren();
  const edge = code.rows.length + 8; // a margin of four squares, as ISO/IEC 18004 asks for
  const svg = put(find("device-picture"), "svg", { viewBox: `-4 -4 ${edge} ${edge}`, role: "img", "aria-label": said("a code to scan") });
  put(svg, "rect", { x: -4, y: -4, width: edge, height: edge, fill: "#fff" });
  const squares = code.rows.flatMap((row, y) => [...row].map((dark, x) => (dark === "1" ? `M${x} ${y}h1v1h-1z` : "")));
  put(svg, "path", { d: squares.join(""), fill: "#000" });
}

show("device", !device);
text("who", person ? said("Readings of this device are kept by the name of {person}.", { person }) : "");
on("device", "click", () => { show("device-form", find("device-form").hidden); find("device-person").focus(); });
on("device-form", "submit", showCode);
