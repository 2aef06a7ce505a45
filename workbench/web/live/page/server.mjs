// What only the server can do: search for equilibria, observables that need the whole solver, files.

import { Refused } from "./rod_case.mjs";

const PAGE = Math.random().toString(36).slice(2); // of this page: each that is open has a share of the searches

/* What the server answers: JSON as plain data, else the answer itself. Throws Refused with the server's sentence. */
export async function post(path, body, signal) {
  let answer;
  try {
    answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Page": PAGE },
      body: JSON.stringify(body),
      signal,
    });
  } catch {
    throw new Refused(
      signal && signal.aborted
        ? ""
        : "The page has lost its server. Start workbench explore again, then reload the page.",
    );
  }
  const isReply = (answer.headers.get("Content-Type") || "").includes("json"),
    reply = isReply ? await answer.json() : answer;
  if (answer.ok && reply.refused === undefined) return reply;
  throw new Refused(asSentence(reply.refused ?? (await answer.text())), reply.field || "");
}

/* ask(path, body, then, refused, isOld): one request a path at a time. isOld: whether the answer is about what is no longer
   shown; default: whether there is another shape since. */
export function makeAsker(shapeOf) {
  const asking = {},
    isOther = (shape) => () => shape !== shapeOf();
  return async (path, body, then, refused, isOld = isOther(shapeOf())) => {
    if (asking[path]) asking[path].abort(); // the server then stops that search
    const mine = (asking[path] = new AbortController());
    try {
      const reply = await post(path, body, mine.signal);
      if (!isOld()) then(reply);
    } catch (error) {
      if (mine.signal.aborted) return; // a newer request replaced it
      if (!(error instanceof Refused)) throw error;
      if (!isOld()) refused(error.sentence);
    }
  };
}

/* A message of the workbench as a sentence of the page. */
export function asSentence(message) {
  const plain = message
    .replace(/^(Rod|Cylinder|Start|Ends)\./, "")
    .replace(/: use workbench equilibria$/, ". The command workbench equilibria has no such limit");
  return plain ? plain[0].toUpperCase() + plain.slice(1) + (/[.!?]$/.test(plain) ? "" : ".") : "";
}
