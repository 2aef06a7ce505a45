// A state of the page as text: as a study file (TOML), and in the address of the page.

import { bytesOf } from "./packed_core.mjs";
import { isState } from "./rod_case.mjs";

const text = (value) => JSON.stringify(value);
const value = (v) => (typeof v === "number" ? decimal(v) : text(v));

/* A float that TOML takes: 20.0, 0.5, 1e-07. */
function decimal(v) {
  const written = String(v);
  return /[.e]/.test(written) ? written : `${written}.0`;
}

export function studyText(state) {
  const rows = [`title = ${text(state.title || "From the live page")}`];
  if (state.reading !== undefined) rows.push(`reading = ${text(state.reading)}`);
  if (state.let_go) rows.push("let_go = true");
  for (const name of ["units", "base", "equilibrium"]) {
    if (!state[name]) continue;
    rows.push("", `[${name}]`);
    for (const [key, v] of Object.entries(state[name]))
      if (v !== null && v !== undefined) rows.push(`${key} = ${value(v)}`);
  }
  return `${rows.join("\n")}\n`;
}

const bytes = (data) => String.fromCharCode(...new TextEncoder().encode(JSON.stringify(data)));

/* Plain data as the part of an address behind "#", and back. */
export const toHash = (data) => btoa(bytes(data)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
export const fromHash = (hash) =>
  JSON.parse(new TextDecoder().decode(bytesOf(hash.replaceAll("-", "+").replaceAll("_", "/"))));

/* The state of the page in its address. */
export function makeAddress(readings) {
  let own = "";

  /* The preset and the state of the address; {} where they are not complete; null where it has none or the page's own. */
  function read() {
    if (location.hash.length < 2 || location.hash === own) return null;
    try {
      const known = fromHash(location.hash.slice(1));
      return isState(known.state, readings) ? known : {};
    } catch {
      return {};
    }
  }

  function show(known) {
    own = `#${toHash(known)}`;
    history.replaceState(null, "", own);
  }

  return { read, show };
}
