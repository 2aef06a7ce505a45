// Files, pictures and texts that leave the page.

import { element, make, set } from "./details.mjs";
import { drawPicture } from "./picture.mjs";
import { Refused, fieldNames, isUnused } from "./rod_case.mjs";
import { post } from "./server.mjs";
import { studyText } from "./study_text.mjs";

const say = (text) => set(element("message"), text);

function save(content, name) {
  const url = URL.createObjectURL(content);
  make("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

/* me: the page's state and shape; data: what the page began with. */
export async function savePicture(me, view, data) {
  if (view.scene && view.scene.isLost()) return say("There is no picture to save: the browser has stopped drawing the rod.");
  const named = fieldNames(me.state).filter((name) => !isUnused(me.state, name));
  const rows = named.map((name) => [name, element(`n-${name}`).value]),
    { colours: code, quantities } = data;
  const { title } = data.presets.find((one) => one.name === me.preset);
  const [{ state, shape }, [, read] = []] = [me, data.readings[me.state.reading]];
  save(await drawPicture({ view, shape, code, rows, quantities, state, title, read }), `${me.preset}.png`);
  say("The picture is in your downloads.");
}

export async function saveFile(me, kind, served) {
  say("");
  try {
    const asked = { kind, state: me.state };
    const own = () => new Blob([csvText(me.shape, me.state.units)], { type: "text/csv" });
    save(served ? await (await post("/download", asked)).blob() : own(), `${me.preset}.${kind}`);
    say(`The ${kind.toUpperCase()} file is in your downloads.`);
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    say(error.sentence);
  }
}

export async function copyText(text, then) {
  try {
    await navigator.clipboard.writeText(text);
    say(then);
  } catch {
    say("The browser does not allow copying: copy the text by hand.");
  }
}

export function showStudy(state) {
  const text = studyText(state);
  element("study-text").value = text;
  element("study").showModal();
  return copyText(text, "The study is copied.");
}

/* The shape as a table of text (CSV). */
function csvText({ s, x, y, z, alpha, beta, dbeta, push, kappa, tension }, { length, force }) {
  const columns = {
    [`s [${length}]`]: s,
    [`x [${length}]`]: x,
    [`y [${length}]`]: y,
    [`z [${length}]`]: z,
    "alpha [rad]": alpha,
    "beta [rad]": beta,
    [`dbeta [rad/${length}]`]: dbeta,
    [`kappa [1/${length}]`]: kappa,
    [`F3 [${force}]`]: tension,
    [`push [${force}/${length}]`]: push,
  };
  const rows = Array.from(s, (_, i) => Object.values(columns).map((column) => column[i]));
  return `${[Object.keys(columns), ...rows].map((row) => row.join(",")).join("\r\n")}\r\n`;
}
