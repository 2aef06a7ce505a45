// A state of the page as the text of a study file (TOML).

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
  JSON.parse(
    new TextDecoder().decode(
      Uint8Array.from(atob(hash.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0)),
    ),
  );
